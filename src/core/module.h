// Heavy libraries (OpenCASCADE, CGAL) are shared objects beside the program, opened only by a job that
// needs them, so that text -> IGES starts in milliseconds.
#pragma once

#include <filesystem>
#include <string>

#include "core/diagnostics.h"

namespace selvage {

// The folder in which the running program, its modules and its worker programs stand. (For tests: the build's
// bin folder, found the same way.) Empty where /proc does not tell.
std::filesystem::path program_folder();

// Opens `selvage_NAME.so` beside the program (or in ../lib/selvage) once, and returns what its function
// `extern "C" const void* ENTRY()` gives: a pointer to a table of functions, declared in the header of the
// part that the module implements. Errors (internal): missing file, missing entry.
Result<const void*> open_module(const std::string& name, const std::string& entry);

// A worker program (`selvage-tetgen`) beside the program or in ../lib/selvage. Error (internal): missing.
Result<std::filesystem::path> find_worker(const std::string& name);

}  // namespace selvage
