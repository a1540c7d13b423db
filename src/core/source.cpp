#include "core/source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace selvage {

namespace {

constexpr int patience = 10;  // seconds that a pipe without a writer is waited for

Message io_error(const std::filesystem::path& path, std::string_view what) {
  return error(Kind::io, fmt::format("{}: {}", what, std::strerror(errno)), {.file = path.string()});
}

struct Descriptor {
  int fd = -1;
  bool owned = false;
  ~Descriptor() {
    if (owned && fd >= 0) ::close(fd);
  }
};

// Waits for a writer of this pipe, which was opened without waiting; what was read on the way is added to
// `bytes`. False: nobody came.
bool await_writer(int pipe, std::string& bytes) {
  constexpr int times_a_second = 10;
  for (int i = 0; i < patience * times_a_second; ++i) {
    char first = 0;
    const ssize_t got = ::read(pipe, &first, 1);
    if (got > 0) bytes.push_back(first);
    if (got != 0) return true;  // with a writer who has written nothing yet: EAGAIN
    pollfd look = {.fd = pipe, .events = POLLIN, .revents = 0};
    if (::poll(&look, 1, 1000 / times_a_second) > 0) return true;  // bytes, or a writer who has gone
  }
  return false;
}

// Adds everything up to the end to `bytes`; false: errno says why not.
bool read_to_end(int descriptor, std::string& bytes) {
  constexpr std::size_t chunk = std::size_t{1} << 18;
  for (;;) {
    const std::size_t old = bytes.size();
    bytes.resize(old + chunk);
    const ssize_t got = ::read(descriptor, bytes.data() + old, chunk);
    bytes.resize(old + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) return true;
    if (got < 0 && errno != EINTR) return false;
  }
}

}  // namespace

Result<Source> Source::open(const std::filesystem::path& path) {
  Descriptor file;
  if (path == "-") {
    file.fd = STDIN_FILENO;
  } else {
    file.fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe may have no writer
    file.owned = true;
    if (file.fd < 0) return io_error(path, "cannot open");
  }
  struct stat facts {};
  if (::fstat(file.fd, &facts) != 0) return io_error(path, "cannot read");
  if (S_ISDIR(facts.st_mode)) {
    errno = EISDIR;
    return io_error(path, "cannot read");
  }
  if (file.owned && (S_ISCHR(facts.st_mode) || S_ISBLK(facts.st_mode)))
    return error(Kind::io, "this is a device, not a file; '-' reads standard input", {.file = path.string()});
  Source source;
  source.name_ = path == "-" ? "<stdin>" : path.string();
  if (S_ISREG(facts.st_mode) && facts.st_size > 0 && file.owned) {
    const auto size = static_cast<std::size_t>(facts.st_size);
    void* mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.fd, 0);
    if (mapping != MAP_FAILED) {
      ::madvise(mapping, size, MADV_SEQUENTIAL);
      source.mapping_ = mapping;
      source.bytes_ = {static_cast<const char*>(mapping), size};
      return source;
    }
  }
  source.owned_ = std::make_unique<std::string>();
  std::string& bytes = *source.owned_;
  if (file.owned) {
    if (S_ISFIFO(facts.st_mode) && !await_writer(file.fd, bytes))
      return error(Kind::io, fmt::format("nothing has opened this pipe to write to it within {} s", patience),
                   {.file = path.string()});
    if (::fcntl(file.fd, F_SETFL, O_RDONLY) != 0) return io_error(path, "cannot read");
  }
  if (!read_to_end(file.fd, bytes)) return io_error(path, "cannot read");
  source.bytes_ = bytes;
  return source;
}

Source Source::from_memory(std::string bytes, std::string name) {
  Source source;
  source.name_ = std::move(name);
  source.owned_ = std::make_unique<std::string>(std::move(bytes));
  source.bytes_ = *source.owned_;
  return source;
}

Source::Source(Source&& other) noexcept {
  *this = std::move(other);
}

Source& Source::operator=(Source&& other) noexcept {
  if (this != &other) {
    release();
    name_ = std::move(other.name_);
    owned_ = std::move(other.owned_);
    mapping_ = std::exchange(other.mapping_, nullptr);
    bytes_ = std::exchange(other.bytes_, {});
  }
  return *this;
}

Source::~Source() {
  release();
}

void Source::release() {
  if (mapping_ != nullptr) ::munmap(mapping_, bytes_.size());
  mapping_ = nullptr;
  bytes_ = {};
}

}  // namespace selvage
