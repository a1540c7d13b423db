#include "cad/model.h"

#include <algorithm>

namespace selvage::cad {

bool has_shared_edges(const Part& part) {
  std::map<int, int> uses;
  for (const Face& face : part.faces) {
    if (face.loops.empty()) return false;
    for (const Loop& loop : face.loops)
      for (const Edge& edge : loop.edges) {
        if (edge.curve.points.empty()) continue;
        if (edge.id < 0) return false;
        ++uses[edge.id];
      }
  }
  return std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second == 2; });
}

std::size_t Model::face_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.faces.size();
  return count;
}

}  // namespace selvage::cad
