// A folder for files that nobody shall see.
#pragma once

#include <filesystem>

#include "core/diagnostics.h"

namespace selvage {

// Removed, with all that is in it, when the object goes: by the process that made it, not by its children.
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
  explicit TemporaryFolder(std::filesystem::path path);
  std::filesystem::path path_;
  int owner_ = 0;
};

}  // namespace selvage
