#include "pipeline/detect.h"

#include <fmt/format.h>

#include "core/words.h"
#include "formats/registry.h"

namespace selvage::pipeline {

using formats::all_formats;
using formats::Descriptor;

namespace {

constexpr std::size_t head_size = 4096;

const Descriptor* sniff(std::string_view head) {
  for (const Descriptor* format : all_formats())
    if (format->sniff != nullptr && format->sniff(head)) return format;
  return nullptr;
}

}  // namespace

const Descriptor* format_with_extension(std::string_view extension) {
  for (const Descriptor* format : all_formats())
    for (std::string_view own : format->extensions)
      if (same_word(own, extension)) return format;
  return nullptr;
}

const Descriptor* format_named(std::string_view name) {
  for (const Descriptor* format : all_formats())
    if (same_word(format->name, name)) return format;
  return nullptr;
}

const Descriptor* format_of(const Source& source) {
  if (const Descriptor* format = sniff(source.bytes().substr(0, head_size))) return format;
  return format_with_extension(std::filesystem::path(source.name()).extension().string());
}

Result<const Descriptor*> detect_readable(const Source& source) {
  const Descriptor* format = format_of(source);
  if (format != nullptr && format->is_readable()) return format;
  std::string readable;
  for (const Descriptor* other : all_formats())
    if (other->is_readable()) readable += fmt::format("{}{}", readable.empty() ? "" : ", ", other->name);
  return error(
      Kind::unsupported,
      format != nullptr
          ? fmt::format("this is {} ({}), which this version cannot read; it reads: {}", format->name,
                        format->title, readable)
          : fmt::format(
                "of no known format: neither its first bytes nor its extension tell; readable are: {}",
                readable),
      {.file = source.name()});
}

bool is_readable_format(const std::filesystem::path& path) {
  const Descriptor* format = format_with_extension(path.extension().string());
  if (format == nullptr || !format->is_readable()) {  // a .k is a program of a knitting machine, too
    const Result<std::string> head = read_head(path, head_size);
    format = head ? sniff(*head) : nullptr;
  }
  return format != nullptr && format->is_readable() && format->read_points == nullptr;
}

}  // namespace selvage::pipeline
