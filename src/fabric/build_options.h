// How the yarns of a text are built: what all constructions are asked for.
#pragma once

#include <cstddef>
#include <optional>

#include "fabric/model.h"
#include "fabric/plan.h"
#include "fabric/plies.h"
#include "yarn/body.h"

namespace selvage::fabric {

struct BuildOptions {
  std::optional<yarn::EndStyle> ends;  // none: as the file has them; where it does not say, patch
  double tolerance = 0;  // file units; 0: the file's, or 1/1000 of the smallest section size in the file
  // Control points of tubes with all digits of the computation; else on a decimal grid of at most 1e-4 of the
  // tolerance, so that texts of them are short.
  bool full_digits = false;
  Detail detail = Detail::usual;  // yarns are taken apart into plies and filaments as their threads say
  // Constructions exactly as their paper gives them, overlaps and all; else mended so that no yarns overlap.
  bool as_published = false;
  // Least gap between the yarns of a construction, in the file's unit; 0: a share of their thickness (1 %, of
  // braids 0.5 %). Yarns without room for it lie as far apart as they can.
  double gap = 0;
  std::size_t max_control_points = 5'000'000;  // a yarn: a limit error instead of an exhausted memory
  WorkLimits work;
};

// The smallest section size (width or thickness) of the yarns of the text, or of its constructions' threads;
// file units, none where there is no size.
std::optional<double> smallest_section(const Fabric& fabric);

// The tolerance in force, file units.
double tolerance_of(const Fabric& fabric, const BuildOptions& options);

}  // namespace selvage::fabric
