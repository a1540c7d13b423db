#include "core/machine.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace selvage {

namespace fs = std::filesystem;

namespace {

constexpr double mebibyte = 1048576;

// "MemAvailable:   16000000 kB"
std::optional<double> of_machine(const fs::path& root) {
  std::ifstream file(root / "proc/meminfo");
  std::string word;
  double kibibytes = 0;
  while (file >> word)
    if (word == "MemAvailable:" && file >> kibibytes) return kibibytes / 1024;
  return std::nullopt;
}

// A number of bytes; "max" is none.
std::optional<double> limit_in(const fs::path& path) {
  std::ifstream file(path);
  double bytes = 0;
  if (file >> bytes && bytes > 0) return bytes / mebibyte;
  return std::nullopt;
}

// The least limit of the group and those above it; in a container the names above its own are not there.
std::optional<double> of_group(const fs::path& mount, const fs::path& group, const std::string& file) {
  std::optional<double> least;
  for (fs::path place = group.relative_path();; place = place.parent_path()) {
    if (const std::optional<double> limit = limit_in(mount / place / file))
      least = std::min(least.value_or(*limit), *limit);
    if (place.empty()) return least;
  }
}

}  // namespace

double available_memory(const fs::path& root) {
  std::optional<double> least = of_machine(root);
  const auto take = [&](const std::optional<double>& limit) {
    if (limit) least = std::min(least.value_or(*limit), *limit);
  };
  // "0::/a/b" (version 2), "9:memory:/a/b" (version 1)
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == line.npos || second == line.npos) continue;
    const std::string_view kind = std::string_view(line).substr(first + 1, second - first - 1);
    const fs::path group = line.substr(second + 1);
    if (kind.empty()) take(of_group(root / "sys/fs/cgroup", group, "memory.max"));
    if (kind == "memory") take(of_group(root / "sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return least.value_or(0);
}

}  // namespace selvage
