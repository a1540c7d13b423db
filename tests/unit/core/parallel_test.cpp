#include "core/parallel.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <chrono>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>

namespace selvage {
namespace {

// As long as it lives no thread starts: its stack would not fit into the address space.
class NoThreads {
 public:
  NoThreads() {
    ::pthread_getattr_default_np(&before_);
    pthread_attr_t huge;
    ::pthread_getattr_default_np(&huge);
    is_set_ = ::pthread_attr_setstacksize(&huge, std::size_t{1} << 47U) == 0 &&
              ::pthread_setattr_default_np(&huge) == 0;
    ::pthread_attr_destroy(&huge);
  }
  ~NoThreads() {
    ::pthread_setattr_default_np(&before_);
    ::pthread_attr_destroy(&before_);
  }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;
  [[nodiscard]] bool is_set() const { return is_set_; }

 private:
  pthread_attr_t before_{};
  bool is_set_ = false;
};

TEST(Parallel, GoesOnWithTheThreadsThatStart) {
  std::vector<int> done(1000, 0);
  std::size_t others = 0;
  {
    const NoThreads none;
    ASSERT_TRUE(none.is_set());
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);  // so it is
    for_each_index(done.size(), 8, [&](std::size_t i) { ++done[i]; });
  }
  for (const int count : done) others += count == 1 ? 0 : 1;
  EXPECT_EQ(others, 0U);
}

TEST(Parallel, ExceptionsOfThreadsComeToTheCaller) {
  EXPECT_THROW(for_each_index(1000, 4,
                              [](std::size_t i) {
                                if (i == 500) throw std::bad_alloc();
                              }),
               std::bad_alloc);
  EXPECT_THROW(for_each_index(3, 1, [](std::size_t) { throw std::runtime_error("one"); }),
               std::runtime_error);
}

TEST(Parallel, TakesInOrderWhatWasMadeInAny) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::size_t> slots(7), taken;
    bool is_taking = false;
    for_each_in_order(
        1000, slots.size(), threads,
        [&](std::size_t i, std::size_t slot) {
          std::this_thread::sleep_for(std::chrono::microseconds(i * 7919 % 13));
          slots[slot] = i * i;
        },
        [&](std::size_t i, std::size_t slot) {
          EXPECT_FALSE(is_taking);
          is_taking = true;
          EXPECT_EQ(slots[slot], i * i);
          taken.push_back(i);
          is_taking = false;
        });
    ASSERT_EQ(taken.size(), 1000U);
    for (std::size_t i = 0; i < taken.size(); ++i) EXPECT_EQ(taken[i], i);
  }
}

TEST(Parallel, NoMoreIsAheadThanThereIsRoomFor) {
  for (const int threads : {1, 2, 5})
    for (const std::size_t room : {1U, 3U, 6U}) {
      std::atomic<std::size_t> ahead = 0, most = 0;
      std::size_t taken = 0;
      for_each_in_order(
          300, 6, [&] { return room; }, threads,
          [&](std::size_t i, std::size_t) {
            const std::size_t now = ++ahead;
            for (std::size_t known = most; known < now && !most.compare_exchange_weak(known, now);) {
            }
            std::this_thread::sleep_for(std::chrono::microseconds(i * 7919 % 13));
          },
          [&](std::size_t i, std::size_t) {
            EXPECT_EQ(i, taken++);
            --ahead;
          });
      EXPECT_EQ(taken, 300U);
      EXPECT_LE(most, room);
    }
}

TEST(Parallel, AnExceptionEndsWhatComesInOrder) {
  const auto nothing = [](std::size_t, std::size_t) {};
  const auto at_500 = [](std::size_t i, std::size_t) {
    if (i == 500) throw std::runtime_error("500");
  };
  for (const int threads : {1, 4}) {
    EXPECT_THROW(for_each_in_order(1000, 8, threads, at_500, nothing), std::runtime_error);
    EXPECT_THROW(for_each_in_order(1000, 8, threads, nothing, at_500), std::runtime_error);
  }
}

}  // namespace
}  // namespace selvage
