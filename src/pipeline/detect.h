// Which format a file has: by its content, then by its extension.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/diagnostics.h"
#include "core/source.h"
#include "formats/format.h"

namespace selvage::pipeline {

// The format with this extension (with the dot, any case); null when there is none.
const formats::Descriptor* format_with_extension(std::string_view extension);
// The format with this name; null when there is none.
const formats::Descriptor* format_named(std::string_view name);

// By the first bytes, then by the extension; null when neither tells.
const formats::Descriptor* format_of(const Source& source);

// Error (unsupported): unknown, or known but not readable by this version.
Result<const formats::Descriptor*> detect_readable(const Source& source);

// For the search of folders: a format that can be read has its extension, or recognises its first bytes.
bool is_readable_format(const std::filesystem::path& path);

}  // namespace selvage::pipeline
