// Yarns as beams of LS-DYNA: resultants (Belytschko and Schwer), or trusses; a part for each section of a
// yarn.
#include "structured/beams.h"

#include <algorithm>
#include <map>

#include "core/columns.h"
#include "fem/materials.h"
#include "fem/sections.h"
#include "formats/k/deck.h"
#include "formats/k/explicit.h"

namespace selvage::formats::k {
namespace {

// Beams of one yarn with one section.
struct BeamPart {
  std::size_t region = 0, section = 0;
};

struct BeamParts {
  std::vector<BeamPart> list;
  std::vector<std::size_t> of_element;
};

BeamParts parts_of(const fem::BeamModel& beams) {
  BeamParts parts;
  parts.of_element.resize(beams.mesh.elements.size());
  for (std::size_t i = 0; i < beams.mesh.regions.size(); ++i) {
    std::map<std::size_t, std::size_t> known;
    const fem::Region& region = beams.mesh.regions[i];
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      const auto [at, is_new] = known.try_emplace(beams.section_of[e], parts.list.size());
      if (is_new) parts.list.push_back({i, beams.section_of[e]});
      parts.of_element[e] = at->second;
    }
  }
  return parts;
}

// LS-DYNA's material has one shear modulus, that of isotropy: the constants of torsion and shear make up for
// the yarn's own. s is n1, t is n2.
void write_beam_parts(TextBuffer& text, const fem::BeamModel& beams, const BeamParts& parts,
                      const fem::DeckNames& names) {
  constexpr double shear_share = 5.0 / 6;
  const fem::Mesh& mesh = beams.mesh;
  for (std::size_t k = 0; k < parts.list.size(); ++k) {
    const BeamPart& part = parts.list[k];
    const fem::BeamSection& s = beams.sections[part.section];
    const std::size_t material = fem::material_of(mesh, mesh.regions[part.region]);
    const fem::BeamModuli moduli = fem::beam_moduli(mesh.materials[material]);
    const double nu = fem::orthotropic(mesh.materials[material]).nu12;
    const double share = moduli.shear / (moduli.young / (2 * (1 + nu)));
    text << "*SECTION_BEAM\n";
    put_integers(text, {k + 1, beams.are_trusses ? 3U : 2U});
    if (beams.are_trusses)
      put_reals(text, {s.area, 0, 0});
    else
      put_reals(text, {s.area, s.i11, s.i22, share * s.torsion, shear_share * share * s.area});
    text << "*PART_CONTACT\n" << names.of(part.region) << '\n';
    put_integers(text, {k + 1, k + 1, material + 1});
    put_reals(text, {0, 0, 0, 0, 2 * beams.radii[part.region]});  // the thickness in contact
  }
}

void write_beam_materials(TextBuffer& text, const fem::Mesh& mesh) {
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fem::Orthotropic c = fem::orthotropic(mesh.materials[i]);
    text << "*MAT_ELASTIC_TITLE\n" << names[i] << '\n';
    put_right(text, i + 1, 10);
    put_reals(text, {c.density.value_or(1e-9), c.e1, c.nu12});
  }
}

void write_beam_elements(TextBuffer& text, const fem::BeamModel& beams, const BeamParts& parts) {
  const fem::Mesh& mesh = beams.mesh;
  text << (beams.are_trusses ? "*ELEMENT_BEAM\n" : "*ELEMENT_BEAM_ORIENTATION\n");
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    put_right(text, {e + 1, parts.of_element[e] + 1, mesh.elements[e][0] + 1, mesh.elements[e][1] + 1}, 8);
    text << '\n';
    if (!beams.are_trusses) put_reals(text, {mesh.across[e].x(), mesh.across[e].y(), mesh.across[e].z()});
  }
}

void write_beam_sets(TextBuffer& text, const fem::BeamModel& beams, const BeamParts& parts,
                     const fem::DeckNames& names) {
  const std::size_t regions = beams.mesh.regions.size();
  std::vector<std::vector<std::size_t>> of_region(regions);
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < parts.list.size(); ++k) {
    of_region[parts.list[k].region].push_back(k);
    all.push_back(k);
  }
  for (std::size_t i = 0; i < regions; ++i)
    write_list(text, "SET_PART_LIST", i + 1, names.of(i), of_region[i]);
  write_list(text, "SET_PART_LIST", regions + 1, "All", all);
  std::size_t number = 0;
  for (const fem::NamedSet& set : fem::node_sets(beams.mesh, names))
    write_list(text, "SET_NODE_LIST", ++number, set.name, set.members);
}

// As comments: contact makes the model nonlinear.
void write_contacts(TextBuffer& text, const fem::BeamModel& beams, const fem::DeckNames& names) {
  if (beams.contacts.empty()) return;
  text << "$ Contact pairs: yarns that touch or nearly do, the least gap between their\n$ surfaces (< 0: "
          "overlap), places:\n";
  for (const fem::BeamContact& contact : beams.contacts)
    text << "$ pair: " << names.of(contact.a) << ", " << names.of(contact.b) << ": " << contact.gap << ", "
         << contact.places << '\n';
  text << "$ All of them at once: take the marks $~ away.\n$~*CONTACT_AUTOMATIC_GENERAL\n$~";
  put_integers(text, {beams.mesh.regions.size() + 1, 0, 2, 0});
  text << "$~";
  put_reals(text, {0, 0});
  text << "$~\n";
}

}  // namespace

Result<WriteFacts> write_beams(const fem::BeamModel& beams, OutputFile& output,
                               const MeshFileOptions& options) {
  const fem::DeckNames names(beams.mesh, {.longest = 70, .is_text = true, .unfit = "*$,&"});
  const BeamParts parts = parts_of(beams);
  TextBuffer text(output);
  text << "*KEYWORD\n*TITLE\nSelvage: " << std::string_view(beams.mesh.title).substr(0, 70)
       << "\n$ Units: mm, N, MPa, tonne, s\n";
  fem::write_yarn_names(text, beams.mesh, names, "$", 80);
  write_nodes(text, beams.mesh);
  write_beam_parts(text, beams, parts, names);
  write_beam_materials(text, beams.mesh);
  write_beam_elements(text, beams, parts);
  write_beam_sets(text, beams, parts, names);
  if (options.forming != nullptr)
    write_forming(text, *options.forming,
                  {.nodes = beams.mesh.nodes.size(),
                   .elements = beams.mesh.elements.size(),
                   .parts = parts.list.size(),
                   .sections = parts.list.size(),
                   .materials = beams.mesh.materials.size(),
                   .node_sets = fem::node_sets(beams.mesh, names).size()},
                  true);
  else
    write_contacts(text, beams, names);
  text << "*END\n";
  Result<WriteFacts> facts = finished(text,
                                      {{"nodes", beams.mesh.nodes.size()},
                                       {beams.are_trusses ? "trusses" : "beams", beams.mesh.elements.size()},
                                       {"parts", parts.list.size()}},
                                      {{"contact pairs", beams.contacts.size()}});
  if (facts) facts->messages = fem::strengths_left_out(beams.mesh.materials, "an LS-DYNA file of beams");
  return facts;
}

}  // namespace selvage::formats::k
