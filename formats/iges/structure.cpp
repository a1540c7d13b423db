#include "formats/iges/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "core/words.h"
#include "formats/iges/standard.h"
#include "formats/iges/structure_numbers.h"

namespace selvage::formats::iges {

namespace {

// What a pointer of the directory or of a record leads to; it is not negative. Null for nothing.
const DirectoryEntry* target_of(const File& file, int pointer) {
  return pointer > 0 ? file.entity(pointer) : nullptr;
}

// The fields of the directory that point, and parameter records: whose lines they are, their values, and what
// they point to.
class StructureCheck {
 public:
  StructureCheck(const File& file, Findings& findings)
      : file_(file),
        findings_(findings),
        there_(file.lines().count(Section::parameter)),
        owner_(static_cast<std::size_t>(there_) + 1, 0),
        part_(file.directory().size(), false) {
    bounds_.resolution = file.global().stated_resolution;
  }

  void run() {
    for (const DirectoryEntry& entry : file_.directory()) check_pointers(entry);
    for (const DirectoryEntry& entry : file_.directory())
      if (entry.type != 0) check(entry);
    for (int line = 1; line <= there_; ++line)
      if (owner(line) == 0)
        findings_.defect("no directory entry has this parameter line", spot(line).place());
    check_subordinates();
    check_bounds();
  }

 private:
  void check_pointers(const DirectoryEntry& entry) {
    check_pointer(entry, 7, entry.transformation, {124}, "transformation");
    check_pointer(entry, 13, -std::min(entry.color, 0), {314}, "colour");
    check_pointer(entry, 5, -std::min(entry.level, 0), {406}, "level");
    check_pointer(entry, 4, -std::min(entry.font, 0), {304}, "line font");
    check_pointer(entry, 6, entry.view, {410, 402}, "view");
    const DirectoryEntry* at = target_of(file_, entry.transformation);
    for (std::size_t steps = 0; at != nullptr; at = target_of(file_, at->transformation))
      if (at == &entry || ++steps > file_.directory().size()) {
        defect(entry, file_.spot(entry, 7), "its transformations go in a circle");
        return;
      }
  }
  void check_pointer(const DirectoryEntry& entry, int field, int pointer, std::initializer_list<int> types,
                     std::string_view what) {
    if (pointer == 0) return;
    const DirectoryEntry* const target = target_of(file_, pointer);
    if (target == nullptr)
      defect(entry, file_.spot(entry, field),
             fmt::format("the {} points to {}, where no directory entry begins", what, pointer));
    else if (std::find(types.begin(), types.end(), target->type) == types.end())
      defect(entry, file_.spot(entry, field), fmt::format("the {} points to a {}", what, target->name()));
  }

  void check(const DirectoryEntry& entry) {
    if (entry.first_line < 1 || entry.first_line > there_) {
      defect(entry, file_.spot(entry, 2),
             fmt::format("its parameters are said to begin on line P{}, of {}", entry.first_line, there_));
      return;
    }
    if (entry.line_count < 1) {
      defect(entry, file_.spot(entry, 14), fmt::format("a count of {} parameter lines", entry.line_count));
      return;
    }
    const int last = claim(entry);
    const Values values(
        Parameters(file_.lines(), Section::parameter, entry.first_line, last, file_.global().delimiters));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i].is_broken) defect(entry, values.spot(i), broken_number(values[i].text));
    if (values.flaw()) defect(entry, values.flaw()->spot, values.flaw()->text);
    if (values.failure()) {
      defect(entry, values.failure()->spot, values.failure()->text);
      return;
    }
    if (values.last_line() < last)
      defect(entry, file_.spot(entry, 14),
             fmt::format("{} parameter lines are counted, and the record ends on the {}. of them",
                         entry.line_count, values.last_line() - entry.first_line + 1));
    if (values.integer(0).value_or(-1) != entry.type)
      defect(entry, values.spot(0), fmt::format("its parameters begin with {}", in_quotes(values[0].text)));
    else
      check_values(entry, values);
  }

