// Yarn counts as the trades write them: `Ne 30/2`, `Nm 2/60`, `dtex 167 f48 x2`, `denier 20/22`.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "formats/txt/scope.h"

namespace selvage::formats::txt {

struct YarnCount {
  fabric::LinearDensity whole;  // of the yarn with all of its plies
  int plies = 1;                // 1: the notation names none
  int filaments = 0;            // of each ply; 0: the notation names none
  std::string understood;       // "2 plies of 1400 dtex, 2800 dtex in all"; empty: a number alone
};

// Direct systems (tex, dtex, denier): the first number is the linear density; behind `/` a number above
// `max_plies_of_count` is that of filaments, any other one that of plies; `f48` and `48f` are filaments, `x2`
// plies (`2/150/48`, `2/78`: in front), `12k` thousands of filaments; `R` marks the resultant count of the
// whole yarn. `denier 20/22` is a raw silk's range. Indirect systems (Nm, Ne; NeL of linen and NeK of worsted
// yarns are read as Nm): of two numbers the smaller one is that of plies, on either side of `/`. Numbers are
// decimals, params, or expressions in brackets. `text`: the line without its word, and perhaps with the
// system's word within. Errors (malformed): what is wrong, and how to write it.
Result<YarnCount> read_yarn_count(std::string_view text, fabric::LinearDensity::Measure system, Scope& scope);

// May the word stand in front of a count: the sign Tt of linear density, and its names?
bool is_title_of_count(std::string_view word);

// Is it more than a number, a param or what is wrong with one?
bool is_count_notation(std::string_view text, const Scope& scope);

inline constexpr int max_plies_of_count = 9;

// The count that a glass yarn's designation says, as a text of this language: `tex 68x2` of `EC9 68x2`
// (glass, continuous, 9 um; tex: ISO 2078), `tex 66.14x2` of `G75 1/2` (9 um; 7500 yards in a pound;
// strands/plies). None: the line is no such designation.
std::optional<std::string> count_of_glass(std::string_view line);

// The system of a line that gives a count without its word in front: `1400x2 dtex`, `20 tex x 2`, `Ne30/2`,
// `300D`; as in `density_words`. Empty: the line gives none.
std::string_view system_of_count(std::string_view line);

}  // namespace selvage::formats::txt
