// Bytes that come before those which stand in front of them in the file: they wait on the disk, not in
// memory.
#pragma once

#include <memory>
#include <utility>

#include "core/output.h"
#include "core/text_buffer.h"

namespace selvage {

class Spool {
 public:
  // Beside `output`, without a name. Errors: as OutputFile::create().
  static Result<std::unique_ptr<Spool>> beside(const OutputFile& output) {
    Result<OutputFile> file = output.scratch();
    if (!file) return file.error();
    return std::unique_ptr<Spool>(new Spool(std::move(*file)));
  }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  TextBuffer& text() { return text_; }
  // What was written so far, behind what `output` has. Errors: io, of either file.
  Status append_to(OutputFile& output) {
    if (Status whole = text_.finish(); !whole) return whole;
    return file_.read_all([&](std::string_view bytes) { return output.write(bytes); });
  }
  // Bytes that were written; all of them only after text().finish().
  [[nodiscard]] std::uint64_t size() const { return file_.size(); }

 private:
  explicit Spool(OutputFile file) : file_(std::move(file)), text_(file_) {}

  OutputFile file_;
  TextBuffer text_;
};

}  // namespace selvage
