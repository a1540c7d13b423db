// IGES for fuzzers: a byte put in anywhere shifts the columns of its line, and no reader comes far then. Here
// a file is taken apart into its records, one of them is changed, and the columns are written anew.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace selvage::fuzz {

// Changes bytes by chance; the result may have `most`.
using Mutate = std::function<void(std::string& bytes, std::size_t most)>;

// None: the bytes are no IGES file with a directory.
std::optional<std::string> mutated_iges(std::string_view bytes, std::uint32_t seed, const Mutate& mutate);

}  // namespace selvage::fuzz
