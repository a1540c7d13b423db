// List of the system calls of a contained process, as a filter of the kernel (seccomp); all others are
// refused.
//
// The list was made by tracing the commands over samples (Debian 12's C library, OpenCASCADE, CGAL, TetGen,
// Embree, oneTBB, HDF5). A call that is not in it fails with EPERM; one without which the C library has
// another way (clone3, openat2, ...), or that is newer than this list, fails with ENOSYS, so that it takes
// that way.
//
// libseccomp would write the same filter, but takes 0.7 ms in each process to do so, where a small input
// takes 3 ms in all.
#pragma once

namespace selvage {

// Of this processor's calls a filter can be made.
bool can_filter_calls();

// Takes all calls but those of the list away from this process and its threads, for good: no processes,
// programs, sockets, devices, attributes of files or executable memory that can be written. `requests`: a
// socket to which it may send messages; negative: none. False: errno says why not.
[[nodiscard]] bool filter_calls(int requests);

}  // namespace selvage
