#include "formats/txt/count.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/number_text.h"
#include "core/text_report.h"
#include "core/words.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

using fabric::LinearDensity;
using System = LinearDensity::Measure;

// What trades call the systems, beside `density_words`.
constexpr std::array<Word<System>, 10> trade_words{{{"Td", System::denier},
                                                    {"den", System::denier},
                                                    {"D", System::denier},
                                                    {"deniers", System::denier},
                                                    {"decitex", System::dtex},
                                                    {"Nec", System::ne},
                                                    {"NeC", System::ne},
                                                    {"s", System::ne},
                                                    {"cc", System::ne},
                                                    {"metric", System::nm}}};

std::optional<System> system_named(std::string_view word) {
  for (const auto& known : density_words)
    if (same_word(known.text, word)) return known.value;
  for (const auto& known : trade_words)
    if (same_word(known.text, word)) return known.value;
  return std::nullopt;
}

// What a word measures in that is none of `density_words`.
struct TradeUnit {
  std::string_view word;
  System system;        // that it is read as
  double factor;        // its 1 in that system
  std::string_view is;  // what it is, for the note
};
constexpr TradeUnit hanks(std::string_view word, double yards, std::string_view is) {
  constexpr double metres_a_yard = 0.9144, grams_a_pound = 453.59237;
  return {word, System::nm, yards * metres_a_yard / grams_a_pound, is};
}
constexpr std::string_view of_linen = "the number of hanks of 300 yards in a pound",
                           of_worsted = "the number of hanks of 560 yards in a pound";
constexpr std::array<TradeUnit, 10> trade_units{
    {hanks("NeL", 300, of_linen),
     hanks("lea", 300, of_linen),
     hanks("NeK", 560, of_worsted),
     hanks("NeW", 560, of_worsted),
     hanks("Nw", 560, of_worsted),
     hanks("worsted", 560, of_worsted),
     hanks("YSW", 256, "the number of skeins of 256 yards in a pound"),
     {"ktex", System::tex, 1e3, "1000 tex"},
     {"kilotex", System::tex, 1e3, "1000 tex"},
     {"mtex", System::tex, 1e-3, "1/1000 tex"}}};

const TradeUnit* unit_named(std::string_view word) {
  for (const TradeUnit& known : trade_units)
    if (same_word(known.word, word)) return &known;
  return nullptr;
}

bool is_indirect(System system) {
  return system == System::nm || system == System::ne;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

Message wrong_count(std::string_view text, std::string_view what) {
  return error(Kind::malformed, fmt::format("the yarn count {}: {}", in_quotes(text), what));
}

// The next part of a notation: a number, a word of letters, or a sign.
struct Token {
  enum class Kind { number, word, sign, end } kind = Kind::end;
  std::string_view text;
  double value = 0;            // of a number
  bool is_expression = false;  // a param, or an expression in brackets
  bool is_thousands = false;   // 12k: of filaments
};

class Tokens {
 public:
  Tokens(std::string_view text, Scope& scope) : text_(text), rest_(text), scope_(scope) {}

  Result<Token> next() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) rest_.remove_prefix(1);
    if (rest_.empty()) return Token{};
    if (rest_.front() == '(') return expression(bracketed());
    if (is_digit(rest_.front()) || rest_.front() == '.') return number();
    constexpr std::string_view times = "\xC3\x97";  // the sign of multiplication
    if (rest_.starts_with(times)) return rest_.remove_prefix(times.size()), Token{Token::Kind::word, "x"};
    if (starts_name(rest_.front())) return word();
    return Token{Token::Kind::sign, taken(1)};
  }

 private:
  std::string_view taken(std::size_t size) {
    const std::string_view text = rest_.substr(0, size);
    rest_.remove_prefix(text.size());
    return text;
  }

  std::size_t bracketed() const {
    int depth = 0;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      depth += (rest_[i] == '(') - (rest_[i] == ')');
      if (depth == 0) return i + 1;
    }
    return rest_.size();
  }

  Result<Token> expression(std::size_t size) {
    const std::string_view text = taken(size);
    const std::optional<Result<double>> value = scope_.value(text, Measure::plain);
    if (!value) return wrong_count(text_, fmt::format("{} is not a number", in_quotes(text)));
    if (!value->ok()) return value->error();
    return Token{Token::Kind::number, text, **value, true};
  }

  Result<Token> number() {
    double value = 0;
    const auto [stop, failure] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (failure != std::errc{}) return wrong_count(text_, "a number is expected");
    Token token{Token::Kind::number, taken(static_cast<std::size_t>(stop - rest_.data())), value};
    if (rest_.empty() || lower(rest_.front()) != 'k' || (rest_.size() > 1 && is_letter(rest_[1])))
      return token;
    rest_.remove_prefix(1);
    token.value *= 1000.0;
    token.is_thousands = true;
    return token;
  }

  Result<Token> word() {
    std::size_t size = 1;
    while (size < rest_.size() && (starts_name(rest_[size]) || is_digit(rest_[size]))) ++size;
    if (size < rest_.size() && rest_[size] == '(') {  // a function
      const std::size_t name = size;
      rest_.remove_prefix(name);
      const std::size_t whole = name + bracketed();
      rest_ = std::string_view(rest_.data() - name, rest_.size() + name);
      return expression(whole);
    }
    const std::vector<std::string_view> params = scope_.names();
    if (std::find(params.begin(), params.end(), rest_.substr(0, size)) != params.end())
      return expression(size);
    size = 1;
    while (size < rest_.size() && is_letter(rest_[size])) ++size;
    return Token{Token::Kind::word, taken(size)};
  }

  std::string_view text_, rest_;
  Scope& scope_;
};

