// Reports as they come from outside, as JSON that can be relied on: the parent process reads them, and
// nothing stands between it and who wrote them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/diagnostics.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

inline constexpr std::size_t largest_report = std::size_t{1} << 30;  // bytes
inline constexpr std::size_t deepest_report = 32;                    // lists and objects within each other

// A report of any run. Its members are of the types in which the program writes them, each of its inputs has
// a path, no object has two members of one name; members that the program does not know may be anything.
// Takes time and memory in proportion to `bytes`. Errors, in the file `name`: limit (larger, nested deeper);
// malformed, with the place in the text where it is no JSON, else with the place in the report
// ("inputs[2].ok").
Result<Json> parse_report(std::string_view bytes, std::string_view name);

// One of a report's inputs. Errors: the same, without a file.
Result<Json> parse_entry(std::string_view bytes);

}  // namespace selvage::pipeline
