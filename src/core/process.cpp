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
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/sanitized.h"

namespace selvage {

namespace {

using Clock = std::chrono::steady_clock;

struct PacketHead {
  std::uint32_t size = 0;
  char kind = 0;
};
constexpr std::size_t head_bytes = 5;
// Exit status of a job whose packets do not reach the parent.
constexpr int unheard_status = 120;
// And of one whose limits could not be set.
constexpr int unlimited_status = 121;

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
  bool at_end = false;   // of the pipe
  bool unheard = false;  // something that it sent could not be read
  bool timed_out = false;
  Clock::time_point deadline = Clock::time_point::max();
  std::string inbox;  // bytes of a packet that is not complete yet
};

// Not above what is allowed already: to raise a limit is an error, and the lower one stays in force.
void set_limit(__rlimit_resource_t resource, rlim_t amount) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) == 0) {
    limit.rlim_cur = limit.rlim_max = std::min(amount, limit.rlim_max);
    if (::setrlimit(resource, &limit) == 0) return;
  }
  ::_exit(unlimited_status);
}

// Seconds of processor time that the system gives each process (`ulimit -t`).
rlim_t processor_limit() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_CPU, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

// At the limit a process is sent SIGXCPU, or SIGKILL where it cannot be raised.
bool has_used_up(int signal, const rusage& used) {
  if (signal == SIGXCPU) return true;
  constexpr rlim_t clocks_differ_by = 1;  // second: the limit is measured in ticks
  const rlim_t limit = processor_limit();
  const auto seconds = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + clocks_differ_by;
  return signal == SIGKILL && limit != RLIM_INFINITY && seconds >= limit;
}