class Reading {
 public:
  Reading(std::string_view text, System system, Scope& scope)
      : text_(text), system_(system), tokens_(text, scope) {}

  Result<YarnCount> read() {
    for (;;) {
      Result<Token> token = tokens_.next();
      if (!token) return token.error();
      if (token->kind == Token::Kind::end) break;
      const Status taken = token->kind == Token::Kind::number ? take_number(*token)
                           : token->kind == Token::Kind::word ? take_word(token->text)
                                                              : take_sign(token->text);
      if (!taken) return taken.error();
    }
    if (!base_) return wrong_count(text_, "its number is missing");
    if (role_ != Role::none) return wrong_count(text_, "a number is missing at its end");
    return is_indirect(system_) ? indirect() : direct();
  }

 private:
  // What the number that follows is.
  enum class Role { none, slash, plies, filaments, resultant };

  [[nodiscard]] Message needs_brackets() const {
    if (text_.find("/*") != std::string_view::npos) return not_part("/*");
    return wrong_count(text_, fmt::format("an expression in a count needs brackets: ({})", trimmed(text_)));
  }

  Status take_number(const Token& token) {
    if (!(token.value > 0.0)) return wrong_count(text_, "its numbers are larger than 0");
    if (token.is_thousands) return take_thousands(token);
    const Role role = std::exchange(role_, Role::none);
    if (!base_ || role == Role::resultant) {
      if (role == Role::resultant && base_) return put(resultant_, token.value);
      is_resultant_ = role == Role::resultant;
      base_ = token.value;
      base_is_expression_ = token.is_expression && token.text.front() != '(';
      return {};
    }
    if (role == Role::none)
      return wrong_count(text_, fmt::format("{} has to be joined to what is before it, by '/', 'x' or 'f'",
                                            in_quotes(token.text)));
    if (role == Role::slash && (base_is_expression_ || (token.is_expression && token.text.front() != '(')))
      return needs_brackets();
    const bool is_indirect_pair = role == Role::slash && is_indirect(system_);
    if (!is_indirect_pair && (token.value != std::floor(token.value) || token.value > 1e6))
      return role == Role::slash ? needs_brackets()
                                 : wrong_count(text_, "numbers of plies and of filaments are whole numbers");
    if (role == Role::slash) return slashed_.push_back(token.value), Status{};
    if (role == Role::plies) return plies_.push_back(token.value), Status{};
    return put(filaments_, token.value);
  }

