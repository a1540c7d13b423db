// Parameter records: whose lines they are, their values, and what they point to.
#include <fmt/format.h>

#include <algorithm>

#include "core/text_report.h"
#include "formats/iges/structure_file.h"

namespace selvage::formats::iges::structure {

namespace {

constexpr std::size_t width = 64;

using Types = std::initializer_list<int>;
constexpr Types curves = {100, 102, 104, 106, 110, 112, 126, 130};
constexpr Types surfaces = {108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198};

// A cursor over the own values of an entity that notes which of them point where.
class References {
 public:
  struct Reference {
    int pointer = 0;
    std::size_t value = 0;  // index in the record
    const Types* types = nullptr;
  };

  References(const Entry& entry, const Record& record) : record_(record) { visit(entry.type, entry.form); }

  // How many values are the entity's own, its type among them; none: not known.
  [[nodiscard]] std::optional<std::size_t> own() const { return own_; }
  [[nodiscard]] const std::vector<Reference>& all() const { return all_; }

 private:
  int integer() { return record_.integer(at_++).value_or(0); }
  void skip(std::size_t count) { at_ += count; }
  // A number of things of `each` values; no more than there are values.
  int count(std::size_t each = 1) {
    const int stated = integer();
    const auto room = static_cast<int>((record_.values().size() + each) / each);
    if (stated < 0 || stated > room) broken_ = true;
    return std::clamp(stated, 0, room);
  }
  void pointer(const Types& types) {
    const int value = integer();
    if (value != 0) all_.push_back({value, at_ - 1, &types});
  }
  void pointers(int count, const Types& types) {
    for (int i = 0; i < count; ++i) pointer(types);
  }

  void visit(int type, int form) {
    if (!visit_curve(type) && !visit_surface(type, form) && !visit_bounded(type) && !visit_solid(type) &&
        !visit_structure(type, form))
      return;
    if (!broken_) own_ = at_;
  }
  bool visit_curve(int type);
  bool visit_surface(int type, int form);
  bool visit_bounded(int type);
  bool visit_solid(int type);
  bool visit_structure(int type, int form);

