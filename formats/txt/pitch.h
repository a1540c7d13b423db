// Pitches as the trades write them (`60 epi`, `24 per cm`, `0.42 mm`), and how open a cloth of them is.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fabric/model.h"

namespace selvage::formats::txt {

// The same in the language's own form, `60/in`, `24/cm`, `0.42mm`: a number (or an expression in brackets, or
// a name), then perhaps a noun (`ends`, `picks`, `threads`, `wales`, ...), then a unit behind a blank, behind
// `/` or `per`, or one of epi, ppi, wpi, cpi, epc, ppc. None: it has that form already, or is none of these.
std::optional<std::string> pitch_in_own_form(std::string_view text);

// What length the text of a pitch counts yarns on, mm: an inch, else a centimetre. None: it is a distance.
std::optional<double> length_counted_on(std::string_view text);

// Of a cloth that nobody means without saying so: above this, in widths of the yarn, a pitch needs `open`.
inline constexpr double max_pitch_in_widths = 20.0;

// The width of the widest of these threads, in file units; 0: the text does not say it. `inside`: the fabric
// and the blocks that it is in, the innermost one last.
double width_of_threads(std::span<const fabric::Fabric* const> inside, const std::vector<std::string>& names);

}  // namespace selvage::formats::txt
