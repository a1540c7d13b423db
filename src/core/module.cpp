#include "core/module.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <array>

namespace selvage {

namespace fs = std::filesystem;

fs::path program_folder() {
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  return failure ? fs::path() : program.parent_path();
}

namespace {

Result<fs::path> find_beside_program(const std::string& file) {
  const fs::path here = program_folder();
  if (here.empty())  // and certainly not the folder that the user happens to be in
    return error(Kind::internal, fmt::format("cannot find '{}': where this program stands is told by "
                                             "/proc/self/exe, which cannot be read",
                                             file));
  for (const fs::path& folder : std::array{here, here / "../lib/selvage"}) {
    std::error_code failure;
    if (fs::exists(folder / file, failure)) return folder / file;
  }
  return error(Kind::internal, fmt::format("the installation is incomplete: '{}' is neither in '{}' nor in "
                                           "'../lib/selvage' beside it",
                                           file, here.string()));
}

}  // namespace

std::string memory_ended() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return "needs more memory than there is";
  return fmt::format("needs more memory than the {} MB that it may take; --memory gives it more",
                     limit.rlim_cur >> 20U);
}

Result<const void*> open_module(const std::string& name, const std::string& entry) {
  Result<fs::path> path = find_beside_program("selvage_" + name + ".so");
  if (!path) return path.error();
  // Opening the same file again gives the same handle, and a module stays open until the process ends.
  void* handle = ::dlopen(path->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr)
    return error(Kind::internal, fmt::format("cannot open the module '{}': {}", path->string(), ::dlerror()));
  using Table = const void* (*)();
  auto table = reinterpret_cast<Table>(::dlsym(handle, entry.c_str()));
  if (table == nullptr)
    return error(Kind::internal, fmt::format("the module '{}' has no entry '{}'", path->string(), entry));
  return table();
}

Result<fs::path> find_worker(const std::string& name) {
  return find_beside_program(name);
}

}  // namespace selvage
