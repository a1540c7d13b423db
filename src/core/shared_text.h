// Text that is kept for long where processes are forked often: in memory that they share. Of other memory
// each fork copies what describes its pages, in proportion to their number. Where the system shares none,
// ordinary memory does.
#pragma once

#include <cstddef>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

namespace selvage {

class SharedText {
 public:
  SharedText() = default;
  SharedText(const SharedText&) = delete;
  SharedText& operator=(const SharedText&) = delete;
  SharedText(SharedText&& other) noexcept { *this = std::move(other); }
  SharedText& operator=(SharedText&& other) noexcept {
    std::swap(blocks_, other.blocks_);
    std::swap(used_, other.used_);
    return *this;
  }
  ~SharedText();

  // A copy that lives as long as this. Throws std::bad_alloc.
  std::string_view keep(std::string_view text);

 private:
  struct Block {
    char* begin = nullptr;
    std::size_t size = 0;
    std::vector<char> ordinary;  // where it stands, unless it is shared
  };
  std::deque<Block> blocks_;
  std::size_t used_ = 0;  // of the last block
};

}  // namespace selvage
