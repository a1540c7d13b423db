// Input bytes: a copy of a file, standard input, or a buffer of a test. Files are opened here only.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "core/diagnostics.h"

namespace selvage {

inline constexpr std::size_t any_size = std::numeric_limits<std::size_t>::max() / 2;

// Bytes with the name that messages use for them. Movable; the view stays valid across moves.
class Source {
 public:
  // Copies a regular file, or reads to the end anything else that can be read (a pipe, "-" for standard
  // input). Not mapped: what somebody else does to the file then neither changes bytes that a reader has
  // checked nor takes them away from it. Errors (io): missing, a directory, a device (but for "-"), no
  // permission, unreadable, a file that has changed meanwhile, a pipe that nothing has opened to write to it
  // within 10 s; limit: more than `most` bytes. Throws std::bad_alloc.
  static Result<Source> open(const std::filesystem::path& path, std::size_t most = any_size);
  static Source from_memory(std::string bytes, std::string name = "<memory>");

  Source(Source&& other) noexcept;
  Source& operator=(Source&& other) noexcept;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source();

  [[nodiscard]] std::string_view bytes() const { return bytes_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  // May messages show its words and lines? Not those of a file that a link elsewhere leads to, or of what is
  // no regular file (but standard input): they may be somebody else's.
  [[nodiscard]] bool may_be_quoted() const { return may_be_quoted_; }

 private:
  Source() = default;
  void release();

  std::string name_;
  std::unique_ptr<std::string> owned_;  // for bytes of no file; its address survives a move
  void* pages_ = nullptr;               // for bytes of a file
  std::string_view bytes_;
  bool may_be_quoted_ = true;
};

// The first bytes of a regular file, `size` at most. Errors (io).
Result<std::string> read_head(const std::filesystem::path& path, std::size_t size);

// Is the file in this folder or below it? Both canonical.
bool is_below(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace selvage
