// replay TARGET FILE|FOLDER...: runs the target on files, as a fuzzer would, without a fuzzer. replay --list:
// the targets.
#include <filesystem>
#include <iostream>

#include "core/source.h"
#include "fuzz/targets.h"

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  return files;
}

}  // namespace

int main(int count, char** arguments) {
  if (count == 2 && std::string_view(arguments[1]) == "--list") {
    std::cout << selvage::fuzz::target_lines();
    return 0;
  }
  const selvage::fuzz::Target* target = count > 2 ? selvage::fuzz::target_named(arguments[1]) : nullptr;
  if (target == nullptr) {
    std::cerr << "usage: fuzz_replay TARGET FILE|FOLDER...; targets:";
    for (const selvage::fuzz::Target& known : selvage::fuzz::targets()) std::cerr << ' ' << known.name;
    std::cerr << '\n';
    return 2;
  }
  std::size_t ran = 0;
  for (int i = 2; i < count; ++i)
    for (const fs::path& file : files_of(arguments[i])) {
      const selvage::Result<selvage::Source> source = selvage::Source::open(file);
      if (!source) {
        std::cerr << selvage::to_string(source.error()) << '\n';
        return 1;
      }
      std::cerr << file.string() << std::endl;  // said before it runs: the last line tells which one it was
      target->run(source->bytes());
      ++ran;
    }
  std::cout << ran << " inputs of " << target->name << '\n';
  return ran > 0 ? 0 : 1;
}
