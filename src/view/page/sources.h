// The page's own texts, as they stand in this folder.
#pragma once

#include <span>
#include <string_view>

namespace selvage::view::page {

std::string_view html();
std::string_view css();
// They follow each other in the page, one module.
std::span<const std::string_view> scripts();

}  // namespace selvage::view::page
