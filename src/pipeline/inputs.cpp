#include "pipeline/inputs.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <functional>
#include <set>
#include <unordered_set>

#include "core/source.h"
#include "core/words.h"
#include "pipeline/detect.h"
#include "pipeline/parts.h"
#include "pipeline/variants.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;

namespace {

void add_field(std::string& record, std::string_view field) {
  record += field;
  record += '\0';
}

// Reads what add_field() wrote.
class Fields {
 public:
  explicit Fields(const char* record) : rest_(record) {}
  std::string_view next() {
    const std::string_view field = rest_;
    rest_ += field.size() + 1;
    return field;
  }

 private:
  const char* rest_;
};

// As parts of a path would be compared.
bool is_before(std::string_view a, std::string_view b) {
  const auto rank = [](char c) { return c == '/' ? -1 : static_cast<int>(static_cast<unsigned char>(c)); };
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [&](char x, char y) { return rank(x) < rank(y); });
}

class Expansion {
 public:
  explicit Expansion(bool allow_outside) : allow_outside_(allow_outside) {}

  Status add(const std::string& argument) {
    if (argument == "-") return add_standard_input();
    std::error_code failure;
    const fs::file_status status = fs::status(argument, failure);
    if (fs::is_directory(status)) return add_folder(argument);
    if (!fs::exists(status) && argument.size() > 1 && argument.front() == '@')
      return add_list(argument.substr(1));
    if (!fs::exists(status) && argument.find_first_of("*?[") != std::string::npos)
      return add_pattern(argument);
    add_file(argument);
    return {};
  }

  InputList list;

 private:
  // A name that no file has may be that of a fabric in several files.
  void add_file(const std::string& path) {
    const std::string file = first_file(path).string();
    list.inputs.add(input_at(file, fs::path(file).filename()));
  }

  // The outputs of a fabric in several files have no number.
  static Input input_at(const std::string& path, const fs::path& name) {
    const std::optional<fs::path> whole = whole_path(name);
    const bool is_set = whole && mark_of(path);
    return {path, is_set ? fs::path(*whole).replace_extension() : fs::path(name).replace_extension()};
  }

  Status add_standard_input() {
    if (has_standard_input_) return error(Kind::usage, "standard input ('-') can be read only once");
    has_standard_input_ = true;
    list.inputs.add({"-", "stdin"});
    return {};
  }

  struct Walk {
    fs::path root;               // the named folder, as all paths in `entered` without links
    std::set<fs::path> entered;  // folders to which links led, and the root
    std::function<void(const std::string&)> found;
  };

  // False, with a note.
  bool pass_by(const fs::path& link, std::string_view why) {
    constexpr std::size_t most_notes = 20;
    if (list.notes.size() < most_notes)
      list.notes.push_back(
          note(Kind::usage, fmt::format("passed by: this symbolic link {}", why)).placed({}, link.native()));
    else if (list.notes.size() == most_notes)
      list.notes.push_back(note(Kind::usage, "further symbolic links were passed by"));
    return false;
  }

  // A link may lead to a file in the named folder. It leaves it only where that is wanted, then to a folder,
  // too, which is entered once; folders in the named one are found without it.
  bool may_follow(const fs::path& link, Walk& walk) {
    std::error_code failure;
    const fs::path target = fs::canonical(link, failure);
    if (failure) return pass_by(link, fmt::format("leads nowhere ({})", failure.message()));
    const bool is_folder = fs::is_directory(target, failure);
    const bool is_within = is_below(target, walk.root);
    if (!is_within && !allow_outside_)
      return pass_by(link, "leads out of the folder; --allow-outside follows it");
    if (!is_folder) return true;
    if (is_within || is_below(walk.root, target) || !walk.entered.insert(target).second)
      return pass_by(link, "leads to a folder that is searched where it is");
    return true;
  }

