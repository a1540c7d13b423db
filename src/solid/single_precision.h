// A yarn's skin in single precision, as formats of pictures and of printing have it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/units.h"
#include "solid/tessellation.h"

namespace selvage::solid {

struct SingleSkin {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // as Tessellation::triangles
  double spacing = 0;  // between neighbouring numbers where the largest coordinate is, file units
};

// Each coordinate is the number nearest to it. Ends of an edge that become one point are one vertex, and the
// triangles at that edge are none: what was closed stays closed. Errors (limit): a coordinate beyond the
// range of single precision; not one triangle is left.
Result<SingleSkin> in_single_precision(const yarn::Body& body, Tessellation&& skin);

// Looks after what single precision costs the yarns of one file.
class PrecisionWatch {
 public:
  // `tolerance` of the triangles, file units, > 0.
  void look(const yarn::Body& body, double spacing, double tolerance);
  // Of the yarn that suffers most; none where no spacing is above its tolerance. `format`: "STL".
  [[nodiscard]] std::optional<Message> warning(std::string_view format, Unit units) const;

 private:
  double worst_ = 1;  // spacing over tolerance
  double spacing_ = 0, tolerance_ = 0;
  std::string yarn_;
  TextPlace place_;
};

}  // namespace selvage::solid
