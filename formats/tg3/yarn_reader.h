// The element <Yarn> of a tg3 file.
#pragma once

#include <optional>

#include "formats/tg3/fields.h"
#include "formats/tg3/textile.h"

namespace selvage::formats::tg3 {

// All but its name, role and thread. Errors, at their element: a missing interpolation, section or node,
// types that are not known, sections that do not belong to nodes or positions.
std::optional<TextileYarn> read_yarn(const Element& element, const Fields& fields);

}  // namespace selvage::formats::tg3
