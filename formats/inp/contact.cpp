// Surfaces of dry yarns, and the pairs of them that may touch.
#include "cell_problem/contact_surfaces.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

void write_surface(TextBuffer& text, const std::string& name, const std::vector<fem::OuterSide>& sides) {
  if (sides.empty()) return;
  text << "*SURFACE, NAME=" << name << ", TYPE=ELEMENT\n";
  for (const fem::OuterSide& side : sides) text << side.element + 1 << ", S" << side.side + 1 << '\n';
}

}  // namespace

void write_contact_surfaces(TextBuffer& text, const Deck& deck) {
  for (const fem::ContactSurface& surface : deck.contact.surfaces) {
    const std::string& name = deck.names.of(surface.region);
    write_surface(text, name + "_Surface", surface.whole);
    write_surface(text, name + "_Upper", surface.upper);
    write_surface(text, name + "_Lower", surface.lower);
  }
}

// As comments: contact makes a step nonlinear. Frictionless, for the second number of *FRICTION is not the
// same in Abaqus and in CalculiX; pressure over overclosure in MPa/mm.
void write_contact_pairs(TextBuffer& text, const Deck& deck) {
  const fem::ContactSurfaces& contact = deck.contact;
  if (contact.pairs.empty()) return;
  text << "** Yarns that are near each other. Contact makes the step nonlinear: take the marks **~ away to "
          "have it.\n"
          "**~*SURFACE INTERACTION, NAME=YarnContact\n**~*SURFACE BEHAVIOR, "
          "PRESSURE-OVERCLOSURE=LINEAR\n**~1e6\n";
  for (const auto& [first, second] : contact.pairs)
    text << "**~*CONTACT PAIR, INTERACTION=YarnContact, TYPE=SURFACE TO SURFACE\n**~"
         << deck.names.of(contact.surfaces[first].region) << "_Surface, "
         << deck.names.of(contact.surfaces[second].region) << "_Surface\n";
}

}  // namespace selvage::formats::inp
