// libFuzzer's side: --target=NAME chooses what is run (libFuzzer passes options with two dashes by).
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string_view>

#include "fuzz/targets.h"

namespace {

const selvage::fuzz::Target* target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view option = "--target=";
  for (int i = 1; i < *count; ++i)
    if (const std::string_view word = (*arguments)[i]; word.starts_with(option))
      target = selvage::fuzz::target_named(word.substr(option.size()));
  if (target != nullptr) return 0;
  std::cout << selvage::fuzz::target_lines() << std::flush;  // what scripts/fuzz asks for
  std::_Exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->run({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  if (target->mutated != nullptr && seed % 2 == 0) {
    const auto mutate = [](std::string& bytes, std::size_t room) {
      const std::size_t length = bytes.size();
      bytes.resize(room);
      bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), length, room));
    };
    const std::optional<std::string> changed =
        target->mutated({reinterpret_cast<const char*>(data), size}, seed, mutate);
    if (changed && changed->size() <= most) {
      std::copy(changed->begin(), changed->end(), data);
      return changed->size();
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
