#include "core/number_text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace selvage {

namespace {

struct Pairs {
  char digits[200];
  constexpr Pairs() : digits() {
    for (std::size_t i = 0; i < 100; ++i) {
      digits[2 * i] = static_cast<char>('0' + i / 10);
      digits[2 * i + 1] = static_cast<char>('0' + i % 10);
    }
  }
};
constexpr Pairs pairs;

// Two digits before `end`; returns the first. (A checked memcpy, which hardened builds make of one into a
// buffer of known size, is a call and a third of all that is done for a number.)
char* write_pair(char* end, std::uint64_t value) {
  *--end = pairs.digits[2 * value + 1];
  *--end = pairs.digits[2 * value];
  return end;
}

// Decimal digits of `value` so that the last one is before `end`; returns the first.
char* write_digits(char* end, std::uint64_t value) {
  while (value >= 100) {
    end = write_pair(end, value % 100);
    value /= 100;
  }
  if (value >= 10) {
    end = write_pair(end, value);
  } else {
    *--end = static_cast<char>('0' + value);
  }
  return end;
}

}  // namespace

char* write_number(char* out, double value) {
  const double size = std::abs(value);
  // Outside this range the exponent has more than two digits, or an integer more than a double's.
  if (!(size >= 1e-5 && size < 1e15)) return std::to_chars(out, out + max_number_length, value).ptr;
  if (value < 0.0) *out++ = '-';
  const auto decimal = fmt::detail::dragonbox::to_decimal(size);
  char buffer[24];
  char* const last = buffer + sizeof buffer;
  char* first = write_digits(last, decimal.significand);
  const auto count = static_cast<int>(last - first);
  const int whole = count + decimal.exponent;  // digits before the point
  const int fixed = decimal.exponent >= 0 ? whole : whole > 0 ? count + 1 : 2 - whole + count;
  const int scientific = count == 1 ? 5 : count + 5;
  if (fixed > scientific) {
    *out++ = *first;
    if (count > 1) {
      *out++ = '.';
      std::memcpy(out, first + 1, static_cast<std::size_t>(count - 1));
      out += count - 1;
    }
    *out++ = 'e';
    *out++ = whole > 0 ? '+' : '-';
    std::memcpy(out, pairs.digits + 2 * static_cast<std::size_t>(std::abs(whole - 1)), 2);
    return out + 2;
  }
  if (whole <= 0) {  // 0.00ddd
    std::memset(out, '0', 6);
    out[1] = '.';
    out += 2 - whole;
    std::memcpy(out, first, static_cast<std::size_t>(count));
    return out + count;
  }
  if (decimal.exponent >= 0) {  // ddd000
    std::memcpy(out, first, static_cast<std::size_t>(count));
    std::memset(out + count, '0', static_cast<std::size_t>(decimal.exponent));
    return out + whole;
  }
  std::memcpy(out, first, static_cast<std::size_t>(whole));
  out[whole] = '.';
  std::memcpy(out + whole + 1, first + whole, static_cast<std::size_t>(count - whole));
  return out + count + 1;
}

std::optional<double> read_number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data(), end, value);
  if (failure != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace selvage
