#include "core/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <new>
#include <set>
#include <stdexcept>

namespace selvage {
namespace {

// Bytes of address space in use.
rlim_t used() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return static_cast<rlim_t>(pages) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

// As long as it lives there is room for little more than what there is: not for the stack of a thread.
class Cramped {
 public:
  Cramped() {
    ::getrlimit(RLIMIT_AS, &before_);
    rlimit small = before_;
    small.rlim_cur = used() + (4U << 20U);
    is_set_ = ::setrlimit(RLIMIT_AS, &small) == 0;
  }
  ~Cramped() { ::setrlimit(RLIMIT_AS, &before_); }
  Cramped(const Cramped&) = delete;
  Cramped& operator=(const Cramped&) = delete;
  [[nodiscard]] bool is_set() const { return is_set_; }

 private:
  rlimit before_{};
  bool is_set_ = false;
};

TEST(Parallel, GoesOnWithTheThreadsThatStart) {
  std::vector<int> done(1000, 0);
  std::size_t others = 0;
  {
    const Cramped cramped;
    ASSERT_TRUE(cramped.is_set());
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);  // the limit holds
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

}  // namespace
}  // namespace selvage
