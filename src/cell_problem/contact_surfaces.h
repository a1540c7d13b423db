// Where dry yarns may touch: for decks in which contact is defined.
#pragma once

#include <array>
#include <vector>

#include "fem/mesh.h"
#include "fem/sides.h"

namespace selvage::fem {

// A yarn's sides without its end faces, and without what the faces of a cell cut.
struct ContactSurface {
  std::size_t region = 0;
  std::vector<OuterSide> whole;         // in the order of the elements
  std::vector<OuterSide> upper, lower;  // those that look up, and down: by the z of their outward normal
};

struct ContactSurfaces {
  std::vector<ContactSurface> surfaces;           // one a yarn
  std::vector<std::array<std::size_t, 2>> pairs;  // of indices into `surfaces`, the lower first
  std::size_t distances = 0;                      // that were measured for them: what the work grows with
};

// Nothing of a mesh that has a matrix. Pairs: yarns of which a corner on one's surface is nearer to the
// other's than a quarter of the thinner one's thickness (four volumes over the surface: a round yarn's
// diameter).
ContactSurfaces contact_surfaces(const Mesh& mesh);

}  // namespace selvage::fem
