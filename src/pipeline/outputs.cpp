#include "pipeline/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <utility>

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

std::vector<fs::path> places_of(const PlannedOutput& output) {
  const fs::path path = output.path;
  if (output.format->folders.empty()) return {path};
  std::vector<fs::path> places = {path / path.filename()};
  for (const std::string_view folder : output.format->folders)
    places.push_back(path / folder / path.filename());
  return places;
}

bool can_be_written(const Descriptor& format, Command command) {
  if (command == Command::mesh) return format.write_mesh != nullptr || format.write_raster != nullptr;
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
  if (format.write_raster != nullptr) text += " (for voxels: selvage mesh --voxel N)";
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
  bool operator<(const Identity& other) const { return words < other.words; }

  std::array<std::uint64_t, 2> words{};
};

// Whose a name is.
struct Owned {
  Identity name;
  std::size_t input;
  bool operator<(const Owned& other) const {
    return name == other.name ? input < other.input : name < other.name;
  }
};

// Null: none has that name. The list is sorted.
const Owned* first_of(const std::vector<Owned>& list, const Identity& name) {
  const auto found =
      std::lower_bound(list.begin(), list.end(), name,
                       [](const Owned& one, const Identity& wanted) { return one.name < wanted; });
  return found == list.end() || found->name != name ? nullptr : &*found;
}

// `check --gap-map` writes one file, of one input; other commands that write none have no formats.
Result<Formats> gap_map_formats(const Options& options, const InputList& list) {
  if (options.command != Command::check || options.gap_map.empty()) return Formats{};
  const Descriptor* format = format_with_extension(fs::path(options.gap_map).extension().string());
  if (format == nullptr || format->write_gap_map == nullptr)
    return error(Kind::usage, fmt::format("--gap-map writes no file of the name '{}'; name a {} file",
                                          options.gap_map, extension_of_gap_maps()));
  if (!list.one_file)
    return error(Kind::usage, fmt::format("'--gap-map {}' names one file, but there may be several inputs; "
                                          "name one input",
                                          options.gap_map));
  return Formats{format};
}

// Names of the formats that have this option of their own.
std::vector<std::string_view> formats_with(const Option& option) {
  std::vector<std::string_view> names;
  for (const Descriptor* format : formats::all_formats())
    if (std::ranges::find(format->options, &option) != format->options.end()) names.push_back(format->name);
  return names;
}

// An option of a format is a mistake where nothing is written as that, or where it asks for a second file and
// there is only standard output.
Status check_own_options(const Options& options, const Formats& wanted) {
  for (const Descriptor* format : formats::all_formats())
    for (const Option* option : format->options) {
      if (!options.of_formats.has(*option)) continue;
      const std::vector<std::string_view> names = formats_with(*option);
      if (std::ranges::none_of(wanted,
                               [&](auto* one) { return std::ranges::find(names, one->name) != names.end(); }))
        return error(Kind::usage, fmt::format("{} is an option of {}, and nothing is written as that",
                                              option->long_name(), alternatives(names)));
      if (options.output == "-" && format->companion.asked_by == option)
        return error(Kind::usage, fmt::format("{} makes two files, and standard output takes one: name a "
                                              "file or a folder with -o",
                                              option->long_name()));
    }
  return {};
}

bool has_companion(const Options& options, const Descriptor& format) {
  const formats::Companion& beside = format.companion;
  return beside.format != nullptr && (beside.asked_by == nullptr || options.of_formats.has(*beside.asked_by));
}

// Decks of other formats are elastic.
Status check_transport(fem::Physics physics, const Formats& wanted) {
  for (const Descriptor* format : wanted) {
    if (format->carries_transport) continue;
    std::string others;
    for (const Descriptor* other : formats::all_formats())
      if (other->carries_transport) others += fmt::format(" --to {}", other->name);
    return error(Kind::usage, fmt::format("{} holds no deck of --physics {}: write it with{}", format->name,
                                          fem::transport_law(physics).word, others));
  }
  return {};
}

