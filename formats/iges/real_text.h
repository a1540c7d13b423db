// Reals as IGES writes them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace selvage::formats::iges {

// Reads the number at the front of [at, end): an optional sign, digits with at most one point, and an
// exponent with the letter E or D ("1", "-.5", "2.", "1.5D-03"); no blanks in front. Returns the first
// character behind it, and `at` where there is no number or one beyond the range of doubles. The value is the
// double nearest to the text, the very bits of std::from_chars.
inline const char* read_real(const char* at, const char* end, double& value);

inline bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
}

namespace detail {

inline constexpr std::array<double, 23> exact_powers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// Eight digits at once, as Lemire describes it ("Quickly parsing eight digits", 2018): pairs, then fours.
inline bool eight_digits(std::uint64_t bytes) {
  return ((bytes & 0xF0F0F0F0F0F0F0F0U) | (((bytes + 0x0606060606060606U) & 0xF0F0F0F0F0F0F0F0U) >> 4U)) ==
         0x3333333333333333U;
}
inline std::uint64_t value_of_eight(std::uint64_t bytes) {
  bytes -= 0x3030303030303030U;
  bytes = bytes * 10 + (bytes >> 8U);
  constexpr std::uint64_t mask = 0x000000FF000000FFU;
  return ((bytes & mask) * 0x000F424000000064U + ((bytes >> 16U) & mask) * 0x0000271000000001U) >> 32U;
}

// mantissa / 10^power, rounded to the nearest double, to the even one of two. 1 <= power <= 27, mantissa > 0.
double divided(std::uint64_t mantissa, unsigned power);

// The general case, for which the standard library knows the way. [first, last) is a number; the exponent's
// letter is at `letter`, or null. False where it is beyond the range of doubles.
bool read_slowly(const char* first, const char* last, const char* letter, double& value);

inline const char* digits(const char* p, const char* end, std::uint64_t& mantissa) {
  if constexpr (std::endian::native == std::endian::little) {
    while (end - p >= 8) {
      std::uint64_t bytes = 0;
      std::memcpy(&bytes, p, 8);
      if (!eight_digits(bytes)) break;
      mantissa = 100'000'000 * mantissa + value_of_eight(bytes);
      p += 8;
    }
  }
  while (p != end && is_digit(*p)) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  return p;
}

}  // namespace detail

inline const char* read_real(const char* at, const char* end, double& value) {
  const char* p = at;
  if (p == end) return at;
  const bool negative = *p == '-';
  if (negative || *p == '+') ++p;
  std::uint64_t mantissa = 0;
  const char* const whole = p;
  while (p != end && is_digit(*p)) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  std::ptrdiff_t count = p - whole;
  std::int64_t exponent = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    p = detail::digits(p, end, mantissa);
    exponent = fraction - p;
    count -= exponent;
  }
  if (count == 0) return at;
  const char* letter = nullptr;
  if (p != end && (*p | 0x20) >= 'd' && (*p | 0x20) <= 'e') {
    letter = p++;
    const bool down = p != end && *p == '-';
    if (p != end && (down || *p == '+')) ++p;
    if (p == end || !is_digit(*p)) return at;
    std::int64_t power = 0;
    for (; p != end && is_digit(*p); ++p)
      if (power < 100'000) power = 10 * power + (*p - '0');
    exponent += down ? -power : power;
  }
  // Up to 19 digits fit into the mantissa, zeros in front not counted. Below 2^53 it is exact, and so are
  // powers of ten to 10^22: one rounding.
  double size = 0;
  if (count > 19)
    for (const char* zero = whole; *zero == '0' || *zero == '.'; ++zero)
      if (*zero == '0') --count;
  const bool fits = count <= 19;
  if (fits && mantissa <= (std::uint64_t{1} << 53U) && exponent >= -22 && exponent <= 22) {
    const auto exact = static_cast<double>(mantissa);
    size = exponent < 0 ? exact / detail::exact_powers[static_cast<std::size_t>(-exponent)]
                        : exact * detail::exact_powers[static_cast<std::size_t>(exponent)];
  } else if (fits && exponent < 0 && exponent >= -27 && mantissa != 0) {
    size = detail::divided(mantissa, static_cast<unsigned>(-exponent));
  } else {
    return detail::read_slowly(at, p, letter, value) ? p : at;
  }
  value = negative ? -size : size;
  return p;
}

}  // namespace selvage::formats::iges
