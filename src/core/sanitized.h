// Whether this is a build with sanitizers (scripts/sanitize).
#pragma once

namespace selvage {

// The address and thread sanitizers keep tables of terabytes: there the address space of a process cannot be
// limited, and limits of memory are not held.
#if defined(__has_feature)
#define SELVAGE_HAS_SANITIZER (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SELVAGE_HAS_SANITIZER 1
#else
#define SELVAGE_HAS_SANITIZER 0
#endif
inline constexpr bool sanitized = SELVAGE_HAS_SANITIZER;
#undef SELVAGE_HAS_SANITIZER

}  // namespace selvage
