#include "tetrahedra/worker_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>

#include "core/module.h"
#include "tetrahedra/tetgen_worker/starter.h"

namespace selvage::fem {
namespace {

using Clock = WorkerProcess::Clock;

constexpr auto patience = std::chrono::seconds(2);  // with a worker that has ended, or is killed
constexpr std::size_t most_words = 400;

int milliseconds_until(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<long long>(left, 0, 60'000));
}

// Negative: errno says why there is none.
Result<Descriptor> start_starter(const std::filesystem::path& program) {
  const Result<std::filesystem::path> starter = find_worker("selvage-tetgen");
  if (!starter) return starter.error();
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return system_error("make a socket");
  Descriptor ours(ends[0]);
  const Descriptor theirs(ends[1]);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  int failure = 0;
  const auto step = [&](int outcome) { failure = failure == 0 ? outcome : failure; };
  step(::posix_spawn_file_actions_adddup2(&actions, theirs.number(), STDIN_FILENO));
  // A process group of its own, so that Ctrl-C reaches the program only, which decides.
  step(::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK));
  step(::posix_spawnattr_setpgroup(&attributes, 0));
  step(::posix_spawnattr_setsigmask(&attributes, &none));
  std::string name = starter->string(), word = start_word, started = program.string();
  std::array<char*, 4> arguments = {name.data(), word.data(), started.data(), nullptr};
  pid_t process = -1;
  if (failure == 0)
    failure = ::posix_spawn(&process, name.c_str(), &actions, &attributes, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (failure == 0) return ours;
  errno = failure;
  return system_error(fmt::format("start '{}'", name));
}

// Hands over the ends of pipes. False: errno says why not.
bool send(int socket, const StarterRequest& ends) {
  char nothing = 0;
  iovec content{&nothing, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof ends)> room{};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  cmsghdr* const head = CMSG_FIRSTHDR(&message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof ends);
  std::memcpy(CMSG_DATA(head), &ends, sizeof ends);
  while (::sendmsg(socket, &message, MSG_NOSIGNAL) < 0)
    if (errno != EINTR) return false;
  return true;
}

struct Pipe {
  Descriptor out, in;
  bool open() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    out = Descriptor(ends[0]);
    in = Descriptor(ends[1]);
    return true;
  }
};

}  // namespace

void Descriptor::close() {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

Message system_error(std::string_view what) {
  return error(Kind::internal, fmt::format("cannot {} for the mesh worker: {}", what, std::strerror(errno)));
}

Result<int> ready_starter(const std::filesystem::path& program) {
  static std::mutex one_at_a_time;
  static std::map<std::filesystem::path, Descriptor> starters;
  const std::scoped_lock lock(one_at_a_time);
  const auto found = starters.find(program);
  if (found != starters.end()) return found->second.number();
  Result<Descriptor> made = start_starter(program);
  if (!made) return made.error();
  return starters.emplace(program, std::move(*made)).first->second.number();
}

Result<WorkerProcess> WorkerProcess::start(const std::filesystem::path& program,
                                           std::vector<std::string_view> request) {
  const Result<int> starter = ready_starter(program);
  if (!starter) return starter.error();
  Pipe to, answers, words, status;
  // The reading end of a request stays open here: a worker that dies is seen by its answer's end, and no
  // signal comes of writing to it. Its writing end never waits.
  if (!to.open() || !answers.open() || !words.open() || !status.open() ||
      ::fcntl(to.in.number(), F_SETFL, O_NONBLOCK) != 0)
    return system_error("make a pipe");
  const StarterRequest ends{to.out.number(), answers.in.number(), words.in.number(), status.in.number()};
  if (!send(*starter, ends)) return system_error("ask for a process");
  WorkerProcess result;
  result.request_ = std::move(request);
  std::reverse(result.request_.begin(), result.request_.end());
  result.request_end_ = std::move(to.in);
  result.worker_request_end_ = std::move(to.out);
  result.answers_ = std::move(answers.out);
  result.words_end_ = std::move(words.out);
  result.status_ = std::move(status.out);
  return result;
}

// False: errno says why nothing can be sent.
bool WorkerProcess::send_some() {
  while (!request_.empty()) {
    std::string_view& part = request_.back();
    const ssize_t put = ::write(request_end_.number(), part.data(), part.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno == EAGAIN;
    part.remove_prefix(static_cast<std::size_t>(put));
    if (part.empty()) request_.pop_back();
  }
  request_end_.close();
  worker_request_end_.close();
  return true;
}

void WorkerProcess::take_words() {
  std::array<char, 65536> block;
  const ssize_t got = ::read(words_end_.number(), block.data(), block.size());
  if (got < 0 && errno == EINTR) return;
  if (got <= 0) return words_end_.close();
  words_.append(block.data(), static_cast<std::size_t>(got));
  if (words_.size() > most_words) words_.erase(0, words_.size() - most_words);
}

WorkerProcess::Heard WorkerProcess::exchange(Clock::time_point deadline) {
  std::vector<char> block(1 << 20);
  for (;;) {
    std::array<pollfd, 3> watched = {pollfd{answers_.number(), POLLIN, 0},
                                     {words_end_.number(), POLLIN, 0},
                                     {request_end_.number(), POLLOUT, 0}};
    const int ready = ::poll(watched.data(), watched.size(), milliseconds_until(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return Heard::nothing;
    if (ready == 0 && Clock::now() < deadline) continue;
    if (ready == 0) return Heard::not_yet;
    if (watched[1].revents != 0) take_words();
    if (watched[2].revents != 0 && !send_some()) return Heard::nothing;
    if (watched[0].revents == 0) {
      if (Clock::now() >= deadline) return Heard::not_yet;
      continue;
    }
    const ssize_t got = ::read(answers_.number(), block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return Heard::nothing;
    if (got == 0) return Heard::all;
    answer_.append(block.data(), static_cast<std::size_t>(got));
  }
}

// Its words end with it.
void WorkerProcess::await_end() {
  const Clock::time_point deadline = Clock::now() + patience;
  while (words_end_.is_open()) {
    pollfd watched{words_end_.number(), POLLIN, 0};
    const int ready = ::poll(&watched, 1, milliseconds_until(deadline));
    if (ready < 0 && errno != EINTR) return;
    if (ready > 0) take_words();
    if (Clock::now() >= deadline) return;
  }
}

WorkerEnd WorkerProcess::finish(bool has_ended) {
  WorkerEnd result;
  result.timed_out = !has_ended;
  // A worker that closed its output is done or dying; one that hangs there is not waited for.
  const Clock::time_point deadline = Clock::now() + patience;
  StarterAnswer end;
  for (bool is_there = false; has_ended && !is_there;) {
    pollfd watched{status_.number(), POLLIN, 0};
    const int ready = ::poll(&watched, 1, milliseconds_until(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready > 0 && ::read(status_.number(), &end, sizeof end) != sizeof end) end.not_started = ECHILD;
    result.timed_out = ready <= 0;
    is_there = true;
  }
  status_.close();  // by which a worker that is still there is killed
  await_end();
  result.not_started = end.not_started;
  result.status = end.status;
  result.answer = std::move(answer_);
  result.words = std::move(words_);
  return result;
}

}  // namespace selvage::fem