  const Record& record_;
  std::size_t at_ = 1;
  bool broken_ = false;
  std::optional<std::size_t> own_;
  std::vector<Reference> all_;
};

constexpr Types point_type = {116}, direction_type = {123}, line_type = {110}, edge_lists = {502, 504},
                vertex_list = {502}, loop_type = {508}, face_type = {510}, shell_type = {514},
                boundary_142 = {142}, boundary_141 = {141}, definition = {308},
                closed_curves = {100, 102, 104, 106, 110, 112, 126, 130, 142};

bool References::visit_curve(int type) {
  switch (type) {
    case 100:
      skip(7);
      return true;
    case 102:
      pointers(count(), curves);
      return true;
    case 104:
      skip(11);
      return true;
    case 106: {
      const int kind = integer();
      const int n = count();
      skip((kind == 1 ? 1U : 0U) + static_cast<std::size_t>(n) * (kind == 1 ? 2U : kind == 2 ? 3U : 6U));
      return true;
    }
    case 110:
      skip(6);
      return true;
    case 112: {
      skip(3);
      skip(13U * static_cast<std::size_t>(count(13)) + 13U);
      return true;
    }
    case 116:
      skip(4);
      return true;
    case 123:
      skip(3);
      return true;
    case 124:
      skip(12);
      return true;
    case 126: {
      const int k = count(), m = count();
      skip(4 + static_cast<std::size_t>(k + m + 2) + 4 * static_cast<std::size_t>(k + 1) + 5);
      return true;
    }
    case 130:
      pointer(curves);
      skip(13);
      return true;
    default:
      return false;
  }
}

bool References::visit_surface(int type, int form) {
  const bool referred = form == 1;
  switch (type) {
    case 108:
      skip(4);
      pointer(closed_curves);
      skip(4);
      return true;
    case 114: {
      skip(2);
      const auto m = static_cast<std::size_t>(count()), n = static_cast<std::size_t>(count());
      skip(m + n + 2 + 48 * (m + 1) * (n + 1));
      return true;
    }
    case 118:
      pointers(2, curves);
      skip(2);
      return true;
    case 120:
      pointer(line_type);
      pointer(curves);
      skip(2);
      return true;
    case 122:
      pointer(curves);
      skip(3);
      return true;
    case 128: {
      const auto k = static_cast<std::size_t>(count()), l = static_cast<std::size_t>(count()),
                 m = static_cast<std::size_t>(count()), n = static_cast<std::size_t>(count());
      skip(5 + k + m + 2 + l + n + 2 + 4 * (k + 1) * (l + 1) + 4);
      return true;
    }
    case 140:
      skip(4);
      pointer(surfaces);
      return true;
    case 190:
    case 192:
    case 194:
    case 196:
    case 198:
      pointer(point_type);
      if (type == 196) skip(1);
      if (type != 196 || referred) pointer(direction_type);
      if (type == 192) skip(1);
      if (type == 194 || type == 198) skip(2);
      if (referred) pointer(direction_type);
      return true;
    default:
      return false;
  }
}

bool References::visit_bounded(int type) {
  switch (type) {
    case 141:
      skip(2);
      pointer(surfaces);
      for (int n = count(); n > 0; --n) {
        pointer(curves);
        skip(1);
        pointers(count(), curves);
      }
      return true;
    case 142:
      skip(1);
      pointer(surfaces);
      pointers(2, curves);
      skip(1);
      return true;
    case 143:
      skip(1);
      pointer(surfaces);
      pointers(count(), boundary_141);
      return true;
    case 144: {
      pointer(surfaces);
      skip(1);
      const int holes = count();
      pointers(holes + 1, boundary_142);
      return true;
    }
    default:
      return false;
  }
}

bool References::visit_solid(int type) {
  switch (type) {
    case 186:
      pointer(shell_type);
      skip(1);
      for (int n = count(2); n > 0; --n) {
        pointer(shell_type);
        skip(1);
      }
      return true;
    case 502:
      skip(3 * static_cast<std::size_t>(count(3)));
      return true;
    case 504:
      for (int n = count(5); n > 0; --n) {
        pointer(curves);
        for (int end = 0; end < 2; ++end) {
          pointer(vertex_list);
          skip(1);
        }
      }
      return true;
    case 508:
      for (int n = count(5); n > 0; --n) {
        skip(1);
        pointer(edge_lists);
        skip(2);
        for (int k = count(2); k > 0; --k) {
          skip(1);
          pointer(curves);
        }
      }
      return true;
    case 510: {
      pointer(surfaces);
      const int loops = count();
      skip(1);
      pointers(loops, loop_type);
      return true;
    }
    case 514:
      for (int n = count(2); n > 0; --n) {
        pointer(face_type);
        skip(1);
      }
      return true;
    default:
      return false;
  }
}

constexpr Types anything = {};

bool References::visit_structure(int type, int form) {
  if (type == 402 && form != 1 && form != 7 && form != 14 && form != 15) return false;
  switch (type) {
    case 308:
      skip(2);
      pointers(count(), anything);
      return true;
    case 314:
      skip(record_.values().size() > 4 && record_.values()[4].is_string ? 4 : 3);
      return true;
    case 402:
      pointers(count(), anything);
      return true;
    case 406:
      skip(static_cast<std::size_t>(count()));
      return true;
    case 408:
      pointer(definition);
      skip(4);
      return true;
    default:
      return false;
  }
}

class ParameterCheck {
 public:
  ParameterCheck(const RawFile& file, const Directory& directory, Bounds& bounds, Findings& findings)
      : file_(file),
        directory_(directory),
        bounds_(bounds),
        findings_(findings),
        owner_(file.parameters().size(), 0),
        part_(directory.entries.size(), false) {}

  void run() {
    for (const Entry& entry : directory_.entries)
      if (entry.type != 0) check(entry);
    for (std::size_t i = 0; i < owner_.size(); ++i)
      if (owner_[i] == 0)
        findings_.defect("parameter lines that no directory entry has",
                         "no directory entry has this parameter line", file_.parameters()[i].place());
    check_subordinates();
  }

 private:
  void check(const Entry& entry) {
    const Section& lines = file_.parameters();
    if (entry.first < 1 || static_cast<std::size_t>(entry.first) > lines.size()) {
      findings_.defect("parameter pointers to nowhere",
                       fmt::format("{}: its parameters are said to begin on line P{}, of {}", entry.name(),
                                   entry.first, lines.size()),
                       entry.line->place(9));
      return;
    }
    if (entry.count < 1) {
      findings_.defect("parameter line counts",
                       fmt::format("{}: a count of {} parameter lines", entry.name(), entry.count),
                       entry.second->place(25));
      return;
    }
    const auto first = static_cast<std::size_t>(entry.first) - 1;
    const std::size_t count = claim(entry, first);
    Record record(lines, first, count, width);
    if (!record.split(file_.delimiter, file_.record, entry.name(), findings_)) return;
    if (record.last_line() + 1 < count)
      findings_.defect(
          "parameter line counts",
          fmt::format("{}: {} parameter lines are counted, and the record ends on the {}. of them",
                      entry.name(), entry.count, record.last_line() + 1),
          entry.second->place(25));
    if (record.integer(0).value_or(-1) != entry.type)
      findings_.defect(
          "parameters of another type",
          fmt::format("{}: its parameters begin with {}", entry.name(), in_quotes(record.values()[0].text)),
          record.place_of(0));
    else
      check_values(entry, record);
  }

