// The chart of a weft knit as a program that a knitting machine of two beds can knit.
#pragma once

#include "core/diagnostics.h"
#include "core/output.h"
#include "fabric/model.h"
#include "formats/format.h"

namespace selvage::formats::knitout {

// Errors (unsupported), at the knit's line: anything but one weft knit; plating and pile; loops that a
// machine cannot bring where the chart wants them. What was written has been read back: it knits the chart.
Result<WriteFacts> write_fabric(const fabric::Fabric& fabric, OutputFile& output);

}  // namespace selvage::formats::knitout
