#include "formats/vtu/encoding.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base64.h"

namespace selvage::formats::vtu {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20U;

}  // namespace

Result<std::string> encode(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const Bytef*>(data);
  const std::size_t whole = size / block_size, rest = size % block_size;
  std::vector<std::uint64_t> head = {whole + (rest > 0 ? 1 : 0), block_size, rest};
  std::string blocks;
  std::vector<Bytef> room(compressBound(block_size));
  for (std::size_t at = 0; at < size; at += block_size) {
    uLongf length = room.size();
    if (compress2(room.data(), &length, bytes + at, std::min(block_size, size - at), 6) != Z_OK)
      return error(Kind::limit, "zlib ran out of memory");
    head.push_back(length);
    blocks.append(reinterpret_cast<const char*>(room.data()), length);
  }
  std::string text;
  append_base64(text, {reinterpret_cast<const char*>(head.data()), head.size() * sizeof(std::uint64_t)});
  append_base64(text, blocks);
  return text;
}

}  // namespace selvage::formats::vtu
