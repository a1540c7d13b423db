// Nameless files in memory, for output that waits until it is whole. A contained process (core/containment.h)
// cannot make any: it takes what was reserved before.
#pragma once

#include <cstddef>

namespace selvage {

// As many are there from now on; what the system refuses is missing then.
void reserve_memory_files(std::size_t count);

// A descriptor, which is the caller's. Negative: errno says why there is none.
int take_memory_file();

}  // namespace selvage
