// Textiles that a tg3 file says by their parameters alone: TexGen builds their yarns when it opens the file.
#pragma once

#include <optional>
#include <vector>

#include "formats/tg3/fields.h"
#include "formats/tg3/textile.h"

namespace selvage::formats::tg3 {

// The yarns of a <Textile> without any, by its type, as its own sizes say. Errors, at the element: a type
// that is not built here (unsupported), sizes and patterns that are missing or do not fit.
std::optional<std::vector<TextileYarn>> construct(const Element& textile, const Fields& fields);

}  // namespace selvage::formats::tg3
