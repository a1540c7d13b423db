#include "pipeline/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "core/sha256.h"
#include "pipeline/detect.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;
using formats::Descriptor;
using formats::PartMark;

namespace {

constexpr std::size_t head_size = 4096;

std::optional<PartMark> mark_in(const Descriptor& format, std::string_view bytes) {
  if (format.part_mark == nullptr) return std::nullopt;
  return format.part_mark(bytes.substr(0, head_size));
}

void add_counts(std::map<std::string, std::uint64_t>& all,
                const std::map<std::string, std::uint64_t>& further) {
  for (const auto& [name, count] : further) all[name] += count;
}

// Puts the further file's content behind the first one's.
void join(cad::Model& model, cad::Model further) {
  for (cad::Part& part : further.parts) {
    part.origin.entity += " of " + further.file;
    model.parts.push_back(std::move(part));
  }
  for (cad::NamedCurve& curve : further.curves) {
    curve.origin.entity += " of " + further.file;
    model.curves.push_back(std::move(curve));
  }
  for (auto& [level, name] : further.levels) model.levels.emplace(level, std::move(name));
  add_counts(model.entities, further.entities);
  add_counts(model.unknown, further.unknown);
  model.resolution = std::min(model.resolution, further.resolution);
}

// File `number` of the set, or why it is not to be had.
Result<cad::Model> read_part(const Descriptor& format, const fs::path& path, const PartMark& first,
                             int number, Diagnostics& diagnostics) {
  Result<Source> source = Source::open(path);
  if (!source) {
    source.error().text +=
        fmt::format(": it is file {} of {} of the fabric, and all are needed", number, first.count);
    return source.error();
  }
  const std::optional<PartMark> mark = mark_in(format, source->bytes());
  if (!mark || *mark != PartMark{number, first.count, first.set})
    return error(Kind::malformed,
                 mark
                     ? fmt::format("this is file {} of {} of the set {}, where file {} of {} of "
                                   "the set {} is needed: the files come from different runs",
                                   mark->number, mark->count, mark->set, number, first.count, first.set)
                     : fmt::format("this is not file {} of {} of the set {}", number, first.count, first.set),
                 {.file = path.string()});
  const int errors = diagnostics.error_count();
  std::optional<cad::Model> model = format.read_model(*source, diagnostics);
  if (model) return std::move(*model);
  if (diagnostics.error_count() > errors)
    return error(Kind::malformed, "this file of the fabric has errors", {.file = path.string()});
  return error(Kind::internal, fmt::format("the reader of {} gave neither a model nor a reason", format.name),
               {.file = path.string()});
}

}  // namespace

fs::path part_path(const fs::path& whole, int number) {
  fs::path path = whole;
  path.replace_extension();
  path += fmt::format(".{}{}", number, whole.extension().string());
  return path;
}

std::optional<int> part_number(const fs::path& part) {
  const std::string stem = part.stem().string();
  const std::size_t point = stem.rfind('.');
  // Of "..2." the whole would be "..".
  if (point == std::string::npos || stem.find_first_not_of('.') >= point) return std::nullopt;
  int number = 0;
  const char* const end = stem.data() + stem.size();
  const auto [stop, failure] = std::from_chars(stem.data() + point + 1, end, number);
  if (failure != std::errc() || stop != end || number < 1 || stem[point + 1] == '0') return std::nullopt;
  return number;
}

std::optional<fs::path> whole_path(const fs::path& part) {
  if (!part_number(part)) return std::nullopt;
  const std::string stem = part.stem().string();
  return part.parent_path() / (stem.substr(0, stem.rfind('.')) + part.extension().string());
}

std::optional<PartMark> mark_of(const fs::path& path) {
  const Descriptor* format = format_with_extension(path.extension().string());
  std::error_code failure;
  if (format == nullptr || format->part_mark == nullptr || !fs::is_regular_file(path, failure))
    return std::nullopt;
  const Result<std::string> head = read_head(path, head_size);
  if (!head) return std::nullopt;
  return mark_in(*format, *head);
}

fs::path first_file(const fs::path& path) {
  std::error_code failure;
  if (fs::exists(path, failure)) return path;
  const fs::path first = part_path(path, 1);
  return mark_of(first) ? first : path;
}

std::vector<fs::path> files_of(const fs::path& path) {
  std::vector<fs::path> files = {path};
  const std::optional<fs::path> whole = whole_path(path);
  const std::optional<PartMark> mark = whole ? mark_of(path) : std::nullopt;
  if (!mark || mark->number != 1) return files;
  for (int number = 2; number <= mark->count; ++number) files.push_back(part_path(*whole, number));
  return files;
}

Result<std::string> digest_of(const fs::path& path) {
  const std::vector<fs::path> files = files_of(path);
  std::string digests;
  for (const fs::path& file : files) {
    Result<std::string> digest = sha256_of_file(file);
    if (!digest || files.size() == 1) return digest;
    digests += *digest;
  }
  return sha256(digests);
}

std::optional<cad::Model> read_whole_model(const Descriptor& format, const Source& source,
                                           Diagnostics& diagnostics) {
  std::optional<cad::Model> model = format.read_model(source, diagnostics);
  const std::optional<PartMark> mark = mark_in(format, source.bytes());
  if (!model || !mark) return model;
  const std::optional<fs::path> whole = whole_path(source.name());
  if (mark->number > 1 || (!whole && mark->count > 1)) {
    const std::string where =
        whole ? fmt::format("; '{}' stands for all", part_path(*whole, 1).string()) : std::string();
    diagnostics.add(warning(
        Kind::unsupported,
        fmt::format("this is file {} of {} of a fabric, read by itself{}", mark->number, mark->count, where),
        {.file = source.name()}));
    return model;
  }
  for (int number = 2; number <= mark->count; ++number) {
    Result<cad::Model> further = read_part(format, part_path(*whole, number), *mark, number, diagnostics);
    if (further && further->units != model->units)
      further = error(Kind::malformed, "its unit is not that of the first file of the fabric",
                      {.file = part_path(*whole, number).string()});
    if (!further) {
      diagnostics.add(further.error());
      return std::nullopt;
    }
    join(*model, std::move(*further));
  }
  return model;
}

Status remove_stale_parts(const fs::path& whole, int from, const std::vector<fs::path>& kept) {
  const auto remove = [](const fs::path& path) -> Status {
    std::error_code failure;
    fs::remove(path, failure);
    if (!failure) return {};
    return error(Kind::io, fmt::format("cannot remove this file of an earlier run: {}", failure.message()),
                 {.file = path.string()});
  };
  std::error_code failure;
  if (from > 1 && fs::is_regular_file(whole, failure))
    if (Status status = remove(whole); !status.ok()) return status;
  for (int number = from;; ++number) {
    const fs::path path = part_path(whole, number);
    const std::optional<PartMark> mark = mark_of(path);
    if (!mark || mark->number != number) return {};
    if (std::find(kept.begin(), kept.end(), path) != kept.end()) return {};
    if (Status status = remove(path); !status.ok()) return status;
  }
}

}  // namespace selvage::pipeline