// What an explicit step needs of its options and formats.
Status check_forming(const Options& options, const Formats& wanted) {
  if (options.forming.thickness && options.forming.load != fem::FormingLoad::compaction)
    return error(Kind::usage, fmt::format("--thickness is of --load compaction, not of {}",
                                          fem::name_of(options.forming.load)));
  for (const Descriptor* format : wanted) {
    if (format->carries_forming) continue;
    std::string others;
    for (const Descriptor* other : formats::all_formats())
      if (other->carries_forming) others += fmt::format(" --to {}", other->name);
    return error(Kind::usage,
                 fmt::format("{} holds no deck of --deck explicit: write it with{}", format->name, others));
  }
  return {};
}

Status check_beams(const Options& options, const Formats& wanted) {
  for (const Descriptor* format : wanted) {
    if (has_companion(options, *format) && format->companion.asked_by != nullptr)
      return error(Kind::usage, fmt::format("beams are written in one file: leave out {}",
                                            format->companion.asked_by->name));
    if (format->write_beams != nullptr) continue;
    std::string others;
    for (const Descriptor* other : formats::all_formats())
      if (other->write_beams != nullptr) others += fmt::format(" --to {}", other->name);
    return error(Kind::usage,
                 fmt::format("{} is not written with beams: write them with{}", format->name, others));
  }
  return {};
}

// Is it a companion, which is written with another format?
bool is_beside_another(const Descriptor& format) {
  const Formats& all = formats::all_formats();
  return std::any_of(all.begin(), all.end(), [&](const Descriptor* other) {
    return other->companion.format != nullptr && &other->companion.format() == &format;
  });
}

// Not every format holds interfaces, nor every one curved ones.
Status check_joining(const Options& options, const Formats& wanted) {
  const bool is_cohesive = options.joining == fem::Joining::cohesive;
  const std::string_view word = is_cohesive ? "cohesive" : "surfaces";
  if (options.physics != fem::Physics::elastic)
    return error(
        Kind::usage,
        fmt::format("--interface {} is of elastic materials, and --physics {} of a cell that is bonded", word,
                    fem::transport_law(options.physics).word));
  const auto order_of = [&](const Descriptor& format) {
    return is_cohesive ? format.order_of_cohesive : format.order_of_surfaces;
  };
  for (const Descriptor* format : wanted) {
    if (format->write_mesh == nullptr || order_of(*format) >= std::max(options.order, 1)) continue;
    std::string others;
    for (const Descriptor* other : formats::all_formats())
      if (order_of(*other) >= std::max(options.order, 1) && !is_beside_another(*other))
        others += fmt::format(" --to {}", other->name);
    return error(Kind::usage, fmt::format("{} has no elements for --interface {}{}: write it with{}{}",
                                          format->name, word, options.order == 2 ? " --order 2" : "", others,
                                          order_of(*format) > 0 ? ", or with --order 1" : ""));
  }
  return {};
}

// Pore spaces have patches, and no elements that carry anything.
Status check_pores(const Options& options, const Formats& wanted) {
  for (const Descriptor* format : wanted) {
    if (format->is_of_pores && !options.pores)
      return error(Kind::usage,
                   fmt::format("{} holds the space between the yarns of a cell: add --pores", format->name));
    if (options.layers > 0) {
      if (options.order == 2)
        return error(Kind::usage, "--layers is of tetrahedra and wedges with straight edges: --order 1");
      if (!format->has_layers) {
        std::string others;
        for (const Descriptor* other : formats::all_formats())
          if (other->has_layers) others += fmt::format(" --to {}", other->name);
        return error(Kind::usage,
                     fmt::format("{} does not hold --layers: write them with{}", format->name, others));
      }
    }
    if (!options.pores || (format->order_of_pores >= std::max(options.order, 1))) continue;
    std::string others;
    for (const Descriptor* other : formats::all_formats())
      if (other->order_of_pores >= std::max(options.order, 1)) others += fmt::format(" --to {}", other->name);
    return error(Kind::usage, fmt::format("{} does not hold --pores{}: write them with{}{}", format->name,
                                          options.order == 2 ? " of --order 2" : "", others,
                                          format->order_of_pores > 0 ? ", or with --order 1" : ""));
  }
  return {};
}

