#include "pipeline/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "core/base64.h"
#include "core/number_text.h"
#include "core/text_buffer.h"
#include "core/words.h"
#include "core/xml_text.h"
#include "view/page/sources.h"

namespace selvage::pipeline {

namespace {

namespace page = view::page;

// The list under a key; an empty one where there is none.
const Json& list_at(const Json& object, const char* key) {
  static const Json none = Json::array();
  if (!object.is_object()) return none;
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : none;
}
const Json& object_at(const Json& object, const char* key) {
  static const Json none = Json::object();
  if (!object.is_object()) return none;
  const auto found = object.find(key);
  return found != object.end() && found->is_object() ? *found : none;
}

std::size_t messages_of(const Json& entry, std::string_view severity) {
  const Json& list = list_at(entry, "messages");
  return static_cast<std::size_t>(std::count_if(
      list.begin(), list.end(), [&](const Json& one) { return text_at(one, "severity") == severity; }));
}

// In the order of the page.
enum class Outcome { failed, defect, warnings, ok };
constexpr std::array<std::string_view, 4> outcome_names = {"failed", "defect", "warnings", "ok"};
Outcome outcome_of(const Json& entry) {
  if (is_true(entry, "defect")) return Outcome::defect;
  if (!is_true(entry, "ok")) return Outcome::failed;
  return messages_of(entry, "warning") > 0 ? Outcome::warnings : Outcome::ok;
}
std::string_view name_of(Outcome outcome) {
  return outcome_names[static_cast<std::size_t>(outcome)];
}

// A figure of an input.
struct Column {
  std::string_view head;
  std::optional<double> (*value)(const Json& entry);
};

std::optional<double> of_sheet(const Json& entry, const char* key) {
  const Json& sheets = object_at(entry, "sheets");
  return sheets.empty() ? std::nullopt : number_at(sheets.front(), key);
}
std::optional<double> scaled(std::optional<double> value, double factor) {
  return value ? std::optional(factor * *value) : std::nullopt;
}
std::optional<double> size_of(const Json& entry, const char* key) {
  return entry.contains(key) ? std::optional(static_cast<double>(list_at(entry, key).size())) : std::nullopt;
}

constexpr std::array all_columns = {
    Column{"Yarns", [](const Json& e) { return number_at(e, "yarn_count"); }},
    Column{"Overlaps", [](const Json& e) { return size_of(e, "overlaps"); }},
    Column{"Deepest, mm",
           [](const Json& e) {
             const Json& overlaps = list_at(e, "overlaps");
             return overlaps.empty() ? std::nullopt : number_at(overlaps.front(), "depth");
           }},
    Column{"Least gap, mm", [](const Json& e) { return number_at(e, "min_gap"); }},
    Column{"Mass, g/m²", [](const Json& e) { return of_sheet(e, "mass"); }},
    Column{"Thickness, mm", [](const Json& e) { return of_sheet(e, "thickness"); }},
    Column{"Cover, %", [](const Json& e) { return scaled(of_sheet(e, "cover"), 100); }},
    Column{"Fibres fill, %", [](const Json& e) { return scaled(of_sheet(e, "fibre_fraction"), 100); }},
    Column{"Tetrahedra", [](const Json& e) { return number_at(object_at(e, "mesh"), "tets"); }},
    Column{"Least dihedral, °",
           [](const Json& e) { return number_at(object_at(e, "mesh"), "min_dihedral"); }},
    Column{"Files", [](const Json& e) { return size_of(e, "outputs"); }},
    Column{"Seconds", [](const Json& e) { return number_at(e, "seconds"); }},
};

// Those that an input at least has.
std::vector<const Column*> used_columns(const std::vector<const Json*>& entries) {
  std::vector<const Column*> used;
  for (const Column& column : all_columns)
    if (std::any_of(entries.begin(), entries.end(),
                    [&](const Json* entry) { return column.value(*entry).has_value(); }))
      used.push_back(&column);
  return used;
}

std::string shown(double value) {
  return fmt::format("{:.4g}", value);
}
std::string shown(const Json& value) {
  if (value.is_number()) return shown(value.get<double>());
  return value.is_string() ? xml_text(value.get<std::string>()) : xml_text(text_of(value));
}

// `yarn_fraction` as one reads it.
std::string spaced(std::string_view key) {
  std::string text(key);
  std::replace(text.begin(), text.end(), '_', ' ');
  return xml_text(text);
}

// The columns of a table, as they first come: at most so many that its cells are a small multiple of its
// values, and those that are left out.
struct TableColumns {
  std::vector<std::string> keys;
  std::size_t left_out = 0;
};
TableColumns columns_of(const Json& rows) {
  constexpr std::size_t few = 16, most = 64, cells_a_value = 8;
  std::size_t values = 0;
  std::set<std::string_view> known;
  TableColumns columns;
  for (const auto& [name, row] : rows.items()) {
    values += row.size();
    for (const auto& [key, value] : row.items())
      if (known.insert(key).second && columns.keys.size() < most) columns.keys.push_back(key);
  }
  const std::size_t allowed = std::max(few, cells_a_value * values / std::max<std::size_t>(1, rows.size()));
  if (columns.keys.size() > allowed) columns.keys.resize(allowed);
  columns.left_out = known.size() - columns.keys.size();
  return columns;
}

// Rows are members of an object, which are objects, too: systems, threads.
void put_table(TextBuffer& to, std::string_view title, const Json& rows) {
  if (rows.empty()) return;
  const TableColumns columns = columns_of(rows);
  to << "<table><thead><tr><th scope=\"col\" class=\"text\">" << title << "</th>";
  for (const std::string& key : columns.keys) to << "<th scope=\"col\">" << spaced(key) << "</th>";
  to << "</tr></thead><tbody>";
  for (const auto& [name, row] : rows.items()) {
    to << "<tr><th scope=\"row\">" << xml_text(name) << "</th>";
    for (const std::string& key : columns.keys)
      to << "<td>" << (row.contains(key) ? shown(row.at(key)) : "–") << "</td>";
    to << "</tr>";
  }
  to << "</tbody></table>";
  if (columns.left_out > 0)
    to << "<p class=\"quiet\">" << counted(columns.left_out, "further figure") << " left out</p>";
}

// The numbers as the report has them: src/cli/variants.md says what they are.
void put_sheets(TextBuffer& to, const Json& sheets) {
  if (sheets.empty()) return;
  to << "<details><summary>Data sheet</summary>";
  for (const auto& [kind, sheet] : sheets.items()) {
    to << "<h3>" << spaced(kind) << "</h3><table><tbody>";
    for (const auto& [key, value] : sheet.items())
      if (!value.is_structured())
        to << "<tr><th scope=\"row\">" << spaced(key) << "</th><td>" << shown(value) << "</td></tr>";
    to << "</tbody></table>";
    put_table(to, "system", object_at(sheet, "systems"));
    put_table(to, "thread", object_at(sheet, "threads"));
  }
  to << "</details>";
}

void put_outputs(TextBuffer& to, const Json& outputs) {
  if (outputs.empty()) return;
  to << "<details><summary>" << counted(outputs.size(), "file") << "</summary><ul>";
  for (const Json& output : outputs)
    to << "<li>" << xml_text(text_at(output, "path"))
       << (number_at(output, "bytes") ? fmt::format(", {} bytes", *number_at(output, "bytes")) : "")
       << "</li>";
  to << "</ul></details>";
}

void put_picture(TextBuffer& to, const Thumbnail& picture, const std::string& path) {
  to << "<td class=\"picture\">";
  if (picture.png.empty()) {
    to << "<span class=\"quiet\">No picture: " << xml_text(picture.note) << "</span>";
  } else {
    std::string letters;
    append_base64(letters, picture.png);
    to << fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,",
                      thumbnail_width, thumbnail_height, xml_text(path))
       << letters << "\">";
  }
  to << "</td>";
}

// Errors, then warnings, then notes.
void put_messages(TextBuffer& to, const Json& entry) {
  const std::size_t errors = messages_of(entry, "error"), warnings = messages_of(entry, "warning");
  const Json& list = list_at(entry, "messages");
  to << fmt::format("<td class=\"messages\" data-value=\"{}\">", 1'000'000 * errors + warnings);
  if (!list.empty()) {
    const std::string head = errors + warnings == 0 ? counted(list.size(), "note")
                             : errors == 0          ? counted(warnings, "warning")
                             : warnings == 0        ? counted(errors, "error")
                                             : counted(errors, "error") + ", " + counted(warnings, "warning");
    // Of a few nothing is hidden.
    constexpr std::size_t few = 2;
    to << "<details" << (list.size() <= few ? " open" : "") << "><summary>" << head << "</summary><ul>";
    for (const std::string_view severity : {"error", "warning", "note"})
      for (const Json& message : list)
        if (text_at(message, "severity") == severity) {
          const std::string where = text_at(message, "where");
          to << "<li><b>" << severity << "</b> " << xml_text(text_at(message, "text"));
          if (!where.empty()) to << " <span class=\"quiet\">" << xml_text(where) << "</span>";
          to << "</li>";
        }
    to << "</ul></details>";
  }
  to << "</td>";
}

void put_row(TextBuffer& to, const Json& entry, const Thumbnail* picture,
             const std::vector<const Column*>& used) {
  const std::string path = text_at(entry, "path"), name = xml_text(path);
  const Outcome outcome = outcome_of(entry);
  to << "<tr>";
  if (picture != nullptr) put_picture(to, *picture, path);
  to << "<th scope=\"row\" data-value=\"" << name << "\">" << name;
  put_sheets(to, object_at(entry, "sheets"));
  put_outputs(to, list_at(entry, "outputs"));
  to << fmt::format("</th><td class=\"status {0}\" data-value=\"{1}\">{0}{2}</td>", name_of(outcome),
                    static_cast<int>(outcome),
                    is_true(entry, "skipped") ? "<br><span class=\"quiet\">done before</span>" : "");
  put_messages(to, entry);
  for (const Column* column : used) {
    const std::optional<double> value = column->value(entry);
    if (value)
      to << "<td data-value=\"" << *value << "\">" << shown(*value) << "</td>";
    else
      to << "<td></td>";
  }
  to << "</tr>\n";
}

void put_head(TextBuffer& to, bool has_pictures, const std::vector<const Column*>& used) {
  const auto put = [&](std::string_view text, bool is_text, std::string_view more = {}) {
    to << "<th scope=\"col\"" << (is_text ? " class=\"text\"" : "") << more << "><button type=\"button\">"
       << text << "</button></th>";
  };
  if (has_pictures) to << "<th scope=\"col\" class=\"text\"><span class=\"unseen\">Picture</span></th>";
  put("Input", true);
  put("Status", true, " aria-sort=\"ascending\"");
  put("Messages", true);
  for (const Column* column : used) put(column->head, false);
}

std::string title_of(const std::vector<const Json*>& entries) {
  std::array<std::size_t, outcome_names.size()> counts{};
  for (const Json* entry : entries) ++counts[static_cast<std::size_t>(outcome_of(*entry))];
  const auto count = [&](Outcome outcome) { return counts[static_cast<std::size_t>(outcome)]; };
  std::string text = counted(entries.size(), "input");
  const char* mark = ": ";
  const auto add = [&](Outcome outcome, std::string_view what) {
    if (count(outcome) == 0) return;
    text += fmt::format("{}{} {}", mark, count(outcome), what);
    mark = ", ";
  };
  add(Outcome::failed, "failed");
  add(Outcome::defect, "with defects");
  add(Outcome::warnings, "with warnings");
  add(Outcome::ok, "ok");
  return text;
}

std::string facts_of(const Json& report) {
  std::string text = "Selvage " + text_at(report, "selvage");
  if (const std::string started = text_at(report, "started"); !started.empty())
    text += "  ·  begun " + started;
  if (const std::optional<double> seconds = number_at(report, "seconds"))
    text += fmt::format("  ·  {:.3g} s", *seconds);
  return text;
}

}  // namespace

std::vector<const Json*> entries_in_order(const Json& report) {
  std::vector<const Json*> entries;
  for (const Json& entry : list_at(report, "inputs")) entries.push_back(&entry);
  std::ranges::stable_sort(entries, {}, [](const Json* entry) { return outcome_of(*entry); });
  return entries;
}

Status write_report_page(const Json& report, const std::vector<const Json*>& entries,
                         const std::vector<Thumbnail>& pictures, OutputFile& file) {
  const std::vector<const Column*> used = used_columns(entries);
  TextBuffer text(file);
  page::fill(text, page::report_html(), [&](std::string_view slot) {
    if (slot == "title")
      text << xml_text(title_of(entries));
    else if (slot == "facts")
      text << xml_text(facts_of(report));
    else if (slot == "css")
      text << page::palette_css() << page::report_css();
    else if (slot == "script")
      text << page::report_js();
    else if (slot == "head")
      put_head(text, !pictures.empty(), used);
    else if (slot == "rows")
      for (std::size_t k = 0; k < entries.size(); ++k)
        put_row(text, *entries[k], pictures.empty() ? nullptr : &pictures[k], used);
  });
  return text.finish();
}

}  // namespace selvage::pipeline
