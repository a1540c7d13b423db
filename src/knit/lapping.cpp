#include "knit/lapping.h"

#include <fmt/format.h>

#include <array>
#include <charconv>

#include "core/wrapped.h"

namespace selvage::fabric {

namespace {

// The text of a lapping, read from left to right.
class LappingReader {
 public:
  LappingReader(std::string_view text, TextPlace place) : text_(text), place_(place) {}

  Result<Lapping> read() {
    Lapping lapping;
    while (true) {
      Result<int> from = space();
      if (!from) return from.error();
      if (!take('-'))
        return fault(
            "this is no lapping: overlaps such as 1-0, separated by '/' or blanks, closed by '//' or not");
      Result<int> to = space();
      if (!to) return to.error();
      lapping.push_back({*from, *to});
      const std::size_t overlap_end = at_;
      skip_blanks();
      std::size_t slashes = 0;
      for (; take('/'); ++slashes) skip_blanks();
      if (at_ == text_.size() && (slashes == 0 || slashes == 2)) return lapping;
      if (at_ == text_.size())
        return fault(
            fmt::format("this lapping does not close: after its last '/' an overlap is missing, or it ends "
                        "with '//' (here: {} strokes)",
                        slashes));
      if (slashes > 1) return fault("after the '//' that closes a lapping nothing may follow");
      if (at_ == overlap_end) return fault("this is no lapping: overlaps are separated by '/' or blanks");
    }
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool take(char c) {
    const bool is_here = at_ < text_.size() && text_[at_] == c;
    if (is_here) ++at_;
    return is_here;
  }
  Result<int> space() {
    const char* const first = text_.data() + at_;
    const char* const last = text_.data() + text_.size();
    if (first == last || *first < '0' || *first > '9')
      return fault("this is no lapping: the number of a space is missing, as in 1-0/1-2");
    int value = 0;
    const std::from_chars_result read = std::from_chars(first, last, value);
    if (read.ec != std::errc() || value > highest_space)
      return fault(fmt::format("spaces between needles are counted from 0 to {} here", highest_space));
    at_ += static_cast<std::size_t>(read.ptr - first);
    return value;
  }
  [[nodiscard]] Message fault(std::string what) const {
    const int column = place_.column > 0 ? place_.column + static_cast<int>(at_) : 0;
    return error(Kind::malformed, std::move(what)).placed({place_.line, column});
  }

  std::string_view text_;
  TextPlace place_;
  std::size_t at_ = 0;
};

// An N x 1 lapping goes over N - 1 needles: tricot 1, cord 2, satin 3, velvet 4.
struct Classic {
  std::string_view name;
  std::vector<std::string_view> closed, open;
};

const std::array<Classic, 7>& classics() {
  static const std::array<Classic, 7> all{{
      {"tricot", {"1-0/1-2"}, {"0-1/2-1"}},
      {"cord", {"1-0/2-3"}, {"0-1/3-2"}},
      {"satin", {"1-0/3-4"}, {"0-1/4-3"}},
      {"velvet", {"1-0/4-5"}, {"0-1/5-4"}},
      {"locknit", {"2-3/1-0", "1-0/1-2"}, {"3-2/0-1", "0-1/2-1"}},
      {"queens-cord", {"1-0/0-1", "3-4/1-0"}, {"1-0/0-1", "4-3/0-1"}},
      {"atlas", {"1-0/1-2/2-3/2-1"}, {"0-1/1-2/3-2/2-1"}},
  }};
  return all;
}

}  // namespace

Result<Lapping> parse_lapping(std::string_view text, TextPlace place) {
  return LappingReader(text, place).read();
}

const Overlap& overlap_at(const Lapping& lapping, long long course) {
  return lapping[static_cast<std::size_t>(wrapped(course, static_cast<long long>(lapping.size())))];
}

std::vector<std::string_view> classic_lappings(std::string_view name, Warpknit::Stitch stitch) {
  for (const Classic& classic : classics())
    if (classic.name == name) return stitch == Warpknit::Stitch::open ? classic.open : classic.closed;
  return {};
}

}  // namespace selvage::fabric