  // Hidden files and folders are passed by; a folder that cannot be entered is an error of its own.
  Status add_folder(const fs::path& folder) {
    from_folder_ = true;
    SharedText text;
    std::vector<std::string_view> files;
    std::error_code failure;
    const fs::path root = fs::canonical(folder, failure);
    Walk walk{root, {root}, [&](const std::string& file) { files.push_back(text.keep(file)); }};
    collect(folder, walk);
    std::sort(files.begin(), files.end(), is_before);
    for (const std::string_view file : files)
      list.inputs.add(input_at(std::string(file), fs::path(file).lexically_relative(folder)));
    if (files.empty() && list.missing.empty())
      list.missing.push_back(error(Kind::io, "no readable file in this folder", {.file = folder.string()}));
    return {};
  }

  void collect(const fs::path& folder, Walk& walk) {
    std::error_code failure;
    std::vector<fs::directory_entry> entries;
    for (fs::directory_iterator next(folder, failure); !failure && next != fs::directory_iterator();
         next.increment(failure))
      if (!next->path().filename().native().starts_with('.')) entries.push_back(*next);
    // Of two links to a folder the first one counts, whatever order the file system has.
    std::sort(entries.begin(), entries.end());
    for (const fs::directory_entry& entry : entries) {
      std::error_code unknown;
      if (entry.is_symlink(unknown) && !may_follow(entry.path(), walk)) continue;
      if (entry.is_directory(unknown))
        collect(entry.path(), walk);
      else if (entry.is_regular_file(unknown) && is_readable_format(entry.path()))
        walk.found(entry.path().native());
    }
    if (failure)
      list.missing.push_back(error(Kind::io, fmt::format("cannot read the folder: {}", failure.message()),
                                   {.file = folder.string()}));
  }

  Status add_pattern(const std::string& pattern) {
    glob_t found{};
    const int outcome = ::glob(pattern.c_str(), GLOB_ERR, nullptr, &found);
    const int reason = errno;
    std::vector<std::string> paths;
    if (outcome == 0) paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
    ::globfree(&found);
    if (outcome == GLOB_NOSPACE || (outcome == GLOB_ABORTED && reason != ENOENT))
      list.missing.push_back(error(Kind::io,
                                   fmt::format("cannot search all folders of this pattern: {}",
                                               outcome == GLOB_NOSPACE ? "no memory" : std::strerror(reason)),
                                   {.file = pattern}));
    else if (paths.empty())
      list.missing.push_back(error(Kind::io, "no file matches this pattern", {.file = pattern}));
    for (const std::string& path : paths)
      if (Status status = add(path); !status.ok()) return status;
    return {};
  }

  Status add_list(const std::string& name) {
    Result<Source> source = Source::open(name, largest_list);
    if (!source) {
      source.error().kind = Kind::usage;
      return source.error();
    }
    from_folder_ = true;
    int number = 0;
    for (std::string_view line : split(source->bytes(), '\n')) {
      ++number;
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line.empty()) continue;
      const auto refuse = [&](std::string what) {
        return error(Kind::usage, std::move(what), {.file = name, .place = {number, 1}});
      };
      if (line.front() == '@') return refuse("a list cannot name another list");
      if (line.find('\0') != std::string_view::npos)
        return refuse("this line has a zero byte: a list is a text with the path of an input in each line");
      if (line.size() >= PATH_MAX)
        return refuse(fmt::format("this line has {} bytes, and a path less than {}", line.size(), PATH_MAX));
      if (Status status = add(std::string(line)); !status.ok()) return status;
    }
    return {};
  }

 public:
  // Files 2, 3, ... of a fabric whose first one is an input, too, are read with that one.
  void drop_later_parts() {
    std::unordered_set<std::string> first_parts;
    for (std::size_t i = 0; i < list.inputs.size(); ++i)
      if (const fs::path path = list.inputs.path(i); part_number(path) == 1)
        first_parts.insert(path.lexically_normal().string());
    if (first_parts.empty()) return;
    list.inputs.erase_if([&](std::string_view path) {
      const std::optional<fs::path> whole = whole_path(path);
      if (!whole || !first_parts.contains(part_path(*whole, 1).lexically_normal().string())) return false;
      const std::optional<formats::PartMark> mark = mark_of(path);
      return mark && mark->number > 1;
    });
  }

  [[nodiscard]] bool is_one_file() const {
    return !from_folder_ && list.inputs.size() == 1 && list.missing.empty();
  }

 private:
  static constexpr std::size_t largest_list = std::size_t{1} << 28;  // bytes: some million paths

  bool allow_outside_;
  bool from_folder_ = false, has_standard_input_ = false;
};

}  // namespace