  // Marks the entry's lines; each must point back. Gives how many of them are there and its own.
  std::size_t claim(const Entry& entry, std::size_t first) {
    const Section& lines = file_.parameters();
    const auto count = static_cast<std::size_t>(entry.count);
    for (std::size_t i = 0; i < count; ++i) {
      if (first + i >= lines.size()) {
        findings_.defect(
            "parameter line counts",
            fmt::format("{}: {} parameter lines are counted, and there are {}", entry.name(), entry.count, i),
            entry.second->place(25));
        return i;
      }
      const RawLine& line = lines[first + i];
      const std::optional<int> back = field_number(line.columns(66, 72));
      if (!back || *back != entry.de) {
        findings_.defect("parameter lines that point to another entity",
                         fmt::format("{}: its parameter line points back to {} (columns 66-72)", entry.name(),
                                     in_quotes(line.columns(66, 72))),
                         line.place(66));
        const bool is_others = owner_[first + i] != 0 || (back && directory_.at(*back) != nullptr);
        if (is_others && i > 0) return i;
      }
      if (owner_[first + i] != 0)
        findings_.defect("parameter lines of two entities",
                         fmt::format("{}: the line belongs to D{} too", entry.name(), owner_[first + i]),
                         line.place());
      owner_[first + i] = entry.de;
    }
    const std::size_t next = first + count;
    if (next < lines.size() && field_number(lines[next].columns(66, 72)) == entry.de) {
      findings_.defect("parameter line counts",
                       fmt::format("{}: {} parameter lines are counted, and the next one belongs to it too",
                                   entry.name(), entry.count),
                       entry.second->place(25));
      std::size_t more = next;
      for (; more < lines.size() && field_number(lines[more].columns(66, 72)) == entry.de; ++more)
        owner_[more] = entry.de;
      return more - first;
    }
    return count;
  }

  void check_values(const Entry& entry, const Record& record) {
    for (std::size_t i = 0; i < record.values().size(); ++i)
      if (!record.values()[i].is_string && !record.real(i) && is_known(entry))
        findings_.defect("values that are no numbers",
                         fmt::format("{}: {} is no number", entry.name(), in_quotes(record.values()[i].text)),
                         record.place_of(i));
    const References references(entry, record);
    const bool has_numbers = entry.type == 126 || entry.type == 128 || entry.type == 124;
    if (has_numbers && (!references.own() || record.values().size() < *references.own())) {
      findings_.defect("entities with too few values",
                       references.own()
                           ? fmt::format("{}: {} values; {} are due", entry.name(),
                                         record.values().size() - 1, *references.own() - 1)
                           : fmt::format("{}: a count that the record cannot hold", entry.name()),
                       record.place_of(record.values().size() - 1));
      return;
    }
    for (const References::Reference& reference : references.all()) check(entry, record, reference);
    if (references.own()) check_trailer(entry, record, *references.own());
    if (entry.type == 126) check_curve(entry, record, bounds_, findings_);
    if (entry.type == 128) check_surface(entry, record, bounds_, findings_);
    if (entry.type == 124) check_matrix(entry, record, findings_);
    if (entry.type == 314) check_color(entry, record, findings_);
  }

  static bool is_known(const Entry& entry) {
    return entry.type < 200 || entry.type == 314 || entry.type >= 500;
  }

  void check(const Entry& entry, const Record& record, const References::Reference& reference) {
    const Entry* target = directory_.at(std::abs(reference.pointer));
    const TextPlace place = record.place_of(reference.value);
    if (target == nullptr || target->type == 0) {
      findings_.defect(
          "pointers to nowhere",
          fmt::format("{}: points to {}, where no directory entry begins", entry.name(), reference.pointer),
          place);
      return;
    }
    if (target == &entry) {
      findings_.defect("pointers to themselves", fmt::format("{}: points to itself", entry.name()), place);
      return;
    }
    const Types& types = *reference.types;
    if (types.size() > 0 && std::find(types.begin(), types.end(), target->type) == types.end())
      findings_.defect("pointers to entities of another type",
                       fmt::format("{}: points to a {}", entry.name(), target->name()), place);
    if (entry.type != 402 && entry.type != 308 && entry.type != 408)
      part_[static_cast<std::size_t>(target->de / 2)] = true;
  }

