// The inputs of a run: every path, folder, pattern, list and "-" of the command line as files, in a fixed
// order.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

struct Input {
  std::string path;     // as the user would name it; "-": standard input
  std::string stem;     // of its outputs, below the output folder, without an extension: "a/plain"
  std::string other{};  // of `diff`: the path of what it is compared with; else empty
  std::vector<fabric::Setting> settings{};  // of its params

  // As reports call it: the path, of a variant `PATH?pitch=0.9&turns=200`.
  [[nodiscard]] std::string name() const;
};

struct InputList {
  std::vector<Input> inputs;  // in the order of the command line; the files of a folder sorted by their bytes
  std::vector<Message>
      missing;            // folders that cannot be read or hold nothing readable, patterns without a match
  bool one_file = false;  // the command line names exactly one file (no folder, no list)
};

// Errors (usage): a list that cannot be read, "-" twice, nothing named. `diff` and `edit` take files only, as
// they are named.
Result<InputList> inputs_of(const Options& options);

// Keeps the I-th of N parts, which are contiguous and differ by at most one in size. 0 <= part < parts.
template <class T>
void keep_part(std::vector<T>& list, std::size_t part, std::size_t parts) {
  const std::size_t count = list.size();
  list.resize(count * (part + 1) / parts);
  list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count * part / parts));
}

}  // namespace selvage::pipeline
