#include "tetrahedra/tetgen_worker/starter.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

namespace selvage::fem {
namespace {

// A process that asks for more at once has gone astray.
constexpr std::size_t most_children = 1024;

struct Child {
  pid_t process = -1;
  int end = -1;  // closed: nobody waits for it
};

bool is_pipe(int descriptor) {
  struct stat facts {};
  return ::fstat(descriptor, &facts) == 0 && S_ISFIFO(facts.st_mode);
}

class Starter {
 public:
  explicit Starter(const char* program) : program_(program), self_(std::to_string(::getpid())) {
    ::sigemptyset(&signals_);
    ::sigaddset(&signals_, SIGCHLD);
    ::sigprocmask(SIG_BLOCK, &signals_, nullptr);
    std::signal(SIGCHLD, SIG_DFL);
    std::signal(SIGPIPE, SIG_IGN);
    ended_ = ::signalfd(-1, &signals_, SFD_CLOEXEC | SFD_NONBLOCK);
  }

  int run() {
    if (ended_ < 0) return 1;
    for (;;) {
      std::vector<pollfd> watched = {{STDIN_FILENO, POLLIN, 0}, {ended_, POLLIN, 0}};
      for (const Child& child : children_) watched.push_back({child.end, 0, 0});
      if (::poll(watched.data(), watched.size(), -1) < 0 && errno != EINTR) break;
      for (std::size_t i = 0; i < children_.size(); ++i)
        if (watched[i + 2].revents != 0) end(children_[i]);
      reap();
      if (watched[0].revents != 0 && !take()) break;
    }
    for (Child& child : children_) end(child);
    return 0;
  }

 private:
  // With what it has started.
  static void end(Child& child) {
    ::kill(-child.process, SIGKILL);
    if (child.end >= 0) ::close(child.end);
    child.end = -1;
  }

  static void answer(int end, StarterAnswer what) {
    // Where it is full, or nobody reads it, that is the asker's affair.
    [[maybe_unused]] const bool is_heard =
        ::fcntl(end, F_SETFL, O_NONBLOCK) == 0 && ::write(end, &what, sizeof what) == sizeof what;
    ::close(end);
  }

  void reap() {
    signalfd_siginfo facts{};
    while (::read(ended_, &facts, sizeof facts) > 0) {
    }
    int status = 0;
    for (pid_t gone = 0; (gone = ::waitpid(-1, &status, WNOHANG)) > 0;) {
      const auto child = std::find_if(children_.begin(), children_.end(),
                                      [&](const Child& one) { return one.process == gone; });
      if (child == children_.end()) continue;
      if (child->end >= 0) answer(child->end, {0, status});
      children_.erase(child);
    }
  }

  // False: the socket has closed.
  bool take() {
    char nothing = 0;
    iovec content{&nothing, 1};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(StarterRequest))> room{};
    msghdr message{};
    message.msg_iov = &content;
    message.msg_iovlen = 1;
    message.msg_control = room.data();
    message.msg_controllen = room.size();
    const ssize_t got = ::recvmsg(STDIN_FILENO, &message, MSG_CMSG_CLOEXEC);
    if (got < 0) return errno == EINTR || errno == EMFILE || errno == EAGAIN;
    if (got == 0) return false;
    std::vector<int> ends;
    for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr; head = CMSG_NXTHDR(&message, head)) {
      if (head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_RIGHTS) continue;
      ends.resize((head->cmsg_len - CMSG_LEN(0)) / sizeof(int));
      std::memcpy(ends.data(), CMSG_DATA(head), ends.size() * sizeof(int));
    }
    if (ends.size() == 4 && std::all_of(ends.begin(), ends.end(), is_pipe)) {
      start({ends[0], ends[1], ends[2], ends[3]});
      ends.pop_back();  // it is kept, or closed already
    }
    for (const int one : ends) ::close(one);
    return true;
  }

  void start(const StarterRequest& request) {
    if (children_.size() >= most_children) return answer(request.end, {EAGAIN, 0});
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawnattr_init(&attributes);
    sigset_t usual;
    ::sigemptyset(&usual);
    int failure = 0;
    const auto step = [&](int outcome) { failure = failure == 0 ? outcome : failure; };
    step(::posix_spawn_file_actions_adddup2(&actions, request.input, STDIN_FILENO));
    step(::posix_spawn_file_actions_adddup2(&actions, request.output, STDOUT_FILENO));
    step(::posix_spawn_file_actions_adddup2(&actions, request.errors, STDERR_FILENO));
    // A process group of its own, so that it is killed with all that it has started.
    step(::posix_spawnattr_setflags(&attributes,
                                    POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF));
    step(::posix_spawnattr_setpgroup(&attributes, 0));
    step(::posix_spawnattr_setsigmask(&attributes, &usual));
    ::sigaddset(&usual, SIGPIPE);
    step(::posix_spawnattr_setsigdefault(&attributes, &usual));
    std::array<char*, 3> arguments = {program_.data(), self_.data(), nullptr};
    Child child;
    child.end = request.end;
    if (failure == 0)
      failure =
          ::posix_spawn(&child.process, program_.c_str(), &actions, &attributes, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::posix_spawnattr_destroy(&attributes);
    if (failure != 0) return answer(request.end, {failure, 0});
    children_.push_back(child);
  }

  std::string program_, self_;
  sigset_t signals_{};
  int ended_ = -1;
  std::vector<Child> children_;
};

}  // namespace

int start_programs(const char* program) {
  return Starter(program).run();
}

}  // namespace selvage::fem
