#include "core/machine.h"

#include <gtest/gtest.h>

#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

using test::put_bytes;
using test::ScratchFolder;

// A file system with 8000 MiB of memory to be had.
struct Machine : ScratchFolder {
  Machine() { put("proc/meminfo", "MemTotal:       16384000 kB\nMemAvailable:    8192000 kB\n"); }
  void put(const std::string& path, const std::string& bytes) const {
    const std::filesystem::path file = *this / path;
    std::filesystem::create_directories(file.parent_path());
    put_bytes(file, bytes);
  }
  [[nodiscard]] double memory() const { return available_memory(*this / ""); }
};

TEST(Machine, AvailableMemory) {
  EXPECT_EQ(Machine().memory(), 8000);
}

TEST(Machine, NothingIsKnown) {
  const ScratchFolder empty;
  EXPECT_EQ(available_memory(empty / ""), 0);
}

TEST(Machine, LeastLimitOfTheGroupsAbove) {
  const Machine machine;
  machine.put("proc/self/cgroup", "0::/user/job\n");
  machine.put("sys/fs/cgroup/user/job/memory.max", "max\n");
  EXPECT_EQ(machine.memory(), 8000);
  machine.put("sys/fs/cgroup/user/memory.max", "1073741824\n");
  EXPECT_EQ(machine.memory(), 1024);
  machine.put("sys/fs/cgroup/user/job/memory.max", "536870912\n");
  EXPECT_EQ(machine.memory(), 512);
}

// In a container the group's name is one of the host, and its files stand at the top.
TEST(Machine, GroupOfAContainer) {
  const Machine machine;
  machine.put("proc/self/cgroup", "0::/../docker/abc\n");
  machine.put("sys/fs/cgroup/memory.max", "1073741824\n");
  EXPECT_EQ(machine.memory(), 1024);
}

TEST(Machine, GroupsOfVersionOne) {
  const Machine machine;
  machine.put("proc/self/cgroup", "9:cpu:/x\n8:memory:/docker/abc\n");
  machine.put("sys/fs/cgroup/memory/memory.limit_in_bytes", "2147483648\n");
  EXPECT_EQ(machine.memory(), 2048);
  machine.put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(machine.memory(), 8000);
}

}  // namespace
}  // namespace selvage
