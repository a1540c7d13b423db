#include "formats/iges/real_text.h"

#include <charconv>
#include <string>
#include <system_error>

namespace selvage::formats::iges::detail {

namespace {

__extension__ using Wide = unsigned __int128;

// 5^k shifted left until its highest bit is the highest of 64, and by how much.
struct Divisor {
  std::uint64_t value = 0;
  int shift = 0;
};
constexpr std::array<Divisor, 28> divisors = [] {
  std::array<Divisor, 28> all;
  std::uint64_t power = 1;
  for (Divisor& divisor : all) {
    divisor.shift = std::countl_zero(power);
    divisor.value = power << static_cast<unsigned>(divisor.shift);
    power *= 5;
  }
  return all;
}();

}  // namespace

// By integers: 10^k = 5^k 2^k, and 5^27 still fits 64 bits. The quotient of the mantissa (its highest bit
// moved to 2^127, halved so that the quotient fits) by 5^k has 63 or 64 bits; with the remainder they tell
// exactly on which side of the middle between two doubles the number lies.
double divided(std::uint64_t mantissa, unsigned power) {
  const Divisor& divisor = divisors[power];
  const int zeros = std::countl_zero(mantissa);
  const Wide numerator = static_cast<Wide>(mantissa << static_cast<unsigned>(zeros)) << 63U;
  const auto quotient = static_cast<std::uint64_t>(numerator / divisor.value);
  const bool exact =
      static_cast<std::uint64_t>(numerator) == quotient * divisor.value;  // modulo 2^64: no more is needed
  const int spare = 11 - std::countl_zero(quotient);  // bits below the 53 that a double has
  std::uint64_t kept = quotient >> static_cast<unsigned>(spare);
  const std::uint64_t rest = quotient & ((std::uint64_t{1} << static_cast<unsigned>(spare)) - 1);
  const std::uint64_t half = std::uint64_t{1} << static_cast<unsigned>(spare - 1);
  if (rest > half || (rest == half && (!exact || (kept & 1U) != 0))) ++kept;
  // mantissa / 10^k = quotient 2^(shift - zeros - 63 - k); far from the ends of a double's range.
  const int exponent = divisor.shift - zeros - 63 - static_cast<int>(power) + spare;
  const auto scale = std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52U);
  return static_cast<double>(kept) * scale;
}

bool read_slowly(const char* first, const char* last, const char* letter, double& value) {
  if (*first == '+') {
    ++first;
  }
  std::string copy;  // with an E; from_chars takes no D
  if (letter != nullptr && *letter != 'E' && *letter != 'e') {
    copy.assign(first, last);
    copy[static_cast<std::size_t>(letter - first)] = 'E';
    first = copy.data();
    last = first + copy.size();
  }
  const auto [end, status] = std::from_chars(first, last, value);
  if (status == std::errc{}) return end == last;
  if (status != std::errc::result_out_of_range) return false;
  // Too small is zero to the nearest double, too large is nothing. The number is d.ddd 10^size, size from
  // where its first digit that is not 0 stands.
  const char* p = *first == '-' ? first + 1 : first;
  std::int64_t size = -1;
  bool started = false, fraction = false;
  for (; p != last && (is_digit(*p) || *p == '.'); ++p) {
    if (*p == '.')
      fraction = true;
    else if (!started && *p != '0')
      started = true, size += fraction ? 0 : 1;
    else if (started && !fraction)
      ++size;
    else if (!started && fraction)
      --size;
  }
  std::int64_t power = 0;
  if (p != last) {
    const bool down = p[1] == '-';
    for (p += down || p[1] == '+' ? 2 : 1; p != last; ++p)
      if (power < 1'000'000'000) power = 10 * power + (*p - '0');
    if (down) power = -power;
  }
  value = *first == '-' ? -0.0 : 0.0;
  return size + power < 0;
}

}  // namespace selvage::formats::iges::detail
