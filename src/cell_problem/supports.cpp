#include "cell_problem/supports.h"

#include <algorithm>

#include "cell_problem/cell_kind.h"
#include "cell_problem/complete_cell.h"

namespace selvage::fem {
namespace {

// Against turning about the axis, of the nodes `members` the one farthest from the line along it through
// `held`: the displacement that turning makes there.
NodeSupport support_against_turning(const Mesh& mesh, const std::vector<std::size_t>& members,
                                    std::size_t held, int axis) {
  const auto turned = [&](std::size_t n) {
    return Vec3(Vec3::Unit(axis).cross(mesh.nodes[n] - mesh.nodes[held]));
  };
  const std::size_t farthest = *std::max_element(
      members.begin(), members.end(),
      [&](std::size_t a, std::size_t b) { return turned(a).squaredNorm() < turned(b).squaredNorm(); });
  Eigen::Index direction = 0;
  turned(farthest).cwiseAbs().maxCoeff(&direction);
  return {.node = farthest, .direction = static_cast<int>(direction)};
}

}  // namespace

Groups connected_nodes(const Mesh& mesh) {
  Groups groups(mesh.nodes.size());
  const auto count = static_cast<std::size_t>(mesh.nodes_per_element());
  for (const auto& element : mesh.elements)
    for (std::size_t k = 1; k < count; ++k) groups.join(element[0], element[k]);
  for (const Interface& interface : mesh.interfaces)
    for (const FacingSides& facing : interface.sides)
      groups.join(facing.first.nodes[0], facing.second.nodes[0]);
  for (const Equation& equation : mesh.equations)
    for (const Term& term : equation)
      if (term.node < mesh.nodes.size()) groups.join(equation.front().node, term.node);
  return groups;
}

std::vector<NodeSupport> supports(const Mesh& mesh) {
  std::vector<NodeSupport> found;
  if (!mesh.cell || kind_of_cell(mesh.cell->periodic) == CellKind::piece) return found;
  std::vector<bool> depends(mesh.nodes.size(), false);
  for (const Equation& equation : mesh.equations) depends[equation.front().node] = true;
  Groups groups = connected_nodes(mesh);
  std::vector<std::vector<std::size_t>> parts(mesh.nodes.size());  // by their least numbers
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (!depends[n]) parts[groups.of(n)].push_back(n);
  const std::size_t corner = mesh.cell->corners[0];
  const std::optional<int> beam = beam_axis(mesh.cell->periodic);  // has displacements
  for (const std::vector<std::size_t>& members : parts) {
    if (members.empty()) continue;
    const bool has_corner = corner != no_node && groups.of(corner) == groups.of(members.front());
    const std::size_t held = has_corner ? corner : members.front();
    found.push_back({.node = held, .direction = {}});
    if (beam) found.push_back(support_against_turning(mesh, members, held, *beam));
  }
  return found;
}

}  // namespace selvage::fem
