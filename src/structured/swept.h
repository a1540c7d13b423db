// Hexahedra swept along the yarns of a dry fabric, with wedges at the tips of their sections. What is divided
// is the section, once (section_pattern.h), and the way along the yarn, as coarsely as its bends allow
// (stations.h).
#pragma once

#include <functional>
#include <span>

#include "core/diagnostics.h"
#include "core/units.h"
#include "fabric/model.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

struct SweptOptions {
  double size = 0;  // of pieces through the thickness, file units; 0: a third of a yarn's narrowest section
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress{};  // of yarns; may be empty
};

// One Region a body in their order, in mm. Along a yarn elements are at most eight sizes long (four where
// there are wedges, which are stiff in bending), turn by at
// most 0.35 radians and leave the surface by at most 3 % of the thickness. Nodes of the surface stand a
// little outside of it, so that volumes are right (kept_volume.h); where neighbours leave no room for that,
// sizes are smaller, by 0.65 up to four times, with a note. Warnings: materials (materials.h). Errors:
// geometry (an element that is turned inside out, with its yarn and place), limit (more than 2 10^7
// elements).
Result<Mesh> mesh_swept(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                        const SweptOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fem
