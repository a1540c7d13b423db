// What a knitting machine makes of a program: loops, what each was pulled through, and where their needles
// were. No geometry: how the loops lie is decided elsewhere (chart.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/text_report.h"

namespace selvage::formats::knitout {

enum class Bed : signed char { front = 1, back = -1 };

inline Bed opposite(Bed bed) {
  return bed == Bed::front ? Bed::back : Bed::front;
}

struct Needle {
  Bed bed = Bed::front;
  bool is_slider = false;
  int number = 0;
  bool operator==(const Needle&) const = default;
};

std::string name_of(const Needle& needle);  // f12, bs-3

// Where a needle stands: columns count from the needles of the front bed, to the right. A back needle b at
// racking R stands at b + R: on the column of the front needle that it faces, or to the right of it.
struct Station {
  int column = 0;           // b + the whole part of R, rounded down
  bool is_between = false;  // R has a fraction: needles of both beds stand in turn
  Bed bed = Bed::front;
  bool operator==(const Station&) const = default;
};

inline constexpr int no_loop = -1;

struct Loop {
  std::uint32_t carriers = 0;                          // index in StitchGraph::carrier_sets
  signed char direction = 1;                           // of the carrier: 1 to the right, -1 to the left
  bool is_tuck = false;                                // laid to what the needle held, not pulled through it
  bool splits = false;                                 // what it was pulled through went on to another needle
  bool faces_loops = false;                            // the needle opposite held loops when it was made
  bool was_moved = false;                              // to another needle, by a transfer
  Station made;                                        // where
  Spot spot;                                           // the operation
  std::uint32_t first_through = 0, through_count = 0;  // in StitchGraph::throughs; of a tuck: what it joined

  enum class End : char { on_needle, knitted, dropped };
  End end = End::on_needle;
  Station left;            // where it left its needle, or hangs at the end
  int next = no_loop;      // the first loop that was pulled through it
  int place_in_stack = 0;  // among those that one loop was pulled through, from the needle's own bed on
};

struct StitchGraph {
  std::vector<Loop> loops;    // in the order in which they were made
  std::vector<int> throughs;  // of all loops, those of a needle from its own bed on
  std::vector<std::string> carriers;
  std::vector<std::vector<int>> carrier_sets;  // indices in `carriers`
  // Of two loops that passed each other while one hung on each bed (lower number first): was the first one on
  // the front bed, the last time?
  std::map<std::pair<int, int>, bool> passings;

  [[nodiscard]] std::span<const int> through(const Loop& loop) const {
    return std::span(throughs).subspan(loop.first_through, loop.through_count);
  }
};

}  // namespace selvage::formats::knitout
