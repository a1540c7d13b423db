#include "core/job_streams.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <utility>

#include "core/written.h"

namespace selvage {

namespace {

void close_at(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

// `descriptor`, which is closed, in the place of the stream.
bool replace(int stream, int descriptor) {
  const bool well = descriptor >= 0 && ::dup2(descriptor, stream) == stream;
  if (descriptor > STDERR_FILENO) ::close(descriptor);
  return well;
}

bool empty(int stream, int how) {
  return replace(stream, ::open("/dev/null", how | O_CLOEXEC));
}

// Into memory, to the end: a flaw in a reader shall not be one beside a terminal.
bool read_terminal() {
  const int memory = ::memfd_create("selvage", MFD_CLOEXEC);
  std::array<char, 65536> block;
  for (ssize_t got = 1; memory >= 0 && got != 0;) {
    got = ::read(STDIN_FILENO, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 || !write_all(memory, block.data(), static_cast<std::size_t>(got))) return false;
  }
  return memory >= 0 && ::lseek(memory, 0, SEEK_SET) == 0 && replace(STDIN_FILENO, memory);
}

// Nothing that steers a terminal: these are the last words of libraries.
std::string plain(std::string_view text) {
  std::string result(text);
  for (char& letter : result)
    if ((static_cast<unsigned char>(letter) < ' ' && letter != '\n' && letter != '\t') || letter == '\x7f')
      letter = '?';
  return result;
}

}  // namespace

void JobStreams::open(Relay& relay, int stream) {
  std::array<int, 2> ends{};
  // The parent's end alone never waits.
  if (!is_open_ || ::isatty(stream) == 0) return;
  is_open_ = ::pipe2(ends.data(), O_CLOEXEC) == 0;
  if (!is_open_) return;
  relay = {ends[0], ends[1], stream};
  is_open_ = ::fcntl(relay.from, F_SETFL, O_NONBLOCK) == 0;
}

JobStreams::JobStreams(UsedStreams used) : used_(used) {
  if (used.output) open(relays_[0], STDOUT_FILENO);
  open(relays_[1], STDERR_FILENO);
}

JobStreams::JobStreams(JobStreams&& other) noexcept
    : used_(other.used_), is_open_(other.is_open_), relays_(std::exchange(other.relays_, {})) {}

JobStreams& JobStreams::operator=(JobStreams&& other) noexcept {
  std::swap(used_, other.used_);
  std::swap(is_open_, other.is_open_);
  std::swap(relays_, other.relays_);
  return *this;
}

JobStreams::~JobStreams() {
  const int reason = errno;
  for (Relay& relay : relays_) {
    close_at(relay.from);
    close_at(relay.into);
  }
  errno = reason;
}

bool JobStreams::enter() {
  if (!used_.input && !empty(STDIN_FILENO, O_RDONLY)) return false;
  if (used_.input && ::isatty(STDIN_FILENO) != 0 && !read_terminal()) return false;
  if (!used_.output && !empty(STDOUT_FILENO, O_WRONLY)) return false;
  for (Relay& relay : relays_) {
    close_at(relay.from);
    if (relay.into >= 0 && !replace(relay.to, std::exchange(relay.into, -1))) return false;
  }
  return true;
}

void JobStreams::leave() {
  for (Relay& relay : relays_) close_at(relay.into);
}

bool JobStreams::relay(Relay& relay) {
  constexpr int most_blocks = 16;  // at once: other jobs wait
  std::array<char, 65536> block;
  for (int i = 0; relay.from >= 0 && i < most_blocks; ++i) {
    const ssize_t got = ::read(relay.from, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return true;
    if (got <= 0) close_at(relay.from);
    if (got < 0) return false;
    const std::string_view text(block.data(), static_cast<std::size_t>(got));
    const std::string shown = relay.to == STDERR_FILENO ? plain(text) : std::string(text);
    if (!write_all(relay.to, shown.data(), shown.size())) return false;
  }
  return true;
}

bool JobStreams::relay() {
  const bool output = relay(relays_[0]), error = relay(relays_[1]);
  return output && error;
}

}  // namespace selvage