class Runner {
 public:
  explicit Runner(const JobPool& pool) : pool_(pool) {
    const sigset_t watched = watched_signals();
    ::sigprocmask(SIG_BLOCK, &watched, &old_mask_);
    // Where the caller had children ignored, the kernel would take ours away without a word.
    struct sigaction usual {};
    usual.sa_handler = SIG_DFL;
    ::sigaction(SIGCHLD, &usual, &old_action_);
    signals_ = ::signalfd(-1, &watched, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  ~Runner() {
    if (signals_ >= 0) ::close(signals_);
    ::sigaction(SIGCHLD, &old_action_, nullptr);
    ::sigprocmask(SIG_SETMASK, &old_mask_, nullptr);
  }

  Result<PoolEnd> run() {
    if (signals_ < 0)
      return error(Kind::limit,
                   fmt::format("cannot watch over processes: {}; nothing was done", std::strerror(errno)));
    while (next_ < pool_.count || !running_.empty()) {
      while (next_ < pool_.count && running_.size() < std::max<std::size_t>(1, pool_.at_once)) {
        if (!start(next_)) break;
        ++next_;
      }
      // Where none could be started, there is nothing to wait for.
      if (!running_.empty()) wait();
      if (interrupted_) {
        stop();
        return PoolEnd::interrupted;
      }
    }
    return PoolEnd::complete;
  }

 private:
  // False: no room for another process now, try again when one has ended.
  bool start(std::size_t job) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return refuse(job, errno);
    const pid_t parent = ::getpid();
    // The parent's end alone never waits.
    const pid_t pid = ::fcntl(ends[0], F_SETFL, O_NONBLOCK) == 0 ? ::fork() : -1;
    const int reason = errno;
    if (pid == 0) live_as_child(job, ends[1], parent);
    ::close(ends[1]);
    if (pid < 0) {
      ::close(ends[0]);
      return refuse(job, reason);
    }
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

  // While others run there may be room later; after them there is nothing to wait for.
  bool refuse(std::size_t job, int reason) {
    if (!running_.empty()) return false;
    pool_.finished(job, {JobEnd::How::not_started, reason});
    return true;
  }

  [[noreturn]] void live_as_child(std::size_t job, int pipe, pid_t parent) {
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != parent) ::_exit(unlimited_status);
    // What other jobs say is not this one's to read.
    ::close(signals_);
    for (const Running& other : running_) ::close(other.pipe);
    ::sigprocmask(SIG_SETMASK, &old_mask_, nullptr);
    if (pool_.mebibytes > 0 && !sanitized)
      set_limit(RLIMIT_AS, static_cast<rlim_t>(std::min(pool_.mebibytes, 1e12) * 1048576.0));
    // A crash is reported by the parent; its memory would only fill the user's folder.
    set_limit(RLIMIT_CORE, 0);
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
    // Where the kernel cannot wait for us, we look again and again, with pauses.
    if (::poll(watched.data(), watched.size(), milliseconds) < 0 && errno != EINTR) ::usleep(10'000);
    for (Running& child : running_) read_packets(child);
    read_signals();
    reap();
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
      if (got < 0 && errno != EAGAIN) child.at_end = child.unheard = true;
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
    while (::read(signals_, &facts, sizeof facts) == static_cast<ssize_t>(sizeof facts))
      if (facts.ssi_signo != SIGCHLD) interrupted_ = true;
  }

  void reap() {
    for (std::size_t i = 0; i < running_.size();) {
      int status = 0;
      rusage used{};
      const pid_t gone = ::wait4(running_[i].pid, &status, WNOHANG, &used);
      if (gone == 0 || (gone < 0 && errno != ECHILD)) {
        ++i;
        continue;
      }
      const int reason = gone < 0 ? errno : 0;
      Running child = std::move(running_[i]);
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      read_packets(child);
      ::close(child.pipe);
      pool_.finished(child.job,
                     reason != 0 ? JobEnd{JobEnd::How::unheard, reason} : end_of(child, status, used));
    }
  }

  static JobEnd end_of(const Running& child, int status, const rusage& used) {
    if (!WIFEXITED(status) && !child.timed_out && has_used_up(WTERMSIG(status), used))
      return {JobEnd::How::used_up, static_cast<int>(processor_limit())};
    if (!WIFEXITED(status))
      return {
          child.timed_out || WTERMSIG(status) == SIGALRM ? JobEnd::How::timed_out : JobEnd::How::signalled,
          WTERMSIG(status)};
    const int value = WEXITSTATUS(status);
    if (value == unlimited_status) return {JobEnd::How::not_started, EPERM};
    if (value == unheard_status || child.unheard) return {JobEnd::How::unheard, EIO};
    return {JobEnd::How::exited, value};
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
  struct sigaction old_action_ {};
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
  // Nothing that this process does from here on would be heard of.
  if (size != bytes.size() || !write_all(descriptor_, head.data(), head.size()) ||
      !write_all(descriptor_, bytes.data(), bytes.size()))
    ::_exit(unheard_status);
}

void end_after(double seconds) {
  std::signal(SIGALRM, SIG_DFL);
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, SIGALRM);
  ::sigprocmask(SIG_UNBLOCK, &set, nullptr);
  ::alarm(static_cast<unsigned>(std::clamp(std::ceil(seconds), 1.0, 1e8)));
}

std::string describe(const JobEnd& end, double seconds, std::string_view memory) {
  switch (end.how) {
    case JobEnd::How::exited:
      return {};
    case JobEnd::How::timed_out:
      return fmt::format("was stopped: not done within its {:g} s; --timeout gives it more", seconds);
    case JobEnd::How::used_up:
      return fmt::format(
          "was stopped: it used up the {} s of processor time that the system gives a process (ulimit -t)",
          end.status);
    case JobEnd::How::not_started:
      return fmt::format("could not be started: {}", std::strerror(end.status));
    case JobEnd::How::unheard:
      return fmt::format("could not tell what came of it: {}", std::strerror(end.status));
    case JobEnd::How::signalled:
      break;
  }
  if (end.status == SIGKILL)
    return "was killed from outside, most likely because the machine ran out of memory; try --memory and a "
           "smaller -j";
  if (end.status == SIGPIPE) return "was ended: nobody reads standard output any more";
  return fmt::format("crashed: {} (it could not take more memory than {})", ::strsignal(end.status), memory);
}

Result<PoolEnd> run_jobs(const JobPool& pool) {
  return Runner(pool).run();
}

}  // namespace selvage
