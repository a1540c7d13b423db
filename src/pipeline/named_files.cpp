#include "pipeline/named_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "core/new_name.h"
#include "core/sha256.h"
#include "core/text_report.h"
#include "fabric/inside.h"
#include "fabric/measured.h"
#include "pipeline/detect.h"

namespace selvage::pipeline {

namespace {

namespace fs = std::filesystem;
using fabric::Draft;
using fabric::Weave;

Result<Draft> only_draft(const fabric::Fabric& fabric) {
  const Draft* draft = nullptr;
  bool has_levels = false;
  std::size_t weaves = 0;
  for (const fabric::Item& item : fabric.items) {
    const auto* const weave = std::get_if<Weave>(&item);
    if (weave == nullptr) continue;
    draft = &weave->draft;
    has_levels = !weave->columns.empty();
    ++weaves;
  }
  if (weaves != 1) return error(Kind::malformed, fmt::format("it has {} weaves, not one", weaves));
  if (has_levels) return error(Kind::malformed, "its weave has levels, and no draft");
  if (draft->form == Draft::Form::file)
    return error(Kind::unsupported,
                 fmt::format("its draft stands in a file, too: {}", in_quotes(draft->file)));
  return *draft;
}

// The fabric of a file; an error says why there is none in the words that follow the file's name.
Result<fabric::Fabric> fabric_in(const Source& source, std::string_view wanted, Diagnostics& diagnostics) {
  const Result<const formats::Descriptor*> format = detect_readable(source);
  if (!format) return format.error();
  if ((*format)->read_fabric == nullptr)
    return error(Kind::unsupported, fmt::format("it is {} ({}), which holds geometry and no {}",
                                                (*format)->name, (*format)->title, wanted));
  Diagnostics own;
  std::optional<fabric::Fabric> fabric = (*format)->read_fabric(source, own);
  for (const Message& message : own.messages()) diagnostics.add(message);
  if (!fabric) return error(Kind::malformed, "it has errors");
  return std::move(*fabric);
}

// What an input may cost with all files that it names, each counted as often as it is named: a text of a few
// lines may name two texts that name two more.
class Budget {
 public:
  // Error (limit): with this one more there are too many.
  Status name_file() {
    constexpr int most_files = 10'000;
    if (++files_ <= most_files) return {};
    return refuse(
        fmt::format("with all that these files name in turn, this input would read more than {} "
                    "files: `use` a file from one text, with `repeat` for its copies",
                    most_files));
  }
  // `path`: what the bytes were read from; they count as input where it was not read before.
  Status read(const fs::path& path, std::size_t bytes) {
    if (known_.insert(path).second) input_ += bytes;
    return take(bytes);
  }
  Status take(std::size_t bytes) {
    constexpr std::size_t free_bytes = 64'000'000, most_growth = 16;
    taken_ += bytes;
    const std::size_t most = free_bytes + most_growth * input_;
    if (taken_ <= most) return {};
    return refuse(
        fmt::format("the files that this input names are read again and again: {} bytes, and with "
                    "files of this size {} are the most; name each of them fewer times",
                    taken_, most));
  }
  // The error that it gave first.
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  Status refuse(std::string text) {
    if (status_) status_ = error(Kind::limit, std::move(text));
    return status_;
  }

