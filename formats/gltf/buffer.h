// The one buffer of a glTF file: vertices and triangles as bytes.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/base64.h"
#include "core/spool.h"

namespace selvage::formats::gltf {

// Of a .glb it stands behind all text, and waits in a spool; of a .gltf it is base64 inside the text, and is
// written as it comes.
class Buffer {
 public:
  // `text` outlives the buffer; `spool` null: base64 to `text`.
  Buffer(TextBuffer& text, std::unique_ptr<Spool> spool) : text_(text), spool_(std::move(spool)) {}

  Buffer& append(std::string_view bytes) {
    size_ += bytes.size();
    if (spool_) {
      spool_->text() << bytes;
    } else {
      waiting_ += bytes;
      if (waiting_.size() >= block) encode(waiting_.size() / 3 * 3);
    }
    return *this;
  }

  // The last letters of base64; nothing may be appended afterwards.
  void close() {
    if (!spool_) encode(waiting_.size());
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] bool is_embedded() const { return spool_ == nullptr; }
  // Of a .glb: all bytes, behind what `output` has.
  Status append_to(OutputFile& output) { return spool_->append_to(output); }

 private:
  static constexpr std::size_t block = std::size_t{1} << 16U;

  void encode(std::size_t count) {
    std::string letters;
    append_base64(letters, std::string_view(waiting_).substr(0, count));
    text_ << letters;
    waiting_.erase(0, count);
  }

  TextBuffer& text_;
  std::unique_ptr<Spool> spool_;
  std::string waiting_;  // for a third byte
  std::uint64_t size_ = 0;
};

}  // namespace selvage::formats::gltf
