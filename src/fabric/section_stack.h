// Outlines of a yarn's sections, as they are measured one by one: the grid of a surface through them.
#pragma once

#include "fabric/measured.h"

namespace selvage::fabric {

// The measured yarn has outlines (MeasuredYarn::sections). Every outline gets as many points as the one with
// the most has (12 at least, 64 at most), at even steps of its length; neighbours run the same way round, and
// begin so that the sum of the squares of their points' ways is least. The surface, quadratic round and cubic
// along by the chords of the sections' middles, goes through all these points. Errors as of yarn_of.
Result<Grid> grid_of_outlines(const MeasuredYarn& measured);

}  // namespace selvage::fabric
