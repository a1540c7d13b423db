// The comment header of a knitout program, and the yarns that it tells of.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text_report.h"

namespace selvage::formats::knitout {

struct Header {
  std::optional<double> gauge;  // needles an inch
  Spot gauge_spot;
  std::vector<std::string_view> carriers;  // front to back
  bool has_carriers = false;
  struct YarnText {
    std::string_view text;
    Spot spot;
  };
  std::map<std::string_view, YarnText> yarns;  // by carrier
};

// Is this the first line of a knitout program, of any version?
bool is_knitout(std::string_view head);

// The first line. Error: it is not that of a knitout program. Warning: a later version.
bool read_first_line(std::string_view line, TextReport& report);

// A comment line that begins with `;;`, `NAME: VALUE`; others mean nothing. Errors: a gauge that is none, a
// carrier twice.
void read_header_line(std::string_view line, const Spot& begin, Header& header, TextReport& report);

}  // namespace selvage::formats::knitout
