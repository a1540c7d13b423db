#include "formats/step/part21.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <numeric>

namespace selvage::formats::step {

namespace {

constexpr int deepest = 64;  // brackets in brackets

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_name(char c) {
  return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '-' || c == '!';
}

struct Failure {
  Spot spot;
  std::string text;
};

enum class Token { end, word, reference, string, number, other, open, close, comma, semicolon, equals };

// The tokens of a text with their places.
class Lexer {
 public:
  explicit Lexer(std::string_view bytes)
      : at_(bytes.data()), end_(bytes.data() + bytes.size()), line_start_(at_) {}

  [[nodiscard]] Token token() const { return token_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] int reference() const { return reference_; }
  [[nodiscard]] const Spot& spot() const { return spot_; }

  void next() {
    skip_blanks();
    spot_ = here();
    const char* const from = at_;
    token_ = at_ == end_ ? Token::end : take();
    text_ = {from, static_cast<std::size_t>(at_ - from)};
  }

  // Up to the statement's end, whatever stands there.
  void skip_statement() {
    while (token_ != Token::semicolon && token_ != Token::end) next();
  }

 private:
  [[nodiscard]] Spot here() const { return {at_, line_, static_cast<int>(at_ - line_start_) + 1}; }

  void new_line() {
    ++line_;
    line_start_ = at_ + 1;
  }

  void skip_blanks() {
    for (; at_ != end_; ++at_) {
      if (*at_ == '\n') {
        new_line();
      } else if (*at_ == '/' && end_ - at_ > 1 && at_[1] == '*') {
        skip_comment();
      } else if (*at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != '\f') {
        return;
      }
    }
  }

  // Stops at its last character.
  void skip_comment() {
    const Spot start = here();
    for (at_ += 2; end_ - at_ > 1; ++at_) {
      if (*at_ == '*' && at_[1] == '/') {
        ++at_;
        return;
      }
      if (*at_ == '\n') new_line();
    }
    throw Failure{start, "this comment has no end"};
  }

  template <class Belongs>
  void take_while(Belongs belongs) {
    while (at_ != end_ && belongs(*at_)) ++at_;
  }

  Token take() {
    const char c = *at_++;
    switch (c) {
      case '(':
        return Token::open;
      case ')':
        return Token::close;
      case ',':
        return Token::comma;
      case ';':
        return Token::semicolon;
      case '=':
        return Token::equals;
      case '$':
      case '*':
        return Token::other;
      case '#':
        return take_reference();
      case '\'':
        return take_string();
      case '"':
        return take_enclosed('"', "binary value");
      case '<':
        return take_enclosed('>', "resource");
      case '.':
        take_while([](char part) { return is_name(part); });
        if (at_ == end_ || *at_ != '.') throw Failure{spot_, "this enumeration value has no end"};
        ++at_;
        return Token::other;
      default:
        break;
    }
    if (is_digit(c) || c == '-' || c == '+') {
      take_while([](char part) {
        return is_digit(part) || part == '.' || part == 'E' || part == 'e' || part == '+' || part == '-';
      });
      check_size({spot_.at, static_cast<std::size_t>(at_ - spot_.at)});
      return Token::number;
    }
    if (!is_name(c)) throw Failure{spot_, fmt::format("{} is no part of a STEP file", in_quotes({&c, 1}))};
    take_while(is_name);
    return Token::word;
  }

  // OpenCASCADE does not stop at an infinite knot.
  void check_size(std::string_view number) const {
    const std::size_t exponent = number.find_first_of("eE");
    if (exponent == std::string_view::npos && number.size() < 300) return;
    if (exponent != std::string_view::npos && number.substr(exponent + 1).starts_with('-')) return;
    std::string plain(number);
    if (exponent != std::string_view::npos) std::erase(plain, '+');
    double value = 0;
    const auto [last, failed] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
    if (failed == std::errc::result_out_of_range)
      throw Failure{spot_, "a number that is larger than any number may be"};
  }

  Token take_reference() {
    const char* const from = at_;
    take_while(is_digit);
    const auto [last, failed] = std::from_chars(from, at_, reference_);
    if (last != at_ || failed != std::errc{} || from == at_ || reference_ <= 0)
      throw Failure{spot_, "'#' is not followed by a number from 1 to 2147483647"};
    return Token::reference;
  }

