#include "formats/vtu/decoding.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "core/number_text.h"
#include "core/text_report.h"
#include "core/words.h"

namespace selvage::formats::vtu {

namespace {

// zlib makes at most 1032 bytes of one.
constexpr std::uint64_t most_growth = 1100;

int value_of(char letter) {
  if (letter >= 'A' && letter <= 'Z') return letter - 'A';
  if (letter >= 'a' && letter <= 'z') return letter - 'a' + 26;
  if (letter >= '0' && letter <= '9') return letter - '0' + 52;
  return letter == '+' ? 62 : letter == '/' ? 63 : -1;
}

// Bytes one after the other, of base64 or as they stand. Padding may stand between two parts of base64.
class Bytes {
 public:
  Bytes(std::string_view data, bool is_base64) : rest_(data), is_base64_(is_base64) {}

  // The next `count`; none where there are fewer.
  std::optional<std::string> take(std::uint64_t count) {
    if (!is_base64_) {
      if (count > rest_.size()) return std::nullopt;
      std::string bytes(rest_.substr(0, count));
      rest_.remove_prefix(count);
      return bytes;
    }
    if (count > waiting_.size() - taken_ + rest_.size()) return std::nullopt;
    while (waiting_.size() - taken_ < count)
      if (!decode_more()) return std::nullopt;
    std::string bytes = waiting_.substr(taken_, count);
    taken_ += count;
    return bytes;
  }

 private:
  // Many at a time: what was taken goes then.
  bool decode_more() {
    waiting_.erase(0, std::exchange(taken_, 0));
    const std::size_t before = waiting_.size();
    for (int round = 0; round < 65536; ++round) {
      std::uint32_t bits = 0;
      int letters = 0, padding = 0;
      while (letters + padding < 4 && !rest_.empty()) {
        const char letter = rest_.front();
        const int value = value_of(letter);
        if (value < 0 && letter != '=' && letter != ' ' && letter != '\n' && letter != '\r' && letter != '\t')
          return waiting_.size() > before;
        rest_.remove_prefix(1);
        if (letter == '=') {
          ++padding;
        } else if (value >= 0) {
          bits = bits << 6U | static_cast<std::uint32_t>(value);
          ++letters;
        }
      }
      if (letters < 2) break;
      bits <<= 6U * static_cast<std::uint32_t>(4 - letters);
      for (int k = 0; k < letters - 1; ++k)
        waiting_ += static_cast<char>(bits >> (16U - 8U * static_cast<std::uint32_t>(k)) & 255U);
    }
    return waiting_.size() > before;
  }

