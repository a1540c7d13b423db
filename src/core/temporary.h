// Files and folders that nobody shall see. Each has a name that nothing else has, and is locked while the
// process that made it (or one that it forked) lives: what an ended process left is told from what another
// one works with.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage {

// `begin`, 16 hexadecimal digits drawn at random, `end`.
std::string temporary_name(std::string_view begin, std::string_view end);

// Locks the open file or folder until every copy of `descriptor` is closed; false when it has lost its name
// before the lock was had (it was taken for abandoned). A file system without locks says true.
bool hold(int descriptor);

// The regular files and folders in `place` with a name of that form, which no user's own has by chance, that
// no process holds. Where the file system cannot tell, it is held.
std::vector<std::filesystem::path> abandoned_in(const std::filesystem::path& place, std::string_view begin,
                                                std::string_view end);

// Removed, with all that is in it, when the object goes: by the process that made it, not by its children.
// What a killed process left is removed when the next one makes a folder.
class TemporaryFolder {
 public:
  // In $TMPDIR, or /tmp. Error: io.
  static Result<TemporaryFolder> create();
  TemporaryFolder(TemporaryFolder&& other) noexcept;
  TemporaryFolder& operator=(TemporaryFolder&& other) = delete;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder(std::filesystem::path path, int lock);
  std::filesystem::path path_;
  int lock_ = -1;
  int owner_ = 0;
};

}  // namespace selvage