  int files_ = 0;
  std::size_t input_ = 0, taken_ = 0;
  std::set<fs::path> known_;
  Status status_;
};

// A file of points as it was read; an error says why there is none.
struct MeasuredFile {
  fs::path path;
  Source source;
  Result<fabric::Measured> measured;
};

Result<fabric::Measured> measured_in(const Source& source, Diagnostics& diagnostics) {
  const Result<const formats::Descriptor*> format = detect_readable(source);
  if (!format) return format.error();
  if ((*format)->read_points == nullptr)
    return error(Kind::unsupported, fmt::format("it is {} ({}), which holds no yarns as points",
                                                (*format)->name, (*format)->title));
  std::optional<fabric::Measured> measured = (*format)->read_points(source, diagnostics);
  if (!measured) return error(Kind::malformed, "it has errors");
  return std::move(*measured);
}

// The yarn of a file of points, in the text's unit; an error says why there is none, at its place in that
// file where it has one.
Result<fabric::Yarn> measured_yarn(const fabric::PointsFile& wanted, bool takes_size, Unit units,
                                   const MeasuredFile& file, Budget& budget, Diagnostics& diagnostics) {
  if (!file.measured) return file.measured.error();
  const std::vector<fabric::MeasuredYarn>& yarns = file.measured->yarns;
  const auto found = wanted.yarn.empty() ? yarns.begin()
                                         : std::find_if(yarns.begin(), yarns.end(),
                                                        [&](const auto& y) { return y.name == wanted.yarn; });
  if (found == yarns.end() || (wanted.yarn.empty() && yarns.size() > 1)) {
    std::vector<std::string_view> names;
    names.reserve(yarns.size());
    for (const fabric::MeasuredYarn& yarn : yarns) names.push_back(yarn.name);
    return error(
        Kind::malformed,
        wanted.yarn.empty()
            ? fmt::format("it has {} yarns: say which one, as in yarn {}", yarns.size(), in_quotes(names[0]))
            : fmt::format("it has no yarn {}{}", in_quotes(wanted.yarn), did_you_mean(wanted.yarn, names)));
  }
  if (Status fits = budget.take(found->points.size() * sizeof(Vec3)); !fits) return fits.error();
  fabric::MeasuredYarn scaled = *found;
  if (file.measured->units)
    fabric::scale(scaled, millimetres_per(*file.measured->units) / millimetres_per(units));
  Result<fabric::Yarn> yarn = fabric::yarn_of(scaled, wanted.error, takes_size);
  if (yarn) return yarn;
  TextReport report(file.source);
  report.error(spot_at(file.source, yarn.error().place), yarn.error().text, yarn.error().kind);
  report.hand_over(diagnostics);
  return error(Kind::malformed, "it has errors");
}

// The text's own statements win: a direction up, a closed line, a section.
void take_shape(fabric::Yarn& yarn, fabric::Yarn measured) {
  const TextPlace place = std::get<fabric::PointsFile>(yarn.shape).place;
  yarn.shape = std::move(measured.shape);
  if (auto* path = std::get_if<fabric::Path>(&yarn.shape)) {
    path->place = place;  // rows of another file have no lines in this one
    path->lines.assign(path->points.size(), place.line);
  }
  yarn.closed = yarn.closed || measured.closed;
  if (!yarn.up) yarn.up = measured.up;
  if (!yarn.role) yarn.role = measured.role;
  if (measured.own.section) yarn.own.section = measured.own.section;
}

class NamedFiles {
 public:
  NamedFiles(const Source& input, bool allow_outside, Diagnostics& diagnostics)
      : allow_outside_(allow_outside), diagnostics_(diagnostics) {
    std::error_code failure;
    const fs::path folder = fs::path(input.name()).parent_path();
    home_ = fs::canonical(folder.empty() ? fs::path(".") : folder, failure);
    open_.push_back(fs::canonical(input.name(), failure));  // none of standard input
  }

  // Of one text with its blocks.
  void resolve(fabric::Fabric& fabric, const Source& source) {
    TextReport report(source);
    resolve(fabric, source, report, fabric.units);
    report.hand_over(diagnostics_);
  }
  std::vector<std::string> take_read() { return std::move(read_); }

 private:
  struct Opened {
    fs::path path;
    Source source;
  };
  // Of one text.
  struct UsedFiles {
    std::map<fs::path, std::string> blocks;  // their names
    TakenNames taken;                        // of blocks
  };

