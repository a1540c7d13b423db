#include "formats/step/part21.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/words.h"
#include "formats/step/lexer.h"
#include "formats/step/strings.h"

namespace selvage::formats::step {

namespace {

constexpr int deepest = 64;  // brackets in brackets

const Statement* found_in(const std::vector<Statement>& sorted, int id) {
  const auto found = std::ranges::lower_bound(sorted, id, {}, &Statement::id);
  return found != sorted.end() && found->id == id ? &*found : nullptr;
}

// Statements by their ids.
class Places {
 public:
  explicit Places(const std::vector<Statement>& sorted) : statements_(sorted) {
    if (sorted.empty()) return;
    const auto most = static_cast<std::size_t>(sorted.back().id);
    if (most > 8 * sorted.size() + 1000) return;  // ids with wide gaps are looked for instead
    table_.assign(most + 1, -1);
    for (std::size_t i = 0; i < sorted.size(); ++i)
      table_[static_cast<std::size_t>(sorted[i].id)] = static_cast<int>(i);
  }

  [[nodiscard]] int of(int id) const {
    if (!table_.empty())
      return static_cast<std::size_t>(id) < table_.size() ? table_[static_cast<std::size_t>(id)] : -1;
    const Statement* const found = found_in(statements_, id);
    return found != nullptr ? static_cast<int>(found - statements_.data()) : -1;
  }

 private:
  const std::vector<Statement>& statements_;
  std::vector<int> table_;
};

class FileReader {
 public:
  FileReader(const Source& source, TextReport& report)
      : report_(report), bytes_(source.bytes()), lexer_(bytes_) {}

  std::optional<Part21> read() {
    try {
      read_sections();
      sort();
      resolve();
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

  // Some write `Header;` and `EndSec;`.
  [[nodiscard]] bool is_word(std::string_view word) const {
    return lexer_.token() == Token::word && same_word(lexer_.text(), word);
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
    file_.schema_spot = lexer_.spot();
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
      if (type == "FILE_SCHEMA") file_.schema_spot = lexer_.spot();
      lexer_.next();
      strings_.clear();
      read_parameters();
      if (lexer_.token() == Token::word)
        report_.warning(lexer_.spot(), fmt::format("no ';' behind {} of the header", type));
      else
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
    statement.spot = lexer_.spot();
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
        if (token == Token::string && lexer_.has_bare_apostrophe())
          report_.warning(lexer_.spot(), "an apostrophe inside this string is not doubled");
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
           token == Token::omitted || token == Token::derived || token == Token::enumeration ||
           token == Token::other;
  }

  std::uint32_t type_index(std::string_view name) {
    const auto known = type_indices_.find(name);
    if (known != type_indices_.end()) return known->second;
    file_.types.emplace_back(name);
    return type_indices_.emplace(name, static_cast<std::uint32_t>(file_.types.size() - 1)).first->second;
  }

  // By ids. One that is defined a second time in the same words is left out.
  void sort() {
    const std::vector<Statement>& list = file_.statements;
    std::vector<std::size_t> order(list.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto id = [&](std::size_t i) { return list[i].id; };
    if (!std::ranges::is_sorted(order, {}, id)) std::ranges::stable_sort(order, {}, id);
    const auto repeats = [&](std::size_t a, std::size_t b) {
      if (list[a].id != list[b].id) return false;
      std::string text =
          fmt::format("#{} is defined a second time, first in line {}", list[a].id, list[a].spot.line);
      if (are_same(list[a], list[b]))
        report_.warning(list[b].spot, text + ", by the same words");
      else
        report_.error(list[b].spot, text + ", in other words; give one of them a number of its own");
      return true;
    };
    order.erase(std::unique(order.begin(), order.end(), repeats), order.end());
    if (order.size() != list.size() || !std::ranges::is_sorted(order)) regroup_refs(order);
  }

  [[nodiscard]] bool are_same(const Statement& a, const Statement& b) const {
    Lexer first = lexer_at(a), second = lexer_at(b);
    do {
      first.next();
      second.next();
      if (first.token() != second.token() || first.text() != second.text()) return false;
    } while (first.token() != Token::semicolon);
    return true;
  }
  [[nodiscard]] Lexer lexer_at(const Statement& statement) const { return Lexer(bytes_, statement.spot); }

  // Statements, and with them what they refer to, in this order.
  void regroup_refs(const std::vector<std::size_t>& order) {
    std::vector<Statement> sorted;
    sorted.reserve(order.size());
    std::vector<int> refs;
    refs.reserve(file_.refs.size());
    for (const std::size_t i : order) {
      sorted.push_back(file_.statements[i]);
      sorted.back().first_ref = static_cast<std::uint32_t>(refs.size());
      refs.insert(refs.end(), file_.refs.begin() + file_.statements[i].first_ref,
                  file_.refs.begin() + static_cast<std::ptrdiff_t>(file_.refs_end(i)));
    }
    file_.statements = std::move(sorted);
    file_.refs = std::move(refs);
  }

  // Finds what each reference names.
  void resolve() {
    const Places places(file_.statements);
    std::sort(outside_.begin(), outside_.end());
    file_.targets.resize(file_.refs.size());
    for (std::size_t i = 0; i < file_.statements.size() && !report_.is_full(); ++i)
      for (std::size_t r = file_.statements[i].first_ref; r < file_.refs_end(i); ++r) {
        file_.targets[r] = places.of(file_.refs[r]);
        if (file_.targets[r] >= 0 || std::binary_search(outside_.begin(), outside_.end(), file_.refs[r]))
          continue;
        report_.error(file_.statements[i].spot, fmt::format("#{} refers to #{}, which is not in the file",
                                                            file_.statements[i].id, file_.refs[r]));
      }
  }

  TextReport& report_;
  std::string_view bytes_;
  Lexer lexer_;
  Part21 file_;
  bool in_data_ = false;
  std::vector<std::string> strings_;
  std::vector<int> outside_;
  std::map<std::string, std::uint32_t, std::less<>> type_indices_;
};

}  // namespace

const Statement* Part21::find(int id) const {
  return found_in(statements, id);
}

std::size_t Part21::refs_end(std::size_t place) const {
  return place + 1 < statements.size() ? statements[place + 1].first_ref : refs.size();
}

std::string_view readable_bytes(const Source& source, const Part21& file, std::string& kept) {
  const std::string_view bytes = source.bytes();
  for (const Statement& statement : file.statements) {
    if (!statement.is_left_out) continue;
    if (kept.empty()) kept = bytes;
    Lexer lexer(bytes, statement.spot);
    do lexer.next();
    while (lexer.token() != Token::word);
    kept[static_cast<std::size_t>(lexer.text().data() - bytes.data())] = 'Z';
  }
  return kept.empty() ? bytes : std::string_view(kept);
}

std::string first_string(const Source& source, const Statement& statement) {
  Lexer lexer(source.bytes(), statement.spot);
  do lexer.next();
  while (lexer.token() != Token::string && lexer.token() != Token::semicolon);
  if (lexer.token() != Token::string) return {};
  return decoded(lexer.text().substr(1, lexer.text().size() - 2));
}

std::optional<Part21> read_part21(const Source& source, TextReport& report) {
  return FileReader(source, report).read();
}

}  // namespace selvage::formats::step
