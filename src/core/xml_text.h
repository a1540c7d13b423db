// Text of others in XML.
#pragma once

#include <string>
#include <string_view>

namespace selvage {

// `text` as it may stand in XML 1.0, in an element or in quotes; bytes that are no UTF-8 and characters that
// XML does not know become `unknown`.
std::string xml_text(std::string_view text, std::string_view unknown = "\xEF\xBF\xBD");

}  // namespace selvage