  // Where the file is that `text` calls `name`, if it may be read; an error says why not in the words that
  // follow its name.
  Result<fs::path> find(const std::string& name, const Source& text) {
    if (Status fits = budget_.name_file(); !fits) return fits.error();
    const fs::path folder = fs::path(text.name()).parent_path();
    std::error_code failure;
    const fs::path base = fs::canonical(folder.empty() ? fs::path(".") : folder, failure);
    if (failure) return error(Kind::io, fmt::format("cannot open its folder: {}", failure.message()));
    fs::path file = fs::canonical(base / name, failure);
    if (failure) return error(Kind::io, fmt::format("cannot open: {}", failure.message()));
    if (!allow_outside_ && !is_below(file, home_))
      return error(
          Kind::usage,
          "it is neither in this text's folder nor below it: move it there, or --allow-outside reads "
          "it");
    if (!fs::is_regular_file(file, failure)) return error(Kind::io, "it is not a regular file");
    return file;
  }
  Result<Opened> open(const std::string& name, const Source& text) {
    const Result<fs::path> file = find(name, text);
    return file ? open_at(*file, name, text) : file.error();
  }
  Result<Opened> open_at(const fs::path& file, const std::string& name, const Source& text) {
    const fs::path path = fs::path(text.name()).parent_path() / name;
    // Standard input is the input's alone.
    Result<Source> source = Source::open(path == "-" ? "./-" : path);
    if (!source) return source.error();
    if (Status fits = budget_.read(file, source->bytes().size()); !fits) return fits.error();
    read_.push_back(fmt::format("{} {}", name, sha256(source->bytes())));
    return Opened{file, std::move(*source)};
  }
  // The same of a file of points. Where it was the last one, it is not read again: a text names it for each
  // of its yarns.
  Result<const MeasuredFile*> measured(const std::string& name, const Source& text) {
    const Result<fs::path> file = find(name, text);
    if (!file) return file.error();
    if (!last_measured_ || last_measured_->path != *file) {
      Result<Opened> opened = open_at(*file, name, text);
      if (!opened) return opened.error();
      Result<fabric::Measured> read = measured_in(opened->source, diagnostics_);
      last_measured_.emplace(
          MeasuredFile{std::move(opened->path), std::move(opened->source), std::move(read)});
    }
    return &*last_measured_;
  }
  // At the line that names a file. Where the budget is spent, it is the input's line that is told, once.
  void refuse(TextReport& report, const Source& source, TextPlace place, std::string text, Kind kind) {
    if (!budget_.status() && (open_.size() > 1 || std::exchange(told_budget_, true))) return;
    report.error(spot_at(source, place), std::move(text), kind);
  }

  // `unit`: of the text; its blocks do not know it.
  void resolve(fabric::Fabric& fabric, const Source& source, TextReport& report, Unit unit) {
    around_.push_back(&fabric);
    for (fabric::NamedBlock& block : fabric.blocks) resolve(*block.fabric, source, report, unit);
    UsedFiles used;
    for (const fabric::NamedBlock& block : fabric.blocks) used.taken.try_emplace(block.name, 2);
    for (const fabric::Item& item : fabric.items)
      if (const auto* const use = std::get_if<fabric::Use>(&item)) used.taken.try_emplace(use->what, 2);
    for (fabric::Item& item : fabric.items) {
      if (auto* const weave = std::get_if<Weave>(&item);
          weave != nullptr && weave->draft.form == Draft::Form::file)
        resolve_draft(weave->draft, source, report);
      if (auto* const yarn = std::get_if<fabric::Yarn>(&item);
          yarn != nullptr && std::holds_alternative<fabric::PointsFile>(yarn->shape))
        resolve_points(*yarn, source, report, unit);
      if (auto* const use = std::get_if<fabric::Use>(&item); use != nullptr && use->is_file)
        resolve_use(*use, fabric, source, report, unit, used);
    }
    around_.pop_back();
  }

  void resolve_draft(Draft& draft, const Source& source, TextReport& report) {
    const auto fail = [&](const Message& why) {
      refuse(report, source, draft.place,
             fmt::format("no draft in the file {}: {}", in_quotes(draft.file), why.text), why.kind);
    };
    const Result<Opened> named = open(draft.file, source);
    if (!named) return fail(named.error());
    const Result<fabric::Fabric> fabric = fabric_in(named->source, "draft", diagnostics_);
    if (!fabric) return fail(fabric.error());
    Result<Draft> found = only_draft(*fabric);
    if (!found) return fail(found.error());
    found->place = draft.place;
    draft = std::move(*found);
  }

  void resolve_points(fabric::Yarn& yarn, const Source& source, TextReport& report, Unit unit) {
    const auto points = std::get<fabric::PointsFile>(yarn.shape);
    const auto fail = [&](const Message& why) {
      refuse(report, source, points.place,
             fmt::format("no yarn in the file {}: {}", in_quotes(points.file), why.text), why.kind);
    };
    const Result<const MeasuredFile*> named = measured(points.file, source);
    if (!named) return fail(named.error());
    // Of threads of one name the block's own.
    const fabric::Fabric* home = around_.back();
    for (const fabric::Fabric* text : around_)
      if (text->find_thread(yarn.thread) != nullptr) home = text;
    const fabric::Thread thread = fabric::resolved_thread(*home, yarn);
    const bool takes_size = !thread.section && !thread.diameter && !thread.linear_density;
    Result<fabric::Yarn> found = measured_yarn(points, takes_size, unit, **named, budget_, diagnostics_);
    if (!found) return fail(found.error());
    take_shape(yarn, std::move(*found));
  }

