#include "results/field_mesh.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/words.h"

namespace selvage::fem {

namespace {

using Shape = FieldMesh::Shape;

constexpr std::uint8_t none = 255;
// Corners of an element's sides, outward, for elements as VTK orders them; of triangles the last is `none`.
using Side = std::array<std::uint8_t, 4>;

std::span<const Side> sides_of(Shape shape) {
  static constexpr std::array<Side, 1> triangle = {{{0, 1, 2, none}}};
  static constexpr std::array<Side, 1> quadrilateral = {{{0, 1, 2, 3}}};
  static constexpr std::array<Side, 4> tetrahedron = {
      {{0, 2, 1, none}, {0, 1, 3, none}, {1, 2, 3, none}, {0, 3, 2, none}}};
  static constexpr std::array<Side, 5> pyramid = {
      {{0, 3, 2, 1}, {0, 1, 4, none}, {1, 2, 4, none}, {2, 3, 4, none}, {3, 0, 4, none}}};
  // VTK's wedge, whose first triangle looks outward.
  static constexpr std::array<Side, 5> wedge = {
      {{0, 1, 2, none}, {3, 5, 4, none}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
  static constexpr std::array<Side, 6> hexahedron = {
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  switch (shape) {
    case Shape::triangle:
      return triangle;
    case Shape::quadrilateral:
      return quadrilateral;
    case Shape::tetrahedron:
      return tetrahedron;
    case Shape::pyramid:
      return pyramid;
    case Shape::wedge:
      return wedge;
    case Shape::hexahedron:
      return hexahedron;
  }
  return {};
}

// A side of an element, with its nodes in increasing order.
struct Known {
  std::array<std::uint32_t, 4> nodes{};
  std::uint32_t region = 0, element = 0;
  std::uint8_t side = 0;
  [[nodiscard]] bool same(const Known& other) const { return region == other.region && nodes == other.nodes; }
  bool operator<(const Known& other) const {
    return std::tie(region, nodes, element, side) <
           std::tie(other.region, other.nodes, other.element, other.side);
  }
};

}  // namespace

std::size_t corner_count(Shape shape) {
  switch (shape) {
    case Shape::triangle:
      return 3;
    case Shape::quadrilateral:
    case Shape::tetrahedron:
      return 4;
    case Shape::pyramid:
      return 5;
    case Shape::wedge:
      return 6;
    case Shape::hexahedron:
      return 8;
  }
  return 0;
}

bool is_matrix(const std::string& region) {
  return same_word(region, "matrix");
}

Outside outside_of(const FieldMesh& mesh) {
  std::vector<Known> sides;
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    const FieldMesh::Element& element = mesh.elements[e];
    const std::span<const Side> own = sides_of(element.shape);
    for (std::size_t k = 0; k < own.size(); ++k) {
      Known side{{}, element.region, e, static_cast<std::uint8_t>(k)};
      for (std::size_t i = 0; i < 4; ++i)
        side.nodes[i] =
            own[k][i] == none ? std::numeric_limits<std::uint32_t>::max() : element.corners[own[k][i]];
      std::sort(side.nodes.begin(), side.nodes.end());
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end());
  Outside outside;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].same(sides[k])) ++end;
    if (end == k + 1) {
      const FieldMesh::Element& element = mesh.elements[sides[k].element];
      const Side& side = sides_of(element.shape)[sides[k].side];
      const auto corner = [&](std::size_t i) { return element.corners[side[i]]; };
      outside.triangles.push_back({corner(0), corner(1), corner(2)});
      outside.element.push_back(sides[k].element);
      outside.inner.push_back(side[3] != none ? 2 : 0);
      if (side[3] != none) {
        outside.triangles.push_back({corner(0), corner(2), corner(3)});
        outside.element.push_back(sides[k].element);
        outside.inner.push_back(3);
      }
    }
    k = end - 1;
  }
  return outside;
}

}  // namespace selvage::fem
