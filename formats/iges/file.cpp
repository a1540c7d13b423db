#include "formats/iges/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

namespace selvage::formats::iges {

std::string DirectoryEntry::name() const {
  return fmt::format("{} at D{}", type, pointer);
}

namespace {

// The fields of one directory line, each 8 columns wide.
class Fields {
 public:
  Fields(const Line& line, TextReport& report) : line_(line), report_(report) {}

  [[nodiscard]] std::string_view text(int number) const {
    return {line_.at + std::ptrdiff_t{8} * (number - 1), 8};
  }
  int integer(int number, std::string_view what) {
    bool valid = true;
    const int value = column_number(text(number), valid).value_or(0);
    if (!valid) {
      report_.error(line_.spot(8 * (number - 1) + 1),
                    fmt::format("{} is no {}", in_quotes(text(number)), what));
      failed_ = true;
    }
    return value;
  }
  // Two digits of the status, `at` 0, 2, 4 or 6; other characters than digits are blanks in sloppy files.
  int status(int at, int most) {
    const char* const digits = text(9).data() + at;
    int value = 0;
    for (const char c : {digits[0], digits[1]}) {
      if (c >= '0' && c <= '9') {
        value = 10 * value + (c - '0');
      } else if (c != ' ') {
        report_.error(line_.spot(65 + at), fmt::format("{} is no status number", in_quotes(text(9))));
        failed_ = true;
        return 0;
      }
    }
    return value <= most ? value : 0;
  }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  const Line& line_;
  TextReport& report_;
  bool failed_ = false;
};

bool read_entry(const Line& first_line, const Line& second_line, TextReport& report, DirectoryEntry& entry) {
  Fields first(first_line, report), second(second_line, report);
  entry.line = first_line.number;
  entry.type = first.integer(1, "entity type");
  entry.first_line = first.integer(2, "line number");
  entry.structure = first.integer(3, "directory pointer");
  entry.level = first.integer(5, "level");
  entry.transformation = first.integer(7, "directory pointer");
  entry.blanked = first.status(0, 1) == 1;
  entry.subordinate = first.status(2, 3);
  entry.use = first.status(4, 6);
  entry.hierarchy = first.status(6, 2);
  const int type = second.integer(1, "entity type");
  entry.color = second.integer(3, "colour");
  entry.line_count = second.integer(4, "number of lines");
  entry.form = second.integer(5, "form number");
  std::memcpy(entry.label.data(), second.text(8).data(), entry.label.size());
  bool valid = true;
  entry.subscript = column_number(second.text(9), valid).value_or(0);
  if (first.failed() || second.failed()) return false;
  if (type != entry.type) {
    report.error(second_line.spot(),
                 fmt::format("the first line of this entity says type {}, the second {}", entry.type, type));
    return false;
  }
  return true;
}

}  // namespace

bool File::read_directory(TextReport& report) {
  const int lines = lines_.count(Section::directory);
  directory_.resize(static_cast<std::size_t>(lines / 2));
  int pointer = 1;
  for (DirectoryEntry& entry : directory_) {
    entry.pointer = pointer;
    const Line first = lines_.line(Section::directory, pointer);
    const Line second = lines_.line(Section::directory, pointer + 1);
    if (!read_entry(first, second, report, entry) && report.is_full()) return false;
    pointer += 2;
  }
  if (lines % 2 != 0)
    report.error(lines_.line(Section::directory, lines).spot(),
                 "the directory has an odd number of lines, but two belong to each entity");
  return report.errors() == 0;
}

// The terminate section says how many lines the others have.
void File::check_terminate(TextReport& report) const {
  if (lines_.count(Section::terminate) == 0) {
    report.warning(lines_.end(), "the terminate section is missing: the file may be cut off");
    return;
  }
  const Line line = lines_.line(Section::terminate, 1);
  for (const std::size_t i : {0U, 1U, 2U, 3U}) {
    const std::string_view field = line.text().substr(8 * i, 8);
    bool valid = field.size() == 8 && field[0] == "SGDP"[i];
    const std::optional<int> said = valid ? column_number(field.substr(1), valid) : std::nullopt;
    const int there = lines_.count(static_cast<Section>(i));
    if (valid && said && *said == there) continue;
    constexpr std::array<std::string_view, 4> names = {"start", "global", "directory", "parameter"};
    report.warning(line.spot(static_cast<int>(8 * i) + 1),
                   fmt::format("the terminate section says {}, but the {} section has {} lines",
                               in_quotes(field), names[i], there));
  }
  if (lines_.count(Section::terminate) > 1)
    report.warning(lines_.line(Section::terminate, 2).spot(), "the terminate section has more than one line");
}

std::optional<File> File::open(const Source& source, TextReport& report) {
  std::optional<Lines> lines = Lines::index(source, report);
  if (!lines) return std::nullopt;
  std::optional<Global> global = read_global(*lines, report);
  if (!global) return std::nullopt;
  File file(std::move(*lines), std::move(*global));
  if (!file.read_directory(report)) return std::nullopt;
  file.check_terminate(report);
  return file;
}

const DirectoryEntry* File::entity(int pointer) const {
  if (pointer < 0) pointer = -pointer;
  if (pointer % 2 == 0) return nullptr;
  const auto index = static_cast<std::size_t>(pointer / 2);
  return index < directory_.size() ? &directory_[index] : nullptr;
}

// The directory pointer that a parameter line ends with; 0 where it has none that can be read.
int File::owner_of(int parameter_line) const {
  const Line line = lines_.line(Section::parameter, parameter_line);
  bool valid = true;
  const int owner = column_number({line.at + line.data, 8}, valid).value_or(0);
  return valid ? owner : 0;
}

Parameters File::parameters(const DirectoryEntry& entry) const {
  const int there = lines_.count(Section::parameter);
  const auto failed = [&](std::string text) {
    Parameters none(lines_, Section::parameter, 0, 0, global_.delimiters);
    none.replace_failure(spot(entry), std::move(text));
    return none;
  };
  const int first = entry.first_line;
  if (first < 1 || first > there)
    return failed(fmt::format("its parameters begin at line {} of the parameter section, which has {} lines",
                              first, there));
  const int owner = owner_of(first);
  if (owner != 0 && owner != entry.pointer)
    return failed(fmt::format("line {} of the parameter section, where its parameters begin, belongs to D{}",
                              first, owner));
  // A line count that is wrong is not believed as long as lines say whose they are.
  int last = std::clamp(first + std::max(entry.line_count, 1) - 1, first, there);
  const int last_owner = owner_of(last);
  if (last_owner != entry.pointer && last_owner != 0) last = first;
  while (last < there && owner_of(last + 1) == entry.pointer) ++last;
  Parameters parameters(lines_, Section::parameter, first, last, global_.delimiters);
  const std::int64_t type = parameters.integer();
  if (parameters.ok() && type != entry.type)
    parameters.fail(
        fmt::format("these are the parameters of a type {}, but the directory says {}", type, entry.type));
  return parameters;
}

Trailer read_trailer(Parameters& parameters) {
  Trailer trailer;
  for (std::vector<int>* const list : {&trailer.associativities, &trailer.properties})
    if (!parameters.at_end() && parameters.ok())
      *list = parameters.pointers("pointers behind the parameters");
  return trailer;
}

}  // namespace selvage::formats::iges
