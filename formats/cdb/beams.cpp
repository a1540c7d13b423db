// Yarns as BEAM188, each beam with a node that tells where its width lies, or as LINK180.
#include <algorithm>
#include <map>
#include <numeric>

#include "core/columns.h"
#include "fem/materials.h"
#include "formats/cdb/deck.h"
#include "structured/beams.h"

namespace selvage::formats::cdb {
namespace {

// The element's z axis points to its third node, which stands along n1: z is the width, y the height.
void write_beam_sections(TextBuffer& text, const fem::BeamModel& beams) {
  for (std::size_t k = 0; k < beams.sections.size(); ++k) {
    const fem::BeamSection& s = beams.sections[k];
    if (beams.are_trusses) {
      text << "SECTYPE," << k + 1 << ",LINK\nSECDATA," << s.area << '\n';
      continue;
    }
    text << "SECTYPE," << k + 1 << ",BEAM,";
    if (s.shape == fem::BeamSection::Shape::circle)
      text << "CSOLID\nSECDATA," << (s.width + s.height) / 4 << '\n';
    else
      text << "ASEC\nSECDATA," << s.area << ',' << s.i22 << ",0," << s.i11 << ",0," << s.torsion << '\n';
  }
}

std::vector<Vec3> places_of(const fem::BeamModel& beams) {
  const fem::Mesh& mesh = beams.mesh;
  std::vector<Vec3> places = mesh.nodes;
  for (std::size_t e = 0; !beams.are_trusses && e < mesh.elements.size(); ++e) {
    const Vec3 &a = mesh.nodes[mesh.elements[e][0]], &b = mesh.nodes[mesh.elements[e][1]];
    places.emplace_back((a + b) / 2 + (b - a).norm() * mesh.across[e]);
  }
  return places;
}

void write_beam_elements(TextBuffer& text, const fem::BeamModel& beams) {
  const fem::Mesh& mesh = beams.mesh;
  open_block(text, "EBLOCK,19,SOLID,", mesh.elements.size(), "(19i10)");
  for (const fem::Region& region : mesh.regions)
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      write_element_head(text, {.material = fem::material_of(mesh, region) + 1,
                                .section = beams.section_of[e] + 1,
                                .nodes = beams.are_trusses ? 2U : 3U,
                                .number = e + 1});
      std::vector nodes = {mesh.elements[e][0], mesh.elements[e][1]};
      if (!beams.are_trusses) nodes.push_back(mesh.nodes.size() + e);
      put_numbers(text, nodes, 10, 8);
    }
  text << "        -1\n";
}

void write_beam_components(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names) {
  const auto elements = [&](std::string name, std::size_t first, std::size_t last) {
    fem::NamedSet set{std::move(name), std::vector<std::size_t>(last - first)};
    std::iota(set.members.begin(), set.members.end(), first);
    write_component(text, set, false);
  };
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    elements(names.of(i), mesh.regions[i].first_element, mesh.regions[i].last_element);
  elements("AllElements", 0, mesh.elements.size());
  for (const fem::NamedSet& set : fem::node_sets(mesh, names)) write_component(text, set, true);
}

void write_beam_materials(TextBuffer& text, const fem::Mesh& mesh) {
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fem::BeamModuli moduli = fem::beam_moduli(mesh.materials[i]);
    const fem::Orthotropic c = fem::orthotropic(mesh.materials[i]);
    text << "! material " << i + 1 << ": " << names[i] << '\n';
    const auto put = [&](std::string_view label, double value) {
      text << "MP," << label << ',' << i + 1 << ',' << value << '\n';
    };
    put("EX", moduli.young);
    put("GXY", moduli.shear);
    put("GXZ", moduli.shear);
    put("PRXY", c.nu12);
    if (c.density) put("DENS", *c.density);
    if (c.expansion) put("ALPX", (*c.expansion)[0]);
  }
}

void write_contacts(TextBuffer& text, const fem::BeamModel& beams, const fem::DeckNames& names) {
  text << "! Contact radius of each yarn, half of its thickness:\n";
  for (std::size_t i = 0; i < beams.radii.size(); ++i)
    text << "!   " << names.of(i) << ": " << beams.radii[i] << '\n';
  if (beams.contacts.empty()) return;
  text << "! Contact pairs: yarns that touch or nearly do, the least gap between their surfaces (< 0: "
          "overlap), places:\n";
  for (const fem::BeamContact& contact : beams.contacts)
    text << "! pair: " << names.of(contact.a) << ", " << names.of(contact.b) << ": " << contact.gap << ", "
         << contact.places << '\n';
}

}  // namespace

Result<WriteFacts> write_beams(const fem::BeamModel& beams, OutputFile& output,
                               const MeshFileOptions& /*options*/) {
  const fem::DeckNames names(beams.mesh, {.longest = 32, .taken = {"ALL", "STAT", "DEFA"}});
  TextBuffer text(output);
  text << "/COM,ANSYS mesh archive by Selvage: mm, N, MPa, tonne, s. Read it with CDREAD,DB\n";
  fem::write_yarn_names(text, beams.mesh, names, "!", 100);
  // Beams are cubic between their nodes (KEYOPT 3), as they bend.
  text << "/PREP7\n" << (beams.are_trusses ? "ET,1,180\n" : "ET,1,188\nKEYOPT,1,3,3\n");
  write_beam_sections(text, beams);
  write_node_block(text, places_of(beams));
  write_beam_elements(text, beams);
  write_beam_components(text, beams.mesh, names);
  write_beam_materials(text, beams.mesh);
  write_contacts(text, beams, names);
  text << "FINISH\n";
  Result<WriteFacts> facts =
      finished(text,
               {{"nodes", beams.mesh.nodes.size()},
                {beams.are_trusses ? "LINK180" : "BEAM188", beams.mesh.elements.size()},
                {"beam sections", beams.sections.size()}},
               {{"contact pairs", beams.contacts.size()}});
  if (facts) facts->messages = fem::strengths_left_out(beams.mesh.materials, "an ANSYS archive of beams");
  return facts;
}

}  // namespace selvage::formats::cdb
