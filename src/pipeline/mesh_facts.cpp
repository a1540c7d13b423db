#include "pipeline/mesh_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/words.h"
#include "fem/quality.h"

namespace selvage::pipeline {
namespace {

// Relative; of a region whose exact volume is known.
double volume_error(const fem::Region& region) {
  return region.volume / region.exact_volume - 1;
}

// Equal boxes, which have no quality to speak of.
bool is_voxels(const fem::Mesh& mesh) {
  return mesh.shape == fem::Mesh::Shape::hexahedron && mesh.cell;
}

Json region_json(const fem::Mesh& mesh, const fem::Region& region) {
  const bool is_exact = region.exact_volume > 0, is_brick = mesh.shape == fem::Mesh::Shape::hexahedron;
  std::size_t wedges = 0;
  for (std::size_t e = region.first_element; e < region.last_element; ++e) wedges += mesh.is_wedge(e) ? 1 : 0;
  return {{"name", region.name},
          {"kind", region.kind == fem::Region::Kind::yarn ? "yarn"
                   : mesh.patches.empty()                 ? "matrix"
                                                          : "pores"},
          {is_brick ? "hexahedra" : "tets", region.last_element - region.first_element - wedges},
          {"wedges", if_true(wedges > 0, wedges)},
          {"volume", region.volume},
          {"exact_volume", if_true(is_exact, region.exact_volume)},
          {"volume_error", if_true(is_exact, volume_error(region))},
          {"min_dihedral", if_true(!is_voxels(mesh), region.quality.min_dihedral)}};
}

Json worst_json(const fem::Mesh& mesh) {
  return list_json(mesh.worst, [&](const fem::BadElement& bad) {
    const auto region = std::find_if(mesh.regions.begin(), mesh.regions.end(),
                                     [&](const fem::Region& r) { return bad.element < r.last_element; });
    return Json{{"min_dihedral", bad.min_dihedral},
                {"region", region == mesh.regions.end() ? std::string() : region->name},
                {"at", point_json(bad.at)}};
  });
}

Json patch_json(const fem::Patch& patch) {
  constexpr std::array<const char*, 3> kinds = {"wall", "periodic", "open"};
  return {{"name", patch.name},
          {"kind", kinds[static_cast<std::size_t>(patch.kind)]},
          {"sides", patch.sides.size()}};
}

Json layers_json(const fem::Mesh& mesh) {
  double worst = 1;
  for (std::size_t w = 0; w < mesh.layers.wedges.size(); ++w)
    worst = std::min(worst, fem::shape_of(mesh, mesh.elements.size() + w).scaled_jacobian);
  return {{"count", mesh.layers.count},           {"wedges", mesh.layers.wedges.size()},
          {"asked_thickness", mesh.layers.asked}, {"thickness", mesh.layers.thickness},
          {"thinned", mesh.layers.thinned},       {"min_scaled_jacobian", worst}};
}

void add_cell(Json& facts, const fem::Mesh& mesh) {
  double yarns = 0;
  for (const fem::Region& region : mesh.regions)
    if (region.kind == fem::Region::Kind::yarn) yarns += region.volume;
  std::string periodic;
  for (std::size_t k = 0; k < 3; ++k)
    if (mesh.cell->periodic[k]) periodic += std::string(periodic.empty() ? "" : " ") + "xyz"[k];
  facts["periodic"] = periodic;
  const double box = mesh.cell->shape().volume();
  if (!mesh.patches.empty()) {
    facts["porosity"] = mesh.regions.front().volume / box;
    facts["patches"] = list_json(mesh.patches, patch_json);
    if (!mesh.layers.wedges.empty()) facts["layers"] = layers_json(mesh);
    return;
  }
  facts["yarn_share"] = yarns / box;
  facts["equations"] = mesh.equations.size();
  facts["load_cases"] = mesh.load_cases.size();
}

Json interface_json(const fem::Mesh& mesh, const fem::Interface& interface) {
  double area = 0;
  for (const fem::FacingSides& facing : interface.sides) {
    const auto& n = facing.first.nodes;
    area += (mesh.nodes[n[1]] - mesh.nodes[n[0]]).cross(mesh.nodes[n[2]] - mesh.nodes[n[0]]).norm() / 2;
  }
  return {{"first", mesh.regions[interface.first].name},
          {"second", mesh.regions[interface.second].name},
          {"cohesive", mesh.joining == fem::Joining::cohesive},
          {"triangles", interface.sides.size()},
          {"area", area}};
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
  return region.kind == fem::Region::Kind::yarn ? fmt::format("yarn '{}'", region.name)
                                                : "the " + region.name;
}

std::string shares_in_words(const fem::Mesh& mesh) {
  const double percent = 100 / mesh.cell->shape().volume();
  if (!mesh.patches.empty())
    return fmt::format("pores are {:.2f} % of the cell (wanted: {:.2f} %)",
                       percent * mesh.regions.front().volume, percent * mesh.regions.front().exact_volume);
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
  if (is_voxels(mesh)) return std::nullopt;  // mesh_voxels() says what they lack
  const bool is_brick = mesh.shape == fem::Mesh::Shape::hexahedron;
  const double usual = is_brick ? 0.005 : 0.002;  // what the default size promises
  const fem::Region* worst = worst_volume(mesh);
  if (worst == nullptr || std::abs(volume_error(*worst)) <= usual) return std::nullopt;
  return warning(
      Kind::geometry,
      fmt::format("the volume of {} is {:.2g} % too {}; a smaller --size{} makes it better", name_of(*worst),
                  100 * std::abs(volume_error(*worst)), volume_error(*worst) < 0 ? "small" : "large",
                  mesh.order == 1 && !is_brick ? " or --order 2" : ""));
}

namespace {

// The axes along which there is a passage, or none: "x, y".
std::string axes_in_words(const fem::Passages& passages, bool is_open) {
  std::vector<char> axes;
  for (std::size_t k = 0; k < 3; ++k)
    if (passages.along[k] == is_open) axes.push_back("xyz"[k]);
  return fmt::format("{}", fmt::join(axes, ", "));
}

}  // namespace

Json passages_json(const fem::Passages& passages) {
  return {{"along", axes_in_words(passages, true)},
          {"pockets", passages.pockets},
          {"pocket_volume", passages.pocket_volume}};
}

std::string passages_in_words(const fem::Passages& passages) {
  const std::string open = axes_in_words(passages, true);
  return open.empty() ? "the pores have no passage" : fmt::format("the pores have passages along {}", open);
}

std::optional<Message> shut_pores(const fem::Mesh& mesh, const fem::Passages& passages) {
  const std::string shut = axes_in_words(passages, false);
  std::string text;
  if (!shut.empty())
    text = fmt::format(
        "nothing can flow along {}: the yarns leave no passage there; a larger --gap, or a "
        "cell with more room between them, opens one",
        shut);
  if (passages.pockets > 0)
    text += fmt::format("{}{} part{} of the pores ({:.2g} % of their volume) {} no passage",
                        text.empty() ? "" : "; ", passages.pockets, passages.pockets == 1 ? "" : "s",
                        100 * passages.pocket_volume / mesh.regions.front().volume,
                        passages.pockets == 1 ? "has" : "have");
  if (text.empty()) return std::nullopt;
  Message message = warning(Kind::geometry, std::move(text));
  return passages.pocket_places.empty() ? message : message.at_point(passages.pocket_places.front());
}

Json mesh_json(const fem::Mesh& mesh, std::optional<double> estimate) {
  const bool is_brick = mesh.shape == fem::Mesh::Shape::hexahedron, has_quality = !is_voxels(mesh);
  const std::size_t wedges = mesh.count_wedges();
  double volume = 0, exact = 0, off = 0;
  for (const fem::Region& region : mesh.regions) {
    volume += region.volume;
    if (region.exact_volume <= 0) continue;
    exact += region.exact_volume;
    off += std::abs(region.volume - region.exact_volume);
  }
  Json facts = {{"nodes", mesh.nodes.size()},
                {"tets", is_brick ? 0 : mesh.elements.size()},
                {"volume", volume},
                {"hexahedra", if_true(is_brick, mesh.elements.size() - wedges)},
                {"wedges", if_true(wedges > 0, wedges)},
                {"min_dihedral", if_true(has_quality, mesh.quality.min_dihedral)},
                {"first_percentile_dihedral", has_quality ? Json(fem::first_percentile_angle(mesh)) : Json()},
                {"max_aspect", if_true(has_quality, mesh.quality.max_aspect)},
                {"min_scaled_jacobian", if_true(has_quality && is_brick, mesh.quality.min_scaled_jacobian)},
                {"volume_error", if_true(has_quality || exact > 0, exact > 0 ? off / exact : 0)},
                {"below_target", mesh.angles ? Json(mesh.angles->below) : Json()},
                {"in_wedges", mesh.angles ? Json(mesh.angles->in_wedges) : Json()},
                {"regions", list_json(mesh.regions,
                                      [&](const fem::Region& region) { return region_json(mesh, region); })},
                {"worst", if_true(!mesh.worst.empty(), worst_json(mesh))},
                {"estimate", if_known(estimate)}};
  if (mesh.cell) add_cell(facts, mesh);
  if (!mesh.interfaces.empty())
    facts["interfaces"] = list_json(
        mesh.interfaces, [&](const fem::Interface& interface) { return interface_json(mesh, interface); });
  return facts;
}

std::string tetrahedra_in_words(const fem::Mesh& mesh) {
  return fmt::format("{} tetrahedra; smallest dihedral angles from {:.1f} degrees, first percentile {:.1f}",
                     mesh.elements.size(), mesh.quality.min_dihedral, fem::first_percentile_angle(mesh));
}

std::string interfaces_in_words(const fem::Mesh& mesh) {
  std::size_t sides = 0;
  for (const fem::Interface& interface : mesh.interfaces) sides += interface.sides.size();
  const std::string where = counted(mesh.interfaces.size(), "interface");
  return mesh.joining == fem::Joining::cohesive
             ? fmt::format("{} in {}", counted(sides, "cohesive element"), where)
             : fmt::format("{} of surfaces that face each other, {} on either side", where,
                           counted(sides, "triangle"));
}

std::string layers_in_words(const fem::Mesh& mesh, Unit units) {
  const fem::WallLayers& layers = mesh.layers;
  const std::string_view unit = name_of(units);
  std::string text = fmt::format("{} wedges in {} layer{} along the walls, {:.3g} {} thick on average",
                                 layers.wedges.size(), layers.count, layers.count == 1 ? "" : "s",
                                 layers.thickness / millimetres_per(units), unit);
  constexpr double nearly = 0.95;
  if (layers.thickness < nearly * layers.asked)
    text += fmt::format(" (of {:.3g} {}: neighbours are in the way, or --size is too small for it)",
                        layers.asked / millimetres_per(units), unit);
  if (layers.thinned > 0)
    text += fmt::format("; less than half of that at {:.2g} % of the walls' nodes", 100 * layers.thinned);
  return text;
}

std::string hexahedra_in_words(const fem::Mesh& mesh) {
  const std::size_t wedges = mesh.count_wedges();
  return fmt::format("{} hexahedra and {} wedges; scaled Jacobians from {:.2f}, {:.2f} on average",
                     mesh.elements.size() - wedges, wedges, mesh.quality.min_scaled_jacobian,
                     mesh.quality.mean_scaled_jacobian);
}

static std::size_t count_sections(const fem::BeamModel& beams, const fem::Region& region) {
  const auto begin = beams.section_of.begin();
  return std::set<std::size_t>(begin + static_cast<std::ptrdiff_t>(region.first_element),
                               begin + static_cast<std::ptrdiff_t>(region.last_element))
      .size();
}

Json beams_json(const fem::BeamModel& beams) {
  const fem::Mesh& mesh = beams.mesh;
  std::size_t number = 0;
  const auto yarn_json = [&](const fem::Region& region) {
    return Json{{"name", region.name},
                {"beams", region.last_element - region.first_element},
                {"sections", count_sections(beams, region)},
                {"contact_radius", beams.radii[number++]},
                {"volume", region.volume},
                {"exact_volume", region.exact_volume}};
  };
  const auto contact_json = [&](const fem::BeamContact& contact) {
    return Json{{"a", mesh.regions[contact.a].name},
                {"b", mesh.regions[contact.b].name},
                {"gap", contact.gap},
                {"places", contact.places},
                {"at", point_json(contact.at)}};
  };
  const auto section_json = [](const fem::BeamSection& section) {
    return Json{{"shape", name_of(section.shape)},
                {"width", section.width},
                {"height", section.height},
                {"area", section.area},
                {"i11", section.i11},
                {"i22", section.i22},
                {"torsion", section.torsion}};
  };
  return {{"nodes", mesh.nodes.size()},
          {"beams", mesh.elements.size()},
          {"bend", !beams.are_trusses},
          {"regions", list_json(mesh.regions, yarn_json)},
          {"sections", list_json(beams.sections, section_json)},
          {"contact_pairs", list_json(beams.contacts, contact_json)}};
}

std::string beams_in_words(const fem::BeamModel& beams) {
  const std::string_view what = beams.are_trusses ? "truss element" : "beam";
  std::string text = fmt::format("{} with {}", counted(beams.mesh.elements.size(), what),
                                 counted(beams.sections.size(), "section"));
  std::size_t varying = 0, most = 0;
  for (const fem::Region& region : beams.mesh.regions) {
    const std::size_t count = count_sections(beams, region);
    varying += count > 1 ? 1 : 0;
    most = std::max(most, count);
  }
  if (varying > 0)
    text += fmt::format("; the section varies along {} and is that of each {}'s middle: {} stations at most",
                        counted(varying, "yarn"), what, most);
  return text + fmt::format("; {} of yarns that touch or nearly do", counted(beams.contacts.size(), "pair"));
}

Json forming_json(const fem::Forming& forming) {
  const bool is_pressed = forming.load == fem::FormingLoad::compaction;
  return {{"load", fem::name_of(forming.load)},
          {"stroke", forming.stroke[0]},
          {"stroke_y", if_true(forming.load == fem::FormingLoad::biaxial, forming.stroke[1])},
          {"thickness", if_true(is_pressed, forming.thickness)},
          {"final_thickness", if_true(is_pressed, forming.final_thickness)},
          {"friction", forming.friction},
          {"duration", forming.duration},
          {"loose_ends", forming.loose_ends},
          {"stable_increment", forming.stable.time},
          {"stable_element", forming.stable.element + 1},
          {"stable_length", forming.stable.length},
          {"wave_speed", forming.stable.wave_speed},
          {"increments", forming.increments()}};
}

std::string forming_in_words(const fem::Forming& forming) {
  const fem::StableIncrement& stable = forming.stable;
  std::string text = fmt::format(
      "explicit step, {}: {:.3g} s in about {:.2g} increments of {:.3g} s (element {}: {:.3g} mm at {:.3g} "
      "m/s; "
      "no mass scaling), friction {:g}; it is quasi-static while the kinetic energy stays a few per cent of "
      "the "
      "internal one",
      fem::name_of(forming.load), forming.duration, forming.increments(), stable.time, stable.element + 1,
      stable.length, stable.wave_speed / 1000, forming.friction);
  if (forming.loose_ends > 0)
    text += fmt::format("; {} end{} of yarns that look up or down {} free", forming.loose_ends,
                        forming.loose_ends == 1 ? "" : "s", forming.loose_ends == 1 ? "is" : "are");
  return text;
}

Json raster_json(const fem::Raster& raster) {
  return {{"count", raster.count},
          {"lengths", point_json(raster.lengths())},
          {"yarn_fraction", raster.yarn},
          {"fibre_fraction", if_true(!std::isnan(raster.fibre), raster.fibre)},
          {"overlap_fraction", raster.overlap},
          {"phases", list_json(raster.phases, [](const fem::RasterPhase& phase) {
             return Json{{"name", phase.name}, {"material", phase.material}, {"fraction", phase.fraction}};
           })}};
}

std::string raster_in_words(const fem::Raster& raster) {
  const auto [nx, ny, nz] = raster.count;
  std::string text =
      fmt::format("{} x {} x {} voxels; yarns fill {:.2f} % of the cell", nx, ny, nz, 100 * raster.yarn);
  if (raster.fibre > 0) text += fmt::format(", fibres {:.2f} %", 100 * raster.fibre);
  return text;
}

}  // namespace selvage::pipeline
