// Whether this is a build with sanitizers (scripts/sanitize).
#pragma once

namespace selvage {

// The address and thread sanitizers keep tables of terabytes: there the address space of a process cannot be
// limited, and limits of memory are not held.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // gcc
inline constexpr bool sanitized = true;
#elif defined(__has_feature)  // clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace selvage
