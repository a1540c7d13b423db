// What a job may take of the machine, and reach of it.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "pipeline/options.h"
#include "pipeline/outputs.h"

namespace selvage::pipeline {

// Where no --timeout is given: of a file of another program, and of a text.
constexpr double foreign_timeout = 300, text_timeout = 600;  // seconds

// Where no --memory is given: each of so many jobs at once gets its share of the machine, but never so little
// that libraries could not be opened.
void share_memory(Options& options, std::size_t jobs);

// Does a job's work: what libraries throw does not leave it. Errors: limit (memory), internal.
Status guarded(const Options& options, const std::function<void()>& work);

// How much memory a job may take, and the remedy: "the 4000 MB of --memory".
std::string memory_limit(const Options& options);
// The folders of a run's outputs that are not there yet: jobs make them before they are contained, and those
// that are still empty go with this object.
class NewFolders {
 public:
  void expect(const std::filesystem::path& output);
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders();

 private:
  std::set<std::filesystem::path> looked_at_, missing_;
};

// In the process of a job, before it reads anything: it may read its inputs (empty names are none) and what
// stands beside or below them (anything, where the options allow files outside), and write to the folders of
// its outputs, which are made where they are missing. Error (internal): it cannot be contained.
Status contain_job(const Options& options, std::span<const std::string> inputs,
                   std::span<const std::filesystem::path> outputs);

}  // namespace selvage::pipeline
