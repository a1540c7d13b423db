#include "core/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <utility>

#include "core/memory_files.h"
#include "core/standard_output.h"
#include "core/temporary.h"

namespace selvage {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t copied_at_once = 1U << 20;
constexpr std::string_view hidden_begin = ".selvage-", hidden_end = ".partial";

Status sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // EINVAL: a file system that has nothing to do here.
  const bool is_done = descriptor >= 0 && (::fsync(descriptor) == 0 || errno == EINVAL);
  const int reason = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (is_done) return {};
  return error(Kind::io, fmt::format("cannot make the names of new files durable: {}", std::strerror(reason)),
               {.file = folder.string()});
}

// With the permissions of the file that it is to replace, `place`: to change them later takes a right that
// contained processes do not have.
int open_new(const fs::path& path, int flags, const fs::path& place) {
  static std::mutex one_at_a_time;  // the mask is the whole process's
  const std::scoped_lock lock(one_at_a_time);
  struct stat old {};
  if (::stat(place.c_str(), &old) != 0) return ::open(path.c_str(), flags, 0666);
  const mode_t mask = ::umask(0);
  const int descriptor = ::open(path.c_str(), flags, old.st_mode & 0777);
  const int reason = errno;
  ::umask(mask);
  errno = reason;
  return descriptor;
}

bool has_permissions(int descriptor, mode_t wanted) {
  struct stat facts {};
  return ::fstat(descriptor, &facts) == 0 && (facts.st_mode & 0777) == wanted;
}

Status copy(const OutputFile& from, OutputFile& to) {
  return from.read_all([&](std::string_view bytes) { return to.write(bytes); });
}

}  // namespace

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::optional<fs::path> followed(const fs::path& target) {
  constexpr int most_links = 40;  // as Linux has it
  fs::path place = target;
  for (int i = 0; i < most_links; ++i) {
    std::error_code failure;
    const fs::path next = fs::read_symlink(place, failure);
    if (failure) return place;
    place = folder_of(place) / next;  // an absolute one replaces the folder
  }
  errno = ELOOP;
  return std::nullopt;
}

Message OutputFile::io_error(std::string_view what) const {
  return error(Kind::io, fmt::format("{}: {}", what, std::strerror(errno)),
               {.file = form_ == Form::standard_output ? "<stdout>" : target_.string()});
}

std::string OutputFile::unnamed() const {
  return fmt::format("/proc/self/fd/{}", descriptor_);
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
  return error(Kind::io,
               "cannot write: this is a device or a pipe, which a file would replace; - is standard output",
               {.file = target_.string()});
}

// Every folder that is made needs its own name made durable, too: from where they begin is kept.
Status OutputFile::make_folder() {
  const fs::path folder = folder_of(place_);
  fs::path there = folder;
  std::error_code failure;
  while (!fs::exists(there, failure) && there != folder_of(there)) there = folder_of(there);
  fs::create_directories(folder, failure);
  if (failure) {
    errno = failure.value();
    return io_error("cannot create the folder");
  }
  if (there != folder) made_below_ = there;
  return {};
}

Status OutputFile::open_hidden() {
  for (;;) {
    hidden_ = folder_of(place_) / temporary_name(hidden_begin, hidden_end);
    descriptor_ = open_new(hidden_, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, place_);
    if (descriptor_ >= 0 && hold(descriptor_)) return {};
    const int reason = errno;
    if (descriptor_ >= 0)
      ::close(std::exchange(descriptor_, -1));
    else if (errno != EEXIST) {
      hidden_.clear();
      errno = reason;
      return io_error("cannot write");
    }
  }
}

Result<OutputFile> OutputFile::create(const fs::path& target) {
  OutputFile file;
  file.target_ = target;
  const std::optional<fs::path> place = followed(target);
  if (!place) return file.io_error("cannot write");
  file.place_ = *place;
  if (Status fits = file.check_target(); !fits) return fits.error();
  if (Status made = file.make_folder(); !made) return made.error();
  file.descriptor_ = open_new(folder_of(file.place_), O_TMPFILE | O_RDWR | O_CLOEXEC, file.place_);
  const bool has_none = file.descriptor_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL);
  if (file.descriptor_ < 0 && !has_none) return file.io_error("cannot write");
  // An unnamed file gets its name through /proc, which may not be there.
  if (!has_none && ::access(file.unnamed().c_str(), F_OK) != 0) ::close(std::exchange(file.descriptor_, -1));
  if (file.descriptor_ >= 0) {
    hold(file.descriptor_);
    return file;
  }
  if (Status opened = file.open_hidden(); !opened) return opened.error();
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
  file.descriptor_ = take_memory_file();
  if (file.descriptor_ < 0) return file.io_error("cannot reserve memory for the output");
  return file;
}

Result<OutputFile> OutputFile::scratch() const {
  return form_ == Form::file ? create(target_) : in_memory();
}

OutputFile::OutputFile(OutputFile&& other) noexcept {
  *this = std::move(other);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  if (this != &other) {
    discard();
    form_ = other.form_;
    target_ = std::move(other.target_);
    place_ = std::move(other.place_);
    made_below_ = std::move(other.made_below_);
    hidden_ = std::exchange(other.hidden_, {});
    descriptor_ = std::exchange(other.descriptor_, -1);
    position_ = other.position_;
    size_ = other.size_;
    named_ = other.named_;
  }
  return *this;
}

OutputFile::~OutputFile() {
  discard();
}

void OutputFile::discard() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  if (!hidden_.empty()) ::unlink(hidden_.c_str());  // what cannot be removed is a leftover
  hidden_.clear();
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
    size_ = std::max(size_, offset);
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
  position_ = size_ = size;
  return {};
}

