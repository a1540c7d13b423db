// A mesh worker's process: its request goes to its standard input, its answer comes from its standard output.
//
// A contained process (core/containment.h) may start none. A starter does it for it: a process of
// selvage-tetgen that begins before the containment and is handed the ends of the pipes of each worker
// through a socket (tetgen_worker/starter.h). It ends with the process that it serves, and its workers with
// it.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::fem {

// The socket of the starter of this program in this process, which begins now if it has not yet. Error
// (internal): it cannot be had.
Result<int> ready_starter(const std::filesystem::path& program);

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close();
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

struct WorkerEnd {
  bool timed_out = false;
  int not_started = 0;  // errno, where it is not 0
  int status = 0;       // of waitpid
  std::string answer;
  std::string words;  // the last of what it printed
};

class WorkerProcess {
 public:
  using Clock = std::chrono::steady_clock;

  // `request`: its parts, which stay where they are as long as this does. Error (internal): no pipe, no
  // starter.
  static Result<WorkerProcess> start(const std::filesystem::path& program,
                                     std::vector<std::string_view> request);
  WorkerProcess(WorkerProcess&& other) noexcept = default;
  WorkerProcess& operator=(WorkerProcess&& other) noexcept = default;

  enum class Heard {
    all,
    not_yet,
    nothing,  // it cannot be read: errno says why
  };
  // Hands over the request, and takes the answer to its end, or until the deadline.
  Heard exchange(Clock::time_point deadline);
  // Its answer has ended, or it is killed; the process is gone afterwards.
  WorkerEnd finish(bool has_ended);

 private:
  WorkerProcess() = default;
  bool send_some();
  void take_words();
  void await_end();

  std::vector<std::string_view> request_;  // what has not been sent
  Descriptor request_end_, worker_request_end_;
  Descriptor answers_, words_end_, status_;
  std::string answer_, words_;
};

// Why something cannot be done for the worker, by errno.
Message system_error(std::string_view what);

}  // namespace selvage::fem
