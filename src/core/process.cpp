#include "core/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <vector>

namespace selvage {

namespace {

using Clock = std::chrono::steady_clock;

struct PacketHead {
  std::uint32_t size = 0;
  char kind = 0;
};
constexpr std::size_t head_bytes = 5;

bool write_all(int descriptor, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t put = ::write(descriptor, bytes, size);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    bytes += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

sigset_t watched_signals() {
  sigset_t set;
  ::sigemptyset(&set);
  for (int number : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) ::sigaddset(&set, number);
  return set;
}

struct Running {
  std::size_t job = 0;
  pid_t pid = -1;
  int pipe = -1;
  bool at_end = false;  // of the pipe
  bool timed_out = false;
  Clock::time_point deadline = Clock::time_point::max();
  std::string inbox;  // bytes of a packet that is not complete yet
};

class Runner {
 public:
  explicit Runner(const JobPool& pool) : pool_(pool) {
    const sigset_t watched = watched_signals();
    ::sigprocmask(SIG_BLOCK, &watched, &old_mask_);
    signals_ = ::signalfd(-1, &watched, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  ~Runner() {
    ::close(signals_);
    ::sigprocmask(SIG_SETMASK, &old_mask_, nullptr);
  }

  bool run() {
    while (next_ < pool_.count || !running_.empty()) {
      while (next_ < pool_.count && running_.size() < std::max<std::size_t>(1, pool_.at_once)) {
        if (!start(next_)) break;
        ++next_;
      }
      wait();
      if (interrupted_) {
        stop();
        return false;
      }
    }
    return true;
  }

 private:
  // False: no room for another process now, try again when one has ended.
  bool start(std::size_t job) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return refuse(job);
    const pid_t parent = ::getpid();
    const pid_t pid = ::fork();
    if (pid < 0) {
      const int reason = errno;
      ::close(ends[0]);
      ::close(ends[1]);
      errno = reason;
      return refuse(job);
    }
    if (pid == 0) live_as_child(job, ends[1], parent);
    ::close(ends[1]);
    ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
    Running child;
    child.job = job;
    child.pid = pid;
    child.pipe = ends[0];
    if (pool_.seconds > 0)
      child.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                          std::chrono::duration<double>(std::min(pool_.seconds, 1e8)));
    running_.push_back(std::move(child));
    return true;
  }

  bool refuse(std::size_t job) {
    if (!running_.empty()) return false;
    pool_.finished(job, {JobEnd::How::not_started, errno});
    return true;
  }

  [[noreturn]] void live_as_child(std::size_t job, int pipe, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    ::sigprocmask(SIG_SETMASK, &old_mask_, nullptr);
    if (pool_.mebibytes > 0) {
      const auto bytes = static_cast<rlim_t>(std::min(pool_.mebibytes, 1e12) * 1048576.0);
      const rlimit limit{bytes, bytes};
      ::setrlimit(RLIMIT_AS, &limit);
    }
    // A crash is reported by the parent; its memory would only fill the user's folder.
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::_exit(pool_.run(job, Channel(pipe)));
  }

  void wait() {
    std::vector<pollfd> watched = {{signals_, POLLIN, 0}};
    double seconds = pool_.tick ? pool_.tick() : 3600;
    for (const Running& child : running_) {
      // A pipe at its end would wake us again and again until the kernel has taken the child down.
      watched.push_back({child.at_end ? -1 : child.pipe, POLLIN, 0});
      if (child.deadline != Clock::time_point::max())
        seconds = std::min(seconds, std::chrono::duration<double>(child.deadline - Clock::now()).count());
    }
    const int milliseconds = static_cast<int>(std::clamp(seconds * 1000.0 + 1.0, 0.0, 3.6e6));
    ::poll(watched.data(), watched.size(), milliseconds);
    for (Running& child : running_) read_packets(child);
    read_signals();
    const Clock::time_point now = Clock::now();
    for (Running& child : running_) {
      if (now < child.deadline || child.timed_out) continue;
      child.timed_out = true;
      ::kill(child.pid, SIGKILL);
    }
  }

  void read_packets(Running& child) {
    std::array<char, 65536> buffer;
    for (;;) {
      const ssize_t got = ::read(child.pipe, buffer.data(), buffer.size());
      if (got < 0 && errno == EINTR) continue;
      child.at_end = got == 0;
      if (got <= 0) break;
      child.inbox.append(buffer.data(), static_cast<std::size_t>(got));
    }
    std::size_t begin = 0;
    while (child.inbox.size() - begin >= head_bytes) {
      PacketHead head;
      std::memcpy(&head.size, child.inbox.data() + begin, sizeof head.size);
      head.kind = child.inbox[begin + sizeof head.size];
      if (child.inbox.size() - begin - head_bytes < head.size) break;
      pool_.received(child.job, head.kind,
                     std::string_view(child.inbox).substr(begin + head_bytes, head.size));
      begin += head_bytes + head.size;
    }
    child.inbox.erase(0, begin);
  }

  void read_signals() {
    signalfd_siginfo facts{};
    while (::read(signals_, &facts, sizeof facts) == static_cast<ssize_t>(sizeof facts)) {
      if (facts.ssi_signo == SIGCHLD)
        reap();
      else
        interrupted_ = true;
      if (interrupted_) return;
    }
  }

  void reap() {
    for (std::size_t i = 0; i < running_.size();) {
      int status = 0;
      if (::waitpid(running_[i].pid, &status, WNOHANG) != running_[i].pid) {
        ++i;
        continue;
      }
      Running child = std::move(running_[i]);
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      read_packets(child);
      ::close(child.pipe);
      JobEnd end;
      if (WIFEXITED(status))
        end = {JobEnd::How::exited, WEXITSTATUS(status)};
      else
        end = {child.timed_out ? JobEnd::How::timed_out : JobEnd::How::signalled, WTERMSIG(status)};
      pool_.finished(child.job, end);
    }
  }

  void stop() {
    for (const Running& child : running_) ::kill(child.pid, SIGKILL);
    for (const Running& child : running_) {
      while (::waitpid(child.pid, nullptr, 0) < 0 && errno == EINTR) {
      }
      ::close(child.pipe);
      if (pool_.interrupted) pool_.interrupted(child.job);
    }
    running_.clear();
  }

  const JobPool& pool_;
  sigset_t old_mask_{};
  int signals_ = -1;
  std::size_t next_ = 0;
  std::vector<Running> running_;
  bool interrupted_ = false;
};

}  // namespace

void Channel::send(char kind, std::string_view bytes) const {
  std::array<char, head_bytes> head{};
  const auto size = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(head.data(), &size, sizeof size);
  head[sizeof size] = kind;
  if (write_all(descriptor_, head.data(), head.size())) write_all(descriptor_, bytes.data(), bytes.size());
}

std::string describe(const JobEnd& end, double seconds, double mebibytes) {
  switch (end.how) {
    case JobEnd::How::exited:
      return {};
    case JobEnd::How::timed_out:
      return fmt::format("was stopped: not done within its {:g} s (--timeout)", seconds);
    case JobEnd::How::not_started:
      return fmt::format("could not be started: {}", std::strerror(end.status));
    case JobEnd::How::signalled:
      break;
  }
  if (end.status == SIGKILL)
    return "was killed from outside, most likely because the machine ran out of memory; try --memory and a "
           "smaller -j";
  if (end.status == SIGPIPE) return "was ended: nobody reads standard output any more";
  std::string text = fmt::format("crashed: {}", ::strsignal(end.status));
  if (mebibytes > 0) text += fmt::format(" (its memory was limited to {:g} MB by --memory)", mebibytes);
  return text;
}

bool run_jobs(const JobPool& pool) {
  return Runner(pool).run();
}

}  // namespace selvage
