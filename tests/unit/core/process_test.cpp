#include "core/process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <string>
#include <vector>

#include "core/sanitized.h"
#include "unit/core/forked.h"

namespace selvage {
namespace {

using test::in_a_child;

// Runs `count` jobs that do this.
struct Outcome {
  bool started = false;
  std::vector<JobEnd> ends;
  std::string heard;
};
Outcome run_all(std::size_t count, std::size_t at_once,
                const std::function<int(std::size_t, const Channel&)>& work) {
  Outcome outcome;
  outcome.ends.resize(count);
  JobPool pool;
  pool.count = count;
  pool.at_once = at_once;
  pool.run = work;
  pool.received = [&](std::size_t, char, std::string_view bytes) { outcome.heard += bytes; };
  pool.finished = [&](std::size_t job, const JobEnd& end) { outcome.ends[job] = end; };
  const Result<PoolEnd> end = run_jobs(pool);
  outcome.started = end.ok();
  return outcome;
}

int say_number(std::size_t job, const Channel& channel) {
  channel.send('m', std::to_string(job));
  return static_cast<int>(job) + 1;
}

// This process can open `more` descriptors from now on.
void leave_descriptors(rlim_t more) {
  const int next = ::open("/dev/null", O_RDONLY);
  ::close(next);
  const rlimit limit{static_cast<rlim_t>(next) + more, static_cast<rlim_t>(next) + more};
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

TEST(Process, ResultsAndEnds) {
  const Outcome outcome = run_all(3, 2, say_number);
  ASSERT_TRUE(outcome.started);
  EXPECT_EQ(outcome.heard.size(), 3U);
  for (int job = 0; job < 3; ++job) {
    EXPECT_EQ(outcome.ends[static_cast<std::size_t>(job)].how, JobEnd::How::exited);
    EXPECT_EQ(outcome.ends[static_cast<std::size_t>(job)].status, job + 1);
  }
}

TEST(Process, NoDescriptorForSignals) {
  EXPECT_EQ(in_a_child([] {
              leave_descriptors(0);
              return run_all(2, 1, say_number).started ? 1 : 0;
            }),
            0);
}

// Each job ends as one that could not be started: nothing is waited for.
TEST(Process, NoDescriptorsForPipes) {
  EXPECT_EQ(in_a_child([] {
              leave_descriptors(1);
              const Outcome outcome = run_all(3, 2, say_number);
              if (!outcome.started) return 1;
              for (const JobEnd& end : outcome.ends)
                if (end.how != JobEnd::How::not_started || end.status != EMFILE) return 2;
              return 0;
            }),
            0);
}

// Room for the pipe of one job at a time: the others follow when it has ended.
TEST(Process, JobsWaitForRoom) {
  EXPECT_EQ(in_a_child([] {
              leave_descriptors(3);
              const Outcome outcome = run_all(5, 4, say_number);
              if (!outcome.started) return 1;
              for (const JobEnd& end : outcome.ends)
                if (end.how != JobEnd::How::exited) return 2;
              return 0;
            }),
            0);
}

// As a shell's `trap '' CHLD` leaves it to the programs that it starts.
TEST(Process, IgnoredChildrenAreSeenToEnd) {
  EXPECT_EQ(in_a_child([] {
              std::signal(SIGCHLD, SIG_IGN);
              const Outcome outcome = run_all(3, 2, say_number);
              for (const JobEnd& end : outcome.ends)
                if (end.how != JobEnd::How::exited) return 2;
              return outcome.heard.size() == 3 ? 0 : 1;
            }),
            0);
}

TEST(Process, UnheardResultsAreNoSuccess) {
  const Outcome outcome = run_all(1, 1, [](std::size_t, const Channel& channel) {
    for (int descriptor = 3; descriptor < 100; ++descriptor) ::close(descriptor);
    channel.send('m', "lost");
    return 0;
  });
  EXPECT_EQ(outcome.ends[0].how, JobEnd::How::unheard);
  EXPECT_NE(describe(outcome.ends[0], 0, ""), "");
}

TEST(Process, OwnTimeLimit) {
  const Outcome outcome = run_all(1, 1, [](std::size_t, const Channel&) {
    end_after(0.1);
    for (;;) ::pause();
    return 0;
  });
  EXPECT_EQ(outcome.ends[0].how, JobEnd::How::timed_out);
}

// The system ends a process at its limit of processor time by one signal where the limit can be raised, and
// by another, as of somebody who kills it, where it cannot.
TEST(Process, ProcessorTimeOfTheSystem) {
  for (const rlim_t hard : {rlim_t{1}, rlim_t{5}})
    EXPECT_EQ(in_a_child([hard] {
                const rlimit limit{1, hard};
                ::setrlimit(RLIMIT_CPU, &limit);
                const Outcome outcome = run_all(1, 1, [](std::size_t, const Channel&) {
                  volatile unsigned turns = 0;
                  while (turns < 2) turns = 1;
                  return 0;
                });
                const JobEnd& end = outcome.ends[0];
                if (end.how != JobEnd::How::used_up || end.status != 1) return 1;
                return describe(end, 0, "").find("1 s of processor time") == std::string::npos ? 2 : 0;
              }),
              0);
}

// A limit that is lower already stays.
TEST(Process, MemoryIsNotRaised) {
  if (sanitized) GTEST_SKIP() << "the address space cannot be limited with sanitizers";
  EXPECT_EQ(in_a_child([] {
              const rlimit low{rlim_t{1} << 32, rlim_t{1} << 32};
              ::setrlimit(RLIMIT_AS, &low);
              JobPool pool;
              pool.count = 1;
              pool.mebibytes = 1 << 20;
              pool.run = [](std::size_t, const Channel&) {
                rlimit now{};
                ::getrlimit(RLIMIT_AS, &now);
                return now.rlim_cur == rlim_t{1} << 32 ? 7 : 8;
              };
              int status = 0;
              pool.received = [](std::size_t, char, std::string_view) {};
              pool.finished = [&](std::size_t, const JobEnd& end) { status = end.status; };
              return run_jobs(pool).ok() ? status : 1;
            }),
            7);
}

}  // namespace
}  // namespace selvage
