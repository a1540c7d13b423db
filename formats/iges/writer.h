// The writer behind the descriptor, with what only tests set.
#pragma once

#include "formats/format.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

// add() either writes the whole yarn or, where it fails before the output does, nothing of it: finish() then
// still gives a whole file with the yarns before. Errors of add(): geometry (a number that is not finite; a
// solid of a yarn whose ends are open), limit (the yarn needs more than 9,999,999 lines in a section), io.
Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options,
                                                Records::Limits limits = {});

}  // namespace selvage::formats::iges
