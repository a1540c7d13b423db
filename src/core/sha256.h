// SHA-256 (FIPS 180-4) by libmd, for the report and for `--resume`.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/diagnostics.h"
#include "core/output.h"

namespace selvage {

// 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);
// Of a whole file that exists; error (io) when it cannot be read.
Result<std::string> sha256_of_file(const std::filesystem::path& path);
// Of an output before it is committed.
Result<std::string> sha256_of(const OutputFile& output);

}  // namespace selvage
