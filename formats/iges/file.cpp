#include "formats/iges/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "formats/iges/standard.h"

namespace selvage::formats::iges {

std::string DirectoryEntry::name() const {
  return fmt::format("{} at D{}", type, pointer);
}

namespace {

// The fields of an entry, 1 to 20 on its two lines, each 8 columns wide.
class Fields {
 public:
  Fields(const Line& first, const Line& second, DirectoryEntry& entry, Complaints& complaints)
      : first_(first), second_(second), entry_(entry), complaints_(complaints) {}

  void read() {
    entry_.line = first_.number;
    entry_.type = integer(1);
    entry_.first_line = integer(2);
    integer(3);  // structure
    entry_.level = integer(5);
    entry_.transformation = integer(7);
    entry_.color = integer(13);
    entry_.line_count = integer(14);
    entry_.form = integer(15);
    std::memcpy(entry_.label.data(), text(18).data(), entry_.label.size());
    if (const int type = integer(11); type != entry_.type)
      fault(11, fmt::format("the second line is of type {}", type));
    read_status();
    if (complaints_.is_check()) check_others();
  }

 private:
  // BBSSUUHH; blanks stand for zeros in sloppy files.
  void read_status() {
    std::array<int, 4> parts{};
    constexpr std::array<int, 4> most = {1, 3, 6, 2};
    constexpr std::array<std::string_view, 4> words = {"blank", "subordinate", "use", "hierarchy"};
    const std::string_view field = text(9);
    for (std::size_t i = 0; i < 4; ++i) {
      for (const char c : field.substr(2 * i, 2)) {
        if (c >= '0' && c <= '9') {
          parts[i] = 10 * parts[i] + (c - '0');
        } else if (c != ' ') {
          fault(9, fmt::format("status {} is not of eight digits", in_quotes(field)));
          return;
        }
      }
      if (parts[i] <= most[i]) continue;
      parts[i] = 0;
      if (complaints_.is_check())
        complaints_.defect(spot(9), said(9, fmt::format("status {}: the {} part is 00 to 0{}",
                                                        in_quotes(field), words[i], most[i])));
    }
    entry_.blanked = parts[0] == 1;
    entry_.subordinate = parts[1];
    entry_.use = parts[2];
  }

  // What a reader has no use for.
  void check_others() {
    entry_.font = integer(4);
    entry_.view = integer(6);
    integer(8);
    integer(19);
    if (integer(12) < 0) fault(12, "a negative line weight");
    if (entry_.color > 8) fault(13, fmt::format("there is no colour {}: they are 0 to 8", entry_.color));
    const StandardType* const type = standard_type(entry_.type);
    if (type != nullptr && !type->forms.allow(entry_.form))
      fault(15, fmt::format("type {} has no form {}", entry_.type, entry_.form));
  }

  [[nodiscard]] const Line& line(int field) const { return field > 10 ? second_ : first_; }
  [[nodiscard]] static int before(int field) { return 8 * ((field - 1) % 10); }  // columns
  [[nodiscard]] std::string_view text(int field) const {
    return line(field).text().substr(static_cast<std::size_t>(before(field)), 8);
  }
  [[nodiscard]] Spot spot(int field) const { return line(field).spot(before(field) + 1); }
  int integer(int field) {
    const std::optional<int> value = column_number(text(field));
    if (!value) fault(field, fmt::format("{} is no integer", in_quotes(text(field))));
    return value.value_or(0);
  }
  [[nodiscard]] std::string said(int field, const std::string& what) const {
    return fmt::format("{}: {} (directory field {})", entry_.name(), what, field);
  }
  void fault(int field, const std::string& what) { complaints_.fault(spot(field), said(field, what)); }

  const Line &first_, &second_;
  DirectoryEntry& entry_;
  Complaints& complaints_;
};

}  // namespace

void File::read_directory(Complaints& complaints) {
  const int lines = lines_.count(Section::directory);
  directory_.resize(static_cast<std::size_t>(lines / 2));
  int pointer = 1;
  for (DirectoryEntry& entry : directory_) {
    entry.pointer = pointer;
    const Line first = lines_.line(Section::directory, pointer);
    const Line second = lines_.line(Section::directory, pointer + 1);
    Fields(first, second, entry, complaints).read();
    pointer += 2;
  }
  if (lines % 2 != 0)
    complaints.fault(lines_.line(Section::directory, lines).spot(),
                     "the directory has an odd number of lines, but two belong to each entity");
}

std::optional<File> File::open(const Source& source, Complaints& complaints) {
  std::optional<Lines> lines = Lines::index(source, complaints);
  if (!lines || !complaints.goes_on()) return std::nullopt;
  Global global = read_global(*lines, complaints);
  if (!complaints.goes_on()) return std::nullopt;
  File file(std::move(*lines), std::move(global));
  file.read_directory(complaints);
  return complaints.goes_on() ? std::optional(std::move(file)) : std::nullopt;
}

const DirectoryEntry* File::entity(int pointer) const {
  if (pointer < 0) pointer = -pointer;
  if (pointer % 2 == 0) return nullptr;
  const auto index = static_cast<std::size_t>(pointer / 2);
  return index < directory_.size() ? &directory_[index] : nullptr;
}

std::string_view File::owner_text(int parameter_line) const {
  const Line line = lines_.line(Section::parameter, parameter_line);
  return {line.at + line.data, 8};
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

std::vector<int> read_properties(Parameters& parameters) {
  const auto next = [&] {
    const bool is_there = !parameters.at_end() && parameters.ok();
    return is_there ? parameters.pointers("pointers behind the parameters") : std::vector<int>();
  };
  next();  // associativities
  return next();
}

}  // namespace selvage::formats::iges
