#include "cell_problem/pores.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "fem/cell_sides.h"
#include "fem/quality.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

using Corners = std::array<std::size_t, 3>;  // of a side, increasing

Corners corners_of(const ElementSide& nodes) {
  Corners corners = {nodes[0], nodes[1], nodes[2]};
  std::sort(corners.begin(), corners.end());
  return corners;
}

// The walls: what of the matrix's boundary has a yarn behind it. Elements are those of the whole mesh.
std::vector<Patch> walls_of(const Mesh& mesh) {
  const std::size_t matrix = mesh.regions.size() - 1;
  std::vector<Patch> walls(matrix);
  for (std::size_t yarn = 0; yarn < matrix; ++yarn) walls[yarn].name = mesh.regions[yarn].name;
  for (const OuterSide& side : outer_sides(mesh))
    if (side.region == matrix && side.behind != OuterSide::outside)
      walls[side.behind].sides.push_back({side.element, side.side});
  std::erase_if(walls, [](const Patch& wall) { return wall.sides.empty(); });
  return walls;
}

template <class Value>
void keep_range(std::vector<Value>& values, std::size_t first, std::size_t last) {
  if (values.empty()) return;
  values.resize(last);
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
}

// Nodes that no element has are left out.
void renumber_nodes(Mesh& mesh) {
  constexpr std::size_t unused = static_cast<std::size_t>(-1);
  std::vector<std::size_t> number(mesh.nodes.size(), unused);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const std::size_t node : mesh.nodes_of(e)) number[node] = 0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] == unused) continue;
    mesh.nodes[count] = mesh.nodes[n];
    number[n] = count++;
  }
  mesh.nodes.resize(count);
  const auto per_element = static_cast<std::size_t>(mesh.nodes_per_element());
  for (auto& element : mesh.elements)
    for (std::size_t k = 0; k < per_element; ++k) element[k] = number[element[k]];
}

}  // namespace

Status keep_pores(Mesh& mesh) {
  if (mesh.regions.empty() || mesh.regions.back().kind != Region::Kind::matrix)
    return error(Kind::geometry, "the yarns fill the cell: there is no space between them");
  mesh.patches = walls_of(mesh);
  Region pores = std::move(mesh.regions.back());
  const std::size_t first = pores.first_element, last = pores.last_element;
  for (Patch& wall : mesh.patches)
    for (Patch::Side& side : wall.sides) side.element -= first;
  keep_range(mesh.elements, first, last);
  keep_range(mesh.along, first, last);
  keep_range(mesh.across, first, last);
  keep_range(mesh.element_material, first, last);
  mesh.fibre_fraction.clear();
  pores.name = "pores";
  pores.first_element = 0;
  pores.last_element = mesh.elements.size();
  mesh.regions.clear();
  mesh.regions.push_back(std::move(pores));
  renumber_nodes(mesh);
  return {};
}

void add_face_patches(Mesh& mesh) {
  const UnitCell& cell = *mesh.cell;
  std::map<Corners, Patch::Side> by_corners;
  for (const OuterSide& side : outer_sides(mesh))
    if (side.face >= 0) by_corners[corners_of(side.nodes)] = {side.element, side.side};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string letter(1, "xyz"[axis]);
    const bool is_periodic = cell.periodic[axis];
    for (const bool high : {false, true}) {
      Patch patch;
      patch.kind = is_periodic ? Patch::Kind::periodic : Patch::Kind::open;
      patch.name = is_periodic ? letter + (high ? "_high" : "_low") : (high ? "outlet_" : "inlet_") + letter;
      patch.opposite = high ? mesh.patches.size() - 1 : mesh.patches.size() + 1;
      for (const ElementSide& nodes : cell.face_sides[2 * axis + (high ? 0 : 1)])
        patch.sides.push_back(by_corners.at(corners_of(nodes)));
      if (!patch.sides.empty()) mesh.patches.push_back(std::move(patch));
    }
  }
}

namespace {

using Offset = std::array<int, 3>;  // in cells

Offset operator+(Offset a, const Offset& b) {
  for (std::size_t k = 0; k < 3; ++k) a[k] += b[k];
  return a;
}
Offset operator-(Offset a, const Offset& b) {
  for (std::size_t k = 0; k < 3; ++k) a[k] -= b[k];
  return a;
}

// Sets of elements that hang together. Each knows in which cell it stands, seen from its root; where two ways
// lead to one element in different cells, the set is a passage along the axes in which these differ.
class Parts {
 public:
  explicit Parts(std::size_t count) : parent_(count), offset_(count), crossed_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  // Element b stands `step` cells from where it is, seen from a.
  void join(std::size_t a, std::size_t b, const Offset& step) {
    const std::size_t root_a = root_of(a), root_b = root_of(b);
    const Offset there = offset_[a] + step - offset_[b];  // of b's root, seen from a's
    if (root_a == root_b) {
      for (std::size_t k = 0; k < 3; ++k)
        if (there[k] != 0) crossed_[root_a][k] = true;
      return;
    }
    parent_[root_b] = root_a;
    offset_[root_b] = there;
    for (std::size_t k = 0; k < 3; ++k) crossed_[root_a][k] = crossed_[root_a][k] || crossed_[root_b][k];
  }

