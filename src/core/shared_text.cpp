#include "core/shared_text.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstring>

namespace selvage {

SharedText::~SharedText() {
  for (const Block& block : blocks_)
    if (block.ordinary.empty()) ::munmap(block.begin, block.size);
}

std::string_view SharedText::keep(std::string_view text) {
  if (text.empty()) return {};
  if (blocks_.empty() || blocks_.back().size - used_ < text.size()) {
    constexpr std::size_t usual = std::size_t{1} << 20;
    const std::size_t size = std::max(usual, text.size());
    blocks_.emplace_back();
    Block& block = blocks_.back();
    void* place = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (place == MAP_FAILED) block.ordinary.resize(size);
    block.begin = block.ordinary.empty() ? static_cast<char*>(place) : block.ordinary.data();
    block.size = size;
    used_ = 0;
  }
  char* place = blocks_.back().begin + used_;
  std::memcpy(place, text.data(), text.size());
  used_ += text.size();
  return {place, text.size()};
}

}  // namespace selvage