  // Behind its own values: associativities, then properties.
  void check_trailer(const Entry& entry, const Record& record, std::size_t at) {
    for (int list = 0; list < 2 && at < record.values().size(); ++list) {
      const std::optional<int> count = record.integer(at);
      if (!count || *count < 0 || static_cast<std::size_t>(*count) > record.values().size() - at - 1) {
        findings_.defect(
            "pointers behind the parameters",
            fmt::format("{}: {} where the number of {} is due", entry.name(),
                        in_quotes(record.values()[at].text), list == 0 ? "associativities" : "properties"),
            record.place_of(at));
        return;
      }
      for (int i = 0; i < *count; ++i) {
        const int pointer = record.integer(at + 1 + static_cast<std::size_t>(i)).value_or(0);
        const Entry* target = directory_.at(pointer);
        const TextPlace place = record.place_of(at + 1 + static_cast<std::size_t>(i));
        if (target == nullptr)
          findings_.defect(
              "pointers to nowhere",
              fmt::format("{}: points to {}, where no directory entry begins", entry.name(), pointer), place);
        else if (list == 1 && target->type != 406 && target->type != 422 && target->type != 316)
          findings_.defect("pointers to entities of another type",
                           fmt::format("{}: a property that is a {}", entry.name(), target->name()), place);
      }
      at += static_cast<std::size_t>(*count) + 1;
    }
    if (at < record.values().size())
      findings_.defect("pointers behind the parameters",
                       fmt::format("{}: {} values too many", entry.name(), record.values().size() - at),
                       record.place_of(at));
  }

  // Receivers take the status field at its word: what is said to be independent is shown by itself.
  void check_subordinates() {
    for (const Entry& entry : directory_.entries) {
      const bool is_geometry = (entry.type >= 100 && entry.type < 200 && entry.type != 124 &&
                                entry.type != 116 && entry.type != 123);
      if (!is_geometry) continue;
      const bool dependent = (entry.subordinate & 1) != 0;
      const bool is_part = part_[static_cast<std::size_t>(entry.de / 2)];
      if (is_part && !dependent)
        findings_.warning(
            "parts said to be independent",
            fmt::format("{}: it is part of another entity, and its status says that it is independent: some "
                        "systems show it by itself",
                        entry.name()),
            entry.line->place(67));
    }
  }

  const RawFile& file_;
  const Directory& directory_;
  Bounds& bounds_;
  Findings& findings_;
  std::vector<int> owner_;  // of each parameter line
  std::vector<bool> part_;  // of each entry: another one is made of it
};

void check_bounds(const Directory& directory, const Bounds& bounds, Findings& findings) {
  const bool moved = std::any_of(directory.entries.begin(), directory.entries.end(),
                                 [](const Entry& entry) { return entry.type == 124 || entry.type == 408; });
  if (bounds.largest_found <= 0) return;
  if (!moved && bounds.largest > 0 && bounds.largest_found > bounds.largest * (1 + 1e-12))
    findings.defect("faults of the global section",
                    fmt::format("the largest coordinate is said to be {} (global parameter 20); {} has {}",
                                bounds.largest, bounds.largest_entity, bounds.largest_found),
                    {bounds.largest_line, 0});
  if (bounds.resolution > 0.01 * bounds.largest_found)
    findings.warning(
        "faults of the global section",
        fmt::format("the resolution is said to be {} (global parameter 19), and no coordinate is larger than "
                    "{}: readers that merge what is nearer than the resolution lose the shape",
                    bounds.resolution, bounds.largest_found),
        {bounds.resolution_line, 0});
  if (bounds.resolution > 0 && bounds.resolution < 1e-17 * bounds.largest_found)
    findings.warning(
        "faults of the global section",
        fmt::format("the resolution is said to be {} (global parameter 19), finer than the numbers of the "
                    "file can be",
                    bounds.resolution),
        {bounds.resolution_line, 0});
}

}  // namespace

void check_parameters(const RawFile& file, const Directory& directory, Bounds& bounds, Findings& findings) {
  ParameterCheck(file, directory, bounds, findings).run();
  check_bounds(directory, bounds, findings);
}

}  // namespace selvage::formats::iges::structure