  Token take_string() {
    for (; at_ != end_; ++at_) {
      if (*at_ == '\n') new_line();
      if (*at_ != '\'') continue;
      ++at_;
      if (at_ == end_ || *at_ != '\'') return Token::string;
    }
    throw Failure{spot_, "this string has no end"};
  }

  Token take_enclosed(char last, std::string_view kind) {
    take_while([last](char part) { return part != last && part != '\n'; });
    if (at_ == end_ || *at_ != last) throw Failure{spot_, fmt::format("this {} has no end", kind)};
    ++at_;
    return Token::other;
  }

  const char* at_;
  const char* end_;
  const char* line_start_;
  int line_ = 1;
  Token token_ = Token::end;
  std::string_view text_;
  int reference_ = 0;
  Spot spot_;
};

// ids as places in Part21::statements.
class Index {
 public:
  explicit Index(const Part21& file) : file_(file) {
    if (file.statements.empty()) return;
    const auto most = static_cast<std::size_t>(file.statements.back().id);
    if (most > 8 * file.statements.size() + 1000) return;  // ids with wide gaps are looked for instead
    table_.assign(most + 1, -1);
    for (std::size_t i = 0; i < file.statements.size(); ++i)
      table_[static_cast<std::size_t>(file.statements[i].id)] = static_cast<int>(i);
  }

  [[nodiscard]] int of(int id) const {
    if (!table_.empty())
      return static_cast<std::size_t>(id) < table_.size() ? table_[static_cast<std::size_t>(id)] : -1;
    const Statement* found = file_.find(id);
    return found == nullptr ? -1 : static_cast<int>(found - file_.statements.data());
  }

 private:
  const Part21& file_;
  std::vector<int> table_;
};

// Of a graph: a node that is reached from itself, the last step from `by`.
struct Circle {
  std::size_t at = 0, by = 0;
};

// Node i leads to targets[firsts[i]] up to firsts[i + 1]; negative ones lead nowhere. Depth first without
// recursion: a chain may be as long as the file.
std::optional<Circle> find_circle(const std::vector<std::size_t>& firsts, const std::vector<int>& targets) {
  enum : char { untouched, open, done };
  std::vector<char> state(firsts.size() - 1, untouched);
  std::vector<std::pair<std::size_t, std::size_t>> path;  // node, where it leads next
  for (std::size_t root = 0; root < state.size(); ++root) {
    if (state[root] != untouched) continue;
    state[root] = open;
    path.assign(1, {root, firsts[root]});
    while (!path.empty()) {
      auto& [at, next] = path.back();
      if (next == firsts[at + 1]) {
        state[at] = done;
        path.pop_back();
        continue;
      }
      const int target = targets[next++];
      if (target < 0) continue;
      const auto to = static_cast<std::size_t>(target);
      if (state[to] == open) return Circle{to, at};
      if (state[to] == done) continue;
      state[to] = open;
      path.emplace_back(to, firsts[to]);
    }
  }
  return std::nullopt;
}

class FileReader {
 public:
  FileReader(const Source& source, TextReport& report)
      : source_(source), report_(report), lexer_(source.bytes()) {}

