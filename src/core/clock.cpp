#include "core/clock.h"

#include <charconv>
#include <cstdlib>
#include <ctime>
#include <string_view>

namespace selvage {

namespace {

std::string stamp(const char* form) {
  std::time_t seconds = std::time(nullptr);
  if (const char* given = std::getenv("SOURCE_DATE_EPOCH")) {
    const std::string_view text = given;
    long long value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure == std::errc() && end == text.data() + text.size()) seconds = static_cast<std::time_t>(value);
  }
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char buffer[32];
  return {buffer, std::strftime(buffer, sizeof buffer, form, &utc)};
}

}  // namespace

std::string iges_timestamp() {
  return stamp("%Y%m%d.%H%M%S");
}
std::string iso_timestamp() {
  return stamp("%Y-%m-%dT%H:%M:%S");
}

}  // namespace selvage
