// Jobs in processes of their own: one that crashes, hangs or eats memory costs only itself.
//
// The parent stays small (it forks, so everything that it holds is shared, and nothing heavy is loaded in
// it); each job runs in a forked child that talks back through a pipe. No threads may run in the parent.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "core/diagnostics.h"

namespace selvage {

// The child's end of the pipe: packets of a one-letter kind and bytes.
class Channel {
 public:
  explicit Channel(int descriptor) : descriptor_(descriptor) {}
  // A parent that is gone ends the child (the kernel kills it), so a failed write needs no answer.
  void send(char kind, std::string_view bytes) const;

 private:
  int descriptor_;
};

struct JobEnd {
  enum class How {
    exited,       // status: what the job returned
    signalled,    // status: the signal's number
    timed_out,    // killed at its time limit
    not_started,  // status: errno of fork or pipe
  };
  How how = How::exited;
  int status = 0;
};

// Why a job ended badly, in words that a user can act on; nothing for How::exited. `seconds` and `mebibytes`
// are the limits that were in force.
std::string describe(const JobEnd& end, double seconds, double mebibytes);

struct JobPool {
  std::size_t count = 0;    // jobs 0 .. count-1, started in this order
  std::size_t at_once = 1;  // how many run at the same time
  double seconds = 0;       // wall-clock limit a job; 0: none
  double mebibytes = 0;     // limit of a job's address space; 0: none

  // In the child; the value returned (0-255) becomes JobEnd::status. Must not throw.
  std::function<int(std::size_t job, const Channel& channel)> run;
  // In the parent.
  std::function<void(std::size_t job, char kind, std::string_view bytes)> received;
  std::function<void(std::size_t job, const JobEnd& end)> finished;
  // In the parent, now and then; returns the seconds after which it wants to be called again.
  std::function<double()> tick;
  // In the parent, after SIGINT, SIGTERM or SIGHUP, for each job that had begun and was killed.
  std::function<void(std::size_t job)> interrupted;
};

// Runs all jobs; false when a signal interrupted them (the children are dead then). Children die with the
// parent, however it ends.
bool run_jobs(const JobPool& pool);

}  // namespace selvage
