#include "pipeline/limits.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

#include "core/containment.h"
#include "core/machine.h"
#include "core/module.h"
#include "core/output.h"
#include "tetrahedra/worker_process.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;

namespace {

// Address space is what is limited, and libraries take some of it that is no memory.
constexpr double least_share = 1024;  // MiB

// Where it is missing, with a name that lasts. What cannot be made is told when the output is.
void make_folder(const fs::path& folder) {
  std::error_code failure;
  if (folder.empty() || fs::exists(folder, failure)) return;
  make_folder(folder.parent_path());
  if (!fs::create_directory(folder, failure)) return;
  const int above = ::open(folder_of(folder).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (above < 0) return;
  ::fsync(above);
  ::close(above);
}

// Where the file that is written stands, all links followed.
fs::path place_of(const fs::path& output) {
  std::error_code failure;
  const fs::path target = fs::weakly_canonical(followed(output).value_or(output), failure);
  return folder_of(failure ? output : target);
}

}  // namespace

void NewFolders::expect(const fs::path& output) {
  if (!looked_at_.insert(folder_of(output)).second) return;
  std::error_code failure;
  for (fs::path folder = place_of(output); !folder.empty() && !fs::exists(folder, failure);
       folder = folder.parent_path())
    missing_.insert(folder);
}

NewFolders::~NewFolders() {
  // A folder stands behind the one above it.
  for (auto folder = missing_.rbegin(); folder != missing_.rend(); ++folder) ::rmdir(folder->c_str());
}

void share_memory(Options& options, std::size_t jobs) {
  if (options.memory > 0) return;
  const double available = available_memory();
  if (available <= 0) return;
  options.memory =
      std::floor(std::max(least_share, available / static_cast<double>(std::max<std::size_t>(1, jobs))));
  options.memory_is_share = true;
}

Status guarded(const Options& options, const std::function<void()>& work) {
  try {
    work();
    return {};
  } catch (const std::bad_alloc&) {
    return error(Kind::limit, fmt::format("needs more memory than {}", memory_limit(options)));
  } catch (const std::exception& failure) {
    return error(Kind::internal, fmt::format("unexpected failure: {}", failure.what()));
  }
}

std::string memory_limit(const Options& options) {
  if (options.memory <= 0) return "there is";
  if (!options.memory_is_share) return fmt::format("the {:g} MB of --memory", options.memory);
  return fmt::format("its share of the machine, {:g} MB; --memory gives it more", options.memory);
}

Status contain_job(const Options& options, std::span<const std::string> inputs,
                   std::span<const fs::path> outputs) {
  if (options.sandbox == Sandbox::off) return {};
  Allowed allowed;
  allowed.libraries = true;
  if (options.allow_outside) allowed.read.emplace_back("/");
  for (const std::string& input : inputs) {
    if (input.empty() || input == "-") continue;
    allowed.read.emplace_back(input);  // it may be a link to elsewhere
    allowed.read.push_back(folder_of(input));
  }
  for (const fs::path& output : outputs) {
    const fs::path folder = place_of(output);
    make_folder(folder);
    allowed.write.push_back(folder);
  }
  if (!options.scratch.empty()) allowed.write.emplace_back(options.scratch);
  if (options.command == Command::mesh) {
    // Where it is missing that is told when it is needed.
    if (const Result<fs::path> mesher = find_worker("selvage-tetgen")) {
      const Result<int> starter = fem::ready_starter(*mesher);
      if (!starter) return starter.error();
      allowed.requests = *starter;
    }
  }
  return contain(allowed, this_kernel());
}

}  // namespace selvage::pipeline
