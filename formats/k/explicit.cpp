#include "formats/k/explicit.h"

#include <algorithm>

#include "core/columns.h"
#include "formats/k/deck.h"

namespace selvage::formats::k {
namespace {

constexpr std::size_t global_directions = 1, displacement = 2;  // CMO, VAD
constexpr std::size_t hold_x_and_y = 4, hold_rotations = 7;     // CON1, CON2

// LS-DYNA counts rotations from 5 on.
std::size_t direction_of(const fem::RigidPart::Motion& motion) {
  return static_cast<std::size_t>(motion.direction < 3 ? motion.direction + 1 : motion.direction + 2);
}

std::size_t held_curve(const fem::Forming& forming) {
  return forming.curves.size() + 1;
}

void write_controls(TextBuffer& text, const fem::Forming& forming, bool of_beams) {
  text << "$ Stable increments of about " << forming.stable.time << " s (element "
       << forming.stable.element + 1 << "); no mass scaling.\n*CONTROL_TERMINATION\n";
  put_reals(text, {forming.duration});
  text << "*CONTROL_TIMESTEP\n";
  put_reals(text, {0, 0.9});
  text << "$ Energies of hourglasses and of sliding go into glstat.\n*CONTROL_ENERGY\n";
  put_integers(text, {2, 2, 2, 2});
  if (of_beams) return;
  text << "$ Numbering of solids that material axes do not depend on.\n*CONTROL_ACCURACY\n";
  put_integers(text, {0, 3});
  text << "$ By stiffness (Flanagan and Belytschko).\n*CONTROL_HOURGLASS\n";
  put_right(text, std::size_t{4}, 10);
  put_reals(text, {0.05});
}

void write_curves(TextBuffer& text, const fem::Forming& forming) {
  for (std::size_t k = 0; k < forming.curves.size(); ++k) {
    text << "*DEFINE_CURVE_TITLE\n" << forming.curves[k].name << '\n';
    put_integers(text, {k + 1});
    for (const auto& [time, value] : forming.curves[k].points)
      put_reals(text, {time * forming.duration, value}, 20);
  }
  text << "*DEFINE_CURVE_TITLE\nHeld\n";
  put_integers(text, {held_curve(forming)});
  put_reals(text, {0, 0}, 20);
  put_reals(text, {forming.duration, 0}, 20);
}

// Segments have half of their thickness on either side: the plate stands off by it.
void write_plate(TextBuffer& text, const fem::RigidPart& part, double offset, std::size_t number,
                 std::size_t& node, std::size_t& element, const Taken& taken) {
  text << "*PART\n" << part.name << '\n';
  put_integers(text, {number, taken.sections + 1, taken.materials + 1});
  text << "*NODE\n";
  for (std::size_t n = 0; n < part.nodes.size(); ++n) {
    const Vec3& p = part.nodes[n];
    put_right(text, node + n + 1, 8);
    put_reals(text, {p.x(), p.y(), p.z() + offset}, 16);
  }
  text << "*ELEMENT_SHELL\n";
  for (const auto& quad : part.quads) {
    put_right(text, {++element, number}, 8);
    for (const std::size_t corner : quad) put_right(text, node + corner + 1, 8);
    text << '\n';
  }
  node += part.nodes.size();
}

// A grip's mass and inertia move nothing, for all of its motion is prescribed; they are small, for they count
// in the kinetic energy.
void write_grip(TextBuffer& text, const fem::Forming& forming, const fem::RigidPart& part, std::size_t number,
                std::size_t set) {
  constexpr double share = 1e-3;
  const double mass = share * forming.mass, inertia = mass * part.size * part.size;
  write_list(text, "SET_NODE_LIST", set, part.name, part.grip);
  text << "*CONSTRAINED_NODAL_RIGID_BODY_INERTIA\n";
  put_integers(text, {number, 0, set});
  put_reals(text, {part.reference.x(), part.reference.y(), part.reference.z(), mass});
  put_reals(text, {inertia, 0, 0, inertia, 0, inertia});
  put_reals(text, {0, 0, 0, 0, 0, 0});
}

void write_motions(TextBuffer& text, const fem::Forming& forming, std::size_t first) {
  text << "*BOUNDARY_PRESCRIBED_MOTION_RIGID\n";
  for (std::size_t k = 0; k < forming.parts.size(); ++k) {
    const fem::RigidPart& part = forming.parts[k];
    for (const fem::RigidPart::Motion& motion : part.motions) {
      put_right(text, {first + k, direction_of(motion), displacement, motion.curve + 1}, 10);
      put_reals(text, {motion.factor});
    }
    if (part.grip.empty()) continue;  // its material holds a plate
    for (int direction = 0; direction < 6; ++direction) {
      const bool moves = std::any_of(part.motions.begin(), part.motions.end(),
                                     [&](const auto& motion) { return motion.direction == direction; });
      if (moves) continue;
      put_right(text, {first + k, direction_of({direction}), displacement, held_curve(forming)}, 10);
      put_reals(text, {1});
    }
  }
}

void write_plates(TextBuffer& text, const fem::Forming& forming, const Taken& taken) {
  constexpr double thickness_share = 0.05;  // of the cloth's
  const double thickness = thickness_share * forming.thickness;
  text << "*SECTION_SHELL\n";
  put_integers(text, {taken.sections + 1, 2});
  put_reals(text, {thickness, thickness, thickness, thickness});
  text << "$ Steel, for the stiffness of contact; held but for z.\n*MAT_RIGID_TITLE\nPlates\n";
  put_right(text, taken.materials + 1, 10);
  put_reals(text, {7.8e-9, 210'000, 0.3});
  put_integers(text, {global_directions, hold_x_and_y, hold_rotations});
  put_reals(text, {0, 0, 0, 0, 0, 0});
  std::size_t node = taken.nodes, element = taken.elements, number = taken.parts;
  for (const fem::RigidPart& part : forming.parts) {
    const bool is_below = part.motions.front().factor > 0;
    write_plate(text, part, (is_below ? -thickness : thickness) / 2, ++number, node, element, taken);
  }
}

void write_contact(TextBuffer& text, const fem::Forming& forming, bool of_beams) {
  constexpr std::size_t all_parts = 5, soft_constraint = 1;
  text << (of_beams ? "*CONTACT_AUTOMATIC_GENERAL\n" : "*CONTACT_AUTOMATIC_SINGLE_SURFACE\n");
  put_integers(text, {0, 0, all_parts, 0});
  put_reals(text, {forming.friction, forming.friction});
  put_reals(text, {1, 1, 0, 0, 1, 1, 1, 1});
  put_integers(text, {soft_constraint});
}

void write_outputs(TextBuffer& text, const fem::Forming& forming) {
  constexpr int frames = 20, samples = 200;
  text << "$ Quasi-static while the kinetic energy in glstat is a few per cent of the internal one; forces "
          "on\n$ "
          "grips and plates are in bndout.\n";
  for (const std::string_view file : {"GLSTAT", "MATSUM", "BNDOUT", "RBDOUT", "SLEOUT"}) {
    text << "*DATABASE_" << file << '\n';
    put_reals(text, {forming.duration / samples});
  }
  text << "*DATABASE_BINARY_D3PLOT\n";
  put_reals(text, {forming.duration / frames});
}

}  // namespace

void write_forming(TextBuffer& text, const fem::Forming& forming, const Taken& taken, bool of_beams) {
  write_controls(text, forming, of_beams);
  write_curves(text, forming);
  if (forming.load == fem::FormingLoad::compaction) {
    write_plates(text, forming, taken);
  } else {
    for (std::size_t k = 0; k < forming.parts.size(); ++k)
      write_grip(text, forming, forming.parts[k], taken.parts + k + 1, taken.node_sets + k + 1);
  }
  write_motions(text, forming, taken.parts + 1);
  write_contact(text, forming, of_beams);
  write_outputs(text, forming);
}

}  // namespace selvage::formats::k
