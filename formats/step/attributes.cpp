#include "formats/step/attributes.h"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "core/graph.h"
#include "core/words.h"
#include "formats/step/entities.h"
#include "formats/step/lexer.h"

namespace selvage::formats::step {

namespace {

// What is known of a type of Part21::types.
struct TypeFacts {
  EntitySet kinds;       // of a complex entity those of all its parts
  bool is_known = true;  // each of them is in the table
};

TypeFacts facts_of(std::string_view type) {
  TypeFacts facts;
  for (const std::string_view name : words_of(type)) {
    const Entity* const entity = find_entity(name);
    facts.is_known = facts.is_known && entity != nullptr;
    if (entity != nullptr) facts.kinds |= entity->kinds;
  }
  return facts;
}

// Without a statement of this type all shapes are the same: looks, layers, properties. Complex entities are
// none of it.
constexpr std::string_view without_it = "; it is left out, since no shape depends on it";
bool decorates(std::string_view type) {
  for (const std::string_view beginning :
       {"SURFACE_STYLE", "SURFACE_SIDE_STYLE", "FILL_AREA_STYLE", "CURVE_STYLE", "POINT_STYLE", "TEXT_STYLE",
        "SYMBOL_STYLE", "COLOUR", "PRE_DEFINED", "DRAUGHTING_PRE_DEFINED", "PRESENTATION_"})
    if (type.starts_with(beginning)) return type.find(' ') == std::string_view::npos;
  for (const std::string_view name :
       {"DESCRIPTIVE_REPRESENTATION_ITEM", "MEASURE_REPRESENTATION_ITEM", "STYLED_ITEM",
        "OVER_RIDING_STYLED_ITEM", "CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM", "INVISIBILITY",
        "REPRESENTATION", "PROPERTY_DEFINITION", "PROPERTY_DEFINITION_REPRESENTATION"})
    if (type == name) return true;
  return false;
}

// The attributes of one statement after the other. The grammar has been checked: what is a list here ends.
class Checker {
 public:
  Checker(Part21& file, std::string_view text, TextReport& report)
      : file_(file), text_(text), report_(report) {
    for (const std::string& type : file.types) facts_.push_back(facts_of(type));
  }

  void check_all() {
    for (std::size_t i = 0; i < file_.statements.size() && !report_.is_full(); ++i)
      if (facts_[file_.statements[i].type].kinds.any() && !file_.statements[i].is_left_out)
        check(file_.statements[i]);
  }

 private:
  void check(Statement& statement) {
    lexer_ = Lexer(text_, statement.spot);
    statement_ = &statement;
    next_reference_ = statement.first_ref;
    try {
      for (int token = 0; token < 3; ++token) lexer_.next();  // past '#1', '='
      if (lexer_.token() == Token::word) return check_entity(true);
      lexer_.next();
      while (lexer_.token() == Token::word) check_entity(false);
    } catch (const Failure& failure) {
      statement.is_left_out = decorates(file_.type_of(statement));
      if (statement.is_left_out)
        report_.warning(failure.spot, failure.text + std::string(without_it));
      else
        report_.error(failure.spot, failure.text);
    }
  }

  // NAME(...): by itself, or as a part of a complex entity with its own attributes only.
  void check_entity(bool by_itself) {
    name_ = lexer_.text();
    const Entity* const entity = find_entity(name_);
    lexer_.next();
    if (entity == nullptr || entity->is_open) {
      skip_value();
      return;
    }
    const std::vector<Attribute>& attributes = by_itself ? entity->whole : entity->own;
    const Spot open = lexer_.spot();
    lexer_.next();
    std::size_t count = 0;
    for (; lexer_.token() != Token::close; ++count) {
      number_ = count + 1;
      if (count < attributes.size())
        check_value(attributes[count]);
      else
        skip_value();
      skip_comma();
    }
    lexer_.next();
    // OpenCASCADE reads a surface without its name all the same; of a curve it makes nothing, and uses that.
    if (count == 0 && name_ == "REPRESENTATION_ITEM" && !by_itself &&
        file_.type_of(*statement_).find("RATIONAL_B_SPLINE_SURFACE") != std::string_view::npos)
      report_.warning(open, fmt::format("#{} has no name, not even an empty one", statement_->id));
    else if (count < attributes.size() && attributes[count].may_lack)
      tell_lack(open, count + 1, "is not there");
    else if (count != attributes.size())
      fail(open, fmt::format("{} has {} attributes here, not {}", name_, count, attributes.size()));
  }

  void check_value(const Attribute& attribute) {
    if (attribute.takes_anything) return skip_value();
    switch (lexer_.token()) {
      case Token::omitted:
        if (attribute.may_lack && !attribute.is_omissible) tell_lack(lexer_.spot(), number_, "is '$'");
        return take_if(attribute.is_omissible || attribute.is_derived || attribute.may_lack, attribute);
      case Token::derived:
        return take_if(attribute.is_derived, attribute);
      case Token::string:
        return take_if(attribute.takes_string, attribute);
      case Token::number:
        return take_if(attribute.takes_number, attribute);
      case Token::enumeration:
        return take_if(attribute.takes_enumeration, attribute);
      case Token::word:
        if (!attribute.takes_typed) refuse(attribute);
        return skip_value();
      case Token::reference:
        return check_reference(attribute);
      case Token::open:
        if (attribute.element.empty()) refuse(attribute);
        return check_list(attribute);
      default:
        refuse(attribute);
    }
  }

