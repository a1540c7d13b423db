// selvage-tetgen as the starter of mesh workers, for a process that may start none: `selvage-tetgen start
// PROGRAM`.
//
// Standard input is a socket (SOCK_SEQPACKET). Each message hands over a StarterRequest as SCM_RIGHTS;
// PROGRAM is started with the number of the starter's process as its argument, and a StarterAnswer written
// when it has ended. Nobody who reads that any more is how it is asked to kill it. All are killed when the
// socket closes.
#pragma once

#include <cstdint>

namespace selvage::fem {

inline constexpr const char* start_word = "start";

// Ends of pipes, nothing else: a socket would keep its other end from seeing this process's end.
struct StarterRequest {
  int input = -1, output = -1, errors = -1;  // PROGRAM's standard streams
  int end = -1;                              // to which the answer goes
};

struct StarterAnswer {
  std::int32_t not_started = 0;  // errno, where it is not 0
  std::int32_t status = 0;       // of waitpid
};

// Until the socket closes; gives the process's exit status.
int start_programs(const char* program);

}  // namespace selvage::fem
