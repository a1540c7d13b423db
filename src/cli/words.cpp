#include "cli/words.h"

#include <fmt/format.h>

#include "core/diagnostics.h"

namespace selvage::cli {

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string_view near = nearest_word(word, std::vector<std::string_view>(known.begin(), known.end()));
  return near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near);
}

}  // namespace selvage::cli
