#include "formats/iges/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/iges/real_text.h"

namespace selvage::formats::iges {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

// Without the blanks round it, of which there are none in front.
std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// The number that all of `token` is.
std::optional<double> whole_real(std::string_view token) {
  double value = 0;
  const char* const end = token.data() + token.size();
  return read_real(token.data(), end, value) == end ? std::optional(value) : std::nullopt;
}
// The same of an integer, possibly written as a real.
std::optional<std::int64_t> whole_integer(std::string_view token) {
  const bool negative = token.front() == '-';
  std::string_view digits = token.substr(negative || token.front() == '+' ? 1 : 0);
  if (!digits.empty() && digits.size() <= 18 && std::all_of(digits.begin(), digits.end(), is_digit)) {
    std::int64_t value = 0;
    for (const char c : digits) value = 10 * value + (c - '0');
    return negative ? -value : value;
  }
  const std::optional<double> real = whole_real(token);
  if (!real || std::trunc(*real) != *real || std::abs(*real) > 1e15) return std::nullopt;
  return static_cast<std::int64_t>(*real);
}

}  // namespace

std::string broken_number(std::string_view token) {
  return fmt::format("{} runs over the end of its line, or the delimiter behind it is missing",
                     in_quotes(token));
}

Parameters::Parameters(const Lines& lines, Section section, int first, int last, Delimiters delimiters)
    : lines_(&lines), section_(section), line_(first), last_(last), delimiters_(delimiters) {
  if (first < 1 || last < first || last > lines.count(section)) {
    done_ = true;
    value_spot_ = lines.end();
    fail("there are no parameters");
    return;
  }
  enter(first);
  value_spot_ = here();
}

Spot Parameters::here() const {
  return line().spot(static_cast<int>(at_ - start_) + 1);
}

void Parameters::enter(int number) {
  line_ = number;
  const Line present = line();
  at_ = start_ = present.at;
  end_ = present.at + present.data;
}

bool Parameters::next_line() {
  if (line_ >= last_) return false;
  enter(line_ + 1);
  return true;
}

// To the next character that is no blank; false where there is none.
bool Parameters::skip_blanks() {
  for (;;) {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (at_ != end_) return true;
    if (!next_line()) return false;
  }
}

std::nullopt_t Parameters::fail(std::string text) {
  return fail(value_spot_, std::move(text));
}

std::nullopt_t Parameters::fail(const Spot& spot, std::string text) {
  if (!failure_) failure_ = Failure{spot, std::move(text), false};
  return std::nullopt;
}

std::nullopt_t Parameters::give_up(std::string text) {
  if (!failure_) failure_ = Failure{value_spot_, std::move(text), true};
  return std::nullopt;
}

std::size_t Parameters::room() const {
  if (done_ || failure_) return 0;
  constexpr std::size_t widest = 73;
  return static_cast<std::size_t>(end_ - at_) + static_cast<std::size_t>(last_ - line_) * widest;
}

bool Parameters::take_delimiter() {
  if (!skip_blanks())
    fail(here(), fmt::format("the parameters end without {}", in_quotes({&delimiters_.record, 1})));
  else if (is_delimiter())
    done_ = *at_++ == delimiters_.record;
  else
    fail(here(), fmt::format("{} or {} is missing here", in_quotes({&delimiters_.parameter, 1}),
                             in_quotes({&delimiters_.record, 1})));
  return ok();
}

// To the delimiter, or to the end of the line.
void Parameters::scan() {
  while (at_ != end_ && !is_delimiter()) ++at_;
}

// The characters of the next value, without blanks round them, and past its delimiter. False after an error
// or the record delimiter.
bool Parameters::field(std::string_view& token, std::string* joined) {
  token = {};
  if (failure_ || done_) return false;
  if (!skip_blanks()) return take_delimiter();  // which fails
  value_spot_ = here();
  const char* const begin = at_;
  scan();
  token = trimmed({begin, static_cast<std::size_t>(at_ - begin)});
  if (at_ != end_) return take_delimiter();
  if (joined != nullptr) {
    joined->assign(begin, end_);
    while (at_ == end_ && next_line()) {
      scan();
      joined->append(start_, at_);
    }
    token = trimmed(*joined);
    return take_delimiter();
  }
  // Were it joined with what follows, a lost delimiter would make one number of two.
  if (!is_blank(end_[-1]) && next_line() && at_ != end_ && !is_blank(*at_) && !is_delimiter())
    fail(broken_number(token));
  return ok() && take_delimiter();
}

