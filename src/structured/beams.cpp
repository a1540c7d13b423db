#include "structured/beams.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "contact/contact.h"
#include "core/parallel.h"
#include "fem/materials.h"
#include "structured/stations.h"

namespace selvage::fem {
namespace {

constexpr double longest_extents = 4, deviation_extents = 0.1, reach_extents = 0.25;
constexpr double alike = 0.01;  // areas of sections that are one
constexpr int least_beams = 8;

// One yarn as beams, mm.
struct BeamChain {
  std::vector<double> vs;  // of the nodes; of a ring the last is the first again
  std::vector<Vec3> nodes;
  std::vector<PlacedSection> placed;  // of the elements, in their middles
  std::vector<BeamSection> sections;  // with the torsion constant, each once
  std::vector<std::size_t> section_of;
};

void choose_sections(const yarn::Body& body, double scale, BeamChain& chain) {
  for (std::size_t k = 0; k + 1 < chain.vs.size(); ++k) {
    const BeamSection& own = chain.placed[k].section;
    const auto known = std::find_if(chain.sections.begin(), chain.sections.end(),
                                    [&](const BeamSection& other) { return are_alike(own, other, alike); });
    chain.section_of.push_back(static_cast<std::size_t>(known - chain.sections.begin()));
    if (known != chain.sections.end()) continue;
    chain.sections.push_back(own);
    chain.sections.back().torsion = torsion_constant(body, (chain.vs[k] + chain.vs[k + 1]) / 2, scale);
  }
}

BeamChain chain_of(const yarn::Body& body, double scale, double size) {
  const double extent = yarn::narrowest_section(body);
  BeamChain chain;
  chain.vs = stations(body, body.quarters,
                      {.longest = size > 0 ? size : longest_extents * extent,
                       .deviation = deviation_extents * extent,
                       .least = least_beams});
  const std::size_t elements = chain.vs.size() - 1;
  for (std::size_t k = 0; k < chain.vs.size() - (body.closed_along ? 1 : 0); ++k)
    chain.nodes.push_back(beam_section(body, chain.vs[k], scale).centroid);
  for (std::size_t k = 0; k < elements; ++k) {
    PlacedSection placed = beam_section(body, (chain.vs[k] + chain.vs[k + 1]) / 2, scale);
    const Vec3 along = (chain.nodes[(k + 1) % chain.nodes.size()] - chain.nodes[k]).normalized();
    placed.n1 = (placed.n1 - along * along.dot(placed.n1)).normalized();
    chain.placed.push_back(std::move(placed));
  }
  choose_sections(body, scale, chain);
  return chain;
}

void append(BeamModel& beams, const yarn::Body& body, const BeamChain& chain, double scale) {
  Mesh& mesh = beams.mesh;
  Region& region = mesh.regions.emplace_back();
  region.name = body.name;
  region.first_node = mesh.nodes.size();
  region.first_element = mesh.elements.size();
  mesh.nodes.insert(mesh.nodes.end(), chain.nodes.begin(), chain.nodes.end());
  const std::size_t count = chain.nodes.size(), known = beams.sections.size();
  for (std::size_t k = 0; k < chain.placed.size(); ++k) {
    const std::size_t a = region.first_node + k, b = region.first_node + (k + 1) % count;
    mesh.elements.push_back({a, b});
    mesh.along.push_back((mesh.nodes[b] - mesh.nodes[a]).normalized());
    mesh.across.push_back(chain.placed[k].n1);
    beams.section_of.push_back(known + chain.section_of[k]);
    region.volume += chain.placed[k].section.area * (mesh.nodes[b] - mesh.nodes[a]).norm();
  }
  beams.sections.insert(beams.sections.end(), chain.sections.begin(), chain.sections.end());
  region.last_node = mesh.nodes.size();
  region.last_element = mesh.elements.size();
  region.exact_volume = body.volume * scale * scale * scale;
  region.length = body.length * scale;
  if (!body.closed_along) {
    region.start_nodes = {region.first_node};
    region.end_nodes = {region.last_node - 1};
  }
  beams.radii.push_back(yarn::narrowest_section(body) * scale / 2);
}

// Of all yarns that have one section, one is enough; sections that others have, too.
void merge_sections(BeamModel& beams) {
  std::vector<BeamSection> all;
  std::vector<std::size_t> number;
  for (const BeamSection& section : beams.sections) {
    const auto is_it = [&](const BeamSection& other) {
      return are_alike(section, other, 1e-4) &&
             std::abs(section.torsion - other.torsion) <= 1e-3 * other.torsion;
    };
    const auto known = std::find_if(all.begin(), all.end(), is_it);
    number.push_back(static_cast<std::size_t>(known - all.begin()));
    if (known == all.end()) all.push_back(section);
  }
  for (std::size_t& section : beams.section_of) section = number[section];
  beams.sections = std::move(all);
}

Result<std::vector<BeamContact>> find_pairs(std::span<const yarn::Body> bodies, double scale, int threads) {
  contact::ContactOptions options;
  for (const yarn::Body& body : bodies) {
    const double reach = reach_extents * yarn::narrowest_section(body);
    options.reach = options.reach > 0 ? std::min(options.reach, reach) : reach;
  }
  options.threads = threads;
  const Result<contact::Contacts> found = contact::find_contacts(bodies, options);
  if (!found) return found.error();
  std::map<std::array<std::size_t, 2>, BeamContact> pairs;
  for (const contact::Contact& one : found->list) {  // the deepest of a pair comes first
    const auto [at, is_new] = pairs.try_emplace({one.a, one.b});
    if (is_new) at->second = {one.a, one.b, 0, one.gap * scale, one.at * scale};
    ++at->second.places;
  }
  std::vector<BeamContact> list;
  list.reserve(pairs.size());
  for (const auto& [yarns, pair] : pairs) list.push_back(pair);
  return list;
}

void say_what_overlaps(const BeamModel& beams, const std::string& file, Diagnostics& diagnostics) {
  std::size_t count = 0;
  const BeamContact* deepest = nullptr;
  for (const BeamContact& contact : beams.contacts) {
    if (!(contact.gap < 0)) continue;
    ++count;
    if (deepest == nullptr || contact.gap < deepest->gap) deepest = &contact;
  }
  if (count == 0) return;
  const auto name = [&](std::size_t k) { return beams.mesh.regions[k].name; };
  diagnostics.add(
      warning(
          Kind::geometry,
          fmt::format("{} of yarns overlap, the deepest '{}' and '{}' by {:.3g} mm: in contact they begin "
                      "pressed together; --relax moves them apart where they have room",
                      count == 1 ? "a pair" : fmt::format("{} pairs", count), name(deepest->a),
                      name(deepest->b), -deepest->gap))
          .placed({}, file));
}

}  // namespace

Result<BeamModel> make_beams(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                             const BeamOptions& options, Diagnostics& diagnostics) {
  if (bodies.empty()) return error(Kind::geometry, "there is no yarn to mesh");
  const double scale = millimetres_per(units);
  std::vector<BeamChain> chains(bodies.size());
  for_each_index(
      bodies.size(), options.threads,
      [&](std::size_t i) { chains[i] = chain_of(bodies[i], scale, options.size); }, options.progress);
  BeamModel beams;
  beams.are_trusses = options.trusses;
  beams.mesh.shape = Mesh::Shape::beam;
  beams.mesh.title = fabric.title.value_or("");
  for (std::size_t i = 0; i < bodies.size(); ++i) append(beams, bodies[i], chains[i], scale);
  merge_sections(beams);
  MaterialChoice choice = choose_materials(fabric, bodies, diagnostics);
  beams.mesh.materials = std::move(choice.materials);
  for (std::size_t i = 0; i < bodies.size(); ++i) beams.mesh.regions[i].material = choice.of_body[i];
  Result<std::vector<BeamContact>> contacts = find_pairs(bodies, scale, options.threads);
  if (!contacts) return contacts.error();
  beams.contacts = std::move(*contacts);
  say_what_overlaps(beams, fabric.file, diagnostics);
  return beams;
}

BeamModuli beam_moduli(const fabric::Material& material) {
  const fabric::TransverseElastic elastic = as_transverse(material);
  return {elastic.e1, elastic.g12};
}

std::vector<BeamEnds> beam_ends(const BeamModel& beams) {
  constexpr double strain = 0.001;
  std::vector<BeamEnds> ends;
  const Mesh& mesh = beams.mesh;
  for (const Region& region : mesh.regions) {
    BeamEnds own{region.first_node, region.last_node - 1};
    Vec3 way = mesh.along[region.last_element - 1];
    if (region.start_nodes.empty()) {
      const auto distance = [&](std::size_t n) { return (mesh.nodes[n] - mesh.nodes[own.held]).norm(); };
      for (std::size_t n = region.first_node; n < region.last_node; ++n)
        if (distance(n) > distance(own.pulled)) own.pulled = n;
      way = (mesh.nodes[own.pulled] - mesh.nodes[own.held]).normalized();
    }
    own.pull = strain * region.length * way;
    ends.push_back(own);
  }
  return ends;
}

}  // namespace selvage::fem
