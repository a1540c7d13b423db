#include "formats/txt/reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/number_text.h"
#include "fabric/inside.h"
#include "formats/txt/blocks.h"
#include "formats/txt/pitch.h"

namespace selvage::formats::txt {

namespace {

using fabric::Cell;
using fabric::Edit;
using fabric::Fabric;

constexpr int newest_version = 1;

// --- header
// ---------------------------------------------------------------------------------------------------------

void read_repeated_version(Parser& p, Fabric&, std::string_view) {
  p.error(p.statement(), "'fabric' is the first statement of a file, and its only one of this name");
}

// Written in full, in either spelling and number.
std::optional<Unit> unit_by_name(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, Unit>, 15> names = {{{"millimetre", Unit::mm},
                                                                        {"millimeter", Unit::mm},
                                                                        {"centimetre", Unit::cm},
                                                                        {"centimeter", Unit::cm},
                                                                        {"metre", Unit::m},
                                                                        {"meter", Unit::m},
                                                                        {"micrometre", Unit::um},
                                                                        {"micrometer", Unit::um},
                                                                        {"micron", Unit::um},
                                                                        {"\xC2\xB5m", Unit::um},
                                                                        {"\xCE\xBCm", Unit::um},
                                                                        {"in", Unit::inch},
                                                                        {"inches", Unit::inch},
                                                                        {"zoll", Unit::inch},
                                                                        {"\"", Unit::inch}}};
  const bool is_plural = word.size() > 2 && lower(word.back()) == 's';
  for (const auto& [name, unit] : names)
    if (same_word(name, word) || (is_plural && same_word(name, word.substr(0, word.size() - 1)))) return unit;
  return std::nullopt;
}

void read_units(Parser& p, Fabric& fabric, std::string_view) {
  std::optional<Unit> units = unit_by_name(p.peek_word());
  if (units)
    p.take_word();
  else
    units = p.choice("unit", unit_words);
  if (!p.finish()) return;
  if (!p.scope().set_unit(*units))
    return p.error(p.statement(),
                   "numbers above this line have units or are expressions, and need to know the "
                   "file's unit: move this line above them");
  fabric.units = *units;
  fabric.units_given = true;
}

// --- params
// ---------------------------------------------------------------------------------------------------------

// The value that is set from outside instead of the text's own.
std::optional<double> value_of_setting(Parser& p, const fabric::Setting& setting, const Spot& spot) {
  const std::string& text = setting.value;
  const std::size_t dash = text.find('-', 1);
  const auto low = dash == std::string::npos ? std::nullopt : read_number(text.substr(0, dash));
  const auto high = low ? read_number(text.substr(dash + 1)) : std::nullopt;
  if (high && *high > *low) {
    constexpr double steps = 3;
    p.error(spot,
            fmt::format(
                "--set {0}={1}: a difference, {2}; 'selvage sweep' takes a range as {0}={3}:{4}:{5} (from, "
                "to, step), and a difference is written ({1})",
                setting.name, text, number_text(*low - *high), number_text(*low), number_text(*high),
                number_text((*high - *low) / steps)));
    return std::nullopt;
  }
  std::optional<Result<double>> value = p.scope().value(setting.value, Measure::any);
  if (value && value->ok()) return **value;
  const std::string why = value ? value->error().text : in_quotes(setting.value) + " is not a number";
  p.error(spot, fmt::format("--set {}: {}", setting.name, why));
  return std::nullopt;
}

void read_param(Parser& p, Fabric&, std::string_view) {
  const auto name = p.name("the param's name");
  const Spot spot = p.last();
  if (name && !is_identifier(*name))
    return p.error(spot, fmt::format("{} cannot stand in an expression: a param's name consists of letters, "
                                     "digits and '_'",
                                     in_quotes(*name)));
  if (name && is_reserved(*name))
    return p.error(spot, fmt::format("{} is a word of the language or a unit: the param needs another name, "
                                     "such as {}_1",
                                     in_quotes(*name), *name));
  std::string_view text = p.peek_word();
  std::optional<double> value = p.number("the param's value", Measure::any);
  p.finish();
  if (!name) return;
  for (const fabric::Setting& setting : p.settings) {
    if (setting.name != *name) continue;
    text = setting.value;
    value = value_of_setting(p, setting, spot);
  }
  // One that is wrong is known nevertheless: that was told.
  if (const auto line = p.scope().define(*name, value.value_or(1.0), p.scope().is_count(text), spot.line))
    p.error(spot, fmt::format("the param {} is there twice; first on line {}", in_quotes(*name), *line));
}

void check_settings(Parser& p) {
  if (p.is_stopped() || p.report.errors() > 0) return;
  const std::vector<std::string_view> known = p.scope().names();
  for (const fabric::Setting& setting : p.settings) {
    if (std::find(known.begin(), known.end(), setting.name) != known.end()) continue;
    std::string hint = did_you_mean(setting.name, known);
    if (hint.empty())
      hint = known.empty() ? "; it has none (param NAME VALUE)"
                           : fmt::format("; it has: {}", fmt::join(known, ", "));
    p.error(Spot(), fmt::format("--set {}: the text has no such param{}", setting.name, hint));
  }
}

// --- cell
// -----------------------------------------------------------------------------------------------------------

void read_periodic(Parser& p, Cell& cell, std::string_view) {
  do {
    const auto axis = p.choice("axis", axis_words);
    if (!axis) return;
    bool& is_periodic = cell.periodic[static_cast<std::size_t>(*axis)];
    if (is_periodic) p.error(p.last(), "this axis is named twice");
    is_periodic = true;
  } while (p.more());
}

// --- file
// -----------------------------------------------------------------------------------------------------------

const Table<Fabric>& file_table() {
  static const Table<Fabric> table(
      {{"title", into(&Fabric::title, [](Parser& p) { return p.name("the title", true); })},
       {"units", read_units},
       {"param", read_param, Times::any},
       {"tolerance", into(&Fabric::tolerance, a_length("the tolerance"))},
       {"thread", read_thread, Times::any},
       {"material", read_material, Times::any},
       {"outline", read_outline, Times::any},
       {"yarn", read_yarn, Times::any},
       {"weave", read_weave, Times::any},
       {"knit", read_knit, Times::any},
       {"warpknit", read_warpknit, Times::any},
       {"braid", read_braid, Times::any},
       {"piece", read_piece, Times::any},
       {"block", read_block_of_yarns, Times::any},
       {"use", read_use, Times::any},
       {"edit", read_edit, Times::any},
       {"cell", read_cell},
       {"fabric", read_repeated_version, Times::any}});
  return table;
}

// Nothing that could be read as text at all: one error says so. False: there is none.
bool refuse_binary(const Source& source, TextReport& report) {
  const std::string_view bytes = source.bytes();
  const Spot begin;
  if (bytes.empty()) {
    report.error(begin, "the file is empty; a fabric begins with the line 'fabric 1'");
    return true;
  }
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    report.error(begin, "the file is UTF-16 text; save it as UTF-8");
    return true;
  }
  // Bytes above 127 may be an old encoding's letters in a comment; control characters are in no text.
  const std::string_view head = bytes.substr(0, 4096);
  const auto is_control = [](char c) {
    return (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F;
  };
  if (std::none_of(head.begin(), head.end(), is_control)) return false;
  Spot spot;
  const std::size_t mark = head.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (spot.offset = mark; spot.offset < head.size();) {
    spot = spot.behind(text_prefix(head.substr(spot.offset)));
    if (spot.offset == head.size() || (head[spot.offset] != '\n' && head[spot.offset] != '\r')) break;
    spot = head[spot.offset] == '\n' ? Spot{spot.offset + 1, spot.line + 1, 1} : spot.behind(1);
  }
  report.error(spot, "this is not a text file; a fabric is a text that begins with the line 'fabric 1'");
  return true;
}

// The first statement. False: the rest is not worth reading.
bool read_version(Parser& p) {
  const Spot spot = p.statement();
  const std::string_view word = p.peek_word();
  if (same_word(word, "fabric")) {
    p.take_word();
  } else {
    const std::string meant = did_you_mean(word, {"fabric"});
    p.error(spot,
            fmt::format("the first statement of a file is 'fabric 1', found {}{}", in_quotes(word), meant));
    const std::vector<std::string_view>& known = file_table().words;
    if (std::any_of(known.begin(), known.end(), [&](auto k) { return same_word(k, word); })) {
      p.reread();
      return true;
    }
    if (meant.empty()) return false;
    p.take_word();
  }
  const auto version = p.count("the version of the language (write 'fabric 1')");
  if (!p.finish() || *version <= newest_version) return true;
  p.report.error(p.last(),
                 fmt::format("version {} of the language is newer than this program, which knows version {}",
                             *version, newest_version),
                 Kind::unsupported);
  return false;
}

}  // namespace

void read_edit(Parser& p, fabric::Fabric& fabric, std::string_view) {
  Edit edit;
  edit.place = p.statement().place();
  const auto yarn = p.reference(p.yarns);
  edit.form = p.choice("edit", edit_words).value_or(Edit::Form::point);
  const bool is_length = edit.form == Edit::Form::length;
  if (is_length) {
    edit.length = p.positive("the length", Measure::length).value_or(0.0);
    p.expect("point");
  }
  const auto joint = p.count("the number of the joint");
  p.expect(is_length ? "along" : "to");
  const auto vector = is_length ? p.direction("the direction") : p.point("the target");
  if (!p.finish()) return;
  edit.yarn = *yarn;
  edit.joint = *joint;
  (is_length ? edit.direction : edit.target) = *vector;
  fabric.edits.push_back(std::move(edit));
}

void read_block_of_yarns(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Fabric> table({{"tolerance", into(&Fabric::tolerance, a_length("the tolerance"))},
                                    {"thread", read_thread, Times::any},
                                    {"material", read_material, Times::any},
                                    {"outline", read_outline, Times::any},
                                    {"yarn", read_yarn, Times::any},
                                    {"weave", read_weave, Times::any},
                                    {"knit", read_knit, Times::any},
                                    {"warpknit", read_warpknit, Times::any},
                                    {"braid", read_braid, Times::any},
                                    {"block", read_block_of_yarns, Times::any},
                                    {"use", read_use, Times::any},
                                    {"edit", read_edit, Times::any}});
  fabric::NamedBlock block;
  const Spot opened = p.statement();
  block.place = opened.place();
  block.name = p.new_name(p.blocks).value_or("");
  p.finish();
  constexpr int deepest = 32;
  if (p.nesting() == deepest) {
    p.report.error(opened, fmt::format("blocks stand in each other at most {} deep", deepest), Kind::limit);
    return p.stop();
  }
  block.fabric = std::make_shared<Fabric>();
  const int errors = p.report.errors();
  bool is_closed = false;
  p.with_own_names([&] { is_closed = p.read_block(word, block.name, opened, table, *block.fabric); });
  if (is_closed && p.report.errors() == errors && block.fabric->items.empty())
    p.error(p.last(), fmt::format("the block {} is empty: it has no yarns", in_quotes(block.name)));
  fabric.blocks.push_back(std::move(block));
}

void read_cell(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Cell> table({{"matrix", into(&Cell::matrix, a_reference(&Parser::materials))},
                                  {"periodic", read_periodic},
                                  {"margin", read_margin_of_cell}});
  Cell cell;
  const Spot opened = p.statement();
  cell.place = opened.place();
  if (same_word(p.peek_word(), "repeat")) {
    read_repeats_of_cell(p, cell);
    p.read_block(word, "", opened, table, cell);
    fabric.cell = std::move(cell);
    return;
  }
  if (same_word(p.peek_word(), "vectors")) {
    read_vectors_of_cell(p, cell, opened);
    p.read_block(word, "", opened, table, cell);
    fabric.cell = std::move(cell);
    return;
  }
  const auto one = p.point("a corner of the cell");
  const auto other = p.point("the opposite corner of the cell");
  if (other) {
    cell.low = one->cwiseMin(*other);
    cell.high = one->cwiseMax(*other);
    if ((cell.low.array() == cell.high.array()).any()) p.error(opened, "the cell has no volume");
    p.finish();
  }
  p.read_block(word, "", opened, table, cell);
  fabric.cell = std::move(cell);
}

namespace {

// A pitch that nobody means without a word: 24 where 24/cm was meant.
void check_pitch(Parser& p, std::span<const Fabric* const> inside, const fabric::WeaveSystem& system) {
  const auto found = p.pitches.find(system.place.line);
  const double width = width_of_threads(inside, system.threads);
  if (found == p.pitches.end() || found->second.is_open || !(width > 0.0)) return;
  const double widths = system.pitch / width;
  if (!(widths > max_pitch_in_widths)) return;
  const PitchText& pitch = found->second;
  const std::size_t digits = pitch.text.find_first_not_of("0123456789.");
  const std::string number = pitch.text.substr(0, digits);
  const std::string_view unit = inside.front()->units == Unit::inch ? "in" : "cm";
  const std::string by_length =
      number.empty() || pitch.text.find('/') != std::string::npos
          ? std::string()
          : fmt::format("for {0} yarns on a length write '{0}/{1}'; ", number, unit);
  p.error(pitch.spot,
          fmt::format("the pitch {} is {} times the width of the yarn, {:.3g} {}: {}for a cloth as open "
                      "as this write '{} open'",
                      in_quotes(pitch.text),
                      widths < 1e6 ? fmt::format("{:.0f}", widths) : fmt::format("{:.2g}", widths), width,
                      name_of(inside.front()->units), by_length, pitch.text));
}

void check_pitches(Parser& p, std::vector<const Fabric*>& inside) {
  for (const fabric::Item& item : inside.back()->items)
    if (const auto* const weave = std::get_if<fabric::Weave>(&item)) {
      check_pitch(p, inside, weave->warp);
      check_pitch(p, inside, weave->weft);
    }
  for (const fabric::NamedBlock& block : inside.back()->blocks) {
    inside.push_back(block.fabric.get());
    check_pitches(p, inside);
    inside.pop_back();
  }
}

std::optional<Fabric> read(const Source& source, std::span<const fabric::Setting> settings,
                           TextReport& report) {
  if (refuse_binary(source, report)) return std::nullopt;
  Parser p(source, report);
  p.settings = settings;
  p.fabric.file = source.name();
  if (!p.next_statement()) {
    if (report.errors() == 0)
      p.error(Spot(), "the file has no statement; a fabric begins with the line 'fabric 1'");
  } else if (read_version(p)) {
    p.read_block("", "", p.statement(), file_table(), p.fabric);
    p.check_references();
    p.fabric.tell_threads_their_materials();
    check_settings(p);
    std::vector<const Fabric*> inside = {&p.fabric};
    if (report.errors() == 0) check_pitches(p, inside);
    if (report.errors() == 0)
      if (const Status fits = fabric::check_uses(p.fabric); !fits)
        report.error(spot_at(source, fits.error().place), fits.error().text, fits.error().kind);
  }
  return std::move(p.fabric);
}

}  // namespace

std::optional<Fabric> read_fabric(const Source& source, Diagnostics& diagnostics) {
  return read_fabric_with(source, {}, diagnostics);
}

std::optional<Fabric> read_fabric_with(const Source& source, const std::vector<fabric::Setting>& settings,
                                       Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [&](const Source& text, TextReport& report) { return read(text, settings, report); });
}

bool is_fabric_txt(std::string_view head) {
  const Source source = Source::from_memory(std::string(head));
  TextReport report(source);
  Cursor cursor(source, report);
  if (!cursor.next_statement() || !same_word(cursor.take_word(), "fabric")) return false;
  const std::string_view version = cursor.take_word();
  return !version.empty() &&
         std::all_of(version.begin(), version.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace selvage::formats::txt
