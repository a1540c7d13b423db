// The same work on many items by a few threads.
#pragma once

#include <algorithm>
#include <atomic>
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

}  // namespace selvage
