#include "core/temporary.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <utility>

namespace selvage {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t digits = 16;
constexpr std::string_view folder_begin = "selvage-scratch-";

// Of this user, so that nobody's folder goes but his own.
bool is_ours(const fs::path& path) {
  struct stat facts {};
  return ::lstat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == ::geteuid();
}

bool is_temporary_name(std::string_view name, std::string_view begin, std::string_view end) {
  if (name.size() != begin.size() + digits + end.size() || !name.starts_with(begin) || !name.ends_with(end))
    return false;
  return name.substr(begin.size(), digits).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_abandoned(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct stat facts {};
  const bool is_free = ::fstat(descriptor, &facts) == 0 &&
                       (S_ISREG(facts.st_mode) || S_ISDIR(facts.st_mode)) &&
                       ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  ::close(descriptor);
  return is_free;
}

}  // namespace

std::string temporary_name(std::string_view begin, std::string_view end) {
  std::random_device source;
  const std::uint64_t number = std::uint64_t{source()} << 32U | source();
  return fmt::format("{}{:0{}x}{}", begin, number, digits, end);
}

bool hold(int descriptor) {
  while (::flock(descriptor, LOCK_EX) != 0)
    if (errno != EINTR) return true;
  struct stat facts {};
  return ::fstat(descriptor, &facts) != 0 || facts.st_nlink > 0;
}

std::vector<fs::path> abandoned_in(const fs::path& place, std::string_view begin, std::string_view end) {
  std::vector<fs::path> found;
  std::error_code failure;
  for (fs::directory_iterator entry(place, failure), last; !failure && entry != last;
       entry.increment(failure))
    if (is_temporary_name(entry->path().filename().string(), begin, end) && is_abandoned(entry->path()))
      found.push_back(entry->path());
  return found;
}

TemporaryFolder::TemporaryFolder(fs::path path, int lock)
    : path_(std::move(path)), lock_(lock), owner_(::getpid()) {}

TemporaryFolder::TemporaryFolder(TemporaryFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), lock_(std::exchange(other.lock_, -1)), owner_(other.owner_) {}

TemporaryFolder::~TemporaryFolder() {
  if (!path_.empty() && owner_ == ::getpid()) {
    std::error_code failure;  // what cannot be removed stays; nothing rests on it
    // To look into it takes a descriptor, which may not be had; an empty one goes without.
    if (!fs::remove(path_, failure)) fs::remove_all(path_, failure);
  }
  if (lock_ >= 0) ::close(lock_);
}

Result<TemporaryFolder> TemporaryFolder::create() {
  const char* named = std::getenv("TMPDIR");
  const fs::path place = named != nullptr && *named != '\0' ? named : "/tmp";
  std::error_code ignored;  // what cannot be removed stays: nothing rests on it
  for (const fs::path& folder : abandoned_in(place, folder_begin, ""))
    if (is_ours(folder)) fs::remove_all(folder, ignored);
  for (;;) {
    const fs::path path = place / temporary_name(folder_begin, "");
    const auto refused = [&] {
      return error(Kind::io, fmt::format("cannot make a temporary folder '{}': {}", path.string(),
                                         std::strerror(errno)));
    };
    if (::mkdir(path.c_str(), 0700) != 0) {
      if (errno == EEXIST) continue;
      return refused();
    }
    const int lock = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock < 0 && errno == ENOENT) continue;  // taken for abandoned, as hold() says
    if (lock < 0) {
      Message message = refused();
      ::rmdir(path.c_str());
      return message;
    }
    TemporaryFolder folder(path, lock);
    if (hold(lock)) return folder;
  }
}

}  // namespace selvage