  void resolve_use(fabric::Use& use, fabric::Fabric& user, const Source& source, TextReport& report,
                   Unit unit, UsedFiles& used) {
    const auto fail = [&](const Message& why) {
      refuse(report, source, use.place,
             fmt::format("the file {} cannot be used: {}", in_quotes(use.what), why.text), why.kind);
    };
    Result<Opened> named = open(use.what, source);
    if (!named) return fail(named.error());
    std::string& name = used.blocks[named->path];
    if (name.empty()) {
      Result<std::shared_ptr<fabric::Fabric>> fabric = fabric_of(*named, unit);
      if (!fabric) {
        used.blocks.erase(named->path);
        return fail(fabric.error());
      }
      name = new_name(named->path, used);
      user.blocks.push_back({name, use.place, std::move(*fabric), nullptr});
    }
    use.what = name;
    use.is_file = false;
  }

  Result<std::shared_ptr<fabric::Fabric>> fabric_of(const Opened& file, Unit unit) {
    constexpr std::size_t deepest = 32;
    if (std::find(open_.begin(), open_.end(), file.path) != open_.end())
      return error(Kind::malformed, "it uses itself, by itself or by the files that it uses");
    if (open_.size() > deepest)
      return error(Kind::limit, fmt::format("more than {} files use each other in turn", deepest));
    // Its errors were told where it was used first.
    if (faulty_.contains(file.path)) return error(Kind::malformed, "it has errors");
    Result<fabric::Fabric> read = fabric_in(file.source, "yarns to use", diagnostics_);
    if (!read) {
      faulty_.insert(file.path);
      return read.error();
    }
    if (read->units != unit)
      return error(Kind::unsupported,
                   fmt::format("its unit is {}, that of this text {}: give both the same `units`",
                               name_of(read->units), name_of(unit)));
    open_.push_back(file.path);
    const int errors = diagnostics_.error_count();
    resolve(*read, file.source);
    open_.pop_back();
    if (Status fits = budget_.status(); !fits) return fits.error();
    if (diagnostics_.error_count() > errors) {
      faulty_.insert(file.path);
      return error(Kind::malformed, "it has errors");
    }
    std::erase_if(read->items,
                  [](const fabric::Item& item) { return std::holds_alternative<fabric::Piece>(item); });
    if (read->items.empty()) return error(Kind::malformed, "it has no yarns");
    read->cell.reset();
    read->title.reset();
    return std::make_shared<fabric::Fabric>(std::move(*read));
  }

  // After the file, such as no block is called that may be meant there.
  static std::string new_name(const fs::path& file, UsedFiles& used) {
    std::string stem = file.stem().string();
    for (char& c : stem)
      if (!(std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_')) c = '_';
    if (stem.empty() || std::isalpha(static_cast<unsigned char>(stem.front())) == 0) stem = "_" + stem;
    return selvage::new_name(used.taken, stem);
  }

  bool allow_outside_;
  Diagnostics& diagnostics_;
  Budget budget_;
  bool told_budget_ = false;
  std::optional<MeasuredFile> last_measured_;
  fs::path home_;                              // of the input
  std::vector<fs::path> open_;                 // texts that are being read, each used by the one before it
  std::vector<const fabric::Fabric*> around_;  // the block that is looked at, and what it stands in
  std::set<fs::path> faulty_;                  // files that were used and have errors
  std::vector<std::string> read_;
};

}  // namespace

std::vector<std::string> resolve_files(fabric::Fabric& fabric, const Source& source, bool allow_outside,
                                       Diagnostics& diagnostics) {
  NamedFiles files(source, allow_outside, diagnostics);
  const int errors = diagnostics.error_count();
  files.resolve(fabric, source);
  if (diagnostics.error_count() == errors)
    if (const Status fits = fabric::check_uses(fabric); !fits)
      diagnostics.add(Message(fits.error()).placed(fits.error().place, fabric.file));
  return files.take_read();
}

}  // namespace selvage::pipeline
