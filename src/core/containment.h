// What a process may still do that reads strangers' files, so that a flaw in a reader is not a door into the
// machine.
//
// Landlock (Linux 5.13) bounds the file system, a filter of system calls (seccomp) takes away the network,
// the start of programs and the kernel's rarer doors; neither can be undone, and what the process starts
// inherits both. Descriptors that are open stay usable: pipes, standard output.
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
  // Programs that may be started, with the dynamic loader. (The loader would start any program that can be
  // read, in this same containment: that is no more than the process could do by itself.)
  std::vector<std::filesystem::path> run;
  bool libraries = false;  // the system's, and what stands beside the program: modules can be opened
};

// Contains this process, which must have one thread only, for good, as far as `kernel` can. Error (internal):
// a step that `kernel` is said to know did not work.
Status contain(const Allowed& allowed, const Kernel& kernel);

}  // namespace selvage
