#include "core/text_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>

#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

TEST(TextQueue, WritesInTheOrderInWhichItWasTold) {
  for (const int threads : {1, 2, 5}) {
    OutputFile file = std::move(*OutputFile::in_memory());
    TextQueue queue(file, threads);
    std::string wanted;
    std::atomic<int> ahead = 0, most = 0;
    for (int i = 0; i < 500; ++i) {
      const std::string piece = std::to_string(i) + '\n';
      wanted += piece;
      if (i % 3 == 0) {
        queue.add(piece);
        continue;
      }
      queue.add([&, piece, i](std::string& text) {
        EXPECT_TRUE(text.empty());
        for (int known = most, now = ++ahead; known < now && !most.compare_exchange_weak(known, now);) {
        }
        std::this_thread::sleep_for(std::chrono::microseconds(i * 7919 % 13));
        text += piece;
        --ahead;
      });
    }
    ASSERT_TRUE(queue.finish().ok());
    EXPECT_EQ(*file.contents(), wanted);
    EXPECT_LE(most, threads);
    queue.add("more");
    ASSERT_TRUE(queue.finish().ok());
    EXPECT_EQ(*file.contents(), wanted + "more");
  }
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool keeps_what_is_freed = true;
#elif defined(__has_feature)
constexpr bool keeps_what_is_freed = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool keeps_what_is_freed = false;
#endif

// However much goes through it, little is kept.
TEST(TextQueue, KeepsLittle) {
  if (keeps_what_is_freed) GTEST_SKIP() << "the sanitizer keeps what is given back";
  const test::ScratchFolder scratch;
  const auto resident = [] {
    std::ifstream lines("/proc/self/status");
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));  // kB
    return 0L;
  };
  for (const int threads : {1, 3}) {
    Result<OutputFile> file = OutputFile::create(scratch / "text");
    ASSERT_TRUE(file.ok());
    TextQueue queue(*file, threads);
    const long before = resident();
    ASSERT_GT(before, 0);
    for (int i = 0; i < 200; ++i) {
      queue.add(std::string(1U << 20U, 'a'));
      if (i % 10 == 0) queue.add([](std::string& text) { text.assign(1U << 20U, 'b'); });
    }
    ASSERT_TRUE(queue.finish().ok());
    EXPECT_EQ(file->size(), 220U << 20U);
    EXPECT_LT(resident() - before, 80 * 1024);
  }
}

TEST(TextQueue, KeepsTheFirstFailure) {
  for (const int threads : {1, 3}) {
    const test::ScratchFolder scratch;
    Result<OutputFile> file = OutputFile::create(scratch.path() / "text");
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->commit().ok());  // nothing may be written afterwards
    TextQueue queue(*file, threads);
    int made = 0;
    for (int i = 0; i < 100; ++i) queue.add(std::string("text"));
    EXPECT_FALSE(queue.finish().ok());
    queue.add([&](std::string& text) { text += std::to_string(++made); });
    EXPECT_FALSE(queue.finish().ok());
    EXPECT_EQ(made, 0);  // for nothing
  }
}

TEST(TextQueue, ThrowsAgainWhatWasThrown) {
  for (const int threads : {1, 3}) {
    OutputFile file = std::move(*OutputFile::in_memory());
    TextQueue queue(file, threads);
    queue.add(std::string("before"));
    queue.add([](std::string&) { throw std::bad_alloc(); });
    for (int i = 0; i < 100; ++i) queue.add([](std::string& text) { text += "after"; });
    EXPECT_THROW((void)queue.finish(), std::bad_alloc);
    EXPECT_EQ(file.contents()->find("after"), std::string::npos);
  }
  // What was not waited for is dropped.
  OutputFile file = std::move(*OutputFile::in_memory());
  TextQueue queue(file, 3);
  for (int i = 0; i < 10; ++i) queue.add([](std::string& text) { text += "text"; });
}

}  // namespace
}  // namespace selvage
