// Input bytes: a file mapped into memory, standard input, or a buffer of a test. Files are opened here only.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/diagnostics.h"

namespace selvage {

// Bytes with the name that messages use for them. Movable; the view stays valid across moves.
class Source {
 public:
  // Maps a regular file, or reads to the end anything else that can be read (a pipe, "-" for standard input).
  // Errors (io): missing, a directory, a device (but for "-"), no permission, unreadable, a pipe that nothing
  // has opened to write to it within 10 s.
  static Result<Source> open(const std::filesystem::path& path);
  static Source from_memory(std::string bytes, std::string name = "<memory>");

  Source(Source&& other) noexcept;
  Source& operator=(Source&& other) noexcept;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source();

  [[nodiscard]] std::string_view bytes() const { return bytes_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  Source() = default;
  void release();

  std::string name_;
  std::unique_ptr<std::string> owned_;  // for bytes that are not mapped; its address survives a move
  void* mapping_ = nullptr;
  std::string_view bytes_;
};

}  // namespace selvage
