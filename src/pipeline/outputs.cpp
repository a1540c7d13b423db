#include "pipeline/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <unordered_map>

#include "core/output.h"
#include "core/sha256.h"
#include "core/words.h"
#include "formats/registry.h"
#include "pipeline/detect.h"
#include "pipeline/parts.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;
using formats::Descriptor;
using Formats = std::vector<const Descriptor*>;

const Descriptor& picture_format() {
  static const Descriptor self = {.name = "png", .title = "PNG picture", .extensions = {".png"}};
  return self;
}

const Descriptor& page_format() {
  static const Descriptor self = {.name = "html", .title = "HTML page", .extensions = {".html"}};
  return self;
}

bool can_be_written(const Descriptor& format, Command command) {
  if (command == Command::mesh) return format.write_mesh != nullptr;
  if (command == Command::edit) return format.insert_edit != nullptr;
  return format.write_fabric != nullptr || (format.open_bodies != nullptr && !format.is_companion);
}

std::string_view extension_of_gap_maps() {
  for (const Descriptor* format : formats::all_formats())
    if (format->write_gap_map != nullptr) return format->extensions.front();
  return {};
}

namespace {

std::string writable_names(Command command) {
  std::vector<std::string_view> names;
  for (const Descriptor* format : formats::all_formats())
    if (can_be_written(*format, command)) names.push_back(format->name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string writable_extensions(Command command) {
  if (command == Command::view)
    return fmt::format("{}, {}", picture_format().extensions.front(), page_format().extensions.front());
  std::vector<std::string_view> list;
  for (const Descriptor* format : formats::all_formats())
    if (can_be_written(*format, command))
      list.insert(list.end(), format->extensions.begin(), format->extensions.end());
  return fmt::format("{}", fmt::join(list, ", "));
}

Result<const Descriptor*> fitting(const Descriptor& format, Command command) {
  if (can_be_written(format, command)) return &format;
  std::string text = fmt::format("'selvage {}' cannot write {}; it writes: {}", name_of(command), format.name,
                                 writable_names(command));
  if (command != Command::mesh && format.write_mesh != nullptr) text += " (for a mesh: selvage mesh)";
  return error(Kind::usage, std::move(text));
}

Result<const Descriptor*> named_format(std::string_view name, Command command) {
  if (const Descriptor* format = format_named(name)) return fitting(*format, command);
  std::vector<std::string_view> known;
  for (const Descriptor* format : formats::all_formats()) known.push_back(format->name);
  const std::string_view near = nearest_word(name, known);
  return error(Kind::usage, fmt::format("unknown format '{}'{}; known are: {}", name,
                                        near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                                        writable_names(command)));
}

// The format that the name of -o tells; null when it tells none.
const Descriptor* told_by_output(const Options& options) {
  if (options.output.empty() || options.output == "-" || options.output.ends_with('/')) return nullptr;
  if (options.command == Command::view) {
    const std::string extension = fs::path(options.output).extension().string();
    for (const Descriptor* format : {&picture_format(), &page_format()})
      if (extension == format->extensions.front()) return format;
    return nullptr;
  }
  return format_with_extension(fs::path(options.output).extension().string());
}

// A name that tells no format is one of a folder. An extension that no format has is more likely a slip than
// the end of a folder's name, if there is no such folder.
Status check_extension(const Options& options) {
  const fs::path name = options.output;
  std::error_code failure;
  if (told_by_output(options) != nullptr || options.output == "-" || !name.has_extension() ||
      format_with_extension(name.extension().string()) != nullptr || fs::is_directory(name, failure))
    return {};
  return error(
      Kind::usage,
      fmt::format("'-o {}': no format has the extension '{}'; 'selvage {}' writes {} (for a folder of "
                  "this name, add a '/')",
                  options.output, name.extension().string(), name_of(options.command),
                  writable_extensions(options.command)));
}

// A picture, but for a name that says a page; a name that asks for something else is refused.
Result<Formats> picture_formats(const Options& options) {
  const std::string extension = fs::path(options.output).extension().string();
  if (format_with_extension(extension) != nullptr)
    return error(Kind::usage,
                 fmt::format("'selvage view' writes PNG pictures and HTML pages, and '{}' is no name for one",
                             options.output));
  if (Status known = check_extension(options); !known) return known.error();
  const Descriptor* told = told_by_output(options);
  return Formats{told != nullptr ? told : &picture_format()};
}

Result<Formats> wanted_formats(const Options& options) {
  if (options.command == Command::view) return picture_formats(options);
  if (Status known = check_extension(options); !known) return known.error();
  Formats wanted;
  for (const std::string_view name : split(options.formats, ',')) {
    Result<const Descriptor*> format = named_format(name, options.command);
    if (!format) return format.error();
    if (std::find(wanted.begin(), wanted.end(), *format) == wanted.end()) wanted.push_back(*format);
  }
  if (!wanted.empty()) return wanted;
  if (const Descriptor* told = told_by_output(options)) {
    Result<const Descriptor*> format = fitting(*told, options.command);
    if (!format) return format.error();
    return Formats{*format};
  }
  // A text that was worked on stays one.
  const bool is_text = options.command == Command::relax || options.command == Command::edit;
  for (const Descriptor* format : formats::all_formats())
    if ((is_text ? format->is_own : format->is_usual) && can_be_written(*format, options.command))
      wanted.push_back(format);
  return wanted;
}

Status check_single_output(const Options& options, const InputList& list, const Formats& wanted) {
  if (options.output == "-") {
    if (!list.one_file || wanted.size() != 1)
      return error(Kind::usage, "'-o -' takes one input and one format; name the format with --to");
    return {};
  }
  const Descriptor* told = told_by_output(options);
  if (told == nullptr) return {};
  if (wanted.size() > 1 || wanted.front() != told)
    return error(Kind::usage, fmt::format("'-o {}' names a file of {}, but --to asks for {}", options.output,
                                          told->name, options.formats));
  if (!list.one_file)
    return error(Kind::usage,
                 fmt::format("'-o {}' names one file, but there may be several inputs; name a folder",
                             options.output));
  return {};
}

fs::path output_path(const Options& options, const Input& input, const Descriptor& format) {
  if (told_by_output(options) != nullptr) return options.output;
  fs::path path = options.output.empty() ? fs::path(input.path).replace_extension()
                                         : fs::path(options.output) / input.stem;
  path += format.extensions.front();
  return path;
}

// The same for a file under every name that leads to it, and for no other: of that name's digest, as there
// may be 100,000.
struct Identity {
  explicit Identity(const fs::path& path) {
    std::error_code failure;
    fs::path real = fs::weakly_canonical(followed(path).value_or(path), failure);
    if (failure) real = fs::absolute(path, failure).lexically_normal();
    const std::string digest = sha256(real.native());
    for (std::size_t i = 0; i < words.size(); ++i)
      std::from_chars(&digest[16 * i], &digest[16 * i] + 16, words[i], 16);
  }
  bool operator==(const Identity&) const = default;

  std::array<std::uint64_t, 2> words{};
};

struct Bucket {
  std::size_t operator()(const Identity& identity) const { return identity.words[0]; }
};

template <class Value>
using ByIdentity = std::unordered_map<Identity, Value, Bucket>;

Status check_names(const Options& options, const InputList& list,
                   std::vector<std::vector<PlannedOutput>>& plan) {
  std::optional<Identity> report;
  if (!options.report.empty() && options.report != "-") report.emplace(options.report);
  ByIdentity<std::size_t> input_of;
  // Of names that may be files of a set: by the identity of the name that stands for the set.
  ByIdentity<std::vector<fs::path>> parts_of;
  const auto note_part = [&](const fs::path& path) {
    if (const std::optional<fs::path> whole = whole_path(path)) parts_of[Identity(*whole)].push_back(path);
  };
  for (std::size_t i = 0; i < plan.size(); ++i) {
    if (list.inputs[i].path == "-") continue;
    const std::vector<fs::path> files = files_of(list.inputs[i].path);
    for (const fs::path& file : files) {
      // One that is missing is told when it is opened.
      std::error_code failure;
      if (fs::exists(file, failure)) input_of.emplace(Identity(file), i);
      note_part(file);
    }
    // To write what stands for the set would be to replace it.
    if (files.size() > 1) input_of.emplace(Identity(*whole_path(files.front())), i);
  }
  if (report && input_of.contains(*report))
    return error(Kind::usage, fmt::format("the report '{}' would replace an input", options.report));
  ByIdentity<std::size_t> writer_of;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    for (const PlannedOutput& output : plan[i]) {
      if (output.to_standard_output) continue;
      const Identity name(output.path);
      if (name == report)
        return error(Kind::usage, fmt::format("the report and an output would both be '{}'", options.report));
      if (const auto found = input_of.find(name); found != input_of.end())
        return error(Kind::usage,
                     fmt::format("the output '{}' would replace the input '{}'; name another place with -o",
                                 output.path, list.inputs[found->second].path));
      if (const auto [found, is_new] = writer_of.emplace(name, i); !is_new)
        return error(
            Kind::usage,
            fmt::format(
                "'{}' and '{}' would both write '{}'; nothing was done (the files of a folder keep their "
                "subfolders: name the folder above them as the input)",
                list.inputs[found->second].path, list.inputs[i].path, output.path));
      note_part(output.path);
    }
  }
  for (std::vector<PlannedOutput>& outputs : plan)
    for (PlannedOutput& output : outputs)
      if (const auto found = parts_of.find(Identity(output.path)); found != parts_of.end())
        for (const fs::path& part : found->second)
          if (const std::optional<int> number = part_number(part))
            output.taken.push_back(part_path(output.path, *number));
  return {};
}

// `check --gap-map` writes one file, of one input.
Status plan_gap_map(const Options& options, const InputList& list,
                    std::vector<std::vector<PlannedOutput>>& plan) {
  if (options.gap_map.empty()) return {};
  const Descriptor* format = format_with_extension(fs::path(options.gap_map).extension().string());
  if (format == nullptr || format->write_gap_map == nullptr)
    return error(Kind::usage, fmt::format("--gap-map writes no file of the name '{}'; name a {} file",
                                          options.gap_map, extension_of_gap_maps()));
  if (!list.one_file)
    return error(Kind::usage, fmt::format("'--gap-map {}' names one file, but there may be several inputs; "
                                          "name one input",
                                          options.gap_map));
  for (std::vector<PlannedOutput>& outputs : plan) outputs.push_back({format, options.gap_map, false, {}});
  return {};
}

}  // namespace

Result<std::vector<std::vector<PlannedOutput>>> plan_outputs(const Options& options, const InputList& list) {
  std::vector<std::vector<PlannedOutput>> plan(list.inputs.size());
  if (options.command == Command::check || options.command == Command::info ||
      options.command == Command::roundtrip || options.command == Command::diff) {
    if (Status status = plan_gap_map(options, list, plan); !status.ok()) return status.error();
    if (Status status = check_names(options, list, plan); !status.ok()) return status.error();
    return plan;
  }
  Result<Formats> wanted = wanted_formats(options);
  if (!wanted) return wanted.error();
  if (Status status = check_single_output(options, list, *wanted); !status.ok()) return status.error();
  if (options.units && std::any_of(wanted->begin(), wanted->end(),
                                   [](auto* format) { return format->open_bodies == nullptr; }))
    return error(Kind::usage, "--units converts surfaces; text keeps the unit of its input");
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const Input& input = list.inputs[i];
    if (input.path == "-" && options.output.empty())
      return error(Kind::usage, "standard input has no folder for its outputs; name one with -o");
    for (const Descriptor* format : *wanted) {
      if (options.output == "-") {
        plan[i].push_back({format, "<stdout>", true, {}});
        continue;
      }
      const fs::path path = output_path(options, input, *format);
      plan[i].push_back({format, path, false, {}});
      if (format->companion == nullptr) continue;
      const Descriptor& second = format->companion();
      if (std::find(wanted->begin(), wanted->end(), &second) == wanted->end())
        plan[i].push_back(
            {&second, fs::path(path).replace_extension(second.extensions.front()), false, {}, true});
    }
  }
  if (options.command == Command::edit) return plan;  // it may replace its input
  if (Status status = check_names(options, list, plan); !status.ok()) return status.error();
  return plan;
}

}  // namespace selvage::pipeline
