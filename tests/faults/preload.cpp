// Preloaded into the program (LD_PRELOAD), makes the n-th call of one function of the C library fail.
//
//   FAULT_CALL=write   the function: one of the names below
//   FAULT_AT=3         its third call fails; 3+: all from the third on
//   FAULT_IN=all       or `parent`: only calls of the process that was started first
//   FAULT_PAGE=5       descriptor of a file of 4096 zero bytes, in which calls are counted over all processes
//
// Without FAULT_CALL nothing fails. What the C library calls inside itself does not come by here.
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

namespace {

struct Page {
  std::atomic<int> parent;
  std::atomic<int> calls;   // of the function
  std::atomic<int> faults;  // of these, how many failed
};

struct Plan {
  const char* call = nullptr;
  int at = 0;
  bool lasting = false, parent_only = false;
  Page* page = nullptr;
};

Plan make_plan() {
  Plan plan;
  const char *call = std::getenv("FAULT_CALL"), *at = std::getenv("FAULT_AT"),
             *page = std::getenv("FAULT_PAGE");
  if (call == nullptr || at == nullptr || page == nullptr) return plan;
  const long place = ::syscall(SYS_mmap, nullptr, 4096L, static_cast<long>(PROT_READ | PROT_WRITE),
                               static_cast<long>(MAP_SHARED), std::atol(page), 0L);
  if (place == -1) return plan;
  plan.page = reinterpret_cast<Page*>(place);
  plan.call = call;
  plan.at = std::atoi(at);
  plan.lasting = std::strchr(at, '+') != nullptr;
  const char* where = std::getenv("FAULT_IN");
  plan.parent_only = where != nullptr && std::strcmp(where, "parent") == 0;
  int nobody = 0;
  plan.page->parent.compare_exchange_strong(nobody, ::getpid());
  return plan;
}

// Made by the first call, which may come before any constructor has run.
const Plan& plan() {
  static const Plan self = make_plan();
  return self;
}

bool fails(const char* call, int reason) {
  const Plan& p = plan();
  if (p.call == nullptr || std::strcmp(p.call, call) != 0) return false;
  if (p.parent_only && ::getpid() != p.page->parent) return false;
  const int number = ++p.page->calls;
  if (number != p.at && !(p.lasting && number > p.at)) return false;
  ++p.page->faults;
  errno = reason;
  return true;
}

template <class Function>
Function* real(const char* name, Function* /*itself*/) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

mode_t mode_of(int flags, va_list& more) {
  return (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(more, mode_t) : 0;
}

// In the parent before the first thread, so that the plan is one for all processes.
[[gnu::constructor]] void begin() {
  (void)plan();
}

}  // namespace

// CALL(name, what fails gives, errno, result, parameters, arguments)
#define CALL(name, failed, reason, result, parameters, arguments)    \
  extern "C" result name parameters {                                \
    static auto* const itself = real(#name, &name);                  \
    return fails(#name, reason) ? result(failed) : itself arguments; \
  }
// The same under another name.
#define ALIAS(name, as, failed, reason, result, parameters, arguments) \
  extern "C" result name parameters {                                  \
    static auto* const itself = real(#name, &name);                    \
    return fails(#as, reason) ? result(failed) : itself arguments;     \
  }

using Bytes = void*;
const auto no_map = MAP_FAILED;

CALL(write, -1, ENOSPC, ssize_t, (int file, const void* from, size_t size), (file, from, size))
CALL(pwrite, -1, ENOSPC, ssize_t, (int file, const void* from, size_t size, off_t at), (file, from, size, at))
ALIAS(pwrite64, pwrite, -1, ENOSPC, ssize_t, (int file, const void* from, size_t size, off64_t at),
      (file, from, size, at))
CALL(read, -1, EIO, ssize_t, (int file, void* to, size_t size), (file, to, size))
CALL(pread, -1, EIO, ssize_t, (int file, void* to, size_t size, off_t at), (file, to, size, at))
ALIAS(pread64, pread, -1, EIO, ssize_t, (int file, void* to, size_t size, off64_t at), (file, to, size, at))
CALL(fsync, -1, EIO, int, (int file), (file))
CALL(ftruncate, -1, EFBIG, int, (int file, off_t size), (file, size))
ALIAS(ftruncate64, ftruncate, -1, EFBIG, int, (int file, off64_t size), (file, size))
CALL(rename, -1, EIO, int, (const char* from, const char* to) noexcept, (from, to))
CALL(renameat2, -1, EINVAL, int,
     (int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept,
     (from_folder, from, to_folder, to, flags))
CALL(linkat, -1, EIO, int,
     (int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept,
     (from_folder, from, to_folder, to, flags))
CALL(flock, -1, ENOLCK, int, (int file, int operation) noexcept, (file, operation))
CALL(mkdir, -1, ENOSPC, int, (const char* path, mode_t mode) noexcept, (path, mode))
CALL(mmap, no_map, ENOMEM, Bytes,
     (void* at, size_t size, int access, int flags, int file, off_t from) noexcept,
     (at, size, access, flags, file, from))
ALIAS(mmap64, mmap, no_map, ENOMEM, Bytes,
      (void* at, size_t size, int access, int flags, int file, off64_t from) noexcept,
      (at, size, access, flags, file, from))
CALL(memfd_create, -1, EMFILE, int, (const char* name, unsigned flags) noexcept, (name, flags))
CALL(fork, -1, EAGAIN, pid_t, () noexcept, ())
CALL(pipe2, -1, EMFILE, int, (int* ends, int flags) noexcept, (ends, flags))
CALL(signalfd, -1, EMFILE, int, (int file, const sigset_t* set, int flags) noexcept, (file, set, flags))
CALL(fstat, -1, EIO, int, (int file, struct stat* facts) noexcept, (file, facts))
ALIAS(fstat64, fstat, -1, EIO, int, (int file, struct stat64* facts) noexcept, (file, facts))
CALL(poll, -1, ENOMEM, int, (pollfd * watched, nfds_t count, int milliseconds),
     (watched, count, milliseconds))

// What a release build calls instead (_FORTIFY_SOURCE) where the compiler knows the size of a buffer.
ALIAS(__read_chk, read, -1, EIO, ssize_t, (int file, void* to, size_t size, size_t room),
      (file, to, size, room))
ALIAS(__pread_chk, pread, -1, EIO, ssize_t, (int file, void* to, size_t size, off_t at, size_t room),
      (file, to, size, at, room))
ALIAS(__pread64_chk, pread, -1, EIO, ssize_t, (int file, void* to, size_t size, off64_t at, size_t room),
      (file, to, size, at, room))
ALIAS(__poll_chk, poll, -1, ENOMEM, int, (pollfd * watched, nfds_t count, int milliseconds, size_t room),
      (watched, count, milliseconds, room))
ALIAS(__open_2, open, -1, EMFILE, int, (const char* path, int flags), (path, flags))
ALIAS(__open64_2, open, -1, EMFILE, int, (const char* path, int flags), (path, flags))
ALIAS(__openat_2, open, -1, EMFILE, int, (int folder, const char* path, int flags), (folder, path, flags))
ALIAS(__openat64_2, open, -1, EMFILE, int, (int folder, const char* path, int flags), (folder, path, flags))

extern "C" int posix_spawn(pid_t* process, const char* path, const posix_spawn_file_actions_t* actions,
                           const posix_spawnattr_t* attributes, char* const* arguments,
                           char* const* surroundings) {
  static auto* const itself = real("posix_spawn", &posix_spawn);
  return fails("posix_spawn", EAGAIN) ? EAGAIN
                                      : itself(process, path, actions, attributes, arguments, surroundings);
}

// The page of the plan stays open, for programs that are started later.
extern "C" int close_range(unsigned first, unsigned last, int flags) noexcept {
  static auto* const itself = real("close_range", &close_range);
  const char* page = std::getenv("FAULT_PAGE");
  const unsigned kept = page != nullptr ? static_cast<unsigned>(std::atoi(page)) : 0;
  if (kept < first || kept > last) return itself(first, last, flags);
  if (kept > first && itself(first, kept - 1, flags) != 0) return -1;
  return kept < last ? itself(kept + 1, last, flags) : 0;
}

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                              void* argument) noexcept {
  static auto* const itself = real("pthread_create", &pthread_create);
  return fails("pthread_create", EAGAIN) ? EAGAIN : itself(thread, attributes, run, argument);
}

// Its message is the loader's own.
extern "C" void* dlopen(const char* path, int flags) noexcept {
  static auto* const itself = real("dlopen", &dlopen);
  return itself(fails("dlopen", ENOENT) ? "/nowhere/nothing.so" : path, flags);
}

#define OPEN(name)                                                 \
  extern "C" int name(const char* path, int flags, ...) {          \
    static auto* const itself = real(#name, &name);                \
    va_list more;                                                  \
    va_start(more, flags);                                         \
    const mode_t mode = mode_of(flags, more);                      \
    va_end(more);                                                  \
    return fails("open", EMFILE) ? -1 : itself(path, flags, mode); \
  }
OPEN(open)
OPEN(open64)
#define OPEN_AT(name)                                                      \
  extern "C" int name(int folder, const char* path, int flags, ...) {      \
    static auto* const itself = real(#name, &name);                        \
    va_list more;                                                          \
    va_start(more, flags);                                                 \
    const mode_t mode = mode_of(flags, more);                              \
    va_end(more);                                                          \
    return fails("open", EMFILE) ? -1 : itself(folder, path, flags, mode); \
  }
OPEN_AT(openat)
OPEN_AT(openat64)
