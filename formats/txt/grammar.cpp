// The language's words as a TextMate grammar, the form that editors read:
// https://macromates.com/manual/en/language_grammars. Regular expressions are those of Oniguruma.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <set>

#include "formats/txt/lessons.h"

namespace selvage::formats::txt {

namespace {

using Words = std::set<std::string_view>;  // sorted, each once

// One of the words, of any case, whole: names may go on with '.' and '-'.
std::string one_of_words(const Words& words, std::string_view before) {
  return fmt::format("(?i){}({})(?![\\w.-])", before, fmt::join(words, "|"));
}

nlohmann::ordered_json pattern(std::string_view scope, std::string_view match) {
  return {{"name", fmt::format("{}.fabric-txt", scope)}, {"match", match}};
}

}  // namespace

std::string textmate_grammar(const Language& language) {
  Words blocks, statements, values, units;
  for (const Lesson& lesson : language.lessons)
    (lesson.opens_block() || lesson.word == "end" ? blocks : statements).insert(lesson.word);
  for (const Value& value : language.values) values.insert(value.word);
  for (const Measures& measures : language.measures)
    units.insert(measures.units.begin(), measures.units.end());
  const std::string name = "(\"[^\"]*\"|[A-Za-z_][\\w.-]*)";
  const nlohmann::ordered_json named = {
      {"match",
       one_of_words({"block", "curve", "line", "material", "outline", "param", "piece", "thread", "yarn"},
                    "^\\s*") +
           "\\s+" + name},
      {"captures",
       {{"1", {{"name", "keyword.control.fabric-txt"}}}, {"2", {{"name", "entity.name.fabric-txt"}}}}}};
  // Not all that ends with ".txt" is one: the first line tells.
  const nlohmann::ordered_json grammar = {
      {"comment", "Made by: selvage --generate textmate"},
      {"name", language.name},
      {"scopeName", "source.fabric-txt"},
      {"fileTypes", {"fabric.txt"}},
      {"firstLineMatch", "^(\\xEF\\xBB\\xBF)?\\s*(?i:fabric)\\s+\\d+"},
      {"patterns",
       {pattern("comment.line.number-sign", "#(?![0-9A-Fa-f]{6}(?![0-9A-Fa-f])).*$"),
        pattern("constant.other.color", "#[0-9A-Fa-f]{6}"), named,
        pattern("string.quoted.double", "\"[^\"]*\""),
        pattern("keyword.control", one_of_words(blocks, "^\\s*")),
        pattern("keyword.other", one_of_words(statements, "^\\s*")),
        pattern(
            "constant.numeric",
            fmt::format("(?i)(?<![\\w.-])[+-]?(\\d+\\.?\\d*|\\.\\d+)(e[+-]?\\d+)?({}|/\\d*(cm|mm|dm|m|in))?"
                        "(?![\\w.])",
                        fmt::join(units, "|"))),
        pattern("constant.language", one_of_words(values, "(?<![\\w.-])"))}}};
  return grammar.dump(2) + "\n";
}

}  // namespace selvage::formats::txt
