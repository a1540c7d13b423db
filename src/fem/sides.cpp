#include "fem/sides.h"

#include <algorithm>
#include <optional>

namespace selvage::fem {
namespace {

struct Key {
  ElementSide nodes{};  // increasing; of a triangle the largest twice
  std::size_t element = 0, side = 0, region = 0;
  [[nodiscard]] bool is_same_place(const Key& other) const { return nodes == other.nodes; }
  bool operator<(const Key& other) const {
    if (nodes != other.nodes) return nodes < other.nodes;
    return element != other.element ? element < other.element : side < other.side;
  }
};

// The face of the cell in which all corners stand.
int face_of(const Mesh& mesh, const std::optional<Parallelepiped>& cell, const ElementSide& nodes) {
  if (!cell) return -1;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {1, -1})
      if (std::all_of(nodes.begin(), nodes.end(),
                      [&](std::size_t node) { return cell->side_of(mesh.nodes[node], axis) == side; }))
        return 2 * axis + (side > 0 ? 0 : 1);
  return -1;
}

}  // namespace

std::span<const ElementSide> element_sides(Mesh::Shape shape) {
  static constexpr std::array<ElementSide, 4> tetrahedron = {
      {{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {2, 0, 3, 3}}};
  static constexpr std::array<ElementSide, 6> hexahedron = {
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  if (shape == Mesh::Shape::tetrahedron) return tetrahedron;
  return hexahedron;
}

std::span<const ElementSide> element_sides(const Mesh& mesh, std::size_t element) {
  static constexpr std::array<ElementSide, 5> wedge = {
      {{0, 2, 1, 1}, {4, 5, 6, 6}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 0, 4, 6}}};
  // The same of six nodes.
  static constexpr std::array<ElementSide, 5> layer = {
      {{0, 2, 1, 1}, {3, 4, 5, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
  if (element >= mesh.elements.size()) return layer;
  if (mesh.is_wedge(element)) return wedge;
  return element_sides(mesh.shape);
}

ElementSide side_nodes(const Mesh& mesh, std::size_t element, std::size_t side) {
  ElementSide nodes = element_sides(mesh, element)[side];
  const std::size_t count = mesh.elements.size();
  for (std::size_t& node : nodes)
    node = element < count ? mesh.elements[element][node] : mesh.layers.wedges[element - count][node];
  return nodes;
}

std::vector<OuterSide> outer_sides(const Mesh& mesh) {
  std::vector<Key> keys;
  keys.reserve(element_sides(mesh.shape).size() * mesh.elements.size());
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    for (std::size_t e = mesh.regions[i].first_element; e < mesh.regions[i].last_element; ++e)
      for (std::size_t s = 0; s < element_sides(mesh, e).size(); ++s) {
        Key key{side_nodes(mesh, e, s), e, s, i};
        // Which corner of a triangle is repeated depends on the element from which it is seen.
        if (key.nodes[2] == key.nodes[3])
          key.nodes[3] = *std::max_element(key.nodes.begin(), key.nodes.end());
        std::sort(key.nodes.begin(), key.nodes.end());
        keys.push_back(key);
      }
  std::sort(keys.begin(), keys.end());
  std::vector<OuterSide> sides;
  std::optional<Parallelepiped> cell;
  if (mesh.cell) cell = mesh.cell->shape();
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const Key& key = keys[k];
    std::size_t behind = OuterSide::outside;
    if (k > 0 && keys[k - 1].is_same_place(key)) behind = keys[k - 1].region;
    if (k + 1 < keys.size() && keys[k + 1].is_same_place(key)) behind = keys[k + 1].region;
    if (behind == key.region) continue;
    OuterSide side{key.element, key.side, key.region, behind, -1, side_nodes(mesh, key.element, key.side)};
    if (behind == OuterSide::outside) side.face = face_of(mesh, cell, side.nodes);
    sides.push_back(side);
  }
  std::sort(sides.begin(), sides.end(), [](const OuterSide& a, const OuterSide& b) {
    return a.element != b.element ? a.element < b.element : a.side < b.side;
  });
  return sides;
}

Vec3 area_vector(const Mesh& mesh, const ElementSide& side) {
  // Of a quadrilateral, and of a triangle whose last corner is repeated: half the product of the diagonals.
  return (mesh.nodes[side[2]] - mesh.nodes[side[0]]).cross(mesh.nodes[side[3]] - mesh.nodes[side[1]]) / 2;
}

}  // namespace selvage::fem
