#include "core/clock.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <ctime>
#include <optional>

#include "core/readable.h"

namespace selvage {

namespace {

constexpr long long end_of_9999 = 253'402'300'799;  // the last second

// Of SOURCE_DATE_EPOCH; `usable`: as files can have it.
struct Given {
  std::string text;
  long long seconds = 0;
  bool usable = false;
};
std::optional<Given> given_time() {
  const char* const text = std::getenv("SOURCE_DATE_EPOCH");
  if (text == nullptr) return std::nullopt;
  Given given{text};
  const char* const end = given.text.data() + given.text.size();
  const auto [stop, failure] = std::from_chars(given.text.data(), end, given.seconds);
  given.usable = failure == std::errc() && stop == end && given.seconds >= 0 && given.seconds <= end_of_9999;
  return given;
}

std::string stamp(const char* form) {
  const std::optional<Given> given = given_time();
  const std::time_t seconds =
      given && given->usable ? static_cast<std::time_t>(given->seconds) : std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char buffer[32];
  return {buffer, std::strftime(buffer, sizeof buffer, form, &utc)};
}

}  // namespace

Status check_clock() {
  const std::optional<Given> given = given_time();
  if (!given || given->usable) return {};
  return error(
      Kind::usage,
      fmt::format("SOURCE_DATE_EPOCH is '{}': it is the time of files in whole seconds since 1970, from "
                  "0 to {} (the year 9999); mend it, or unset it",
                  shortened(given->text), end_of_9999));
}

std::string iges_timestamp() {
  return stamp("%Y%m%d.%H%M%S");
}
std::string iso_timestamp() {
  return stamp("%Y-%m-%dT%H:%M:%S");
}

}  // namespace selvage
