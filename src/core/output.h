// Output files that are whole or not there.
//
// Bytes go to an unnamed file in the target's folder (or, where the file system has none, to a hidden one of
// a name that nothing else has). commit() makes them durable, then gives them the target's name in one step,
// then makes the name durable. A process that is killed at any moment leaves the old file or the new one;
// where it was about to replace one, or there are no unnamed files, also a hidden one, which
// remove_leftovers() removes.
//
// What is replaced is the file, not its content: other hard links to it keep the old content, and its owner
// is who runs the program. Its permissions stay. Of a symbolic link the file that it leads to is replaced (or
// made).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage {

// Where the links of `target` lead, also where nothing is there yet. None (errno tells): they go in a circle.
std::optional<std::filesystem::path> followed(const std::filesystem::path& target);

// The folder in which `path` is: "." where it names none.
std::filesystem::path folder_of(const std::filesystem::path& path);

class OutputFile {
 public:
  // Creates missing folders above `target`. Errors (io): no permission, full, the target is a directory,
  // or a device or a pipe, which must not be replaced by a file.
  static Result<OutputFile> create(const std::filesystem::path& target);
  // Spooled, and copied to standard output by commit().
  static Result<OutputFile> standard_output();
  // In memory only, for tests: commit() keeps the bytes readable through contents().
  static Result<OutputFile> in_memory();

  // Another one where this one is, for bytes that wait (core/spool.h): it gets no name, and goes with the
  // object.
  [[nodiscard]] Result<OutputFile> scratch() const;

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

  // Nothing may be written afterwards. An error (io) leaves an existing target untouched, unless only making
  // the new name durable failed.
  Status commit();
  // Several files that belong together: all are durable before the first one gets its name, and an error
  // leaves all targets as they were (but for those already replaced where the file system cannot exchange two
  // names: NFS, FAT). A process that is killed between two names leaves some of them new.
  static Status commit(std::span<OutputFile* const> files);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] Result<std::string> contents() const;
  // Hands over all bytes in their order, a block at a time, until `take` fails.
  Status read_all(const std::function<Status(std::string_view)>& take) const;
  // As it was named; a link is not followed.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  // Another name for commit() to give. Error (io): as create().
  Status set_target(const std::filesystem::path& target);

  // Where hidden files of this target are; nothing where it cannot be told.
  static std::optional<std::filesystem::path> hidden_folder(const std::filesystem::path& target);
  // Removes the hidden files that killed processes left in these folders; those of running ones stay. Folders
  // that cannot be read are left alone.
  static void remove_leftovers(const std::set<std::filesystem::path>& folders);

 private:
  enum class Form { file, standard_output, memory };
  enum class Named { no, anew, exchanged, replaced };

  OutputFile() = default;
  void discard();
  [[nodiscard]] Message io_error(std::string_view what) const;
  [[nodiscard]] std::string unnamed() const;  // what leads to a file without a name
  [[nodiscard]] Status check_target() const;
  Status make_folder();
  Status open_hidden();
  // The steps of commit().
  Status stage();
  Status hide();
  Status take_name(bool may_be_taken_back);
  void give_back_name();
  Status make_name_durable() const;

  Form form_ = Form::file;
  std::filesystem::path target_;
  std::filesystem::path place_;  // where the target's links lead
  std::filesystem::path
      made_below_;                // the folder in which the place's folders were made; empty: there were all
  std::filesystem::path hidden_;  // the file's name until it has its own; empty: none
  int descriptor_ = -1;
  std::uint64_t position_ = 0, size_ = 0;
  Named named_ = Named::no;
};

}  // namespace selvage
