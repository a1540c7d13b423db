#include "core/memory_files.h"

#include <sys/mman.h>

#include <mutex>
#include <vector>

namespace selvage {

namespace {

struct Spare {
  std::mutex one_at_a_time;
  std::vector<int> descriptors;
};
Spare& spare() {
  static Spare files;
  return files;
}

int make_memory_file() {
  return ::memfd_create("selvage", MFD_CLOEXEC);
}

}  // namespace

void reserve_memory_files(std::size_t count) {
  Spare& files = spare();
  const std::scoped_lock lock(files.one_at_a_time);
  while (files.descriptors.size() < count) {
    const int made = make_memory_file();
    if (made < 0) return;
    files.descriptors.push_back(made);
  }
}

int take_memory_file() {
  Spare& files = spare();
  const std::scoped_lock lock(files.one_at_a_time);
  if (files.descriptors.empty()) return make_memory_file();
  const int taken = files.descriptors.back();
  files.descriptors.pop_back();
  return taken;
}

}  // namespace selvage
