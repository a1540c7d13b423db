// The draft of a weave as an explicit over/under matrix.
//
// Seen as text (top row = weft 1, column i = warp i) the matrix is the face of the cloth with the warp
// upright: a cloth with the warp along x and the weft along y, looked at from +z and turned by 90 degrees,
// not mirrored. The definitions of the named drafts are those of formats/txt/README.md; "Z twill" is the
// textile trade's word for a diagonal that rises to the right when the warp is upright (Grosicki, Watson's
// Textile Design and Colour).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

// A repeat of more crossings is refused; of one that is said by a few numbers (twill, satin, basket) the
// second counts, more than five hundred shafts: such a text can have thousands of them.
inline constexpr long long most_crossings = 100'000'000, most_crossings_by_numbers = 300'000;

// One repeat, `picks` wefts by `ends` warps, both at least 1. Where they lie above each other, rows of wefts
// and columns of warps, each from the lowest.
struct Drawdown {
  int picks = 0, ends = 0;
  std::vector<bool> bits;         // picks x ends, pick after pick; true: the warp is on top
  int layers = 1;                 // wefts of a row
  std::vector<int> first_ends{};  // of each column, and the number of all; empty: one in each

  [[nodiscard]] int rows() const { return picks / layers; }
  [[nodiscard]] int columns() const {
    return first_ends.empty() ? ends : static_cast<int>(first_ends.size()) - 1;
  }
  [[nodiscard]] int first_end(int column) const {
    return first_ends.empty() ? column : first_ends[static_cast<std::size_t>(column)];
  }
  // Any whole numbers, from 0 (pick 0 is weft 1): the draft repeats both ways.
  [[nodiscard]] bool warp_on_top(long long pick, long long end) const;
  // Numbers of warps go on in both directions, too: that of a column's first one, and {column, from below}.
  [[nodiscard]] long long ends_before(long long column) const;
  [[nodiscard]] std::pair<long long, int> column_of(long long end) const;
  // The smallest repeat, which may be a part of it: number of rows, number of columns.
  [[nodiscard]] long long repeat_of_picks() const;
  [[nodiscard]] long long repeat_of_ends() const;
  bool operator==(const Drawdown&) const = default;
};

// How many of a repeat's warps change sides between each pick and the next one, and how many wefts between
// each end and the next one.
std::pair<std::vector<int>, std::vector<int>> changes_between(const Drawdown& drawdown);

// Where a cloth falls apart, since yarns lie over others wherever they cross and nothing binds these parts:
// `weft 5 lies under every warp` (yarns above each other by their names), or `it is woven in layers` where
// each yarn changes sides. Empty where it holds together: from every yarn a chain of yarns, each over the
// next one, leads to every other one (C. R. J. Clapham, When a fabric hangs together, Bull. London Math. Soc.
// 12 (1980) 161).
std::string what_falls_apart(const Drawdown& drawdown);

// plain       10 / 01
// twill a/b/...  over a, under b, over ...; from a pick to the next one end to the left: a Z twill; to the
// right: S. Period their sum both ways. satin n/s   weft-faced: one warp on top a pick, s ends further to the
// left from pick to pick; warp-faced: one weft on top. Without s the smallest step that there is; 4 and 6,
// which have none, are the irregular satins of the trade (crowfoot; 1 3 5 2 6 4). basket a/b  blocks: warps
// 1..a over picks 1..a and under the next b, the next b warps the other way round.
//
// Fails (malformed) on rows that are empty, ragged or hold other signs, on counts below 1, an odd number of
// them, and on a satin whose step does not lie within 2..n-2 or has a divisor in common with n, or that has
// none; (limit) on a repeat of more than
// most_crossings; (unsupported) on a draft that is still the name of a file: whoever reads files puts
// its rows in.
Result<Drawdown> drawdown_of(const Draft& draft);

// Of warps above each other in columns, and a number of layers of weft. Errors, at the warp: unlike numbers
// of levels, levels beyond 0 .. layers, warps of a column that change their order (malformed); (limit) as
// above.
Result<Drawdown> drawdown_of(const std::vector<WarpColumn>& columns, int layers);

}  // namespace selvage::fabric