  std::optional<Part21> read() {
    try {
      read_sections();
      sort();
      check_references();
    } catch (const Failure& failure) {
      report_.error(failure.spot, failure.text);
    }
    if (report_.errors() > 0) return std::nullopt;
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(std::string text) const { throw Failure{lexer_.spot(), std::move(text)}; }

  [[noreturn]] void fail_expecting(std::string_view what) const {
    if (lexer_.token() == Token::end) fail(fmt::format("the file ends early: {} is missing", what));
    fail(fmt::format("{} where {} should stand", in_quotes(lexer_.text()), what));
  }

  [[nodiscard]] bool is_word(std::string_view word) const {
    return lexer_.token() == Token::word && lexer_.text() == word;
  }

  void expect(Token token, std::string_view what) {
    if (lexer_.token() != token) fail_expecting(what);
    lexer_.next();
  }
  void expect_word(std::string_view word) {
    if (!is_word(word)) fail_expecting(fmt::format("'{};'", word));
    lexer_.next();
    expect(Token::semicolon, "';'");
  }

  void read_sections() {
    lexer_.next();
    if (!is_word("ISO-10303-21")) fail("not a STEP file: it does not begin with ISO-10303-21;");
    expect_word("ISO-10303-21");
    expect_word("HEADER");
    read_header();
    bool has_data = false;
    while (!is_word("END-ISO-10303-21")) {
      if (lexer_.token() != Token::word) fail_expecting("'DATA;' or 'END-ISO-10303-21;'");
      has_data = has_data || is_word("DATA");
      if (is_word("DATA"))
        read_data();
      else if (is_word("ANCHOR") || is_word("REFERENCE") || is_word("SIGNATURE"))
        read_other_section(is_word("REFERENCE"));
      else
        fail_expecting("'DATA;' or 'END-ISO-10303-21;'");
    }
    if (!has_data) fail("there is no DATA section");
    expect_word("END-ISO-10303-21");
  }

  void read_header() {
    while (!is_word("ENDSEC")) {
      if (lexer_.token() != Token::word) fail_expecting("an entity of the header or 'ENDSEC;'");
      const std::string_view type = lexer_.text();
      lexer_.next();
      strings_.clear();
      read_parameters();
      expect(Token::semicolon, "';'");
      take_header(type);
    }
    expect_word("ENDSEC");
  }

  // The strings of the entity in their order: lists of one string are the rule.
  void take_header(std::string_view type) {
    if (type == "FILE_DESCRIPTION" && strings_.size() > 1) file_.description = strings_.front();
    if (type == "FILE_SCHEMA") file_.schemas = strings_;
    if (type == "FILE_NAME" && strings_.size() >= 5) {
      file_.file_name = strings_[0];
      file_.time_stamp = strings_[1];
      file_.originating_system = strings_[strings_.size() - 2];
    }
  }

  void read_data() {
    lexer_.next();
    if (lexer_.token() == Token::open) read_parameters();
    expect(Token::semicolon, "';'");
    in_data_ = true;
    while (!is_word("ENDSEC")) read_statement();
    in_data_ = false;
    expect_word("ENDSEC");
  }

  // Sections of the third edition, about other files. What REFERENCE names is not an error later.
  void read_other_section(bool references) {
    lexer_.next();
    expect(Token::semicolon, "';'");
    while (!is_word("ENDSEC")) {
      if (lexer_.token() == Token::end) fail_expecting("'ENDSEC;'");
      if (references && lexer_.token() == Token::reference) outside_.push_back(lexer_.reference());
      lexer_.skip_statement();
      lexer_.next();
    }
    expect_word("ENDSEC");
  }

  void read_statement() {
    if (lexer_.token() != Token::reference) fail_expecting("'#NUMBER=' or 'ENDSEC;'");
    Statement statement;
    statement.id = lexer_.reference();
    statement.line = lexer_.spot().line;
    statement.first_ref = static_cast<std::uint32_t>(file_.refs.size());
    lexer_.next();
    expect(Token::equals, "'='");
    if (lexer_.token() == Token::word) {
      statement.type = type_index(lexer_.text());
      lexer_.next();
      read_parameters();
    } else {
      statement.type = read_complex();
    }
    expect(Token::semicolon, "';'");
    file_.statements.push_back(statement);
  }

  std::uint32_t read_complex() {
    expect(Token::open, "a type or '('");
    std::string types;
    while (lexer_.token() == Token::word) {
      if (!types.empty()) types += ' ';
      types += lexer_.text();
      lexer_.next();
      read_parameters();
    }
    if (types.empty()) fail_expecting("a type");
    expect(Token::close, "')'");
    return type_index(types);
  }

  // A bracketed list, its values separated by commas.
  void read_parameters() {
    expect(Token::open, "'('");
    int depth = 1;
    bool wants_value = true, is_empty = true;
    while (depth > 0) {
      const Token token = lexer_.token();
      if (token == Token::close && (!wants_value || is_empty)) {
        --depth;
        wants_value = is_empty = false;
      } else if (wants_value && is_value(token)) {
        if (token == Token::reference && in_data_) file_.refs.push_back(lexer_.reference());
        if (token == Token::string && !in_data_)
          strings_.push_back(decoded(lexer_.text().substr(1, lexer_.text().size() - 2)));
        wants_value = is_empty = false;
      } else if (wants_value && token == Token::word) {  // a value with its type
        lexer_.next();
        if (lexer_.token() != Token::open) fail_expecting("'('");
        continue;
      } else if (wants_value && token == Token::open) {
        if (++depth > deepest) fail(fmt::format("more than {} brackets in each other", deepest));
        is_empty = true;
      } else if (!wants_value && token == Token::comma) {
        wants_value = true;
        is_empty = false;
      } else {
        fail_expecting(wants_value ? "a value" : "',' or ')'");
      }
      lexer_.next();
    }
  }

  static bool is_value(Token token) {
    return token == Token::reference || token == Token::string || token == Token::number ||
           token == Token::other;
  }

  std::uint32_t type_index(std::string_view name) {
    const auto known = type_indices_.find(name);
    if (known != type_indices_.end()) return known->second;
    file_.types.emplace_back(name);
    return type_indices_.emplace(name, static_cast<std::uint32_t>(file_.types.size() - 1)).first->second;
  }

  [[nodiscard]] Spot spot_of(const Statement& statement) const {
    return spot_at(source_, {statement.line, 1});
  }

  // The references stay where they are; only whether statements stand in the order of their ids is looked at.
  void sort() {
    auto& list = file_.statements;
    const auto less = [](const Statement& a, const Statement& b) { return a.id < b.id; };
    if (!std::is_sorted(list.begin(), list.end(), less)) {
      regroup_refs(less);
    }
    for (std::size_t i = 1; i < list.size(); ++i)
      if (list[i].id == list[i - 1].id)
        report_.error(spot_of(list[i]), fmt::format("#{} is defined a second time, first in line {}",
                                                    list[i].id, list[i - 1].line));
  }

  template <class Less>
  void regroup_refs(Less less) {
    auto& list = file_.statements;
    std::vector<std::uint32_t> ends(list.size());
    for (std::size_t i = 0; i < list.size(); ++i)
      ends[i] = i + 1 < list.size() ? list[i + 1].first_ref : static_cast<std::uint32_t>(file_.refs.size());
    std::vector<std::size_t> order(list.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return less(list[a], list[b]); });
    std::vector<Statement> sorted;
    sorted.reserve(list.size());
    std::vector<int> refs;
    refs.reserve(file_.refs.size());
    for (const std::size_t i : order) {
      sorted.push_back(list[i]);
      sorted.back().first_ref = static_cast<std::uint32_t>(refs.size());
      refs.insert(refs.end(), file_.refs.begin() + list[i].first_ref, file_.refs.begin() + ends[i]);
    }
    list = std::move(sorted);
    file_.refs = std::move(refs);
  }