  // Of filaments: 12k.
  Status take_thousands(const Token& token) {
    if (!base_)
      return wrong_count(text_, fmt::format("{0}k is a number of filaments, and no count: write the count in "
                                            "front of it, as in tex 800 {0}k",
                                            token.text));
    if (role_ == Role::plies || role_ == Role::resultant)
      return wrong_count(text_, fmt::format("{}k is a number of filaments", token.text));
    role_ = Role::none;
    return put(filaments_, token.value);
  }

  Status take_sign(std::string_view sign) {
    if (sign == "/" && base_ && (role_ == Role::none)) return role_ = Role::slash, Status{};
    if (sign == "-" || sign == ";") return {};  // 2-ply; 20 tex x 2; R 42 tex
    if (sign == "*" || sign == "+" || sign == "^") return needs_brackets();
    return not_part(sign);
  }

  Status take_word(std::string_view word) {
    const bool follows_slash = role_ == Role::slash;
    if (same_word(word, "f") || same_word(word, "fil") || same_word(word, "filaments")) {
      // 48f: the number is there already, and none follows.
      Tokens ahead = tokens_;
      const Result<Token> next = ahead.next();
      const bool is_behind = !next || next->kind != Token::Kind::number;
      if (role_ == Role::none && !slashed_.empty() && !filaments_ && is_behind) {
        filaments_ = slashed_.back();
        slashed_.pop_back();
        return {};
      }
      if (base_ && (role_ == Role::none || follows_slash)) return role_ = Role::filaments, Status{};
    }
    if ((same_word(word, "x") || same_word(word, "ply") || same_word(word, "plies")) && base_) {
      if (same_word(word, "x") && role_ == Role::none) return role_ = Role::plies, Status{};
      if (!same_word(word, "x") && role_ == Role::none && !slashed_.empty()) return {};  // 30/2 ply
    }
    if (same_word(word, "R") && role_ == Role::none) return role_ = Role::resultant, Status{};
    if (const TradeUnit* unit = unit_named(word); unit != nullptr && system_ == unit->system)
      return unit_ = unit, Status{};
    if (same_word(word, "Z") || (same_word(word, "S") && system_ != System::ne))
      return wrong_count(text_, "twist has a statement of its own: twist 660 Z");
    if (const auto system = system_named(word)) {
      if (*system == system_) return {};
      return wrong_count(text_, fmt::format("{} is another system than {}", in_quotes(word),
                                            word_of(density_words, system_)));
    }
    if (!base_ && role_ == Role::none && is_title_of_count(word)) return {};
    return not_part(word);
  }

  [[nodiscard]] Message not_part(std::string_view token) const {
    for (const std::string_view own : {"twist", "density", "packing", "diameter", "section", "material"})
      if (same_word(token, own))
        return wrong_count(text_, fmt::format("{} begins a line of its own", in_quotes(token)));
    const bool is_comment = text_.find(';') != std::string_view::npos ||
                            text_.find("--") != std::string_view::npos ||
                            text_.find("/*") != std::string_view::npos;
    return wrong_count(text_, fmt::format("{} is not part of one; write {}{}", in_quotes(token), examples(),
                                          is_comment ? " (a comment begins with #)" : ""));
  }

  [[nodiscard]] std::string_view examples() const {
    return is_indirect(system_) ? "30/2 or 2/30 (plies)" : "167 f48 (filaments), 1400 x2 (plies)";
  }

  Status put(std::optional<double>& place, double value) {
    if (place) return wrong_count(text_, "the same is given twice in it");
    place = value;
    return {};
  }

  [[nodiscard]] std::string with_system(double value) const {
    const std::string_view word = word_of(density_words, system_);
    const std::string number = number_text(std::round(value * 1e6) / 1e6);
    return is_indirect(system_) ? fmt::format("{} {}", word, number) : fmt::format("{} {}", number, word);
  }

