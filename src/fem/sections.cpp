#include "fem/sections.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace selvage::fem {

std::vector<NamedSet> node_sets(const Mesh& mesh, const DeckNames& names) {
  std::vector<NamedSet> sets;
  const auto add = [&](std::string name, const std::vector<std::size_t>& nodes) {
    if (!nodes.empty()) sets.push_back({std::move(name), nodes});
  };
  if (!mesh.cell) {
    for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
      add(names.of(i) + "_Start", mesh.regions[i].start_nodes);
      add(names.of(i) + "_End", mesh.regions[i].end_nodes);
    }
    return sets;
  }
  for (std::size_t i = 0; i < mesh.cell->face_nodes.size(); ++i)
    add(std::string("Face") + static_cast<char>('A' + i), mesh.cell->face_nodes[i]);
  for (std::size_t i = 0; i < mesh.cell->edge_nodes.size(); ++i)
    add("Edge" + std::to_string(i + 1), mesh.cell->edge_nodes[i]);
  // In the corners of a cell of dry yarns there need not be a node.
  for (std::size_t i = 0; i < mesh.cell->corners.size(); ++i)
    if (mesh.cell->corners[i] < mesh.nodes.size()) {
      std::vector<std::size_t> nodes = mesh.cell->more_corners[i];
      nodes.insert(nodes.begin(), mesh.cell->corners[i]);
      add("Corner" + std::to_string(i + 1), nodes);
    }
  return sets;
}

std::size_t material_of(const Mesh& mesh, const Region& region) {
  const auto found =
      std::find_if(mesh.materials.begin(), mesh.materials.end(),
                   [&](const fabric::Material& material) { return material.name == region.material; });
  return static_cast<std::size_t>(found - mesh.materials.begin());
}

Result<std::vector<Section>> sections(const Mesh& mesh, const DeckNames& names) {
  std::vector<Section> list;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const Region& region = mesh.regions[i];
    std::map<std::size_t, std::vector<std::size_t>> by_material;
    const std::size_t of_all = material_of(mesh, region);
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      by_material[mesh.element_material.empty() ? of_all : mesh.element_material[e]].push_back(e);
    for (auto& [material, elements] : by_material) {
      if (material >= mesh.materials.size() || !has_constants(mesh.materials[material], mesh.physics))
        return error(Kind::internal, "the yarn's material lacks the constants of the deck's physics",
                     {.yarn = region.name});
      const bool is_alone = by_material.size() == 1;
      const std::size_t number = static_cast<std::size_t>(std::count_if(
          list.begin(), list.end(), [&](const Section& section) { return section.region == i; }));
      list.push_back(
          {is_alone ? names.of(i) : names.of_section(i, number), i, material, std::move(elements)});
    }
  }
  return list;
}

std::vector<NamedSet> element_sets(const Mesh& mesh, const std::vector<Section>& sections,
                                   const DeckNames& names) {
  std::vector<NamedSet> sets;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const Region& region = mesh.regions[i];
    sets.push_back({names.of(i), std::vector<std::size_t>(region.last_element - region.first_element)});
    std::iota(sets.back().members.begin(), sets.back().members.end(), region.first_element);
  }
  for (const Section& section : sections)
    if (section.name != sets[section.region].name) sets.push_back({section.name, section.elements});
  return sets;
}

std::vector<std::size_t> element_materials(const Mesh& mesh, const std::vector<Section>& sections) {
  std::vector<std::size_t> materials(mesh.elements.size());
  for (const Section& section : sections)
    for (const std::size_t e : section.elements) materials[e] = section.material;
  return materials;
}

Frames frames(const Mesh& mesh, const std::vector<Section>& sections) {
  Frames result;
  result.of_element.assign(mesh.elements.size(), Frames::none);
  std::map<std::array<double, 6>, std::uint32_t> known;
  // In the order of the elements, whatever the order of the sections.
  std::vector<bool> is_oriented(mesh.elements.size(), false);
  for (const Section& section : sections)
    if (!is_isotropic(mesh.materials[section.material], mesh.physics))
      for (const std::size_t e : section.elements) is_oriented[e] = true;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (!is_oriented[e]) continue;
    const Vec3 &along = mesh.along[e], &across = mesh.across[e];
    const std::array<double, 6> key = {along.x(), along.y(), along.z(), across.x(), across.y(), across.z()};
    const auto [at, is_new] = known.emplace(key, static_cast<std::uint32_t>(result.axes.size() + 1));
    if (is_new) {
      const Vec3 first = along.normalized();
      const Vec3 third = first.cross(across).normalized();
      result.axes.push_back({first, third.cross(first), third});
    }
    result.of_element[e] = at->second;
  }
  return result;
}

}  // namespace selvage::fem
