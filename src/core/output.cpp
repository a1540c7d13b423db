#include "core/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace selvage {

namespace fs = std::filesystem;

fs::path OutputFile::hidden_name(const fs::path& target) {
  return target.parent_path() / ("." + target.filename().string() + ".selvage-partial");
}

Message OutputFile::io_error(std::string_view what) const {
  Message message = error(Kind::io, fmt::format("{}: {}", what, std::strerror(errno)));
  message.file = form_ == Form::standard_output ? "<stdout>" : target_.string();
  return message;
}

// A folder cannot be replaced, and a device or a pipe must not be: /dev/null would be a file from then on.
Status OutputFile::check_target() const {
  std::error_code failure;
  const fs::file_status there = fs::status(target_, failure);
  if (fs::is_directory(there)) {
    errno = EISDIR;
    return io_error("cannot write");
  }
  if (!fs::is_other(there)) return {};
  Message message = error(
      Kind::io, "cannot write: this is a device or a pipe, which a file would replace; - is standard output");
  message.file = target_.string();
  return message;
}

Result<OutputFile> OutputFile::create(const fs::path& target) {
  OutputFile file;
  file.target_ = target;
  if (Status fits = file.check_target(); !fits) return fits.error();
  std::error_code failure;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  fs::create_directories(folder, failure);
  if (failure) {
    errno = failure.value();
    return file.io_error("cannot create the folder");
  }
  file.descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (file.descriptor_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
    const fs::path hidden = hidden_name(target);
    ::unlink(hidden.c_str());
    file.descriptor_ = ::open(hidden.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    file.has_hidden_name_ = file.descriptor_ >= 0;
  }
  if (file.descriptor_ < 0) return file.io_error("cannot write");
  return file;
}

Result<OutputFile> OutputFile::standard_output() {
  Result<OutputFile> file = in_memory();
  if (file) file->form_ = Form::standard_output;
  return file;
}

Result<OutputFile> OutputFile::in_memory() {
  OutputFile file;
  file.form_ = Form::memory;
  file.target_ = "<memory>";
  file.descriptor_ = ::memfd_create("selvage", MFD_CLOEXEC);
  if (file.descriptor_ < 0) return file.io_error("cannot reserve memory for the output");
  return file;
}

OutputFile::OutputFile(OutputFile&& other) noexcept {
  *this = std::move(other);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  if (this != &other) {
    discard();
    form_ = other.form_;
    target_ = std::move(other.target_);
    descriptor_ = std::exchange(other.descriptor_, -1);
    has_hidden_name_ = std::exchange(other.has_hidden_name_, false);
    position_ = other.position_;
  }
  return *this;
}

OutputFile::~OutputFile() {
  discard();
}

void OutputFile::discard() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  if (has_hidden_name_) ::unlink(hidden_name(target_).c_str());
  has_hidden_name_ = false;
}

Status OutputFile::write(std::string_view bytes) {
  Status status = write_at(position_, bytes);
  if (status.ok()) position_ += bytes.size();
  return status;
}

Status OutputFile::write_at(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0) {
      if (errno == EINTR) continue;
      return io_error("cannot write");
    }
    offset += static_cast<std::uint64_t>(put);
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return {};
}

Result<std::string> OutputFile::read_at(std::uint64_t offset, std::size_t size) const {
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, size - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = EIO;
    if (got <= 0) return io_error("cannot read back");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

Status OutputFile::resize(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) return io_error("cannot write");
  position_ = size;
  return {};
}

Status OutputFile::set_target(const fs::path& target) {
  const fs::path hidden = hidden_name(target_);
  target_ = target;
  if (Status fits = check_target(); !fits) return fits;
  if (has_hidden_name_ && ::rename(hidden.c_str(), hidden_name(target_).c_str()) != 0)
    return io_error("cannot write");
  return {};
}

std::uint64_t OutputFile::size() const {
  struct stat facts {};
  return ::fstat(descriptor_, &facts) == 0 ? static_cast<std::uint64_t>(facts.st_size) : 0;
}

Result<std::string> OutputFile::contents() const {
  return read_at(0, static_cast<std::size_t>(size()));
}

Status OutputFile::copy_to_standard_output() {
  const std::uint64_t total = size();
  constexpr std::uint64_t block = 1U << 20;
  for (std::uint64_t offset = 0; offset < total; offset += block) {
    Result<std::string> bytes = read_at(offset, static_cast<std::size_t>(std::min(block, total - offset)));
    if (!bytes) return bytes.error();
    std::string_view rest = *bytes;
    while (!rest.empty()) {
      const ssize_t put = ::write(STDOUT_FILENO, rest.data(), rest.size());
      if (put < 0 && errno == EINTR) continue;
      if (put < 0) return io_error("cannot write");
      rest.remove_prefix(static_cast<std::size_t>(put));
    }
  }
  return {};
}

Status OutputFile::commit() {
  if (form_ == Form::memory) return {};
  if (form_ == Form::standard_output) return copy_to_standard_output();
  if (::fsync(descriptor_) != 0) return io_error("cannot write");
  const fs::path hidden = hidden_name(target_);
  if (!has_hidden_name_) {
    const std::string unnamed = fmt::format("/proc/self/fd/{}", descriptor_);
    // A new target gets its name at once; an existing one is replaced by a rename.
    if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, target_.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      discard();
      return {};
    }
    if (errno != EEXIST) return io_error("cannot write");
    ::unlink(hidden.c_str());
    if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, hidden.c_str(), AT_SYMLINK_FOLLOW) != 0)
      return io_error("cannot write");
    has_hidden_name_ = true;
  }
  if (::rename(hidden.c_str(), target_.c_str()) != 0) return io_error("cannot write");
  has_hidden_name_ = false;
  discard();
  return {};
}

}  // namespace selvage
