// Model to text: canonical, for people to read.
#pragma once

#include "core/diagnostics.h"
#include "core/output.h"
#include "fabric/model.h"
#include "formats/format.h"

namespace selvage::formats::txt {

// Reading what was written gives the same model, every number bit for bit. Streams: memory does not grow with
// the model. Errors: io; malformed: a name that no text can hold (a double quote, a line break, no name at
// all), a number that is not finite, a yarn without a shape.
Result<WriteFacts> write_fabric(const fabric::Fabric& fabric, OutputFile& output);

}  // namespace selvage::formats::txt
