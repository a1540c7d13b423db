// Output files that are whole or not there.
//
// Bytes go to an unnamed file in the target's folder (or, where the file system has none, to a hidden one
// that is removed when the run fails); commit() makes them durable and gives them the target's name in one
// step. A process that is killed at any moment leaves the old file, or the new one, and nothing else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/diagnostics.h"

namespace selvage {

class OutputFile {
 public:
  // Creates missing folders above `target`. Errors (io): no permission, full, the target is a directory,
  // or a device or a pipe, which must not be replaced by a file.
  static Result<OutputFile> create(const std::filesystem::path& target);
  // Spooled, and copied to standard output by commit().
  static Result<OutputFile> standard_output();
  // In memory only, for tests: commit() keeps the bytes readable through contents().
  static Result<OutputFile> in_memory();

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();  // discards what was not committed

  // Unbuffered: hand over blocks of a MiB or so. write() appends after the last byte that write() wrote;
  // write_at() leaves that position alone and may pass the present end.
  Status write(std::string_view bytes);
  Status write_at(std::uint64_t offset, std::string_view bytes);
  // Reads `size` bytes at `offset` (for writers that must move what they wrote). Error: fewer are there.
  Result<std::string> read_at(std::uint64_t offset, std::size_t size) const;
  // Cuts or extends the file, and puts the position of write() there.
  Status resize(std::uint64_t size);

  // fsync, then the name. Nothing may be written afterwards. Errors (io) leave an existing target untouched.
  Status commit();

  [[nodiscard]] std::uint64_t size() const;
  [[nodiscard]] Result<std::string> contents() const;
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  // Another name for commit() to give, in the same folder. Error (io): it is a directory, a device or a pipe.
  Status set_target(const std::filesystem::path& target);
  // The hidden name used where there are no unnamed files: removed before and after each run.
  static std::filesystem::path hidden_name(const std::filesystem::path& target);

 private:
  enum class Form { file, standard_output, memory };

  OutputFile() = default;
  void discard();
  [[nodiscard]] Message io_error(std::string_view what) const;
  [[nodiscard]] Status check_target() const;
  Status copy_to_standard_output();

  Form form_ = Form::file;
  std::filesystem::path target_;
  int descriptor_ = -1;
  bool has_hidden_name_ = false;
  std::uint64_t position_ = 0;
};

}  // namespace selvage
