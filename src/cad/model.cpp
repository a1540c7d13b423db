#include "cad/model.h"

#include <algorithm>

#include "cad/edges.h"
#include "core/groups.h"

namespace selvage::cad {

bool has_shared_edges(const Part& part) {
  std::map<int, int> uses;
  for (const Face& face : part.faces) {
    if (boundary_of(face).empty()) return false;
    for (const Edge& edge : boundary_edges_of(face)) {
      if (edge.curve.points.empty()) continue;
      if (edge.id < 0) return false;
      ++uses[edge.id];
    }
  }
  return std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second == 2; });
}

std::vector<std::vector<std::size_t>> shells_of(const std::vector<Face>& faces) {
  Groups groups(faces.size());
  std::map<int, std::size_t> first;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const Edge& edge : boundary_edges_of(faces[i]))
      if (!edge.curve.points.empty()) groups.join(first.try_emplace(edge.id, i).first->second, i);
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < faces.size(); ++i) members[groups.of(i)].push_back(i);
  std::vector<std::vector<std::size_t>> shells;
  shells.reserve(members.size());
  for (auto& [leader, shell] : members) shells.push_back(std::move(shell));
  return shells;
}

Box3 box_of(const std::vector<Vec3>& points) {
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

Box3 box_of(const Part& part) {
  Box3 box;
  for (const Face& face : part.faces) box.extend(box_of(face.surface.points));
  return box;
}

std::size_t Model::face_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.faces.size();
  return count;
}

}  // namespace selvage::cad
