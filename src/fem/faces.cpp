#include "fem/faces.h"

#include <algorithm>

namespace selvage::fem {

std::vector<SixNodes> six_node_faces(const Mesh& mesh, const Region& region,
                                     const std::vector<ElementSide>& faces) {
  struct Edge {
    std::size_t low, high, middle;
    bool operator<(const Edge& other) const { return low != other.low ? low < other.low : high < other.high; }
    bool operator==(const Edge& other) const { return low == other.low && high == other.high; }
  };
  std::vector<SixNodes> result;
  result.reserve(faces.size());
  for (const auto& f : faces) result.push_back({f[0], f[1], f[2], 0, 0, 0});
  if (mesh.order == 1 || faces.empty()) return result;

  std::vector<Edge> edges;
  for (const auto& f : faces)
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3]), 0});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  auto find = [&](std::size_t a, std::size_t b) {
    const Edge wanted{std::min(a, b), std::max(a, b), 0};
    const auto at = std::lower_bound(edges.begin(), edges.end(), wanted);
    return at != edges.end() && *at == wanted ? at : edges.end();
  };
  for (std::size_t e = region.first_element; e < region.last_element; ++e)
    for (std::size_t k = 0; k < 6; ++k) {
      const auto& element = mesh.elements[e];
      if (const auto at = find(element[edge_ends[k][0]], element[edge_ends[k][1]]); at != edges.end())
        at->middle = element[4 + k];
    }
  for (SixNodes& face : result)
    for (std::size_t k = 0; k < 3; ++k) face[3 + k] = find(face[k], face[(k + 1) % 3])->middle;
  return result;
}

}  // namespace selvage::fem