  // Marks the entry's lines; each must point back. Gives the last one that is there and its own.
  int claim(const DirectoryEntry& entry) {
    const int first = entry.first_line, counted = entry.line_count;
    for (int i = 0; i < counted; ++i) {
      const int line = first + i;
      if (line > there_) {
        defect(entry, file_.spot(entry, 14),
               fmt::format("{} parameter lines are counted, and there are {}", counted, i));
        return there_;
      }
      const std::string_view text = file_.owner_text(line).substr(1);
      const std::optional<int> back = column_number(text);
      if (back != entry.pointer) {
        defect(entry, spot(line, 66),
               fmt::format("its parameter line points back to {} (columns 66-72)", in_quotes(text)));
        const bool is_others = owner(line) != 0 || (back && target_of(file_, *back) != nullptr);
        if (is_others && i > 0) return line - 1;
      }
      if (owner(line) != 0)
        defect(entry, spot(line), fmt::format("the line belongs to D{} too", owner(line)));
      owner(line) = entry.pointer;
    }
    int last = first + counted - 1;
    const auto is_next_own = [&] { return last < there_ && file_.owner_of(last + 1) == entry.pointer; };
    if (is_next_own())
      defect(entry, file_.spot(entry, 14),
             fmt::format("{} parameter lines are counted, and the next one belongs to it too", counted));
    while (is_next_own()) owner(++last) = entry.pointer;
    return last;
  }

