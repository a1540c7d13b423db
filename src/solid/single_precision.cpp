#include "solid/single_precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/groups.h"

namespace selvage::solid {

namespace {

// Corners of no distance are one, and triangles between two such corners go.
void drop_collapsed(SingleSkin& skin) {
  std::optional<Groups> groups;
  for (const auto& t : skin.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (skin.vertices[a] != skin.vertices[b]) continue;
      if (!groups) groups.emplace(skin.vertices.size());
      groups->join(a, b);
    }
  if (!groups) return;
  for (auto& t : skin.triangles)
    for (std::uint32_t& corner : t) corner = groups->of(corner);
  std::erase_if(skin.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

}  // namespace

Result<SingleSkin> in_single_precision(const yarn::Body& body, Tessellation&& skin) {
  SingleSkin single;
  single.vertices.reserve(skin.vertices.size());
  float largest = 0;
  for (const Vec3& p : skin.vertices) {
    // Adding 0 leaves no negative one.
    single.vertices.push_back(p.cast<float>() + Eigen::Vector3f::Zero());
    largest = std::max(largest, single.vertices.back().cwiseAbs().maxCoeff());
  }
  if (!std::isfinite(largest))
    return error(Kind::limit,
                 fmt::format("yarn '{}' has coordinates above {:.1e}, which single precision does not hold",
                             body.name, std::numeric_limits<float>::max()),
                 yarn::about(body));
  single.spacing = static_cast<double>(std::nextafter(largest, std::numeric_limits<float>::infinity())) -
                   static_cast<double>(largest);
  single.triangles = std::move(skin.triangles);
  drop_collapsed(single);
  if (single.triangles.empty())
    return error(Kind::limit,
                 fmt::format("nothing is left of yarn '{}' in single precision: it is too thin for its "
                             "distance from the origin; move it there, or write doubles (obj, ply)",
                             body.name),
                 yarn::about(body));
  return single;
}

void PrecisionWatch::look(const yarn::Body& body, double spacing, double tolerance) {
  if (spacing / tolerance <= worst_) return;
  worst_ = spacing / tolerance;
  spacing_ = spacing;
  tolerance_ = tolerance;
  yarn_ = body.name;
  place_ = body.place;
}

std::optional<Message> PrecisionWatch::warning(std::string_view format, Unit units) const {
  if (worst_ <= 1) return std::nullopt;
  return selvage::warning(
      Kind::limit,
      fmt::format(
          "{} has single precision: where yarn '{}' is, neighbouring coordinates are {:.2g} {} apart, "
          "more than the tolerance {:.2g}; move the yarns towards the origin, or write doubles (obj, "
          "ply)",
          format, yarn_, spacing_, name_of(units), tolerance_),
      {.place = place_, .yarn = yarn_});
}

}  // namespace selvage::solid
