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

#include "core/number_text.h"
#include "core/text_report.h"
#include "core/words.h"

namespace selvage::formats::vtu {

namespace {

// zlib makes at most about a thousand bytes of one.
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
    if (count > waiting_.size() + rest_.size()) return std::nullopt;
    while (waiting_.size() < count)
      if (!decode_four()) return std::nullopt;
    std::string bytes = waiting_.substr(0, count);
    waiting_.erase(0, count);
    return bytes;
  }

 private:
  // Many at a time: what is erased from the front has to be moved.
  bool decode_four() {
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

Message too_short() {
  return error(Kind::malformed, "the data end before the array does");
}

// As vtkZLibDataCompressor writes them (encoding.h).
Result<std::string> inflated(Bytes& bytes, std::uint64_t count,
                             const std::function<std::optional<std::uint64_t>()>& next) {
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
    if (length > most_growth * packed[k] + 64)
      return error(Kind::malformed, "a compressed block cannot hold as much as its head says");
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
                                   const Coding& coding) {
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
    Result<std::string> whole = inflated(bytes, *first, next);
    if (!whole) return whole.error();
    raw = std::move(*whole);
  } else {
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
  if (type == "UInt8") return numbers<std::uint8_t>(raw, big);
  return error(Kind::unsupported, fmt::format("arrays of the type {} are not read", in_quotes(type)));
}

}  // namespace selvage::formats::vtu