// A folder of files, which have no place on standard output.
Status check_folders(const Options& options, const Formats& wanted) {
  for (const Descriptor* format : wanted)
    if (!format->folders.empty() && options.output == "-")
      return error(Kind::usage, fmt::format("{} is a folder of files, and standard output takes one: name a "
                                            "place with -o",
                                            format->name));
  return {};
}

bool writes_files(Command command) {
  return command != Command::check && command != Command::info && command != Command::roundtrip &&
         command != Command::diff;
}

}  // namespace

Result<Plan> Plan::make(const Options& options, InputList& list) {
  const bool writes = writes_files(options.command);
  Result<Formats> wanted = writes ? wanted_formats(options) : gap_map_formats(options, list);
  if (!wanted) return wanted.error();
  if (writes) {
    if (Status status = check_single_output(options, list, *wanted); !status.ok()) return status.error();
    if (options.units && std::any_of(wanted->begin(), wanted->end(),
                                     [](auto* format) { return format->open_bodies == nullptr; }))
      return error(Kind::usage, "--units converts surfaces; text keeps the unit of its input");
    if (Status status = check_own_options(options, *wanted); !status.ok()) return status.error();
    for (const Descriptor* format : *wanted)
      if (format->write_raster != nullptr && options.voxels == 0)
        return error(
            Kind::usage,
            fmt::format("{} holds the voxels of a unit cell: say how many with --voxel N", format->name));
    if (are_lines(options.elements))
      if (Status status = check_beams(options, *wanted); !status.ok()) return status.error();
    if (options.forming.wanted)
      if (Status status = check_forming(options, *wanted); !status.ok()) return status.error();
    if (Status status = check_folders(options, *wanted); !status.ok()) return status.error();
    if (Status status = check_pores(options, *wanted); !status.ok()) return status.error();
    if (options.physics != fem::Physics::elastic)
      if (Status status = check_transport(options.physics, *wanted); !status.ok()) return status.error();
    if (options.joining != fem::Joining::bonded)
      if (Status status = check_joining(options, *wanted); !status.ok()) return status.error();
  }
  Plan plan(options);
  plan.formats_ = std::move(*wanted);
  plan.inputs_ = std::move(list.inputs);
  if (writes)
    if (Status status = plan.check_standard_input(); !status.ok()) return status.error();
  // `edit` may replace its input.
  if (options.command != Command::edit)
    if (Status status = plan.check_names(); !status.ok()) return status.error();
  return plan;
}

Status Plan::check_standard_input() const {
  if (!options_->output.empty()) return {};
  for (std::size_t i = 0; i < size(); ++i)
    if (inputs_.path(i) == "-")
      return error(Kind::usage, "standard input has no folder for its outputs; name one with -o");
  return {};
}

std::vector<PlannedOutput> Plan::outputs_of(const Input& input) const {
  std::vector<PlannedOutput> outputs;
  for (const Descriptor* format : formats_) {
    if (options_->command == Command::check) {
      outputs.push_back({format, options_->gap_map});
      continue;
    }
    if (options_->output == "-") {
      outputs.push_back({format, "<stdout>", true});
      continue;
    }
    const fs::path path = output_path(*options_, input, *format);
    outputs.push_back({format, path});
    const formats::Companion& beside = format->companion;
    if (!has_companion(*options_, *format)) continue;
    const Descriptor& second = beside.format();
    if (std::find(formats_.begin(), formats_.end(), &second) != formats_.end()) continue;
    fs::path name = fs::path(path).replace_extension();
    name += beside.ending;
    name += second.extensions.front();
    outputs.push_back({&second, name, false, {}, &beside});
  }
  return outputs;
}

