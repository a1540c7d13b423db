#include "core/standard_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace selvage {

Status write_to_standard_output(std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(STDOUT_FILENO, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0)
      return error(Kind::io, fmt::format("cannot write to standard output: {}", std::strerror(errno)),
                   {.file = "selvage"});
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return {};
}

Status open_standard_streams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number is given: this one. Opened the wrong way round, so that its use goes on failing.
    if (::open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
      return error(Kind::io, fmt::format("a standard stream is closed, and /dev/null cannot stand for it: {}",
                                         std::strerror(errno)));
  }
  return {};
}

}  // namespace selvage
