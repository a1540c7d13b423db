#include "core/source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <optional>
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

Message too_large(const std::filesystem::path& path, std::size_t most) {
  return error(Kind::limit, fmt::format("larger than the {} bytes that are read of such a file", most),
               {.file = path.string()});
}

// Adds everything up to the end to `bytes`, but stops behind `most`; false: errno says why not.
bool read_to_end(int descriptor, std::size_t most, std::string& bytes) {
  constexpr std::size_t chunk = std::size_t{1} << 18;
  while (bytes.size() <= most) {
    const std::size_t old = bytes.size();
    bytes.resize(old + chunk);
    const ssize_t got = ::read(descriptor, bytes.data() + old, chunk);
    const bool is_again = got < 0 && errno == EINTR;
    bytes.resize(old + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) return true;
    if (got < 0 && !is_again) return false;
  }
  return true;
}

// The number of bytes that were there to fill `buffer` from the file's begin; none: errno says why not.
std::optional<std::size_t> read_from_begin(int file, char* buffer, std::size_t size) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(file, buffer + done, size - done, static_cast<off_t>(done));
    if (got == 0) break;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return std::nullopt;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

bool is_same_state(const struct stat& a, const struct stat& b) {
  return a.st_size == b.st_size && a.st_mtim.tv_sec == b.st_mtim.tv_sec &&
         a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

// Does the path name what is in its folder or below it, links followed?
bool is_inside_its_folder(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code failure;
  if (!fs::is_symlink(path, failure)) return !failure;
  const fs::path target = fs::canonical(path, failure);
  if (failure) return false;
  const fs::path folder = fs::canonical(path.has_parent_path() ? path.parent_path() : ".", failure);
  return !failure && is_below(target, folder);
}

// A copy of the file whose state `facts` is, in pages of its own, to be given back by munmap().
Result<std::string_view> copied(int file, const struct stat& facts, const std::filesystem::path& path) {
  const auto size = static_cast<std::size_t>(facts.st_size);
  // Pages that nothing has touched: a string would be filled with zeros first.
  void* const memory =
      ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  const std::optional<std::size_t> got = read_from_begin(file, static_cast<char*>(memory), size);
  struct stat now {};
  const bool is_read = got && ::fstat(file, &now) == 0;
  if (is_read && *got == size && is_same_state(facts, now))
    return std::string_view(static_cast<const char*>(memory), size);
  Message failure =
      is_read ? error(Kind::io, "changed while it was read: call again when whoever writes it has ended",
                      {.file = path.string()})
              : io_error(path, "cannot read");
  ::munmap(memory, size);
  return failure;
}

}  // namespace

bool is_below(const std::filesystem::path& file, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

Result<std::string> read_head(const std::filesystem::path& path, std::size_t size) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK), true};
  struct stat facts {};
  if (file.fd < 0 || ::fstat(file.fd, &facts) != 0) return io_error(path, "cannot open");
  if (!S_ISREG(facts.st_mode)) return error(Kind::io, "not a regular file", {.file = path.string()});
  std::string head(size, '\0');
  const std::optional<std::size_t> got = read_from_begin(file.fd, head.data(), size);
  if (!got) return io_error(path, "cannot read");
  head.resize(*got);
  return head;
}

Result<Source> Source::open(const std::filesystem::path& path, std::size_t most) {
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
  source.may_be_quoted_ = !file.owned || (S_ISREG(facts.st_mode) && is_inside_its_folder(path));
  if (S_ISREG(facts.st_mode) && facts.st_size > 0 && file.owned) {
    if (static_cast<std::size_t>(facts.st_size) > most) return too_large(path, most);
    const Result<std::string_view> copy = copied(file.fd, facts, path);
    if (!copy) return copy.error();
    source.pages_ = const_cast<char*>(copy->data());
    source.bytes_ = *copy;
    return source;
  }
  source.owned_ = std::make_unique<std::string>();
  std::string& bytes = *source.owned_;
  if (file.owned) {
    if (S_ISFIFO(facts.st_mode) && !await_writer(file.fd, bytes))
      return error(Kind::io, fmt::format("nothing has opened this pipe to write to it within {} s", patience),
                   {.file = path.string()});
    if (::fcntl(file.fd, F_SETFL, O_RDONLY) != 0) return io_error(path, "cannot read");
  }
  if (!read_to_end(file.fd, most, bytes)) return io_error(path, "cannot read");
  if (bytes.size() > most) return too_large(path, most);
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
    pages_ = std::exchange(other.pages_, nullptr);
    bytes_ = std::exchange(other.bytes_, {});
    may_be_quoted_ = other.may_be_quoted_;
  }
  return *this;
}

Source::~Source() {
  release();
}

void Source::release() {
  if (pages_ != nullptr) ::munmap(pages_, bytes_.size());
  pages_ = nullptr;
  bytes_ = {};
}

}  // namespace selvage