  Result<YarnCount> made(double single, double whole, double plies) const {
    YarnCount count;
    if (unit_ != nullptr) {
      single *= unit_->factor;
      whole *= unit_->factor;
    }
    if (!(plies <= 1e6)) return wrong_count(text_, "so many plies are no yarn");
    count.whole = {whole, system_};
    count.plies = static_cast<int>(plies);
    count.filaments = static_cast<int>(filaments_.value_or(0.0));
    if (count.plies > 1)
      count.understood = fmt::format("{} plies of {}", count.plies, with_system(single));
    else if (filaments_ || range_ || unit_ != nullptr)
      count.understood = with_system(whole);
    if (range_) count.understood += fmt::format(", the middle of a raw silk's range {}", *range_);
    if (filaments_)
      count.understood +=
          fmt::format(", {} {}{}", count.filaments, count.filaments == 1 ? "filament" : "filaments",
                      count.plies > 1 ? " each" : "");
    if (count.plies > 1) count.understood += fmt::format("; {} in all", with_system(whole));
    if (unit_ != nullptr) count.understood += fmt::format(" ({} is {})", unit_->word, unit_->is);
    return count;
  }

  // `2x1400` has its plies in front.
  double product_of_plies() {
    if (plies_.size() == 1 && slashed_.empty() && *base_ <= max_plies_of_count &&
        *base_ == std::floor(*base_) && plies_.front() > max_plies_of_count)
      std::swap(*base_, plies_.front());
    double plies = 1;
    for (const double more : plies_) plies *= more;
    return plies;
  }

  // The largest of the numbers is the count, the others are plies.
  Result<YarnCount> indirect() {
    const auto largest = std::max_element(slashed_.begin(), slashed_.end());
    if (largest != slashed_.end() && *largest > *base_) std::swap(*largest, *base_);
    double plies = product_of_plies();
    for (const double more : slashed_) {
      if (more != std::floor(more)) return needs_brackets();
      plies *= more;
    }
    if (is_resultant_) return made(*base_ * plies, *base_, plies);
    return made(*base_, resultant_.value_or(*base_ / plies), plies);
  }

  // Reeled from cocoons of uneven thickness: 13/15, 20/22, 40/44.
  [[nodiscard]] bool is_silk_range() const {
    constexpr double max_of_silk = 50, wide = 40;
    if (system_ != System::denier || slashed_.empty() || *base_ >= max_of_silk) return false;
    const double more = slashed_.front() - *base_;
    return more == 2.0 || (*base_ >= wide && more == 4.0);
  }

  // 2/150/48, 2/78: plies stand in front where what follows cannot be their filaments.
  void put_plies_behind() {
    constexpr double finest = 0.1;  // dtex of a filament
    if (slashed_.empty() || *base_ > max_plies_of_count || *base_ != std::floor(*base_) ||
        slashed_.front() <= max_plies_of_count)
      return;
    const bool has_filaments = filaments_ || (slashed_.size() > 1 && slashed_[1] > max_plies_of_count);
    const double of_filament = 10.0 * LinearDensity{*base_ / slashed_.front(), system_}.tex();
    if (has_filaments || of_filament < finest) std::swap(*base_, slashed_.front());
  }

  Result<YarnCount> direct() {
    put_plies_behind();
    if (is_silk_range()) {
      range_ = fmt::format("{0} to {1} ({0} f{1} would be filaments)", *base_, slashed_.front());
      base_ = 0.5 * (*base_ + slashed_.front());
      slashed_.erase(slashed_.begin());
    }
    double plies = product_of_plies();
    for (const double number : slashed_) {
      if (number <= max_plies_of_count) {
        plies *= number;
      } else if (filaments_) {
        return wrong_count(text_, fmt::format("{} and {} both are numbers of filaments; write plies as x{}",
                                              *filaments_, number, number));
      } else {
        filaments_ = number;
      }
    }
    if (is_resultant_) return made(*base_ / plies, *base_, plies);
    return made(*base_, resultant_.value_or(*base_ * plies), plies);
  }

  std::string_view text_;
  System system_;
  Tokens tokens_;
  Role role_ = Role::none;
  std::optional<double> base_, filaments_, resultant_;
  std::optional<std::string> range_;
  const TradeUnit* unit_ = nullptr;
  std::vector<double> slashed_, plies_;
  bool is_resultant_ = false, base_is_expression_ = false;
};

}  // namespace

bool is_title_of_count(std::string_view word) {
  for (const std::string_view title : {"Tt", "count", "titre", "titer"})
    if (same_word(word, title)) return true;
  return false;
}

Result<YarnCount> read_yarn_count(std::string_view text, System system, Scope& scope) {
  return Reading(text, system, scope).read();
}