Status OutputFile::set_target(const fs::path& target) {
  const std::optional<fs::path> place = followed(target);
  if (place && folder_of(*place) == folder_of(place_)) {
    target_ = target;
    place_ = *place;
    return check_target();
  }
  Result<OutputFile> there = create(target);
  if (!there) return there.error();
  if (Status copied = copy(*this, *there); !copied) return copied;
  *this = std::move(*there);
  return {};
}

Result<std::string> OutputFile::contents() const {
  return read_at(0, static_cast<std::size_t>(size()));
}

Status OutputFile::read_all(const std::function<Status(std::string_view)>& take) const {
  for (std::uint64_t offset = 0; offset < size_; offset += copied_at_once) {
    const Result<std::string> bytes =
        read_at(offset, static_cast<std::size_t>(std::min(copied_at_once, size_ - offset)));
    if (!bytes) return bytes.error();
    if (Status taken = take(*bytes); !taken) return taken;
  }
  return {};
}

Status OutputFile::hide() {
  for (;;) {
    hidden_ = folder_of(place_) / temporary_name(hidden_begin, hidden_end);
    if (::linkat(AT_FDCWD, unnamed().c_str(), AT_FDCWD, hidden_.c_str(), AT_SYMLINK_FOLLOW) == 0) return {};
    hidden_.clear();
    if (errno != EEXIST) return io_error("cannot write");
  }
}

// Everything that needs room on the disk, before the first name is taken.
Status OutputFile::stage() {
  if (form_ != Form::file) return {};
  if (Status fits = check_target(); !fits) return fits;
  struct stat old {};
  const bool replaces = ::stat(place_.c_str(), &old) == 0;
  if (!replaces && errno != ENOENT) return io_error("cannot write");
  const mode_t permissions = old.st_mode & 0777;
  // They are those of the file that was in the target's place when this one was made.
  if (replaces && !has_permissions(descriptor_, permissions) && ::fchmod(descriptor_, permissions) != 0) {
    Result<OutputFile> anew = create(target_);
    if (!anew) return anew.error();
    if (Status copied = copy(*this, *anew); !copied) return copied;
    *this = std::move(*anew);
    errno = EPERM;
    if (!has_permissions(descriptor_, permissions)) return io_error("cannot keep the permissions");
  }
  if (::fsync(descriptor_) != 0) return io_error("cannot write");
  return replaces && hidden_.empty() ? hide() : Status();
}

Status OutputFile::take_name(bool may_be_taken_back) {
  if (form_ == Form::standard_output) return read_all(write_to_standard_output);
  if (form_ == Form::memory) return {};
  if (hidden_.empty()) {
    if (::linkat(AT_FDCWD, unnamed().c_str(), AT_FDCWD, place_.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      named_ = Named::anew;
      return {};
    }
    if (errno != EEXIST) return io_error("cannot write");
    if (Status hidden = hide(); !hidden) return hidden;  // another program was faster
  }
  if (may_be_taken_back &&
      ::renameat2(AT_FDCWD, hidden_.c_str(), AT_FDCWD, place_.c_str(), RENAME_EXCHANGE) == 0) {
    named_ = Named::exchanged;
    return {};
  }
  // ENOENT: there is nothing to exchange with; else the file system cannot, or the rename says what is wrong.
  const bool is_new = may_be_taken_back && errno == ENOENT;
  if (::rename(hidden_.c_str(), place_.c_str()) != 0) return io_error("cannot write");
  hidden_.clear();
  named_ = is_new ? Named::anew : Named::replaced;
  return {};
}

// The reason for which it is given back is told; what fails here leaves the new file.
void OutputFile::give_back_name() {
  if (named_ == Named::anew) ::unlink(place_.c_str());
  if (named_ == Named::exchanged && ::rename(hidden_.c_str(), place_.c_str()) == 0) hidden_.clear();
}

Status OutputFile::make_name_durable() const {
  if (form_ != Form::file) return {};
  for (fs::path folder = folder_of(place_);; folder = folder_of(folder)) {
    if (Status synced = sync_folder(folder); !synced) return synced;
    if (made_below_.empty() || folder == made_below_) return {};
  }
}

Status OutputFile::commit() {
  const std::array<OutputFile*, 1> alone = {this};
  return commit(alone);
}

Status OutputFile::commit(std::span<OutputFile* const> files) {
  for (OutputFile* file : files)
    if (Status staged = file->stage(); !staged) return staged;
  for (OutputFile* file : files) {
    Status named = file->take_name(files.size() > 1);
    if (named) continue;
    for (OutputFile* other : files) other->give_back_name();
    return named;
  }
  std::set<fs::path> synced;
  for (OutputFile* file : files) {
    if (file->made_below_.empty() && !synced.insert(folder_of(file->place_)).second) continue;
    if (Status durable = file->make_name_durable(); !durable) return durable;
  }
  for (OutputFile* file : files)
    if (file->form_ == Form::file) file->discard();  // the old one where two were exchanged
  return {};
}

std::optional<fs::path> OutputFile::hidden_folder(const fs::path& target) {
  const std::optional<fs::path> place = followed(target);
  if (!place) return std::nullopt;
  return folder_of(*place);
}

void OutputFile::remove_leftovers(const std::set<fs::path>& folders) {
  for (const fs::path& folder : folders)
    for (const fs::path& hidden : abandoned_in(folder, hidden_begin, hidden_end)) ::unlink(hidden.c_str());
}

}  // namespace selvage
