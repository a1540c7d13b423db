// The element <Section> of a tg3 file.
#pragma once

#include <optional>

#include "formats/tg3/fields.h"
#include "formats/tg3/section.h"

namespace selvage::formats::tg3 {

// Errors, at their element: sizes that are not positive, sections without area or that run clockwise, too few
// points, an unknown type.
std::optional<Section> read_section(const Element& element, const Fields& fields);

}  // namespace selvage::formats::tg3
