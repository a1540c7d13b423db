// Yarns as chains of beams, for knits and large cloths: what a solver needs of them.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/units.h"
#include "fabric/model.h"
#include "fem/mesh.h"
#include "structured/beam_section.h"
#include "yarn/body.h"

namespace selvage::fem {

// Two yarns that touch, or nearly; or two places of one (a == b).
struct BeamContact {
  std::size_t a = 0, b = 0;  // indices of regions, a <= b
  std::size_t places = 0;
  double gap = 0;          // mm, the least, between their surfaces; < 0: minus the depth of an overlap
  Vec3 at = Vec3::Zero();  // there
};

struct BeamModel {
  // Shape::beam, mm. Elements have two nodes, on the line of the sections' centroids; `along` is the
  // direction between them, `across` their section's n1. A ring's last element ends in its first node;
  // others have a start and an end node.
  Mesh mesh;
  std::vector<BeamSection> sections;
  std::vector<std::size_t> section_of;  // of each element
  std::vector<double> radii;            // of each region, mm: half of its thickness, for contact
  std::vector<BeamContact> contacts;    // by a, then b
  bool are_trusses = false;             // of each section its area alone counts
};

struct BeamOptions {
  double size = 0;  // the longest beam, file units; 0: four times the yarn's thickness
  bool trusses = false;
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress{};  // may be empty: yarns
};

// Beams turn by at most 0.35 radians and leave the centre line by at most a tenth of the thickness. Sections
// that are alike to 1 % of their area are one. Contacts: up to a gap of a quarter of the thinnest yarn.
// Warnings: materials (materials.h); overlaps.
// Errors: of contact::find_contacts.
Result<BeamModel> make_beams(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                             const BeamOptions& options, Diagnostics& diagnostics);

// Young's modulus along a yarn and the modulus of its torsion, MPa: all of a material that beams know.
struct BeamModuli {
  double young = 0, shear = 0;
};
BeamModuli beam_moduli(const fabric::Material& material);

// A beam's two ends that are held and pulled, one each a yarn: of a ring its first node and that farthest
// from it.
struct BeamEnds {
  std::size_t held = 0, pulled = 0;  // nodes
  Vec3 pull = Vec3::Zero();          // mm: a thousandth of the yarn's length, along its end
};
std::vector<BeamEnds> beam_ends(const BeamModel& beams);

}  // namespace selvage::fem
