#include "core/xml_text.h"

#include <algorithm>

#include "core/readable.h"

namespace selvage {

namespace {

bool is_known(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  return first >= 0x20 ? character != "\xEF\xBF\xBE" && character != "\xEF\xBF\xBF"
                       : first == '\t' || first == '\n' || first == '\r';
}

}  // namespace

std::string xml_text(std::string_view text, std::string_view unknown) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view one = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0 || !is_known(one))
      out += unknown;
    else if (one == "&")
      out += "&amp;";
    else if (one == "<")
      out += "&lt;";
    else if (one == ">")
      out += "&gt;";
    else if (one == "\"")
      out += "&quot;";
    else if (one == "\r")
      out += "&#13;";
    else
      out += one;
    text.remove_prefix(one.size());
  }
  return out;
}

}  // namespace selvage
