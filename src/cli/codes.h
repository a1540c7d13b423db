// What the program says in single words and numbers: exit codes, kinds of errors, results of its commands.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace selvage::cli {

struct Code {
  std::string word;   // "3", "geometry", "reshaped"
  std::string where;  // "an exit code"
  std::string meaning;
  std::string remedy;  // empty: there is nothing to be done
};
inline constexpr std::string_view exit_codes = "an exit code";  // Code::where of these
std::vector<Code> all_codes();

}  // namespace selvage::cli
