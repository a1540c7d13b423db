// Text on its way to an OutputFile: collected in one reused block, numbers in their shortest exact form.
#pragma once

#include <string_view>
#include <vector>

#include "core/number_text.h"
#include "core/output.h"

namespace selvage {

// The first failure of a write is kept, and everything after it is dropped; finish() tells.
class TextBuffer {
 public:
  explicit TextBuffer(OutputFile& output, std::size_t block = std::size_t{1} << 20U)
      : output_(output), block_(block + max_number_length) {}

  TextBuffer& operator<<(std::string_view text) {
    while (!text.empty()) {
      reserve(1);
      const std::size_t part = std::min(text.size(), block_.size() - used_);
      text.copy(block_.data() + used_, part);
      used_ += part;
      text.remove_prefix(part);
    }
    return *this;
  }
  TextBuffer& append(std::string_view text) { return *this << text; }
  TextBuffer& operator<<(char letter) {
    reserve(1);
    block_[used_++] = letter;
    return *this;
  }
  TextBuffer& operator<<(double value) { return number(value); }
  TextBuffer& operator<<(float value) { return number(value); }
  TextBuffer& operator<<(std::size_t value) { return number(static_cast<long long>(value)); }
  TextBuffer& operator<<(int value) { return number(static_cast<long long>(value)); }

  // What is written from here on is dropped, too.
  void fail(Message message) {
    if (status_.ok()) status_ = std::move(message);
  }

  Status finish() {
    flush();
    return status_;
  }

 private:
  template <class T>
  TextBuffer& number(T value) {
    reserve(max_number_length);
    used_ = static_cast<std::size_t>(write_number(block_.data() + used_, value) - block_.data());
    return *this;
  }
  void reserve(std::size_t size) {
    if (used_ + size > block_.size()) flush();
  }
  void flush() {
    if (status_.ok() && used_ > 0) status_ = output_.write({block_.data(), used_});
    used_ = 0;
  }

  OutputFile& output_;
  std::vector<char> block_;
  std::size_t used_ = 0;
  Status status_;
};

}  // namespace selvage
