// A fabric in several files: NAME.1.igs, NAME.2.igs, ... Each says in itself which one of how many it is, and
// of which set (formats::PartMark), so that files of different runs are never taken for one fabric.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cad/model.h"
#include "core/diagnostics.h"
#include "core/source.h"
#include "formats/format.h"

namespace selvage::pipeline {

// File `number` of the set that stands for `whole`: "a/x.igs", 2 -> "a/x.2.igs".
std::filesystem::path part_path(const std::filesystem::path& whole, int number);
// The other way: "a/x.2.igs" -> "a/x.igs"; nothing where the name has no number.
std::optional<std::filesystem::path> whole_path(const std::filesystem::path& part);

// Its number.
std::optional<int> part_number(const std::filesystem::path& part);

// What the file says of itself; nothing where it cannot be read, or stands alone.
std::optional<formats::PartMark> mark_of(const std::filesystem::path& path);

// What to open for a name: its file or, where there is none, the first file of the set that it stands for.
std::filesystem::path first_file(const std::filesystem::path& path);

// The files of the set whose first one this is, in order; just the path itself where it is no such file.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& path);

// Of all files together: of one file its SHA-256, of several that of their digests. Error (io).
Result<std::string> digest_of(const std::filesystem::path& path);

// The model of a CAD file, or of all files of its set, one after the other. Errors and warnings to
// `diagnostics`; nothing comes back exactly when there was an error: also when a file of the set is missing,
// or is of another set. A later file by itself is read alone, with a warning.
std::optional<cad::Model> read_whole_model(const formats::Descriptor& format, const Source& source,
                                           Diagnostics& diagnostics);

// Removes what an earlier run left in the place of `whole` when that one wrote another number of files: parts
// from number `from` on that say that they are parts, up to the first that does not or is in `kept`, and,
// where `from` is above 1, `whole` itself. Error (io).
Status remove_stale_parts(const std::filesystem::path& whole, int from,
                          const std::vector<std::filesystem::path>& kept);

}  // namespace selvage::pipeline
