#include "pipeline/mesh_facts.h"

#include <algorithm>
#include <cmath>

namespace selvage::pipeline {
namespace {

MeshReport::Region region_facts(const fem::Region& region) {
  MeshReport::Region facts;
  facts.name = region.name;
  facts.kind = region.kind == fem::Region::Kind::yarn ? "yarn" : "matrix";
  facts.elements = region.last_element - region.first_element;
  facts.volume = region.volume;
  facts.min_dihedral = region.quality.min_dihedral;
  if (region.exact_volume > 0) facts.exact_volume = region.exact_volume;
  return facts;
}

void add_cell(MeshReport& facts, const fem::Mesh& mesh) {
  double yarns = 0;
  for (const fem::Region& region : mesh.regions)
    if (region.kind == fem::Region::Kind::yarn) yarns += region.volume;
  facts.yarn_share = yarns / (mesh.cell->high - mesh.cell->low).prod();
  for (std::size_t k = 0; k < 3; ++k)
    if (mesh.cell->periodic[k]) facts.periodic += std::string(facts.periodic.empty() ? "" : " ") + "xyz"[k];
  facts.equations = mesh.equations.size();
  facts.load_cases = mesh.load_cases.size();
}

}  // namespace

MeshReport mesh_facts(const fem::Mesh& mesh) {
  MeshReport facts;
  facts.nodes = mesh.nodes.size();
  if (mesh.shape == fem::Mesh::Shape::hexahedron)
    facts.hexahedra = mesh.elements.size();
  else
    facts.tets = mesh.elements.size();
  facts.min_dihedral = mesh.quality.min_dihedral;
  facts.max_aspect = mesh.quality.max_aspect;
  double exact = 0, off = 0;
  for (const fem::Region& region : mesh.regions) {
    facts.regions.push_back(region_facts(region));
    facts.volume += region.volume;
    if (region.exact_volume <= 0) continue;
    exact += region.exact_volume;
    off += std::abs(region.volume - region.exact_volume);
  }
  facts.volume_error = exact > 0 ? off / exact : 0;
  if (mesh.angles) {
    facts.below_target = mesh.angles->below;
    facts.in_wedges = mesh.angles->in_wedges;
  }
  for (const fem::BadElement& bad : mesh.worst) {
    const auto region = std::find_if(mesh.regions.begin(), mesh.regions.end(),
                                     [&](const fem::Region& r) { return bad.element < r.last_element; });
    facts.worst.push_back(
        {bad.min_dihedral, region == mesh.regions.end() ? std::string() : region->name, bad.at});
  }
  if (mesh.cell) add_cell(facts, mesh);
  return facts;
}

}  // namespace selvage::pipeline