  [[nodiscard]] std::size_t refs_end(std::size_t i) const {
    return i + 1 < file_.statements.size() ? file_.statements[i + 1].first_ref : file_.refs.size();
  }

  void check_references() {
    const Index index(file_);
    targets_.resize(file_.refs.size());
    for (std::size_t i = 0; i < file_.statements.size() && !report_.is_full(); ++i)
      for (std::size_t r = file_.statements[i].first_ref; r < refs_end(i); ++r) {
        targets_[r] = index.of(file_.refs[r]);
        if (targets_[r] >= 0 || std::find(outside_.begin(), outside_.end(), file_.refs[r]) != outside_.end())
          continue;
        report_.error(spot_of(file_.statements[i]), fmt::format("#{} refers to #{}, which is not in the file",
                                                                file_.statements[i].id, file_.refs[r]));
      }
    if (report_.errors() == 0) check_circles();
  }

  void check_circles() {
    std::vector<std::size_t> firsts;
    for (const Statement& statement : file_.statements) firsts.push_back(statement.first_ref);
    firsts.push_back(file_.refs.size());
    if (const std::optional<Circle> circle = find_circle(firsts, targets_)) {
      report_circle(*circle, "refers to itself");
      return;
    }
    check_assemblies();
  }

  // A product that is part of itself: there the entities do not refer to each other, but a third one to both.
  void check_assemblies() {
    std::vector<std::pair<int, int>> uses;  // whole, part
    for (std::size_t i = 0; i < file_.statements.size(); ++i)
      if (file_.type_of(file_.statements[i]) == "NEXT_ASSEMBLY_USAGE_OCCURRENCE" &&
          refs_end(i) >= file_.statements[i].first_ref + 2)
        uses.emplace_back(targets_[file_.statements[i].first_ref],
                          targets_[file_.statements[i].first_ref + 1]);
    std::sort(uses.begin(), uses.end());
    std::vector<std::size_t> firsts(file_.statements.size() + 1, 0);
    std::vector<int> parts;
    for (const auto& [whole, part] : uses) {
      if (whole < 0) continue;
      ++firsts[static_cast<std::size_t>(whole) + 1];
      parts.push_back(part);
    }
    std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
    if (const std::optional<Circle> circle = find_circle(firsts, parts))
      report_circle(*circle, "is part of itself");
  }

