// What is different between two CAD models: which yarns, parts and curves came, went, moved, changed their
// shape, their name or their colour.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cad/distance.h"
#include "cad/motion.h"
#include "cad/things.h"

namespace selvage::cad {

struct CompareOptions {
  double tolerance = 0;  // of distances, in the models' common unit; 0: to the bit where the bases agree
  // What a change of unit may have left, as a share of the largest coordinate; added to the tolerance.
  double rounding = 0;
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;  // may be null; not called at once
};

struct Difference {
  enum class Kind { added, removed, moved, reshaped, renamed, recoloured };
  Kind kind = Kind::added;
  Thing::Kind what = Thing::Kind::part;
  std::string name;          // in a; of what was added, in b
  std::string other_name;    // in b
  std::string entity;        // where it stands in its file, as the file's format says it; may be empty
  Box3 box;                  // added, removed
  std::size_t surfaces = 0;  // added, removed: how many it has
  Motion motion;             // moved
  // reshaped: how far, and where (in a). `at_least` is a distance that was found, `at_most` its certified
  // bound; where control points were compared both are the largest distance of two of them.
  Reach reach;
  std::string surface;  // which of its surfaces; empty: it has one
  struct ControlPoint {
    int i = 0, j = 0, count_i = 0, count_j = 0;  // from 1; of a curve count_j is 1
    std::size_t changed = 0,
                points = 0;  // of this thing, how many of how many are farther than the tolerance
  };
  std::optional<ControlPoint> control_point;
  Color before, after;      // recoloured
  bool is_swapped = false;  // renamed: what had the other name has this one's now
};
std::string_view name_of(Difference::Kind kind);

struct Comparison {
  struct Counts {
    std::size_t yarns = 0, parts = 0, surfaces = 0, curves = 0;
  };
  Counts a, b;
  std::vector<Difference> differences;  // in the order of a, what was added last
  std::size_t equal = 0;                // things of a without any difference
  // Of these, how many without a bound within the tolerance: nothing farther was found at the points that
  // were looked at, which are the denser the less the bound says.
  std::size_t uncertain = 0;
  double largest = 0;              // bound on the deviation of all that is within the tolerance
  std::string largest_of;          // the thing that has it
  std::vector<std::string> notes;  // what is no difference of geometry: units, missing names, ...
  struct Match {
    Thing::Kind what = Thing::Kind::part;
    std::string name;                  // in a
    double at_least = 0, at_most = 0;  // how far it is from its partner; infinite: no bound
  };
  std::vector<Match> matches;  // in the order of a
};

// Both models in one unit. A name or a colour that only one of the two has is a note, not a difference.
Comparison compare(const Subject& a, const Subject& b, const CompareOptions& options);

}  // namespace selvage::cad
