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

// Does a knitout program of any version begin with these bytes? With its first line, or, without it, with an
// operation that brings yarn, makes a loop or moves one.
bool is_knitout(std::string_view head);

enum class FirstLine { magic, missing, wrong };
// `head`: the program's first bytes. Missing: the program begins without it, with a warning. Wrong: an error,
// the text is no knitout program. Warning: a later version.
FirstLine read_first_line(std::string_view line, std::string_view head, TextReport& report);

// A comment line that begins with `;;`, `NAME: VALUE`; others mean nothing. Carriers of one rail are joined
// by commas, those of its two sides by a semicolon. Errors: a gauge that is none, a carrier twice.
void read_header_line(std::string_view line, const Spot& begin, Header& header, TextReport& report);

}  // namespace selvage::formats::knitout