  void report_circle(const Circle& circle, std::string_view what) {
    const Statement &at = file_.statements[circle.at], &by = file_.statements[circle.by];
    report_.error(spot_of(at), fmt::format("#{} {}, by way of #{}", at.id, what, by.id));
  }

  const Source& source_;
  TextReport& report_;
  Lexer lexer_;
  Part21 file_;
  bool in_data_ = false;
  std::vector<std::string> strings_;
  std::vector<int> outside_;
  std::vector<int> targets_;  // places in statements, one a reference; -1: outside
  std::map<std::string, std::uint32_t, std::less<>> type_indices_;
};

void append_utf8(std::string& text, char32_t code) {
  const auto put = [&](char32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x20 || code == 0x7F) return put(U'_');
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0 | code >> 6U);
  } else {
    if (code < 0x10000) {
      put(0xE0 | code >> 12U);
    } else {
      put(0xF0 | code >> 18U);
      put(0x80 | (code >> 12U & 0x3FU));
    }
    put(0x80 | (code >> 6U & 0x3FU));
  }
  put(0x80 | (code & 0x3FU));
}

// A hexadecimal number of `digits` digits off the front; nothing where there is none.
std::optional<char32_t> take_hex(std::string_view& text, std::size_t digits) {
  std::uint32_t code = 0;
  if (text.size() < digits) return std::nullopt;
  const auto [last, failed] = std::from_chars(text.data(), text.data() + digits, code, 16);
  if (failed != std::errc{} || last != text.data() + digits) return std::nullopt;
  text.remove_prefix(digits);
  return code;
}

// \X2\ and \X4\: code after code until \X0\. UTF-16 pairs, which some write, are one character.
void take_codes(std::string_view& text, std::size_t digits, std::string& result) {
  char32_t high = 0;
  while (const std::optional<char32_t> code = take_hex(text, digits)) {
    if (*code >= 0xD800 && *code < 0xDC00) {
      high = *code;
    } else if (*code >= 0xDC00 && *code < 0xE000) {
      if (high != 0) append_utf8(result, 0x10000 + ((high - 0xD800) << 10U) + (*code - 0xDC00));
      high = 0;
    } else if (*code <= 0x10FFFF) {
      append_utf8(result, *code);
    }
  }
  if (text.starts_with("\\X0\\")) text.remove_prefix(4);
}

}  // namespace

const Statement* Part21::find(int id) const {
  const auto found = std::lower_bound(statements.begin(), statements.end(), id,
                                      [](const Statement& a, int b) { return a.id < b; });
  return found != statements.end() && found->id == id ? &*found : nullptr;
}

std::vector<int> Part21::refs_of(const Statement& statement) const {
  const auto next = static_cast<std::size_t>(&statement - statements.data()) + 1;
  const std::size_t end = next < statements.size() ? statements[next].first_ref : refs.size();
  return {refs.begin() + statement.first_ref, refs.begin() + static_cast<std::ptrdiff_t>(end)};
}

std::optional<Part21> read_part21(const Source& source, TextReport& report) {
  return FileReader(source, report).read();
}

std::string decoded(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const char c = text.front();
    if (text.starts_with("''") || text.starts_with("\\\\")) {
      result += c;
      text.remove_prefix(2);
    } else if (text.starts_with("\\X2\\") || text.starts_with("\\X4\\")) {
      const std::size_t digits = text[2] == '2' ? 4 : 8;
      text.remove_prefix(4);
      take_codes(text, digits, result);
    } else if (text.starts_with("\\X\\")) {
      text.remove_prefix(3);
      if (const std::optional<char32_t> code = take_hex(text, 2)) append_utf8(result, *code);
    } else if (text.starts_with("\\S\\") && text.size() > 3) {
      append_utf8(result, static_cast<unsigned char>(text[3]) | 0x80U);
      text.remove_prefix(4);
    } else if (c == '\n' || c == '\r') {  // a line's end is no part of a string
      text.remove_prefix(1);
    } else if (const std::size_t whole = text_prefix(text); whole > 0) {
      const std::size_t plain = std::min(whole, text.find_first_of("\\'", 1));
      result += text.substr(0, plain);
      text.remove_prefix(plain);
    } else {
      append_utf8(result, static_cast<unsigned char>(c));
      text.remove_prefix(1);
    }
  }
  return result;
}

}  // namespace selvage::formats::step
