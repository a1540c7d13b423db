// Text to model. README.md: the language.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/model.h"

namespace selvage::formats::txt {

// One pass over the source's bytes. Nothing comes back exactly when there was an error; at most 20 are
// reported, in the order of their lines.
std::optional<fabric::Fabric> read_fabric(const Source& source, Diagnostics& diagnostics);
// With other values of its params. Errors: one that the text has not.
std::optional<fabric::Fabric> read_fabric_with(const Source& source,
                                               const std::vector<fabric::Setting>& settings,
                                               Diagnostics& diagnostics);

// Is the first statement `fabric N`?
bool is_fabric_txt(std::string_view head);

}  // namespace selvage::formats::txt
