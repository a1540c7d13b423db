// Run by the build: what core/fmt_library.cpp takes from inside {fmt} writes what the C++ and the C library
// write. A {fmt} whose insides have changed stops the build here.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

namespace {

int failures = 0;

void compare(const std::string& ours, const std::string& theirs) {
  if (ours == theirs) return;
  ++failures;
  std::fprintf(stderr, "fmt writes '%s' where '%s' is right\n", ours.c_str(), theirs.c_str());
}

// The digits alone, without zeros at either end: fmt and to_chars place the point differently.
std::string digits_of(const std::string& number) {
  std::string digits;
  for (char c : number.substr(0, number.find('e')))
    if (c >= '0' && c <= '9' && !(digits.empty() && c == '0')) digits += c;
  digits.erase(digits.find_last_not_of('0') + 1);
  return digits;
}

template <class Number>
Number read_back(const std::string& text) {
  Number value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// Shortest digits, as to_chars has them, that give the number back.
template <class Number>
void check_shortest(Number value) {
  if (!std::isfinite(value)) return;
  std::array<char, 64> buffer{};
  const char* end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific).ptr;
  const std::string ours = fmt::format("{}", value), theirs(static_cast<const char*>(buffer.data()), end);
  compare(digits_of(ours), digits_of(theirs));
  if (std::bit_cast<std::array<char, sizeof(Number)>>(read_back<Number>(ours)) !=
      std::bit_cast<std::array<char, sizeof(Number)>>(value))
    compare(ours, theirs);
}

void check_rounded(double value) {
  std::array<char, 512> buffer{};
  const auto theirs = [&](const char* form) {
    std::snprintf(buffer.data(), buffer.size(), form, value);
    return std::string(buffer.data());
  };
  compare(fmt::format("{:.6g}", value), theirs("%.6g"));
  compare(fmt::format("{:.3e}", value), theirs("%.3e"));
  compare(fmt::format("{:.17g}", value), theirs("%.17g"));
  compare(
      fmt::format("{:12.4f}|{:<12.1f}|", value, value), theirs("%12.4f|") + [&] {
        std::snprintf(buffer.data(), buffer.size(), "%-12.1f|", value);
        return std::string(buffer.data());
      }());
}

}  // namespace

int main() {
  std::uint64_t state = 1;
  for (int i = 0; i < 20000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;  // Knuth's generator
    const std::uint64_t bits = state ^ (state >> 29U);
    check_shortest(std::bit_cast<double>(bits));
    check_shortest(std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32U)));
    check_rounded(static_cast<double>(static_cast<std::int64_t>(bits)) * 1e-15);
    compare(fmt::format("{} {:#x} {:08}", static_cast<std::int64_t>(bits), bits, bits & 0xFFFU), [&] {
      std::array<char, 128> buffer{};
      std::snprintf(buffer.data(), buffer.size(), "%lld %#llx %08llu", static_cast<long long>(bits),
                    static_cast<unsigned long long>(bits), static_cast<unsigned long long>(bits & 0xFFFU));
      return std::string(buffer.data());
    }());
    if (failures > 20) break;
  }
  for (const double value : {0.0, -0.0, 1.0, 0.1, 1e22, 1e23, std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::min(), std::numeric_limits<double>::denorm_min()}) {
    check_shortest(value);
    if (std::abs(value) < 1e100) check_rounded(value);
  }
  compare(fmt::format("{:>5}|{:<5}|{:^5}|{}", "ab", "ab", "ab", true), "   ab|ab   | ab  |true");
  compare(fmt::format("{:{}}|{:.{}}|{:c}", 7, 4, "abcdef", 3, 'x'), "   7|abc|x");
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
