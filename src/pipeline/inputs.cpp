#include "pipeline/inputs.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <unordered_set>

#include "core/source.h"
#include "core/words.h"
#include "pipeline/detect.h"
#include "pipeline/parts.h"
#include "pipeline/variants.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;

namespace {

class Expansion {
 public:
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
    list.inputs.push_back(input_at(file, fs::path(file).filename()));
  }

  // The outputs of a fabric in several files have no number.
  static Input input_at(const std::string& path, const fs::path& name) {
    const std::optional<fs::path> whole = whole_path(name);
    const bool is_set = whole && mark_of(path);
    return {path, is_set ? fs::path(*whole).replace_extension() : fs::path(name).replace_extension()};
  }

  Status add_standard_input() {
    if (std::any_of(list.inputs.begin(), list.inputs.end(),
                    [](const Input& input) { return input.path == "-"; }))
      return error(Kind::usage, "standard input ('-') can be read only once");
    list.inputs.push_back({"-", "stdin"});
    return {};
  }

  // Hidden files and folders are passed by; a folder that cannot be entered is an error of its own.
  Status add_folder(const fs::path& folder) {
    from_folder_ = true;
    std::vector<fs::path> files;
    collect(folder, files);
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files)
      list.inputs.push_back(input_at(file.string(), file.lexically_relative(folder)));
    if (files.empty() && list.missing.empty())
      list.missing.push_back(error(Kind::io, "no readable file in this folder", {.file = folder.string()}));
    return {};
  }

  void collect(const fs::path& folder, std::vector<fs::path>& files) {
    std::error_code failure;
    fs::directory_iterator entries(folder, failure);
    for (; !failure && entries != fs::directory_iterator(); entries.increment(failure)) {
      const fs::path& path = entries->path();
      if (path.filename().native().starts_with('.')) continue;
      std::error_code unknown;
      if (entries->is_directory(unknown) && !entries->is_symlink(unknown))
        collect(path, files);
      else if (entries->is_regular_file(unknown) && is_readable_format(path))
        files.push_back(path);
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
    Result<Source> source = Source::open(name);
    if (!source) {
      source.error().kind = Kind::usage;
      return source.error();
    }
    from_folder_ = true;
    for (std::string_view line : split(source->bytes(), '\n')) {
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line.empty()) continue;
      if (line.front() == '@') return error(Kind::usage, "a list cannot name another list", {.file = name});
      if (Status status = add(std::string(line)); !status.ok()) return status;
    }
    return {};
  }

 public:
  // Files 2, 3, ... of a fabric whose first one is an input, too, are read with that one.
  void drop_later_parts() {
    std::unordered_set<std::string> paths;
    for (const Input& input : list.inputs) paths.insert(fs::path(input.path).lexically_normal().string());
    std::erase_if(list.inputs, [&](const Input& input) {
      const std::optional<fs::path> whole = whole_path(input.path);
      if (!whole || !paths.contains(part_path(*whole, 1).lexically_normal().string())) return false;
      const std::optional<formats::PartMark> mark = mark_of(input.path);
      return mark && mark->number > 1;
    });
  }

  [[nodiscard]] bool is_one_file() const {
    return !from_folder_ && list.inputs.size() == 1 && list.missing.empty();
  }

 private:
  bool from_folder_ = false;
};

}  // namespace

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
  if (variants->size() == 1 && !options.sweep.wanted) {
    for (Input& input : list.inputs) input.settings = variants->front();
    return {};
  }
  if (Status few =
          check_number(static_cast<double>(variants->size()) * static_cast<double>(list.inputs.size()));
      !few)
    return few;
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(variants->size()).size());
  std::vector<Input> all;
  all.reserve(list.inputs.size() * variants->size());
  for (const Input& input : list.inputs)
    for (std::size_t i = 0; i < variants->size(); ++i) {
      all.push_back(input);
      all.back().stem += fmt::format("_{:0{}}", i + 1, digits);
      all.back().settings = (*variants)[i];
    }
  list.inputs = std::move(all);
  list.one_file = false;
  return {};
}

}  // namespace

Result<InputList> inputs_of(const Options& options) {
  const std::vector<std::string>& given = options.inputs;
  const std::string& first = given.front();
  if (options.command == Command::edit)
    return InputList{{{first, first == "-" ? "stdin" : fs::path(first).stem().string()}}, {}, true};
  if (options.command == Command::diff) {
    if (first == "-" && given[1] == "-")
      return error(Kind::usage, "standard input can be only one of the two");
    return InputList{{{first_file(first).string(), {}, first_file(given[1]).string()}}, {}, true};
  }
  Expansion expansion;
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
