#include "cli/explain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "cli/codes.h"
#include "cli/generate.h"
#include "cli/language.h"
#include "cli/words.h"
#include "core/words.h"

namespace selvage::cli {

namespace {

using formats::Lesson;
using formats::Measures;

const Measures* measures_of(std::string_view name) {
  for (const Measures& measures : language().measures)
    if (measures.name == name) return &measures;
  return nullptr;
}

std::string text_of(const Measures& measures) {
  return fmt::format("{} (bare number: {})", fmt::join(measures.units, " "), measures.bare);
}

// "`thread` and `yarn`".
std::string in_ticks(std::string_view words) {
  std::string text;
  for (const std::string_view word : words_of(words))
    text += fmt::format("{}`{}`", text.empty() ? "" : ", ", word);
  return text;
}

std::string place_of(const Lesson& lesson) {
  if (lesson.blocks == "every") return "in every block";
  if (lesson.blocks == "file") return "in the file itself";
  if (lesson.blocks.starts_with("file ")) return "in the file itself, " + in_ticks(lesson.blocks.substr(5));
  return "in " + in_ticks(lesson.blocks);
}

bool has_word(std::string_view list, std::string_view word) {
  return std::ranges::count(words_of(list), word) > 0;
}

std::string text_of(const Lesson& lesson) {
  std::string text =
      fmt::format("{}\n  {}, {}.\n  {}\n", lesson.usage, lesson.opens_block() ? "A block" : "A statement",
                  place_of(lesson), lesson.meaning);
  if (const Measures* const measures = measures_of(lesson.unit))
    text += fmt::format("  Units:   {}\n", text_of(*measures));
  if (!lesson.preset.empty()) text += fmt::format("  Default: {}\n", lesson.preset);
  text += fmt::format("  Example: {}\n", lesson.example);
  for (const formats::Value& value : language().values)
    if (has_word(value.statements, lesson.word))
      text += fmt::format("    {:<14} {}\n", value.word, value.meaning);
  return text;
}

// The statements of a block.
std::string statements_of(std::string_view block) {
  std::string text;
  for (const Lesson& lesson : language().lessons)
    if (has_word(lesson.blocks, block)) text += fmt::format("  {}\n      {}\n", lesson.usage, lesson.meaning);
  return text.empty() ? text : fmt::format("\nIn a block `{}`:\n{}", block, text);
}

std::string units_text() {
  std::string text =
      "A number may carry its unit right behind it: 0.35mm, 30deg, 26/cm. Without one it is in\n"
      "  units m | cm | mm | um | inch     the file's own unit (default mm)\n"
      "and in the units below. Outputs keep the file's unit; --units names another one.\n";
  for (const Measures& measures : language().measures)
    text += fmt::format("  {:<10} {}\n", measures.name, text_of(measures));
  return text;
}

std::string equilibrium_text() {
  return "A weave is built in equilibrium: its yarns have the paths and cross-sections of least energy,\n"
         "the sum of\n"
         "  bending      of yarns along their paths;\n"
         "  tension      of warps and wefts, which pulls yarns straight;\n"
         "  flattening   of cross-sections, which twist resists: the larger the twist factor\n"
         "               (turns a metre times the root of tex), the rounder the yarn;\n"
         "               monofilaments and wires are not flattened;\n"
         "  compaction   of fibres within the yarn.\n"
         "Yarns do not overlap. A loose cloth has nearly round yarns, a dense one flat and compact ones.\n"
         "Plates press lightly on the cloth, as finishing and a thickness gauge do: long floats do not\n"
         "stand away from it.\n"
         "\n"
         "The state determines the tensions:\n"
         "  state finished   equal tensions in both systems: what a data sheet means, and the default\n"
         "  state loom       those of weaving: wefts are nearly straight, warps have most of the crimp\n"
         "  state relaxed    little tension in both systems: off the loom, not finished\n"
         "\n"
         "`crimp S` and `thickness T` are constraints: of all cloths with this crimp, or not thicker\n"
         "than T, the one of least energy is built. The twist factor is that of the thread's `twist`,\n"
         "or the usual one of its material and filaments: a tow needs `material carbon`, `material\n"
         "glass` or `filaments N` to lie flat.\n"
         "\n"
         "A formula gives heights and sections, as it did of every weave before,\n"
         "  with a `profile` (`profile peirce` is the former one of round yarns, `profile sine` of\n"
         "    ellipses), and with --as-published;\n"
         "  with `pucker`, `binder` and `draft leno`, which exclude a state;\n"
         "  where a thread has a section of another form (lenticular, racetrack, power, polygon),\n"
         "    unless the weave has a state or `levels`;\n"
         "  in drafts whose repeat has more than 256 kinds of crossings, with a warning. Up to there\n"
         "    a draft takes 10 ms (plain) to 10 s.\n"
         "\n"
         "`selvage info` reports cross-sections at crossings and between, packing fraction, crimp and\n"
         "take-up of both systems, thickness, the parts of the energy, and the steps and residual of\n"
         "the solution. Cross-sections are ellipses; plies and filaments are not built.\n"
         "A cloth without equilibrium is an error with remedies: its yarns do not fit at these\n"
         "pitches, or not with this crimp or thickness.\n";
}

std::string exit_codes_text() {
  std::string text;
  for (const Code& code : all_codes())
    if (code.where == exit_codes) text += fmt::format("  {:>3}  {}\n", code.word, code.meaning);
  return text;
}

struct Topic {
  std::string_view name, title;
  std::string (*text)();
};

// Words of the language explain themselves: here is what goes through several of them, or is none.
const std::vector<Topic>& topics() {
  static const std::vector<Topic> list = {
      {"units", "numbers with units", units_text},
      {"exit-codes", "what the program returns", exit_codes_text},
      {"sections", "what a yarn is across", [] { return *explain("section"); }},
      {"inputs", "what may be read",
       [] {
         return std::string(
             "Files, folders (searched for readable files), patterns ('in/*.txt'), - for standard input, "
             "@LIST for\n"
             "a list of paths. What can be read: selvage formats. A format is told by the first bytes, then "
             "by\n"
             "the extension.\n");
       }},
      {"outputs", "what is written, and where",
       [] {
         return std::string(
             "-o FILE by its extension, -o FOLDER for several, -o - for standard output; without -o beside "
             "the input.\n"
             "--to names formats. Files appear whole when all of an input's have succeeded; old ones stay "
             "until then.\n");
       }},
      {"language", "the words of the texts", [] { return *explain(""); }},
      {"equilibrium", "woven cloths of least energy", equilibrium_text},
      {"overlap", "yarns that share space", [] {
         return *explain("overlap") +
                "\n  selvage check FILE             says which yarns overlap, how deep, and where\n"
                "  selvage view FILE -o FILE.png  shows them, in magenta\n"
                "  selvage relax FILE -o OUT.txt  moves them apart\n";
       }}};
  return list;
}

// Options of that name, with their commands.
std::string options_of(std::string_view word) {
  std::string text;
  for (const Group& group : all_groups())
    for (const pipeline::Row* row : group.rows) {
      if (row->option.word() != word) continue;
      std::string commands;
      for (const pipeline::Command command : row->commands)
        commands += fmt::format("{}{}", commands.empty() ? "" : ", ", pipeline::name_of(command));
      text += fmt::format("  {} {}\n      {} ({})\n", row->option.name, argument_of(row->option),
                          row->option.help, commands);
    }
  return text.empty() ? text : "\nOptions of that name:\n" + text;
}

// Topics first: of words that are equally near the first one is meant.
std::vector<std::string> all_help() {
  std::vector<std::string> all = all_topics();
  for (const std::string& word : explained_words()) all.push_back(word);
  return all;
}

std::string text_of(const Topic& topic) {
  return fmt::format("{}: {}\n\n{}", topic.name, topic.title, topic.text());
}

const Topic* find_topic(std::string_view name) {
  const auto found =
      std::ranges::find_if(topics(), [&](const Topic& topic) { return same_word(topic.name, name); });
  return found == topics().end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> explained_words() {
  std::set<std::string> words;
  for (const Lesson& lesson : language().lessons) words.emplace(lesson.word);
  for (const formats::Value& value : language().values) words.emplace(value.word);
  for (const Measures& measures : language().measures)
    words.insert(measures.units.begin(), measures.units.end());
  for (const formats::Known& known : language().known) words.insert(known.word);
  for (const Code& code : all_codes()) words.insert(code.word);
  for (const Topic& topic : topics()) words.emplace(topic.name);
  return {words.begin(), words.end()};
}

Result<std::string> explain(const std::string& word) {
  if (word.empty()) {
    std::string text;
    std::set<std::string_view> blocks;
    const auto list = [&](std::string_view block, std::string_view title) {
      text += fmt::format("{}:\n ", title);
      for (const Lesson& lesson : language().lessons)
        if (has_word(lesson.blocks, block)) text += fmt::format(" {}", lesson.word);
      text += '\n';
    };
    list("file", "The file");
    for (const Lesson& lesson : language().lessons)
      if (lesson.opens_block() && blocks.insert(lesson.word).second &&
          std::ranges::any_of(language().lessons,
                              [&](const Lesson& inner) { return has_word(inner.blocks, lesson.word); }))
        list(lesson.word, lesson.word);
    text += "Codes:\n ";
    for (const Code& code : all_codes())
      text +=
          fmt::format(" {}", code.word.find(' ') == std::string::npos ? code.word : "'" + code.word + "'");
    text += "\nTopics:\n ";
    for (const Topic& topic : topics()) text += fmt::format(" {}", topic.name);
    return text + "\n";
  }
  std::string text;
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "\n") + more; };
  for (const Lesson& lesson : language().lessons)
    if (same_word(lesson.word, word)) add(text_of(lesson));
  for (const formats::Value& value : language().values)
    if (same_word(value.word, word))
      add(fmt::format("{}\n  A word within {}. {}\n", value.word, in_ticks(value.statements), value.meaning));
  for (const Measures& measures : language().measures)
    for (const std::string_view unit : measures.units)
      if (same_word(unit, word))
        add(fmt::format("{}\n  A unit of a {}: {}\n", unit, measures.name, text_of(measures)));
  for (const formats::Known& known : language().known)
    if (same_word(known.word, word)) add(fmt::format("{}\n  {}\n", known.word, known.meaning));
  for (const Code& code : all_codes())
    if (same_word(code.word, word))
      add(fmt::format("{}\n  {}: {}\n{}", code.word, code.where, code.meaning,
                      code.remedy.empty() ? "" : fmt::format("  {}\n", code.remedy)));
  if (!text.empty()) return text;
  if (const Topic* const topic = find_topic(word)) return text_of(*topic);
  return error(Kind::usage, fmt::format("nothing is known of '{}'{} (all words: selvage explain)", word,
                                        did_you_mean(word, explained_words())));
}

std::vector<std::string> all_topics() {
  std::vector<std::string> names;
  for (const Topic& topic : topics()) names.emplace_back(topic.name);
  return names;
}

Result<std::string> help_of(const std::string& topic) {
  if (const Topic* const known = find_topic(topic)) return text_of(*known);
  Result<std::string> text = explain(topic);
  if (!text)
    return error(Kind::usage, fmt::format("there is no help on '{}'{} (topics: {})", topic,
                                          did_you_mean(topic, all_help()), fmt::join(all_topics(), ", ")));
  std::string block = topic;
  std::transform(block.begin(), block.end(), block.begin(), lower);
  *text += statements_of(block) + options_of(block);
  std::string kinds;
  for (const formats::Template& one : language().templates)
    if (one.text.find("\n" + block) != std::string_view::npos) kinds += fmt::format(" {}", one.kind);
  if (!kinds.empty()) *text += fmt::format("\nTexts with it (selvage new KIND):{}\n", kinds);
  return text;
}

}  // namespace selvage::cli
