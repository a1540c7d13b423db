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

// Does it bring yarn or take it away, make loops or move them?
inline bool is_of_loops(Verb verb) {
  switch (verb) {
    case Verb::in:
    case Verb::inhook:
    case Verb::releasehook:
    case Verb::out:
    case Verb::outhook:
    case Verb::knit:
    case Verb::tuck:
    case Verb::split:
    case Verb::miss:
    case Verb::drop:
    case Verb::amiss:
    case Verb::xfer:
      return true;
    case Verb::rack:
    case Verb::stitch:
    case Verb::pause:
    case Verb::extension:
      return false;
  }
  return false;
}

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

// Is there a yarn in it, of which a loop is made?
inline bool makes_loop(const Operation& operation) {
  return !operation.carriers.empty() &&
         (operation.verb == Verb::knit || operation.verb == Verb::tuck || operation.verb == Verb::split);
}

// The operation of a line without its comment; nothing where there is none, or an error, which is reported.
// `operation` is filled anew; its room is kept.
bool read_operation(std::string_view line, const Spot& begin, Operation& operation, TextReport& report);

// The words of a line that stands at `begin`, at blanks and tabs, each where it stands.
std::optional<Carrier> next_word(std::string_view& rest, std::string_view line, const Spot& begin);

}  // namespace selvage::formats::knitout
