// The explicit step of Abaqus/Explicit: rigid grips and plates, general contact, and what is recorded.
#include "fem/forming.h"

#include <algorithm>

#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

// Behind the yarns' nodes and elements each part has those of its plate, and its reference node.
struct Numbers {
  std::size_t node = 0, reference = 0, element = 0;  // from 1; the first ones of the plate
};

std::vector<Numbers> numbers_of(const fem::Mesh& mesh, const fem::Forming& forming) {
  std::vector<Numbers> all;
  std::size_t node = mesh.nodes.size() + 1, element = mesh.elements.size() + 1;
  for (const fem::RigidPart& part : forming.parts) {
    all.push_back({node, node + part.nodes.size(), element});
    node += part.nodes.size() + 1;
    element += part.quads.size();
  }
  return all;
}

void write_boundaries(TextBuffer& text, const fem::Forming& forming) {
  text << "*BOUNDARY\n";
  for (const fem::RigidPart& part : forming.parts)
    for (int direction = 0; direction < 6; ++direction) {
      const bool moves = std::any_of(part.motions.begin(), part.motions.end(),
                                     [&](const auto& motion) { return motion.direction == direction; });
      if (!moves) text << part.name << "_Ref, " << direction + 1 << ", " << direction + 1 << '\n';
    }
  for (std::size_t k = 0; k < forming.curves.size(); ++k) {
    text << "*BOUNDARY, TYPE=DISPLACEMENT, AMPLITUDE=" << forming.curves[k].name << '\n';
    for (const fem::RigidPart& part : forming.parts)
      for (const fem::RigidPart::Motion& motion : part.motions)
        if (motion.curve == k)
          text << part.name << "_Ref, " << motion.direction + 1 << ", " << motion.direction + 1 << ", "
               << real(motion.factor) << '\n';
  }
}

void write_outputs(TextBuffer& text, const fem::Forming& forming) {
  constexpr int frames = 20, samples = 200;
  text << "*OUTPUT, FIELD, NUMBER INTERVAL=" << frames << "\n*NODE OUTPUT\nU, V, RF\n*ELEMENT OUTPUT\nS, LE\n"
       << "** Quasi-static while ALLKE is a few per cent of ALLIE; ALLAE, of hourglasses, likewise.\n"
       << "*OUTPUT, HISTORY, TIME INTERVAL=" << real(forming.duration / samples)
       << "\n*ENERGY OUTPUT\nALLKE, ALLIE, ALLAE, ALLFD, ALLWK, ETOTAL\n"
       << "*NODE OUTPUT, NSET=References\nU, UR, RF, RM\n";
}

}  // namespace

void write_rigid_nodes(TextBuffer& text, const fem::Mesh& mesh, const fem::Forming& forming) {
  std::size_t number = mesh.nodes.size();
  const auto write_node = [&](const Vec3& p) {
    text << ++number << ", " << real(p.x()) << ", " << real(p.y()) << ", " << real(p.z()) << '\n';
  };
  for (const fem::RigidPart& part : forming.parts) {
    for (const Vec3& node : part.nodes) write_node(node);
    write_node(part.reference);
  }
}

void write_rigid_parts(TextBuffer& text, const fem::Mesh& mesh, const fem::Forming& forming) {
  const std::vector<Numbers> numbers = numbers_of(mesh, forming);
  for (std::size_t k = 0; k < forming.parts.size(); ++k) {
    const fem::RigidPart& part = forming.parts[k];
    text << "*NSET, NSET=" << part.name << "_Ref\n" << numbers[k].reference << '\n';
    if (!part.grip.empty()) {
      text << "*NSET, NSET=" << part.name << '\n';
      write_set(text, part.grip);
      continue;
    }
    text << "*ELEMENT, TYPE=R3D4, ELSET=" << part.name << '\n';
    std::size_t element = numbers[k].element;
    for (const auto& quad : part.quads) {
      text << element++;
      for (const std::size_t node : quad) text << ", " << numbers[k].node + node;
      text << '\n';
    }
  }
  text << "*NSET, NSET=References\n";
  for (const fem::RigidPart& part : forming.parts) text << part.name << "_Ref\n";
}

void write_rigid_bodies(TextBuffer& text, const fem::Mesh& mesh, const fem::Forming& forming) {
  const std::vector<Numbers> numbers = numbers_of(mesh, forming);
  for (std::size_t k = 0; k < forming.parts.size(); ++k)
    text << "*RIGID BODY, REF NODE=" << numbers[k].reference
         << (forming.parts[k].grip.empty() ? ", ELSET=" : ", TIE NSET=") << forming.parts[k].name << '\n';
}

void write_amplitudes(TextBuffer& text, const fem::Forming& forming) {
  for (const fem::MotionCurve& curve : forming.curves) {
    text << "*AMPLITUDE, NAME=" << curve.name << ", TIME=STEP TIME, ";
    if (curve.is_smooth_step) {
      text << "DEFINITION=SMOOTH STEP\n0, 0, " << real(forming.duration) << ", 1\n";
      continue;
    }
    text << "DEFINITION=TABULAR, SMOOTH=0.25\n";
    for (const auto& [time, value] : curve.points)
      text << real(time * forming.duration) << ", " << real(value) << '\n';
  }
}

void write_explicit_step(TextBuffer& text, const fem::Forming& forming,
                         const std::vector<ContactThickness>& thicknesses) {
  text << "*SURFACE INTERACTION, NAME=YarnContact\n*FRICTION\n" << real(forming.friction) << '\n';
  text << "** Stable increments of about " << real(forming.stable.time) << " s (element "
       << forming.stable.element + 1 << "); no mass scaling.\n*STEP, NLGEOM=YES\n*DYNAMIC, EXPLICIT\n, "
       << real(forming.duration) << "\n*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n";
  if (!thicknesses.empty()) text << "*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS\n";
  for (const ContactThickness& one : thicknesses) text << one.surface << ", " << real(one.thickness) << '\n';
  text << "*CONTACT PROPERTY ASSIGNMENT\n, , YarnContact\n";
  write_boundaries(text, forming);
  write_outputs(text, forming);
  text << "*END STEP\n";
}

}  // namespace selvage::formats::inp
