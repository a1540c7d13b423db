#include "pipeline/mesh_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fem/quality.h"

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

// Relative; of a region whose exact volume is known.
double volume_error(const fem::Region& region) {
  return region.volume / region.exact_volume - 1;
}

const fem::Region* worst_volume(const fem::Mesh& mesh) {
  const fem::Region* worst = nullptr;
  for (const fem::Region& region : mesh.regions)
    if (region.exact_volume > 0 &&
        (worst == nullptr || std::abs(volume_error(region)) > std::abs(volume_error(*worst))))
      worst = &region;
  return worst;
}

std::string name_of(const fem::Region& region) {
  return region.kind == fem::Region::Kind::yarn ? fmt::format("yarn '{}'", region.name) : "the matrix";
}

std::string shares_in_words(const fem::Mesh& mesh) {
  const double percent = 100 / (mesh.cell->high - mesh.cell->low).prod();
  double yarns = 0, wanted = 0, fibres = 0;
  for (const fem::Region& region : mesh.regions) {
    if (region.kind != fem::Region::Kind::yarn) continue;
    yarns += region.volume;
    wanted += region.exact_volume;
    for (std::size_t e = region.first_element; e < region.last_element && !mesh.fibre_fraction.empty(); ++e)
      fibres += fem::volume_of(mesh, e) * mesh.fibre_fraction[e];  // NaN: nothing is known of the yarn
  }
  std::string text = fmt::format("yarns fill {:.2f} % of the cell", percent * yarns);
  if (wanted > 0) text += fmt::format(" (wanted: {:.2f} %)", percent * wanted);
  if (fibres > 0) text += fmt::format(", fibres {:.2f} %", percent * fibres);
  return text;
}

}  // namespace

std::string volumes_in_words(const fem::Mesh& mesh) {
  std::string text;
  if (mesh.cell) text = shares_in_words(mesh);
  if (const fem::Region* worst = worst_volume(mesh))
    text += fmt::format("{}volumes are right to {:.2g} %, the worst is {}", text.empty() ? "" : "; ",
                        100 * std::abs(volume_error(*worst)), name_of(*worst));
  return text;
}

std::optional<Message> wrong_volume(const fem::Mesh& mesh) {
  constexpr double usual = 0.002;  // what the default size promises
  const fem::Region* worst = worst_volume(mesh);
  if (worst == nullptr || std::abs(volume_error(*worst)) <= usual) return std::nullopt;
  return warning(
      Kind::geometry,
      fmt::format("the volume of {} is {:.2g} % too {}; a smaller --size{} makes it better", name_of(*worst),
                  100 * std::abs(volume_error(*worst)), volume_error(*worst) < 0 ? "small" : "large",
                  mesh.order == 1 ? " or --order 2" : ""));
}

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
