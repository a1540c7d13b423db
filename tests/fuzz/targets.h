// What is run on bytes that chance makes: by libFuzzer (fuzzer.cpp, scripts/fuzz), and by the tests on every
// input that was kept (replay.cpp). A target may refuse its bytes in any way it likes; it must neither crash,
// nor break a rule of C++, nor go on without end.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/iges_mutation.h"

namespace selvage::fuzz {

struct Target {
  std::string name;
  std::string does;      // a few words, for the table
  std::string seeds;     // extension of the samples that it starts from; empty: any bytes
  std::size_t most = 0;  // bytes of an input
  std::function<void(std::string_view bytes)> run;
  // Changes that keep to the format's lines, made in every second step; null: bytes alone are changed.
  std::optional<std::string> (*mutated)(std::string_view bytes, std::uint32_t seed,
                                        const Mutate& mutate) = nullptr;
};

// A reader of each format that the program reads, then what comes after readers.
const std::vector<Target>& targets();

// A line a target: name, extension of its seeds, bytes at most, what it does; between tabs (scripts/fuzz.py).
std::string target_lines();

// Null: there is none of this name.
const Target* target_named(std::string_view name);

}  // namespace selvage::fuzz