PlannedInput Plan::at(std::size_t index) const {
  PlannedInput planned;
  planned.input = inputs_.at(index);
  planned.outputs = outputs_of(planned.input);
  if (!taken_.empty())
    for (PlannedOutput& output : planned.outputs)
      if (const auto found = taken_.find(output.path); found != taken_.end()) output.taken = found->second;
  return planned;
}

Status Plan::check_names() {
  std::optional<Identity> report;
  if (!options_->report.empty() && options_->report != "-") report.emplace(options_->report);
  std::vector<Owned> inputs;
  inputs.reserve(size());
  // Of names that may be files of a set: by the identity of the name that stands for the set.
  std::map<Identity, std::vector<fs::path>> parts_of;
  const auto note_part = [&](const fs::path& path) {
    if (const std::optional<fs::path> whole = whole_path(path)) parts_of[Identity(*whole)].push_back(path);
  };
  for (std::size_t i = 0; i < size(); ++i) {
    if (inputs_.path(i) == "-") continue;
    const std::vector<fs::path> files = files_of(inputs_.path(i));
    for (const fs::path& file : files) {
      // One that is missing is told when it is opened.
      std::error_code failure;
      if (fs::exists(file, failure)) inputs.push_back({Identity(file), i});
      note_part(file);
    }
    // To write what stands for the set would be to replace it.
    if (files.size() > 1) inputs.push_back({Identity(*whole_path(files.front())), i});
  }
  std::sort(inputs.begin(), inputs.end());
  if (report && first_of(inputs, *report) != nullptr)
    return error(Kind::usage, fmt::format("the report '{}' would replace an input", options_->report));
  std::vector<Owned> outputs;
  outputs.reserve(size() * formats_.size());
  for (std::size_t i = 0; i < size() && !formats_.empty(); ++i) {
    for (const PlannedOutput& output : outputs_of(inputs_.at(i))) {
      if (output.to_standard_output) continue;
      const Identity name(output.path);
      if (name == report)
        return error(Kind::usage,
                     fmt::format("the report and an output would both be '{}'", options_->report));
      if (const Owned* input = first_of(inputs, name))
        return error(Kind::usage,
                     fmt::format("the output '{}' would replace the input '{}'; name another place with -o",
                                 output.path, inputs_.path(input->input)));
      outputs.push_back({name, i});
      note_part(output.path);
    }
  }
  std::sort(outputs.begin(), outputs.end());
  // Of several the first in the order of the inputs.
  const Owned* first = nullptr;
  for (std::size_t k = 0; k + 1 < outputs.size(); ++k)
    if (outputs[k].name == outputs[k + 1].name &&
        (first == nullptr || outputs[k + 1].input < std::next(first)->input))
      first = &outputs[k];
  if (first != nullptr) {
    const std::size_t second = std::next(first)->input;
    std::string path;
    for (const PlannedOutput& output : outputs_of(inputs_.at(second)))
      if (Identity(output.path) == first->name) path = output.path;
    return error(
        Kind::usage,
        fmt::format("'{}' and '{}' would both write '{}'; nothing was done (the files of a folder keep their "
                    "subfolders: name the folder above them as the input)",
                    inputs_.path(first->input), inputs_.path(second), path));
  }
  if (parts_of.empty()) return {};
  for (std::size_t i = 0; i < size(); ++i)
    for (const PlannedOutput& output : outputs_of(inputs_.at(i)))
      if (const auto found = parts_of.find(Identity(output.path)); found != parts_of.end())
        for (const fs::path& part : found->second)
          if (const std::optional<int> number = part_number(part))
            taken_[output.path].push_back(part_path(output.path, *number));
  return {};
}

}  // namespace selvage::pipeline