  std::size_t root_of(std::size_t element) {
    std::vector<std::size_t> way;
    while (parent_[element] != element) {
      way.push_back(element);
      element = parent_[element];
    }
    // From the root's side: each next one's offset is that of its parent, which is done, and its own.
    for (std::size_t k = way.size(); k-- > 0;) {
      const std::size_t own = way[k];
      if (parent_[own] != element) {
        offset_[own] = offset_[own] + offset_[parent_[own]];
        parent_[own] = element;
      }
    }
    return element;
  }
  std::array<bool, 3>& crossed(std::size_t root) { return crossed_[root]; }

 private:
  std::vector<std::size_t> parent_;
  std::vector<Offset> offset_;  // from the parent
  std::vector<std::array<bool, 3>> crossed_;
};

void join_neighbours(const Mesh& mesh, Parts& parts) {
  std::vector<std::array<std::uint32_t, 4>> cells;
  cells.reserve(mesh.elements.size());
  for (const auto& element : mesh.elements) {
    std::array<std::uint32_t, 4> cell{};
    for (std::size_t k = 0; k < 4; ++k) cell[k] = static_cast<std::uint32_t>(element[k]);
    cells.push_back(cell);
  }
  const std::vector<CellSide> sides = sorted_sides(cells, mesh.nodes.size());
  for (std::size_t k = 0; k + 1 < sides.size(); ++k)
    if (sides[k].corners == sides[k + 1].corners) parts.join(sides[k].cell, sides[k + 1].cell, {});
}

// Over periodic faces, and where an open pair is reached on both sides.
void join_faces(const Mesh& mesh, Parts& parts) {
  // Layers belong to the tetrahedra under them.
  const auto own_part = [&](const Patch::Side& side) {
    const std::size_t count = mesh.elements.size();
    if (side.element < count) return side.element;
    return mesh.layers.under[(side.element - count) / static_cast<std::size_t>(mesh.layers.count)];
  };
  const auto axis_of = [](const Patch& patch) {
    return static_cast<std::size_t>(patch.kind == Patch::Kind::periodic ? patch.name.front() - 'x'
                                                                        : patch.name.back() - 'x');
  };
  for (const Patch& patch : mesh.patches) {
    if (patch.kind != Patch::Kind::periodic || !patch.name.ends_with("_high")) continue;
    Offset step{};
    step[axis_of(patch)] = 1;
    for (std::size_t k = 0; k < patch.sides.size(); ++k)
      parts.join(own_part(patch.sides[k]), own_part(mesh.patches[patch.opposite].sides[k]), step);
  }
  std::map<std::pair<std::size_t, std::size_t>, int> reached;  // of a root and an axis: 1 low, 2 high
  for (const Patch& patch : mesh.patches) {
    if (patch.kind != Patch::Kind::open) continue;
    for (const Patch::Side& side : patch.sides)
      reached[{parts.root_of(own_part(side)), axis_of(patch)}] |= patch.name.starts_with("inlet") ? 1 : 2;
  }
  for (const auto& [where, ends] : reached)
    if (ends == 3) parts.crossed(where.first)[where.second] = true;
}

}  // namespace

Passages find_passages(const Mesh& mesh) {
  Parts parts(mesh.elements.size());
  join_neighbours(mesh, parts);
  join_faces(mesh, parts);
  Passages passages;
  std::map<std::size_t, bool> is_pocket;  // by root
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const std::size_t root = parts.root_of(e);
    const auto [at, is_new] = is_pocket.try_emplace(root, false);
    if (is_new) {
      const std::array<bool, 3>& crossed = parts.crossed(root);
      for (std::size_t k = 0; k < 3; ++k) passages.along[k] = passages.along[k] || crossed[k];
      at->second = std::none_of(crossed.begin(), crossed.end(), [](bool is) { return is; });
      passages.pockets += at->second ? 1 : 0;
      constexpr std::size_t most_places = 10;
      if (at->second && passages.pocket_places.size() < most_places)
        passages.pocket_places.push_back(mesh.nodes[mesh.elements[e][0]]);
    }
    if (at->second) passages.pocket_volume += volume_of(mesh, e);
  }
  for (std::size_t w = 0; w < mesh.layers.wedges.size(); ++w) {
    const std::size_t under = mesh.layers.under[w / static_cast<std::size_t>(mesh.layers.count)];
    if (is_pocket.at(parts.root_of(under)))
      passages.pocket_volume += volume_of(mesh, mesh.elements.size() + w);
  }
  return passages;
}

}  // namespace selvage::fem