  std::string_view rest_;
  bool is_base64_;
  std::string waiting_;
  std::size_t taken_ = 0;  // of its front
};

template <class T>
T number_at(const char* at, bool is_big_endian) {
  std::array<char, sizeof(T)> bytes{};
  std::copy_n(at, sizeof(T), bytes.begin());
  if (is_big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
std::vector<double> numbers(const std::string& bytes, bool is_big_endian) {
  std::vector<double> list(bytes.size() / sizeof(T));
  for (std::size_t k = 0; k < list.size(); ++k)
    list[k] = static_cast<double>(number_at<T>(bytes.data() + k * sizeof(T), is_big_endian));
  return list;
}

// Of one number; 0: a type that is none of numbers.
std::size_t width_of(std::string_view type) {
  for (const auto& [name, width] :
       {std::pair("Float64", 8), std::pair("Float32", 4), std::pair("Int64", 8), std::pair("UInt64", 8),
        std::pair("Int32", 4), std::pair("UInt32", 4), std::pair("Int16", 2), std::pair("UInt16", 2),
        std::pair("Int8", 1), std::pair("UInt8", 1)})
    if (type == name) return static_cast<std::size_t>(width);
  return 0;
}

Message too_short() {
  return error(Kind::malformed, "the data end before the array does");
}

// As vtkZLibDataCompressor writes them (encoding.h).
Result<std::string> inflated(Bytes& bytes, std::uint64_t count,
                             const std::function<std::optional<std::uint64_t>()>& next, std::size_t width,
                             NumberBudget& budget) {
  const std::optional<std::uint64_t> size = next(), rest = next();
  if (!size || !rest) return too_short();
  std::vector<std::uint64_t> packed;
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::optional<std::uint64_t> one = next();
    if (!one) return too_short();
    packed.push_back(*one);
  }
  std::string all;
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::uint64_t length = k + 1 == count && *rest > 0 ? *rest : *size;
    if (packed[k] < length / most_growth)
      return error(Kind::malformed, "a compressed block cannot hold as much as its head says");
    if (Status fits = budget.take(length / width); !fits) return fits.error();
    const std::optional<std::string> block = bytes.take(packed[k]);
    if (!block) return too_short();
    const std::size_t at = all.size();
    all.resize(at + length);
    uLongf made = length;
    if (uncompress(reinterpret_cast<Bytef*>(all.data() + at), &made,
                   reinterpret_cast<const Bytef*>(block->data()), block->size()) != Z_OK ||
        made != length)
      return error(Kind::malformed, "a compressed block is damaged");
  }
  return all;
}

}  // namespace

Status NumberBudget::take(std::uint64_t numbers) {
  if (numbers <= left_) {
    left_ -= numbers;
    return {};
  }
  return error(Kind::limit,
               fmt::format("the arrays of a file of this size may have {} numbers in all, and with this one "
                           "they have more: write the file without compression",
                           most_));
}

Result<std::vector<double>> decode_words(std::string_view text) {
  std::vector<double> list;
  for (std::size_t at = 0;;) {
    at = text.find_first_not_of(" \t\r\n", at);
    if (at == std::string_view::npos) return list;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    const std::string_view word = text.substr(at, end - at);
    const std::optional<double> value =
        same_word(word, "nan") || same_word(word, "-nan") ? std::nan("") : read_number(word);
    if (!value) return error(Kind::malformed, fmt::format("{} is not a finite number", in_quotes(word)));
    list.push_back(*value);
    at = end;
  }
}

Result<std::vector<double>> decode(std::string_view data, bool is_base64, std::string_view type,
                                   const Coding& coding, NumberBudget& budget) {
  const std::size_t width = width_of(type);
  if (width == 0)
    return error(Kind::unsupported, fmt::format("arrays of the type {} are not read", in_quotes(type)));
  Bytes bytes(data, is_base64);
  const auto next = [&]() -> std::optional<std::uint64_t> {
    const std::optional<std::string> word = bytes.take(coding.has_long_heads ? 8 : 4);
    if (!word) return std::nullopt;
    return coding.has_long_heads ? number_at<std::uint64_t>(word->data(), coding.is_big_endian)
                                 : number_at<std::uint32_t>(word->data(), coding.is_big_endian);
  };
  const std::optional<std::uint64_t> first = next();
  if (!first) return too_short();
  std::string raw;
  if (coding.is_compressed) {
    Result<std::string> whole = inflated(bytes, *first, next, width, budget);
    if (!whole) return whole.error();
    raw = std::move(*whole);
  } else {
    if (Status fits = budget.take(*first / width); !fits) return fits.error();
    std::optional<std::string> whole = bytes.take(*first);
    if (!whole) return too_short();
    raw = std::move(*whole);
  }
  const bool big = coding.is_big_endian;
  if (type == "Float64") return numbers<double>(raw, big);
  if (type == "Float32") return numbers<float>(raw, big);
  if (type == "Int64") return numbers<std::int64_t>(raw, big);
  if (type == "UInt64") return numbers<std::uint64_t>(raw, big);
  if (type == "Int32") return numbers<std::int32_t>(raw, big);
  if (type == "UInt32") return numbers<std::uint32_t>(raw, big);
  if (type == "Int16") return numbers<std::int16_t>(raw, big);
  if (type == "UInt16") return numbers<std::uint16_t>(raw, big);
  if (type == "Int8") return numbers<std::int8_t>(raw, big);
  return numbers<std::uint8_t>(raw, big);
}

}  // namespace selvage::formats::vtu
