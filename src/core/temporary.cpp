#include "core/temporary.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

namespace selvage {

TemporaryFolder::TemporaryFolder(std::filesystem::path path) : path_(std::move(path)), owner_(::getpid()) {}

TemporaryFolder::TemporaryFolder(TemporaryFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), owner_(other.owner_) {}

TemporaryFolder::~TemporaryFolder() {
  if (path_.empty() || owner_ != ::getpid()) return;
  std::error_code ignored;  // what cannot be removed stays; nothing rests on it
  std::filesystem::remove_all(path_, ignored);
}

Result<TemporaryFolder> TemporaryFolder::create() {
  const char* place = std::getenv("TMPDIR");
  std::string name =
      (std::filesystem::path(place != nullptr && *place != '\0' ? place : "/tmp") / "selvage-XXXXXX")
          .string();
  if (::mkdtemp(name.data()) == nullptr)
    return error(Kind::io,
                 fmt::format("cannot make a temporary folder '{}': {}", name, std::strerror(errno)));
  return TemporaryFolder(name);
}

}  // namespace selvage