void Inputs::add(const Input& input) {
  std::string record;
  for (const std::string* field : {&input.path, &input.stem, &input.other}) add_field(record, *field);
  for (const fabric::Setting& setting : input.settings) {
    add_field(record, setting.name);
    add_field(record, setting.value);
  }
  add_field(record, {});  // no setting is without a name
  records_.push_back(text_.keep(record).data());
}

Input Inputs::at(std::size_t index) const {
  Fields fields(records_[index]);
  Input input;
  for (std::string* field : {&input.path, &input.stem, &input.other}) *field = fields.next();
  for (std::string_view name = fields.next(); !name.empty(); name = fields.next())
    input.settings.push_back({std::string(name), std::string(fields.next())});
  return input;
}

void Inputs::keep_part(std::size_t part, std::size_t parts) {
  const std::size_t count = records_.size();
  records_.resize(count * (part + 1) / parts);
  records_.erase(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(count * part / parts));
}

std::string Input::name() const {
  std::string name = path;
  for (const fabric::Setting& setting : settings)
    name += fmt::format("{}{}={}", name.size() == path.size() ? '?' : '&', setting.name, setting.value);
  return name;
}

namespace {

// Every input with every variant.
Status vary(InputList& list, const Options& options) {
  Result<Variants> variants = variants_of(options);
  if (!variants) return variants.error();
  const bool is_one = variants->size() == 1 && !options.sweep.wanted;
  if (is_one && variants->front().empty()) return {};
  if (Status few =
          check_number(static_cast<double>(variants->size()) * static_cast<double>(list.inputs.size()));
      !few)
    return few;
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(variants->size()).size());
  Inputs all;
  for (std::size_t k = 0; k < list.inputs.size(); ++k)
    for (std::size_t i = 0; i < variants->size(); ++i) {
      Input input = list.inputs.at(k);
      if (!is_one) input.stem += fmt::format("_{:0{}}", i + 1, digits);
      input.settings = (*variants)[i];
      all.add(input);
    }
  list.inputs = std::move(all);
  list.one_file = list.one_file && is_one;
  return {};
}

}  // namespace

Result<InputList> inputs_of(const Options& options) {
  const std::vector<std::string>& given = options.inputs;
  const std::string& first = given.front();
  const auto only = [](const Input& input) {
    InputList list;
    list.inputs.add(input);
    list.one_file = true;
    return list;
  };
  if (options.command == Command::edit)
    return only({first, first == "-" ? "stdin" : fs::path(first).stem().string()});
  if (options.command == Command::diff) {
    if (first == "-" && given[1] == "-")
      return error(Kind::usage, "standard input can be only one of the two");
    return only({first_file(first).string(), {}, first_file(given[1]).string()});
  }
  Expansion expansion(options.allow_outside);
  for (const std::string& argument : given)
    if (Status status = expansion.add(argument); !status.ok()) return status.error();
  expansion.drop_later_parts();
  expansion.list.one_file = expansion.is_one_file();
  if (expansion.list.inputs.empty() && expansion.list.missing.empty())
    return error(Kind::usage, "no input: the list is empty");
  if (Status varied = vary(expansion.list, options); !varied) return varied.error();
  return std::move(expansion.list);
}

}  // namespace selvage::pipeline
