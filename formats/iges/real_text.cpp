#include "formats/iges/real_text.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>

namespace selvage::formats::iges {

namespace {

constexpr std::array<double, 23> exact_powers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
}

// The general case, for which the standard library knows the way. [first, last) is a number; the exponent's
// letter is at `letter`, or null.
bool read_slowly(const char* first, const char* last, const char* letter, double& value) {
  if (*first == '+') ++first;
  std::string copy;  // with an E; from_chars takes no D
  if (letter != nullptr && *letter != 'E' && *letter != 'e') {
    copy.assign(first, last);
    copy[static_cast<std::size_t>(letter - first)] = 'E';
    first = copy.data();
    last = first + copy.size();
  }
  const auto [end, status] = std::from_chars(first, last, value);
  if (status == std::errc{} && end == last) return true;
  if (status != std::errc::result_out_of_range) return false;
  // Too small is zero to the nearest double, too large is nothing.
  bool small = false;
  for (const char* at = first; at != last; ++at)
    if (*at == 'E' || *at == 'e') small = at + 1 != last && at[1] == '-';
  if (letter == nullptr)
    small = *first == '.' || *first == '0' || (*first == '-' && (first[1] == '0' || first[1] == '.'));
  value = *first == '-' ? -0.0 : 0.0;
  return small;
}

}  // namespace

const char* read_real(const char* at, const char* end, double& value) {
  const char* p = at;
  if (p == end) return at;
  const bool negative = *p == '-';
  if (negative || *p == '+') ++p;
  const char* const first = p;
  std::uint64_t mantissa = 0;
  while (p != end && is_digit(*p)) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  std::ptrdiff_t digits = p - first;
  std::int64_t exponent = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    while (p != end && is_digit(*p)) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
    exponent = fraction - p;
    digits -= exponent;
  }
  if (digits == 0) return at;
  const char* letter = nullptr;
  if (p != end && (*p == 'E' || *p == 'D' || *p == 'e' || *p == 'd')) {
    letter = p++;
    const bool down = p != end && *p == '-';
    if (p != end && (down || *p == '+')) ++p;
    if (p == end || !is_digit(*p)) return at;
    std::int64_t power = 0;
    while (p != end && is_digit(*p)) {
      if (power < 100'000) power = 10 * power + (*p - '0');
      ++p;
    }
    exponent += down ? -power : power;
  }
  // Up to 19 digits fit; a mantissa below 2^53 and a power of ten that are both exact give one rounding.
  if (digits <= 19 && mantissa <= (std::uint64_t{1} << 53U) && exponent >= -22 && exponent <= 22) {
    const auto exact = static_cast<double>(mantissa);
    const double size = exponent < 0 ? exact / exact_powers[static_cast<std::size_t>(-exponent)]
                                     : exact * exact_powers[static_cast<std::size_t>(exponent)];
    value = negative ? -size : size;
    return p;
  }
  return read_slowly(at, p, letter, value) ? p : at;
}

}  // namespace selvage::formats::iges
