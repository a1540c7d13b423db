#include "core/source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace selvage {

namespace {

Message io_error(const std::filesystem::path& path, std::string_view what) {
  Message message = error(Kind::io, fmt::format("{}: {}", what, std::strerror(errno)));
  message.file = path.string();
  return message;
}

struct Descriptor {
  int fd = -1;
  bool owned = false;
  ~Descriptor() {
    if (owned && fd >= 0) ::close(fd);
  }
};

}  // namespace

Result<Source> Source::open(const std::filesystem::path& path) {
  Descriptor file;
  if (path == "-") {
    file.fd = STDIN_FILENO;
  } else {
    file.fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    file.owned = true;
    if (file.fd < 0) return io_error(path, "cannot open");
  }
  struct stat facts {};
  if (::fstat(file.fd, &facts) != 0) return io_error(path, "cannot read");
  if (S_ISDIR(facts.st_mode)) {
    errno = EISDIR;
    return io_error(path, "cannot read");
  }
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
  constexpr std::size_t chunk = std::size_t{1} << 18;
  for (;;) {
    const std::size_t old = bytes.size();
    bytes.resize(old + chunk);
    const ssize_t got = ::read(file.fd, bytes.data() + old, chunk);
    bytes.resize(old + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) break;
    if (got < 0 && errno != EINTR) return io_error(path, "cannot read");
  }
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
