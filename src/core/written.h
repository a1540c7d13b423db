// All of some bytes to a descriptor.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace selvage {

// False: errno says why not all of them were written.
inline bool write_all(int descriptor, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t put = ::write(descriptor, bytes, size);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    bytes += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace selvage
