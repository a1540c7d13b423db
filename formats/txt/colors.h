// Colours by name (those of CSS, https://www.w3.org/TR/css-color-4, but that `indigo` is a denim's), as
// #RRGGBB and #RGB.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "fabric/model.h"

namespace selvage::formats::txt {

// None: it is no colour.
std::optional<fabric::Color> color_named(std::string_view text);
std::vector<std::string_view> color_names();

}  // namespace selvage::formats::txt
