// Directory entries, field by field.
#include <fmt/format.h>

#include <algorithm>

#include "core/text_report.h"
#include "formats/iges/structure_file.h"

namespace selvage::formats::iges::structure {

namespace {

// Which forms a type has, where the standard lists few.
struct Forms {
  int type, first, last;
};
constexpr Forms forms[] = {{100, 0, 0},  {102, 0, 0}, {104, 0, 3}, {108, -1, 1}, {110, 0, 2}, {112, 0, 0},
                           {114, 0, 0},  {116, 0, 0}, {118, 0, 1}, {120, 0, 0},  {122, 0, 0}, {123, 0, 0},
                           {124, 0, 12}, {126, 0, 5}, {128, 0, 9}, {130, 0, 0},  {140, 0, 0}, {141, 0, 0},
                           {142, 0, 0},  {143, 0, 0}, {144, 0, 0}, {186, 0, 0},  {190, 0, 1}, {192, 0, 1},
                           {194, 0, 1},  {196, 0, 1}, {198, 0, 1}, {308, 0, 0},  {314, 0, 0}, {408, 0, 0},
                           {502, 1, 1},  {504, 1, 1}, {508, 0, 1}, {510, 1, 1},  {514, 1, 2}};

// Fields from 0 on both lines together; the sequence number, the tenth of each, is not among them.
constexpr int type_field = 0, parameters_field = 1, structure_field = 2, font_field = 3, level_field = 4,
              view_field = 5, matrix_field = 6, labels_field = 7, status_field = 8, type_again = 9,
              weight_field = 10, color_field = 11, count_field = 12, form_field = 13, label_field = 16,
              subscript_field = 17;

class EntryCheck {
 public:
  EntryCheck(const RawLine& first, const RawLine& second, int de, Findings& findings)
      : first_(first), second_(second), findings_(findings) {
    entry_.de = de;
    entry_.line = &first;
    entry_.second = &second;
  }

  Entry run() {
    entry_.type = integer(type_field);
    entry_.first = integer(parameters_field);
    entry_.level = integer(level_field);
    entry_.matrix = integer(matrix_field);
    entry_.color = integer(color_field);
    entry_.count = integer(count_field);
    entry_.form = integer(form_field);
    for (const int i : {structure_field, font_field, view_field, labels_field, weight_field, subscript_field})
      integer(i);
    if (integer(type_again) != entry_.type)
      defect(type_again, fmt::format("the second line is of type {}", integer(type_again)));
    if (integer(weight_field) < 0) defect(weight_field, "a negative line weight");
    if (entry_.color > 8)
      defect(color_field, fmt::format("there is no colour {}: they are 0 to 8", entry_.color));
    check_status();
    const auto* const known = std::find_if(std::begin(forms), std::end(forms),
                                           [&](const Forms& row) { return row.type == entry_.type; });
    if (known != std::end(forms) && (entry_.form < known->first || entry_.form > known->last))
      defect(form_field, fmt::format("type {} has no form {}", entry_.type, entry_.form));
    return entry_;
  }

 private:
  // BBSSUUHH
  void check_status() {
    const std::string_view field = text(status_field);
    if (field.size() != 8) return;  // the line's length was told
    std::array<int, 4> parts{};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::optional<int> part = field_number(field.substr(2 * i, 2));
      if (!part || *part < 0) {
        defect(status_field, fmt::format("status {} is not of eight digits", in_quotes(field)));
        return;
      }
      parts[i] = *part;
    }
    constexpr std::array<int, 4> most = {1, 3, 6, 2};
    constexpr std::array<std::string_view, 4> words = {"blank", "subordinate", "use", "hierarchy"};
    for (std::size_t i = 0; i < 4; ++i)
      if (parts[i] > most[i])
        defect(status_field,
               fmt::format("status {}: the {} part is 00 to 0{}", in_quotes(field), words[i], most[i]));
    entry_.subordinate = parts[1];
    entry_.use = parts[2];
  }

  [[nodiscard]] const RawLine& line(int field) const { return field < type_again ? first_ : second_; }
  static std::size_t column(int field) {
    return 8 * static_cast<std::size_t>(field < type_again ? field : field - type_again) + 1;
  }
  [[nodiscard]] std::string_view text(int field) const {
    return line(field).columns(column(field), column(field) + 7);
  }
  int integer(int field) {
    const std::optional<int> value = field_number(text(field));
    if (!value) defect(field, fmt::format("{} is no integer", in_quotes(text(field))));
    return value.value_or(0);
  }
  void defect(int field, const std::string& what) {
    const int number =
        field < type_again ? field + 1 : field + 2;  // fields 10 and 20 are the sequence numbers
    findings_.defect("faults of directory entries",
                     fmt::format("{}: {} (directory field {})", entry_.name(), what, number),
                     line(field).place(static_cast<int>(column(field))));
  }

  const RawLine &first_, &second_;
  Findings& findings_;
  Entry entry_;
};

// A field that points: to an entity of a type.
void check_pointer(const Directory& directory, const Entry& entry, int pointer,
                   std::initializer_list<int> types, std::string_view what, TextPlace place,
                   Findings& findings) {
  if (pointer == 0) return;
  const Entry* target = directory.at(pointer);
  if (target == nullptr)
    findings.defect(
        "pointers to nowhere",
        fmt::format("{}: the {} points to {}, where no directory entry begins", entry.name(), what, pointer),
        place);
  else if (std::find(types.begin(), types.end(), target->type) == types.end())
    findings.defect("pointers to entities of another type",
                    fmt::format("{}: the {} points to a {}", entry.name(), what, target->name()), place);
}

void check_matrices(const Directory& directory, const Entry& entry, Findings& findings) {
  const Entry* at = directory.at(entry.matrix);
  for (std::size_t steps = 0; at != nullptr; at = directory.at(at->matrix))
    if (at == &entry || ++steps > directory.entries.size()) {
      findings.defect("transformations in a circle",
                      fmt::format("{}: its transformations go in a circle", entry.name()),
                      entry.line->place(49));
      return;
    }
}

}  // namespace

Directory check_directory(const RawFile& file, Findings& findings) {
  const Section& lines = file.directory();
  Directory directory;
  directory.entries.reserve(lines.size() / 2);
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2)
    directory.entries.push_back(EntryCheck(lines[i], lines[i + 1], static_cast<int>(i) + 1, findings).run());
  if (lines.size() % 2 != 0)
    findings.defect("faults of directory entries", "the last directory entry has one line; two are due",
                    lines.back().place());
  for (const Entry& entry : directory.entries) {
    const auto field = [&](std::size_t first) {
      return field_number(entry.line->columns(first, first + 7)).value_or(0);
    };
    check_pointer(directory, entry, entry.matrix, {124}, "transformation", entry.line->place(49), findings);
    check_pointer(directory, entry, std::min(entry.color, 0) * -1, {314}, "colour", entry.second->place(17),
                  findings);
    check_pointer(directory, entry, std::min(entry.level, 0) * -1, {406}, "level", entry.line->place(33),
                  findings);
    check_pointer(directory, entry, std::min(field(25), 0) * -1, {304}, "line font", entry.line->place(25),
                  findings);
    check_pointer(directory, entry, field(41), {410, 402}, "view", entry.line->place(41), findings);
    if (entry.matrix != 0) check_matrices(directory, entry, findings);
  }
  return directory;
}

}  // namespace selvage::formats::iges::structure