std::int64_t Parameters::integer(std::int64_t otherwise) {
  std::string_view token;
  if (!field(token) || token.empty()) return otherwise;
  const std::optional<std::int64_t> value = whole_integer(token);
  if (!value) fail(fmt::format("{} is no integer", in_quotes(token)));
  return value.value_or(otherwise);
}

int Parameters::pointer() {
  const std::int64_t value = integer();
  if (std::abs(value) <= most_pointer) return static_cast<int>(value);
  fail(fmt::format("{} cannot be a directory pointer", value));
  return 0;
}

double Parameters::real(double otherwise) {
  std::string_view token;
  if (!field(token) || token.empty()) return otherwise;
  const std::optional<double> value = whole_real(token);
  if (!value) fail(fmt::format("{} is no number", in_quotes(token)));
  return value.value_or(otherwise);
}

// As it stands in the file, over line ends.
bool Parameters::characters(std::size_t count, std::string& text) {
  while (count > 0) {
    if (at_ == end_) {
      if (line().is_shifted) {
        fail("a string runs over the end of a line whose columns are shifted: its characters cannot be told");
        return false;
      }
      if (!next_line()) return false;
    }
    const std::size_t part = std::min(count, static_cast<std::size_t>(end_ - at_));
    text.append(at_, part);
    at_ += part;
    count -= part;
  }
  return true;
}

bool Parameters::is_string() {
  if (failure_ || done_ || !skip_blanks()) return false;
  const char* p = at_;
  while (p != end_ && is_digit(*p)) ++p;
  if (p != at_ && p == end_) return count_goes_on();
  return p != at_ && p != end_ && (*p == 'H' || *p == 'h');
}

// The line ends in digits. Are they the beginning of a string's count? A number whose delimiter is lost would
// look the same, so the string has to be one.
bool Parameters::count_goes_on() const {
  Parameters ahead = *this;
  if (line().is_shifted || !ahead.next_line()) return false;
  while (ahead.at_ != ahead.end_ && is_digit(*ahead.at_)) ++ahead.at_;
  if (ahead.at_ == ahead.end_ || (*ahead.at_ != 'H' && *ahead.at_ != 'h')) return false;
  ahead = *this;
  ahead.flaw_.reset();
  ahead.string_here();
  return ahead.ok() && !ahead.flaw_;
}

// Behind the H: the rest of the line without its delimiter, where that is the only one and ends the line.
bool Parameters::text_of_line(std::size_t count, std::string& text) {
  const std::string_view rest = trimmed({at_, static_cast<std::size_t>(end_ - at_)});
  if (rest.empty() || line().is_shifted) return false;
  const char delimiters[] = {delimiters_.parameter, delimiters_.record};
  if (rest.find_first_of(delimiters, 0, 2) != rest.size() - 1) return false;
  text = rest.substr(0, rest.size() - 1);
  at_ += rest.size() - 1;
  if (!flaw_)
    flaw_ = Failure{value_spot_,
                    fmt::format("a string of {} characters says that it has {}", text.size(), count), false};
  return true;
}

std::string Parameters::text() {
  if (!is_string()) {
    std::string_view token;
    if (field(token) && !token.empty()) fail("a string (its length, H and its characters) is due here");
    return {};
  }
  return string_here();
}

std::string Parameters::string_here() {
  value_spot_ = here();
  std::size_t length = 0;
  while (at_ != end_ ? is_digit(*at_) : next_line()) {
    if (at_ == end_ || !is_digit(*at_)) continue;
    if (length < 100'000'000) length = 10 * length + static_cast<std::size_t>(*at_ - '0');
    ++at_;
  }
  has_small_letter_ = *at_ == 'h';
  ++at_;
  const Parameters begin = *this;
  std::string value;
  const bool is_long_enough = length <= room() && characters(length, value);
  if (is_long_enough && at_ == end_) next_line();
  if (!is_long_enough || !skip_blanks() || !is_delimiter()) {
    *this = begin;
    value.clear();
    if (!text_of_line(length, value)) {
      fail(is_long_enough
               ? "no delimiter after a string: its count may be wrong"
               : fmt::format("a string of {} characters is longer than what is left of the parameters",
                             length));
      return value;
    }
  }
  take_delimiter();
  return value;
}

