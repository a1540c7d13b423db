// Small unit cells made by hand: a box of 4 x 3 x 3 bricks, or of six tetrahedra in each of them (so that
// opposite faces match), with a yarn along x in its middle. A block: periodic along all axes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cell_problem/complete_cell.h"
#include "fem/mesh.h"
#include "fem/quality.h"

namespace selvage::test {

class CellMaker {
 public:
  fem::Mesh make(fem::Mesh::Shape shape, int order, bool has_two_materials = false) {
    mesh_.shape = shape;
    mesh_.order = order;
    mesh_.title = "cell of the tests";
    add_grid();
    for (const bool is_yarn : {true, false}) add_region(is_yarn);
    if (order == 2) add_midside_nodes();
    add_materials(has_two_materials);
    const Status completed = fem::complete_cell(mesh_, Box3(low_, high_), {true, true, true});
    EXPECT_TRUE(completed.ok());
    if (shape == fem::Mesh::Shape::tetrahedron) fem::measure(mesh_);
    return std::move(mesh_);
  }

 private:
  static constexpr std::array<std::size_t, 3> counts = {4, 3, 3};

  [[nodiscard]] static std::size_t node(std::size_t i, std::size_t j, std::size_t k) {
    return i + (counts[0] + 1) * (j + (counts[1] + 1) * k);
  }

  void add_grid() {
    for (std::size_t k = 0; k <= counts[2]; ++k)
      for (std::size_t j = 0; j <= counts[1]; ++j)
        for (std::size_t i = 0; i <= counts[0]; ++i) {
          Vec3 p;
          const std::array<std::size_t, 3> at = {i, j, k};
          for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<Eigen::Index>(a);
            const double share = static_cast<double>(at[a]) / static_cast<double>(counts[a]);
            p[axis] = at[a] == counts[a] ? high_[axis] : low_[axis] + share * (high_ - low_)[axis];
          }
          mesh_.nodes.push_back(p);
        }
  }

  void add_region(bool is_yarn) {
    fem::Region region;
    region.kind = is_yarn ? fem::Region::Kind::yarn : fem::Region::Kind::matrix;
    region.name = is_yarn ? "warp \"1\"" : "matrix";
    region.material = is_yarn ? "glass yarn" : "resin";
    region.first_element = mesh_.elements.size();
    for (std::size_t k = 0; k < counts[2]; ++k)
      for (std::size_t j = 0; j < counts[1]; ++j)
        for (std::size_t i = 0; i < counts[0]; ++i)
          if ((j == 1 && k == 1) == is_yarn) add_brick(i, j, k, is_yarn);
    region.last_element = mesh_.elements.size();
    mesh_.regions.push_back(region);
  }

  void add_brick(std::size_t i, std::size_t j, std::size_t k, bool is_yarn) {
    const std::array<std::size_t, 8> n = {
        node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
        node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
    if (mesh_.shape == fem::Mesh::Shape::hexahedron) {
      std::array<std::size_t, 10> element{};
      std::copy(n.begin(), n.end(), element.begin());
      mesh_.elements.push_back(element);
      orient(i, is_yarn);
      return;
    }
    // All have the diagonal 0-6; the ways along the axes from one end to the other.
    for (const auto& [a, b] : {std::array<std::size_t, 2>{1, 2}, {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}}) {
      mesh_.elements.push_back({n[0], n[a], n[b], n[6]});
      orient(i, is_yarn);
    }
  }

  void orient(std::size_t i, bool is_yarn) {
    const double turn = is_yarn ? 0.1 * static_cast<double>(i) : 0;
    mesh_.along.emplace_back(std::cos(turn), std::sin(turn), 0);
    mesh_.across.emplace_back(-std::sin(turn), std::cos(turn), 0);
    mesh_.fibre_fraction.push_back(is_yarn ? 0.7 + 0.01 * static_cast<double>(i) : 0);
  }

  void add_midside_nodes() {
    constexpr std::array<std::array<std::size_t, 2>, 6> edges = {
        {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
    std::map<std::array<std::size_t, 2>, std::size_t> known;
    for (auto& element : mesh_.elements)
      for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto [low, high] = std::minmax(element[edges[e][0]], element[edges[e][1]]);
        const auto [at, is_new] = known.emplace(std::array{low, high}, mesh_.nodes.size());
        if (is_new) mesh_.nodes.push_back((mesh_.nodes[low] + mesh_.nodes[high]) / 2);
        element[4 + e] = at->second;
      }
  }

  void add_materials(bool has_two) {
    mesh_.materials.resize(2);
    mesh_.materials[0].name = "glass yarn";
    mesh_.materials[0].density = 2.1;
    mesh_.materials[0].elastic = fabric::TransverseElastic{57500, 18800, 0.25, 7440, 0.29};
    mesh_.materials[0].expansion = fabric::Expansion{6.1e-6, 1.0 / 45000};
    mesh_.materials[1].name = "resin";
    mesh_.materials[1].elastic = fabric::IsotropicElastic{3400, 0.35};
    mesh_.materials[1].expansion = fabric::Expansion{6e-5, 6e-5};
    if (!has_two) return;
    mesh_.materials.push_back(mesh_.materials[0]);
    mesh_.materials[2].name = "glass_yarn";  // the same letters in a deck
    mesh_.materials[2].elastic = fabric::TransverseElastic{57500 / 0.99, 18800, 0.25, 7440, 0.29};
    mesh_.element_material.assign(mesh_.elements.size(), 1);
    for (std::size_t e = 0; e < mesh_.regions[0].last_element; ++e)
      mesh_.element_material[e] = mesh_.along[e].y() == 0 ? 0 : 2;
  }

  Vec3 low_ = Vec3(0.1, -0.2, 0.3), high_ = Vec3(2.1, 1.3, 1.5);
  fem::Mesh mesh_;
};

inline fem::Mesh tetrahedra_cell(int order, bool has_two_materials = false) {
  return CellMaker().make(fem::Mesh::Shape::tetrahedron, order, has_two_materials);
}
inline fem::Mesh brick_cell() {
  return CellMaker().make(fem::Mesh::Shape::hexahedron, 1);
}

}  // namespace selvage::test
