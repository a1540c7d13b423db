// Shapes of yarns that were swept lately. A cloth's yarns are mostly one of a few, each at many places.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include "yarn/body.h"
#include "yarn/ends.h"
#include "yarn/path.h"
#include "yarn/tube.h"

namespace selvage::fabric {

// From several threads. What is kept changes no body but for Body::shape, which says that two bodies are one
// shape only where they are.
class ShapeMemo {
 public:
  // Everything that decides the shape of a body.
  struct Plan {
    yarn::CentreLine line;
    yarn::TubeSpec spec;
    yarn::Sealings sealings;
    bool operator==(const Plan&) const = default;
  };

  // Null where no body of this plan is kept, which then may be swept and kept.
  [[nodiscard]] std::shared_ptr<const yarn::Body> find(const Plan& plan);
  // Gives the body its number of a shape. One with messages, which name their yarn, is not kept. The shapes
  // that were not asked for for longest are forgotten where all take too much memory.
  void keep(const Plan& plan, yarn::Body& body);
  // The number of a shape that was mapped rigidly: 0 stays 0.
  [[nodiscard]] std::uint64_t mapped(std::uint64_t shape, const Eigen::Matrix3d& linear);

 private:
  struct Known {
    std::size_t hash = 0, bytes = 0;
    Plan plan;
    std::shared_ptr<const yarn::Body> body;
  };
  // With the lock held; what was asked for last comes first.
  [[nodiscard]] const Known* look_up(std::size_t hash, const Plan& plan);

  std::mutex mutex_;
  std::list<Known> known_;
  std::size_t bytes_ = 0;
  std::uint64_t last_shape_ = 0;
  std::map<std::pair<std::uint64_t, std::array<double, 9>>, std::uint64_t> mapped_;
};

}  // namespace selvage::fabric
