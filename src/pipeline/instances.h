// Yarns that are equal up to a rigid motion, found among all yarns of a fabric: each shape is written once.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "formats/format.h"
#include "yarn/body.h"

namespace selvage::pipeline {

// Two passes over the same yarns: count() each, then place() each. Memory: a few numbers a yarn that is like
// no other, and of each shape that comes again its yarn, until the last one that may be a copy was placed.
class InstanceFinder {
 public:
  // No copy lies farther from its yarn than 1e-9 of the yarn's box, and `tolerance` where it is above 0.
  explicit InstanceFinder(double tolerance) : tolerance_(tolerance) {}

  void count(const yarn::Body& body);
  // Nothing for a yarn that is like no other.
  std::optional<formats::Instance> place(const yarn::Body& body);
  struct Found {
    std::size_t shapes = 0, copies = 0;  // the yarns that are written by reference, and of how many shapes
    double largest_deviation = 0;        // of a copy from the yarn as it was built; in the yarns' unit
  };
  [[nodiscard]] const Found& found() const { return found_; }

 private:
  // What must be the same, role, colour and density (to six places) among it: a copy has those of its shape.
  using Kind = std::tuple<int, int, int, int, bool, bool, int, int, int, int, int, int, long long>;
  static Kind kind_of(const yarn::Body& body);
  [[nodiscard]] double tolerance_of(const yarn::Body& body) const;

  struct Shape {
    std::size_t number = 0;
    std::shared_ptr<const yarn::Body> body;
  };
  // Yarns that may be copies of each other, by their invariants.
  struct Class {
    yarn::Invariants invariants;
    std::size_t to_come = 0;
    std::vector<Shape> shapes;
  };
  using Classes = std::multimap<double, Class>;  // by the first invariant
  Class* find(Classes& classes, const yarn::Invariants& invariants, double tolerance);

  double tolerance_;
  std::map<Kind, Classes> kinds_;
  Found found_;
};

}  // namespace selvage::pipeline
