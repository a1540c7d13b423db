// All yarns' skins as triangles, with the gap at every vertex: what `selvage check --gap-map` writes.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "contact/gap_field.h"
#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::solid {

struct GapMap {
  std::vector<std::string> names;         // of the yarns
  std::vector<contact::SkinMesh> skins;   // one a yarn
  std::vector<std::vector<double>> gaps;  // as contact::gap_field()
};

struct GapMapOptions {
  double reach = 0;  // file units; 0: a tenth of the narrowest section
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;  // may be empty
};

// No triangle is farther from its yarn's surface than 1/100 of the yarn's narrowest section, and none is
// much longer than 1/5 of it, so that the vertices see what a chord can show. Errors: what tessellate() says;
// limit (more than 100 million triangles).
Result<GapMap> gap_map(std::span<const yarn::Body> bodies, const GapMapOptions& options);

}  // namespace selvage::solid
