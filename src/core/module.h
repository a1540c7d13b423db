// Heavy libraries (OpenCASCADE, CGAL) are shared objects beside the program, opened only by a job that
// needs them, so that text -> IGES starts in milliseconds.
#pragma once

#include <exception>
#include <filesystem>
#include <new>
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
// The same, as the table that it is.
template <class Table>
Result<const Table*> module_table(const std::string& name, const std::string& entry) {
  Result<const void*> table = open_module(name, entry);
  if (!table) return table.error();
  return static_cast<const Table*>(*table);
}
// What a function of the table gives for these arguments; the error where there is no module.
template <class Table, class Value, class... Parameters, class... Arguments>
Result<Value> call(const Result<const Table*>& module, Result<Value> (*Table::*function)(Parameters...),
                   const Arguments&... arguments) {
  if (!module) return module.error();
  return ((*module)->*function)(arguments...);
}

// "needs more memory than the 2000 MB that it may take; --memory gives it more", of this process.
std::string memory_ended();

// Runs a module's `work`, which returns a Result or Status: what its library throws becomes an error that
// begins with `what`; the end of memory one of kind limit. No exception may leave a module: the program has a
// C++ runtime of its own, and to unwind from the one into the other aborts.
template <class Work>
auto guarded_by_module(const std::string& what, Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return error(Kind::limit, what + ": " + memory_ended());
  } catch (const std::exception& failure) {
    return error(Kind::internal, what + ": " + failure.what());
  }
}

// A worker program (`selvage-tetgen`) beside the program or in ../lib/selvage. Error (internal): missing.
Result<std::filesystem::path> find_worker(const std::string& name);

}  // namespace selvage
