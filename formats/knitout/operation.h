// One line of a knitout program: an operation and its operands, as written.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "core/text_report.h"
#include "formats/knitout/stitch_graph.h"

namespace selvage::formats::knitout {

// Needle numbers go so far to both sides, and all that a program uses lie on a bed of this width: the widest
// machines have 84 inches at gauge 14.
inline constexpr int most_number = 9999, widest_bed = 1200;
// Far more than machines have carriers, and than a needle's hook can hold loops.
inline constexpr std::size_t most_carriers = 1000, most_held = 32;

enum class Verb {
  in,
  inhook,
  releasehook,
  out,
  outhook,
  knit,
  tuck,
  split,
  miss,
  drop,
  amiss,
  xfer,
  rack,
  stitch,
  pause,
  extension
};

struct Carrier {
  std::string_view name;
  Spot spot;
};

struct Operation {
  Verb verb = Verb::pause;
  std::string_view word;  // as written
  Spot spot;
  int direction = 1;  // 1 to the right, -1 to the left
  Needle needle, other;
  Spot needle_spot, other_spot;
  double racking = 0;
  std::vector<Carrier> carriers;
};

// The operation of a line without its comment; nothing where there is none, or an error, which is reported.
// `operation` is filled anew; its room is kept.
bool read_operation(std::string_view line, const Spot& begin, Operation& operation, TextReport& report);

// The words of a line that stands at `begin`, at blanks and tabs, each where it stands.
std::optional<Carrier> next_word(std::string_view& rest, std::string_view line, const Spot& begin);

}  // namespace selvage::formats::knitout
