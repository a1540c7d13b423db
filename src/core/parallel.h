// The same work on many items by a few threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace selvage {

// Calls work(i) for i = 0 .. count - 1, in any order, on `threads` threads, or on as many as the machine lets
// start. The first exception is thrown again here.
template <class Work>
void for_each_index(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex guard;
  const auto run = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(guard);
      if (!failure) failure = std::current_exception();
    }
  };
  const std::size_t helpers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
  std::vector<std::thread> pool;
  pool.reserve(helpers);
  try {
    while (pool.size() + 1 < helpers) pool.emplace_back(run);
  } catch (const std::system_error&) {  // no room for its stack, or a limit: those that there are do it all
  }
  run();
  for (std::thread& t : pool) t.join();
  if (failure) std::rethrow_exception(failure);
}

// The same, with progress(done, count) after each; it may be empty.
template <class Work, class Progress>
void for_each_index(std::size_t count, int threads, const Work& work, const Progress& progress) {
  std::size_t done = 0;
  std::mutex guard;
  for_each_index(count, threads, [&](std::size_t i) {
    work(i);
    if (!progress) return;
    const std::lock_guard lock(guard);
    progress(++done, count);
  });
}

// Calls make(i, slot) for i = 0 .. count - 1 on `threads` threads (as above), in any order, and take(i, slot)
// for each after it, in order and never two at a time, by whichever thread is free. `slot`, 0 .. `slots` - 1,
// is i's own from its make() to its take(): where what was made waits. A make() begins only while fewer than
// room() others wait or are made, which is asked by one thread at a time and is at least 1, at most `slots`.
// The first exception ends it, and is thrown again here.
template <class Room, class Make, class Take>
void for_each_in_order(std::size_t count, std::size_t slots, const Room& room, int threads, const Make& make,
                       const Take& take) {
  std::mutex guard;
  std::condition_variable changed;
  std::vector<char> is_made(slots, 0);
  std::size_t next = 0, taken = 0;
  bool is_taking = false;
  const auto work = [&](std::size_t) {
    std::unique_lock lock(guard);
    const auto unlocked = [&](const auto& run) {
      lock.unlock();
      try {
        run();
      } catch (...) {
        lock.lock();
        taken = next = count;  // nobody begins another one
        changed.notify_all();
        throw;
      }
      lock.lock();
    };
    while (taken < count) {
      if (!is_taking && is_made[taken % slots] != 0) {
        is_taking = true;
        const std::size_t i = taken;
        unlocked([&] { take(i, i % slots); });
        is_taking = false;
        if (taken == count) break;
        is_made[i % slots] = 0;
        ++taken;
        changed.notify_all();
      } else if (next < count && next < taken + room()) {
        const std::size_t i = next++;
        unlocked([&] { make(i, i % slots); });
        is_made[i % slots] = 1;
        changed.notify_all();
      } else {
        changed.wait(lock);
      }
    }
  };
  const std::size_t helpers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
  for_each_index(helpers, threads, work);
}

// The same with room for all slots.
template <class Make, class Take>
void for_each_in_order(std::size_t count, std::size_t slots, int threads, const Make& make,
                       const Take& take) {
  for_each_in_order(
      count, slots, [slots] { return slots; }, threads, make, take);
}

}  // namespace selvage
