// libFuzzer's side: --target=NAME chooses what is run (libFuzzer passes options with two dashes by).
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
  // What scripts/fuzz asks for: one line a target.
  for (const selvage::fuzz::Target& known : selvage::fuzz::targets())
    std::cout << known.name << '\t' << known.seeds << '\t' << known.most << '\t' << known.does << '\n';
  std::cout.flush();
  std::_Exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
