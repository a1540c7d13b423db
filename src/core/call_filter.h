// List of the system calls of a contained process, as a filter of the kernel (seccomp); all others are
// refused.
//
// The list was made by tracing every command over the samples and the tests (Debian 12's C library,
// OpenCASCADE, CGAL, TetGen, Embree, oneTBB, HDF5). A call that is not in it fails with EPERM; one that has a
// successor of which the C library makes use where there is one (clone3, openat2, ...), or that is newer than
// this list, fails with ENOSYS, so that the C library falls back to what the list has.
//
// libseccomp would write the same filter, but takes 0.7 ms to do so, which each input would pay: more than
// all else that its process takes to start.
#pragma once

namespace selvage {

// Of this processor's calls a filter can be made.
bool can_filter_calls();

// Takes all calls but those of the list away from this process and its threads, for good: no processes,
// programs, sockets, devices, attributes of files or executable memory that can be written. `requests`: a
// socket to which it may send messages; negative: none. False: errno says why not.
[[nodiscard]] bool filter_calls(int requests);

}  // namespace selvage
