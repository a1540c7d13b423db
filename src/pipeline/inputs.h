// The inputs of a run: every path, folder, pattern, list and "-" of the command line as files, in a fixed
// order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/shared_text.h"
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

// Kept in little memory, which processes share: a run may have 100,000, and each one's process begins as a
// copy of this one.
class Inputs {
 public:
  void add(const Input& input);
  [[nodiscard]] std::size_t size() const { return records_.size(); }
  [[nodiscard]] bool empty() const { return records_.empty(); }
  // Made anew by each call.
  [[nodiscard]] Input at(std::size_t index) const;
  // Input::path of it; it ends in a zero byte.
  [[nodiscard]] std::string_view path(std::size_t index) const { return records_[index]; }
  // Leaves those out whose path is as asked.
  template <class Predicate>
  void erase_if(const Predicate& is_unwanted) {
    std::erase_if(records_, [&](const char* record) { return is_unwanted(std::string_view(record)); });
  }
  // Keeps the I-th of N parts, which are contiguous and differ by at most one in size. 0 <= part < parts.
  void keep_part(std::size_t part, std::size_t parts);

 private:
  SharedText text_;
  std::vector<const char*> records_;  // fields that end in a zero byte, which no path has
};

struct InputList {
  Inputs inputs;  // in the order of the command line; the files of a folder sorted by their bytes
  std::vector<Message>
      missing;  // folders that cannot be read or hold nothing readable, patterns without a match
  std::vector<Message> notes;  // of what was passed by in folders
  bool one_file = false;       // the command line names exactly one file (no folder, no list)
};

// Symbolic links in a folder are followed to what is in it, and further only where the options allow files
// outside. Errors (usage): a list that cannot be read, or has what is no path, "-" twice, nothing named.
// `diff` and `edit` take files only, as they are named.
Result<InputList> inputs_of(const Options& options);

}  // namespace selvage::pipeline
