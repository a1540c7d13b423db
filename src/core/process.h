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
  // A packet that cannot be sent ends the process: the parent then counts the job as failed (How::unheard).
  void send(char kind, std::string_view bytes) const;

 private:
  int descriptor_;
};

struct JobEnd {
  enum class How {
    exited,       // status: what the job returned
    signalled,    // status: the signal's number
    timed_out,    // killed at its time limit, or that of end_after()
    used_up,      // ended by the system's limit of processor time; status: its seconds
    not_started,  // status: errno of fork or pipe
    unheard,      // its packets, or its end, did not reach the parent; status: errno
  };
  How how = How::exited;
  int status = 0;
};

// Why a job ended badly, in words that a user can act on; nothing for How::exited. `seconds` is the limit
// that was in force, `memory` says how much memory it might take.
std::string describe(const JobEnd& end, double seconds, std::string_view memory);

// In a job: it has so many seconds from now on, and has ended as `timed_out` when they are over.
void end_after(double seconds);

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

enum class PoolEnd {
  complete,
  interrupted,  // by a signal; the children are dead
};

// Runs all jobs. Children die with the parent, however it ends. A job that cannot be started is tried again
// when another one has ended, and has ended as `not_started` when none is left to wait for. Error (limit):
// children cannot be watched at all; nothing was started.
Result<PoolEnd> run_jobs(const JobPool& pool);

}  // namespace selvage