bool is_count_notation(std::string_view text, const Scope& scope) {
  if (text.empty() || read_number(text) || text.find(',') != std::string_view::npos) return false;
  if (is_digit(text.front()) || text.front() == '.' || text.front() == '(') return true;
  if (!system_of_count(text).empty()) return true;
  const std::vector<std::string_view> params = scope.names();
  const std::string_view word = text.substr(0, text.find_first_of(" \t/*+-^("));
  if (std::find(params.begin(), params.end(), word) != params.end()) return word.size() < text.size();
  return lower(text.front()) == 'r' && text.find_first_of("0123456789") != std::string_view::npos;
}

std::optional<std::string> count_of_glass(std::string_view line) {
  constexpr std::array<std::string_view, 4> metric = {"EC", "ECR", "SC", "CC"};
  // D alone is denier.
  constexpr std::array<std::string_view, 9> american = {"ECD", "ECDE", "ECG", "ECH", "ECK",
                                                        "DE",  "G",    "H",   "K"};
  std::size_t letters = 0;
  while (letters < line.size() && is_letter(line[letters])) ++letters;
  const std::string_view strand = line.substr(0, letters);
  const auto is_strand = [&](std::string_view known) { return same_word(known, strand); };
  const bool is_metric = std::ranges::any_of(metric, is_strand);
  if (!is_metric && std::ranges::none_of(american, is_strand)) return std::nullopt;
  std::string_view rest = line.substr(letters);
  std::vector<double> numbers;
  std::string signs;  // between them
  while (!rest.empty()) {
    double value = 0;
    const auto [stop, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (failure == std::errc{} && is_digit(rest.front())) {
      numbers.push_back(value);
      rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
    } else {
      if (rest.front() != ' ' && rest.front() != '-') signs += lower(rest.front());
      rest.remove_prefix(1);
    }
  }
  if (is_metric) {
    if (numbers.size() == 2 && signs.empty()) return fmt::format("tex {}", numbers[1]);
    if (numbers.size() == 3 && signs == "x") return fmt::format("tex {}x{}", numbers[1], numbers[2]);
    return std::nullopt;
  }
  constexpr double tex_of_one = 1e3 * 453.59237 / (100 * 0.9144);
  if (numbers.empty() || !(numbers[0] > 0)) return std::nullopt;
  const std::string tex = fmt::format("tex {:.4g}", tex_of_one / numbers[0]);
  if (numbers.size() == 1 && signs.empty()) return tex;
  if (numbers.size() != 3 || signs != "/") return std::nullopt;
  const double plies = std::max(1.0, numbers[1]) * std::max(1.0, numbers[2]);
  return plies == 1 ? tex : fmt::format("{}x{}", tex, plies);
}

std::string_view system_of_count(std::string_view line) {
  if (const std::size_t blank = line.find_first_of(" \t"); is_title_of_count(line.substr(0, blank)))
    return blank < line.size() ? system_of_count(trimmed(line.substr(blank))) : std::string_view{};
  const bool is_resultant =
      line.size() > 1 && lower(line.front()) == 'r' && (line[1] == ' ' || is_digit(line[1]));
  const bool begins_with_number = !line.empty() && is_digit(line.front());
  for (std::size_t i = 0; i < line.size();) {
    if (!is_letter(line[i])) {
      ++i;
      continue;
    }
    std::size_t stop = i;
    while (stop < line.size() && is_letter(line[stop])) ++stop;
    const std::string_view word = line.substr(i, stop - i);
    // A number of filaments alone, 12k, is no count: its reader says so.
    const auto system = unit_named(word) != nullptr                   ? unit_named(word)->system
                        : same_word(word, "k") && stop == line.size() ? System::tex
                                                                      : system_named(word);
    const bool is_glued =
        i == 0 && stop < line.size() && (is_digit(line[stop]) || (line[stop] == ' ' && stop > 1));
    if (system && (begins_with_number || is_resultant || is_glued)) return word_of(density_words, *system);
    if (!begins_with_number && !is_resultant) return {};
    i = stop;
  }
  return {};
}

}  // namespace selvage::formats::txt
