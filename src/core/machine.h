// What this machine, or the container that the program runs in, has.
#pragma once

#include <filesystem>

namespace selvage {

// MiB that processes can still take: what the kernel says is available, or the limit of a control group
// (version 1 or 2) above this process where that is lower. `root`: of the file system, for tests. 0: not
// known.
double available_memory(const std::filesystem::path& root = "/");

}  // namespace selvage
