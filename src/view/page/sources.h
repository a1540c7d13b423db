// The texts of pages, as they stand in this folder.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "core/text_buffer.h"

namespace selvage::view::page {

std::string_view palette_css();  // of all pages
std::string_view page_html();
std::string_view page_css();
// They follow each other in the page, one module.
std::span<const std::string_view> scripts();

// The page of a report (pipeline/report_page.h).
std::string_view report_html();
std::string_view report_css();
std::string_view report_js();

// A text with its slots `{{NAME}}` filled.
void fill(TextBuffer& to, std::string_view text, const std::function<void(std::string_view slot)>& put);

}  // namespace selvage::view::page