  // At the first place alone: who leaves it out does so everywhere.
  void tell_lack(const Spot& spot, std::size_t number, std::string_view what) {
    if (lacking_.emplace(name_, number).second)
      report_.warning(
          spot, fmt::format("#{}: attribute {} of {} {}, which is read through here and wherever it is so",
                            statement_->id, number, name_, what));
  }

  void take_if(bool fits, const Attribute& attribute) {
    if (!fits) refuse(attribute);
    lexer_.next();
  }

  void check_list(const Attribute& attribute) {
    const Spot open = lexer_.spot();
    lexer_.next();
    std::size_t count = 0;
    for (; lexer_.token() != Token::close; ++count) {
      check_value(attribute.element.front());
      skip_comma();
    }
    lexer_.next();
    if (count < attribute.least)
      fail(open, fmt::format("attribute {} of {} is a list of {}, fewer than {}", number_, name_, count,
                             attribute.least));
    if (count > attribute.most)
      fail(open, fmt::format("attribute {} of {} is a list of {}, more than {}", number_, name_, count,
                             attribute.most));
  }

  void check_reference(const Attribute& attribute) {
    if (attribute.references.none()) refuse(attribute);
    const int place = file_.targets[next_reference_];
    if (place >= 0) {
      const Statement& target = file_.statements[static_cast<std::size_t>(place)];
      const TypeFacts& facts = facts_[target.type];
      if (facts.is_known && (facts.kinds & attribute.references).none())
        fail(lexer_.spot(), fmt::format("attribute {} of {} is #{}, a {}, not {}", number_, name_, target.id,
                                        file_.type_of(target), names_of(attribute.references)));
    }
    skip_value();
  }

  [[noreturn]] void refuse(const Attribute& attribute) const {
    fail(lexer_.spot(), fmt::format("attribute {} of {} is {}, not {}", number_, name_,
                                    in_quotes(lexer_.text()), wanted(attribute)));
  }

  static std::string wanted(const Attribute& attribute) {
    if (!attribute.element.empty()) return "a list";
    if (attribute.takes_string) return "a string";
    if (attribute.references.any()) return fmt::format("a reference to {}", names_of(attribute.references));
    return attribute.takes_enumeration ? "a value between dots" : "a number";
  }

  [[noreturn]] void fail(const Spot& spot, const std::string& text) const {
    throw Failure{spot, fmt::format("#{}: {}", statement_->id, text)};
  }

  void skip_comma() {
    if (lexer_.token() == Token::comma) lexer_.next();
  }

  // One value of any kind: a list, or with its type, too.
  void skip_value() {
    if (lexer_.token() == Token::word) lexer_.next();
    int depth = 0;
    do {
      if (lexer_.token() == Token::reference) ++next_reference_;
      if (lexer_.token() == Token::open) ++depth;
      if (lexer_.token() == Token::close) --depth;
      lexer_.next();
    } while (depth > 0);
  }

  Part21& file_;
  std::string_view text_;
  TextReport& report_;
  std::vector<TypeFacts> facts_;  // one a type of the file
  Lexer lexer_{{}};
  const Statement* statement_ = nullptr;
  std::size_t next_reference_ = 0;                              // in Part21::refs
  std::string_view name_;                                       // of the entity that is being checked
  std::size_t number_ = 0;                                      // of its attribute, from 1
  std::set<std::pair<std::string_view, std::size_t>> lacking_;  // told already
};

}  // namespace

void check_circles(Part21& file, TextReport& report) {
  std::vector<TypeFacts> facts;
  for (const std::string& type : file.types) facts.push_back(facts_of(type));
  const auto has_part = [&](std::size_t i) {
    const Statement& statement = file.statements[i];
    return facts[statement.type].is_known &&
           file.types[statement.type] != "APPLICATION_PROTOCOL_DEFINITION" && !statement.is_left_out;
  };
  constexpr std::size_t most_left_out = 20;  // each costs a search
  for (std::size_t left_out = 0;; ++left_out) {
    Graph graph;
    graph.firsts.push_back(0);
    for (std::size_t i = 0; i < file.statements.size(); ++i) {
      if (has_part(i))
        graph.targets.insert(graph.targets.end(), file.targets.begin() + file.statements[i].first_ref,
                             file.targets.begin() + static_cast<std::ptrdiff_t>(file.refs_end(i)));
      graph.firsts.push_back(graph.targets.size());
    }
    std::vector<std::size_t> order;
    const std::vector<Circle> circles = sort_from_leaves(graph, order);
    if (circles.empty()) return;
    Statement& at = file.statements[circles[0].at];
    const Statement& by = file.statements[circles[0].by];
    const std::string what = fmt::format("#{} refers to itself, by way of #{}", at.id, by.id);
    if (!decorates(file.type_of(at)) || left_out >= most_left_out) {
      report.error(at.spot, what);
      return;
    }
    report.warning(at.spot, what + std::string(without_it));
    at.is_left_out = true;
  }
}

void check_attributes(Part21& file, std::string_view text, TextReport& report) {
  Checker(file, text, report).check_all();
}

}  // namespace selvage::formats::step
