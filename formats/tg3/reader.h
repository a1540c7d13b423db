// A tg3 file as a fabric: README.md.
#pragma once

#include <optional>
#include <string_view>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/model.h"

namespace selvage::formats::tg3 {

// Does it begin as a TexGen model?
bool is_tg3(std::string_view head);

// Errors, each at its element: a file that is too large (limit, before it is read), XML that is not whole,
// another version, what README.md says is not read, and what read_yarn, read_domain and lay refuse.
std::optional<fabric::Fabric> read_fabric(const Source& source, Diagnostics& diagnostics);

// The same with surfaces within `tolerance` (file units, > 0) of the sections of the file. 0: as read_fabric.
std::optional<fabric::Fabric> read_within(const Source& source, double tolerance, Diagnostics& diagnostics);

}  // namespace selvage::formats::tg3