std::string_view Parameters::token(std::string& joined) {
  joined.clear();
  std::string_view token;
  field(token, &joined);
  return token;
}

void Parameters::skip() {
  std::string_view token;
  is_string() ? void(text()) : void(field(token));
}

bool Parameters::slow_real(double& value) {
  if (done_) fail("the parameters end here");
  value = real();
  return ok();
}

bool Parameters::reals(double* out, std::size_t count) {
  if (failure_) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (at_ == end_ || is_blank(*at_))
      if (done_ || !skip_blanks()) return slow_real(out[i]);
    double value = 0;
    const char* const behind = read_real(at_, end_, value);
    if (behind != at_ && behind != end_ && *behind == delimiters_.parameter && !done_) {
      out[i] = value;
      at_ = behind + 1;
    } else if (!slow_real(out[i])) {
      const std::string so_far = fmt::format("; {} of {} numbers were read", i, count);
      if (failure_) failure_->text += so_far;
      return false;
    }
  }
  return true;
}

std::size_t Parameters::count(std::string_view what, std::size_t fields_each) {
  const std::int64_t value = integer();
  const auto number = static_cast<std::size_t>(value);
  if (value < 0)
    fail(fmt::format("a number of {} cannot be {}", what, value));
  else if (number > room() / fields_each)
    fail(fmt::format("{} {}: more than the entity's {} lines can hold", value, what, last_ - line_ + 1));
  return ok() ? number : 0;
}

std::vector<int> Parameters::pointers(std::string_view what) {
  std::vector<int> all(count(what));
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (done_) fail(fmt::format("the parameters end behind {} of {} {}", i, all.size(), what));
    if (!ok()) return {};
    all[i] = pointer();
  }
  return all;
}

bool read_delimiters(Parameters& cursor) {
  const auto one = [&](char& delimiter, std::string_view what) {
    if (!cursor.ok() || !cursor.skip_blanks()) return false;
    cursor.value_spot_ = cursor.here();
    const char* const at = cursor.at_;
    if (*at == cursor.delimiters_.parameter) {  // defaulted
      ++cursor.at_;
      return true;
    }
    if (cursor.end_ - at < 4 || at[0] != '1' || at[1] != 'H') {
      cursor.fail(fmt::format("the global section does not begin with the {} delimiter, such as 1H{},", what,
                              delimiter));
      return false;
    }
    constexpr std::string_view not_allowed = "0123456789+-.DEH \t";
    if (not_allowed.find(at[2]) != std::string_view::npos || static_cast<unsigned char>(at[2]) < 0x20) {
      cursor.fail(fmt::format("{} cannot be the {} delimiter", in_quotes({at + 2, 1}), what));
      return false;
    }
    delimiter = at[2];
    cursor.at_ += 3;
    return cursor.take_delimiter();
  };
  Delimiters& own = cursor.delimiters_;
  if (!one(own.parameter, "parameter") || !one(own.record, "record"))
    cursor.fail("the global section ends before its second parameter");
  else if (own.parameter == own.record)
    cursor.fail(fmt::format("both delimiters are {}", in_quotes({&own.record, 1})));
  return cursor.ok();
}

Values::Values(Parameters in) {
  std::string joined;
  while (!in.at_end()) {
    Value value;
    value.is_string = in.is_string();
    if (value.is_string) {
      joined = in.text();
    } else {
      value.text = in.token(joined);
      value.is_broken = !joined.empty();
    }
    last_line_ = in.at_line();
    if (!in.ok()) break;
    if (value.is_string || value.is_broken) {
      kept_.push_front(std::exchange(joined, {}));
      value.text = trimmed(kept_.front());
    }
    value.spot = end_ = in.spot();
    value.is_small = value.is_string && in.has_small_letter();
    values_.push_back(value);
  }
  failure_ = in.failure();
  flaw_ = in.flaw();
}

std::optional<int> Values::integer(std::size_t i, int otherwise) const {
  if (is_blank(i)) return otherwise;
  return values_[i].is_string ? std::nullopt : column_number(values_[i].text);
}

std::optional<double> Values::real(std::size_t i, double otherwise) const {
  if (is_blank(i)) return otherwise;
  return values_[i].is_string ? std::nullopt : whole_real(values_[i].text);
}

}  // namespace selvage::formats::iges