  void check_values(const DirectoryEntry& entry, const Values& values) {
    const bool is_known = entry.type < 200 || entry.type == 314 || entry.type >= 500;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i].is_small) defect(entry, values.spot(i), "the h behind a string's length is small");
      if (is_known && !values[i].is_string && !values.real(i))
        defect(entry, values.spot(i), fmt::format("{} is no number", in_quotes(values[i].text)));
    }
    const References references = references_of(entry, values);
    const bool has_numbers = entry.type == 126 || entry.type == 128 || entry.type == 124;
    // The normal of a planar curve, the last three values: nobody needs them.
    if (entry.type == 126 && references.own && values.size() + 3 == *references.own)
      findings_.warning(fmt::format("{}: {} values; {} are due: the plane's normal is missing", entry.name(),
                                    values.size() - 1, *references.own - 1),
                        values.spot(values.size() - 1).place());
    else if (has_numbers && (!references.own || values.size() < *references.own)) {
      defect(entry, values.spot(values.size() - 1),
             references.own ? fmt::format("{} values; {} are due", values.size() - 1, *references.own - 1)
                            : std::string("a count that the record cannot hold"));
      return;
    }
    for (const References::Reference& reference : references.all) check(entry, values, reference);
    if (references.own) check_trailer(entry, values, *references.own);
    if (entry.type == 126) check_curve(entry, values, bounds_, findings_);
    if (entry.type == 128) check_surface(entry, values, bounds_, findings_);
    if (entry.type == 124) check_matrix(entry, values, findings_);
    if (entry.type == 314) check_color(entry, values, findings_);
  }

  void check(const DirectoryEntry& entry, const Values& values, const References::Reference& reference) {
    const DirectoryEntry* const target = file_.entity(reference.pointer);
    const Spot spot = values.spot(reference.value);
    if (target == nullptr || target->type == 0) {
      defect(entry, spot, fmt::format("points to {}, where no directory entry begins", reference.pointer));
      return;
    }
    if (target == &entry) {
      defect(entry, spot, "points to itself");
      return;
    }
    if (!may_point(reference.to, target->type))
      defect(entry, spot, fmt::format("points to a {}", target->name()));
    if (entry.type != 402 && entry.type != 308 && entry.type != 408)
      part_[static_cast<std::size_t>(target->pointer / 2)] = true;
  }

  // Behind its own values: associativities, then properties.
  void check_trailer(const DirectoryEntry& entry, const Values& values, std::size_t at) {
    for (int list = 0; list < 2 && at < values.size(); ++list) {
      const std::optional<int> count = values.integer(at);
      if (!count || *count < 0 || static_cast<std::size_t>(*count) > values.size() - at - 1) {
        defect(entry, values.spot(at),
               fmt::format("{} where the number of {} is due", in_quotes(values[at].text),
                           list == 0 ? "associativities" : "properties"));
        return;
      }
      const std::size_t behind = at + 1 + static_cast<std::size_t>(*count);
      while (++at < behind) {
        const int pointer = values.integer(at).value_or(0);
        const DirectoryEntry* const target = target_of(file_, pointer);
        if (target == nullptr)
          defect(entry, values.spot(at),
                 fmt::format("points to {}, where no directory entry begins", pointer));
        else if (list == 1 && target->type != 406 && target->type != 422 && target->type != 316)
          defect(entry, values.spot(at), fmt::format("a property that is a {}", target->name()));
      }
    }
    check_rest(entry, values, at);
  }

  // Behind the trailer there is nothing. ANSYS writes one zero more behind its points.
  void check_rest(const DirectoryEntry& entry, const Values& values, std::size_t at) {
    if (at >= values.size()) return;
    bool is_empty = true;
    for (std::size_t i = at; i < values.size(); ++i) is_empty = is_empty && values.integer(i) == 0;
    const std::size_t count = values.size() - at;
    if (is_empty)
      findings_.warning(fmt::format("{}: {} too many at the end", entry.name(), counted(count, "zero")),
                        values.spot(at).place());
    else
      defect(entry, values.spot(at), fmt::format("{} too many", counted(count, "value")));
  }

  // Receivers take the status field at its word: what is said to be independent is shown by itself.
  void check_subordinates() {
    for (const DirectoryEntry& entry : file_.directory()) {
      const bool is_geometry = entry.type >= 100 && entry.type < 200 && entry.type != 124 &&
                               entry.type != 116 && entry.type != 123;
      if (is_geometry && part_[static_cast<std::size_t>(entry.pointer / 2)] &&
          !entry.is_physically_dependent())
        findings_.warning(
            fmt::format("{}: it is part of another entity, and its status says that it is independent: some "
                        "systems show it by itself",
                        entry.name()),
            file_.spot(entry, 9).place());
    }
  }

  void check_bounds() {
    const Global& global = file_.global();
    const double found = bounds_.largest_found, resolution = bounds_.resolution;
    if (found <= 0) return;
    const bool moved =
        std::any_of(file_.directory().begin(), file_.directory().end(),
                    [](const DirectoryEntry& entry) { return entry.type == 124 || entry.type == 408; });
    if (!moved && global.largest > 0 && found > global.largest * (1 + 1e-12))
      findings_.warning(
          fmt::format("the largest coordinate is said to be {} (global parameter 20); {} has {}",
                      global.largest, bounds_.largest_entity, found),
          global.largest_spot.place());
    if (resolution > 0.01 * found)
      findings_.warning(
          fmt::format("the resolution is said to be {} (global parameter 19), and no coordinate "
                      "is larger than {}: readers that merge what is nearer than the resolution "
                      "lose the shape",
                      resolution, found),
          global.resolution_spot.place());
    if (resolution > 0 && resolution < 1e-17 * found)
      findings_.warning(fmt::format("the resolution is said to be {} (global parameter 19), finer than the "
                                    "numbers of the file can be",
                                    resolution),
                        global.resolution_spot.place());
  }

  [[nodiscard]] Spot spot(int line, int column = 1) const {
    return file_.lines().line(Section::parameter, line).spot(column);
  }
  int& owner(int line) { return owner_[static_cast<std::size_t>(line)]; }
  void defect(const DirectoryEntry& entry, const Spot& spot, const std::string& what) {
    findings_.defect(entry.name() + ": " + what, spot.place());
  }

  const File& file_;
  Findings& findings_;
  int there_;               // parameter lines
  std::vector<int> owner_;  // of each of them, from 1
  std::vector<bool> part_;  // of each entry: another one is made of it
  Bounds bounds_;
};

}  // namespace

void check_structure(const Source& source, Findings& findings) {
  Complaints complaints(findings);
  const std::optional<File> file = File::open(source, complaints);
  if (!file) return;
  StructureCheck(*file, findings).run();
}

}  // namespace selvage::formats::iges
