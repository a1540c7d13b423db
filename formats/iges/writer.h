// The writer behind the descriptor, with what only tests set.
#pragma once

#include "formats/format.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

// A fabric: as many files as it needs (SurfaceOptions::next_part), cut between yarns; those whose group is
// the same stay together, and are checked and written when the next one comes. Errors as of a FileWriter;
// limit: the yarn fits into no file, or there can be one only.
Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options,
                                                Records::Limits limits = {});

}  // namespace selvage::formats::iges
