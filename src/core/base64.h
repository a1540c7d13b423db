// Bytes inside text.
#pragma once

#include <string>
#include <string_view>

namespace selvage {

// Adds the bytes in base64 (RFC 4648, with its padding): four letters for every three bytes.
void append_base64(std::string& to, std::string_view bytes);

}  // namespace selvage
