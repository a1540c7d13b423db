// What a process may still do that reads strangers' files, so that a flaw in a reader is not a door into the
// machine.
//
// Landlock (Linux 5.13) bounds the file system. A filter of system calls (seccomp) leaves those that readers,
// builders, meshers and writers need (core/call_filter.h): there are threads, but no processes and no
// programs, no network, no signals to others. Neither can be undone. Descriptors that are open stay usable:
// pipes, files.
#pragma once

#include <filesystem>
#include <vector>

#include "core/diagnostics.h"

namespace selvage {

enum class Sandbox {
  off,
  automatic,  // what the kernel has
  required,   // all of it, or an error
};

struct Kernel {
  int landlock = 0;      // version of its interface; 0: none
  bool filters = false;  // of system calls, for this processor
};
// The one that this runs on.
Kernel this_kernel();

// Error (usage): `required`, and this kernel does not have it all.
Status check_sandbox(Sandbox wanted, const Kernel& kernel);

struct Allowed {
  // Folders with all that is in them. What is not there, or cannot be opened, is left out.
  std::vector<std::filesystem::path> read;   // or files
  std::vector<std::filesystem::path> write;  // to read, too, and to make, replace and remove files in
  bool libraries = false;  // the system's, and what stands beside the program: modules can be opened
  // A socket to which it may send messages, as to a process that starts programs for it; negative: none.
  int requests = -1;
};

// Contains this process, which must have one thread only, for good, as far as `kernel` can. Error (internal):
// a step that `kernel` is said to know did not work.
Status contain(const Allowed& allowed, const Kernel& kernel);

}  // namespace selvage
