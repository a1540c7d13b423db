// Preloaded into the program (LD_PRELOAD), makes the worker that reads a file named traitor.txt do what a
// flaw in a reader could make it do.
//
//   TRAITOR=FOLDER       where it tries to write, beside what it was told to
//   TRAITOR_OUT=FOLDER   where it may write
//   TRAITOR_DEED         what it does:
//     actions  each of the actions below; of each a line on standard error, "traitor: WHO: NAME: N": who may
//     do
//              it elsewhere, and errno, 0 where the system did it
//     daemon   leaves a process behind: "traitor: daemon PID"
//     streams  tells of its standard streams: "traitor: stream N terminal" or "other"
//     flood    sends one packet of 4 GB to its parent; packets: 4 GB in packets of 1 MiB
//     hang     sleeps: "traitor: hangs"
//     escape   writes what turns a terminal's text red
//     foreign  makes a call of a 32-bit program
//
// No action harms the system where it is not contained: it asks for what is there already, or names what is
// not there, so that the system's answer tells whether the call has reached it.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <mqueue.h>
#include <sched.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/ipc.h>
#include <sys/mman.h>
#include <sys/msg.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/time.h>
#include <sys/timex.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

struct Place {
  std::string folder, file, out;  // outside: a folder, a file in it; and where it may write
  int input = -1;                 // the file that is read
  pid_t parent = 0;
};

struct Action {
  const char* name;
  bool privileged;                   // the system does it, or looks at it, for the administrator only
  long (*deed)(const Place& place);  // negative: errno
};

template <class... Arguments>
long call(long number, Arguments... arguments) {
  return ::syscall(number, arguments...);
}

// Closed again.
long opened(long descriptor) {
  if (descriptor >= 0) ::close(static_cast<int>(descriptor));
  return descriptor;
}

long waited(long child) {
  if (child == 0) ::_exit(0);
  if (child > 0) ::waitpid(static_cast<pid_t>(child), nullptr, 0);
  return child;
}

long unmapped(void* at) {
  if (at == MAP_FAILED) return -1;
  return ::munmap(at, 4096);
}

long sockets_of_every_family(const Place& /*place*/) {
  int reason = EPERM;
  for (int family = 0; family < 46; ++family)
    for (const int type : {SOCK_STREAM, SOCK_DGRAM, SOCK_RAW, SOCK_SEQPACKET}) {
      const int made = ::socket(family, type, 0);
      if (made >= 0) return opened(made);
      if (errno != EPERM) reason = errno;
    }
  errno = reason;
  return -1;
}

long own_limit(int whose) {
  rlimit64 limit{};
  if (::prlimit64(0, RLIMIT_CORE, nullptr, &limit) != 0) return -1;
  return ::prlimit64(whose, RLIMIT_CORE, &limit, nullptr);
}

long own_capabilities() {
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> facts{};
  (void)call(SYS_capget, &head, facts.data());
  return call(SYS_capset, &head, facts.data());
}

long spawned() {
  std::string shell = "/bin/sh", option = "-c", text = "exit 7";
  std::array<char*, 4> words = {shell.data(), option.data(), text.data(), nullptr};
  pid_t child = 0;
  errno = ::posix_spawn(&child, shell.c_str(), nullptr, nullptr, words.data(), environ);
  return errno == 0 ? waited(child) : -1;
}

long vm_read(const Place& place) {
  static long here = 0;
  long there = 0;
  iovec local{&there, sizeof there}, remote{&here, sizeof here};
  return ::process_vm_readv(place.parent, &local, 1, &remote, 1, 0);
}

long removed(int identifier, long (*remove)(int)) {
  return identifier < 0 ? -1 : remove(identifier);
}

long queued(const Place& place) {
  siginfo_t facts{};
  facts.si_code = SI_QUEUE;
  return call(SYS_rt_sigqueueinfo, place.parent, 0, &facts);
}

long set_id_file(const Place& place) {
  const std::string path = place.out + "/set-id";
  const long made = opened(::open(path.c_str(), O_CREAT | O_WRONLY, 04755));
  if (made >= 0) ::unlink(path.c_str());
  return made;
}

constexpr auto writable = PROT_READ | PROT_WRITE, executable = PROT_READ | PROT_EXEC;

long made_executable() {
  void* const at = ::mmap(nullptr, 4096, writable, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const int failed = ::mprotect(at, 4096, executable);
  const int reason = errno;
  ::munmap(at, 4096);
  errno = reason;
  return failed;
}

#define DO(expression)             \
  [](const Place& place) -> long { \
    (void)place;                   \
    return (expression);           \
  }
constexpr const char* nowhere = "/nonexistent/nothing";

const Action actions[] = {
    // files
    {"read a file outside", false, DO(opened(::open(place.file.c_str(), O_RDONLY)))},
    {"read a folder outside", false, DO(opened(::open(place.folder.c_str(), O_RDONLY | O_DIRECTORY)))},
    {"read /etc/passwd", false, DO(opened(::open("/etc/passwd", O_RDONLY)))},
    {"read the parent's memory", true, DO(opened(::open(("/proc/" + std::to_string(place.parent) + "/mem").c_str(), O_RDONLY)))},
    {"read the parent's environment", true, DO(opened(::open(("/proc/" + std::to_string(place.parent) + "/environ").c_str(), O_RDONLY)))},
    {"open a terminal", true, DO(opened(::open("/dev/ptmx", O_RDWR | O_NOCTTY)))},
    {"write to a file outside", false, DO(opened(::open(place.file.c_str(), O_WRONLY)))},
    {"make a file outside", false, DO(opened(::open((place.folder + "/made").c_str(), O_CREAT | O_WRONLY, 0600)))},
    {"make a nameless file outside", false, DO(opened(::open(place.folder.c_str(), O_TMPFILE | O_WRONLY, 0600)))},
    {"make a set-user-ID file", false, set_id_file},
    {"truncate", false, DO(::truncate(place.file.c_str(), 3))},
    {"rename", false, DO(::rename((place.folder + "/old").c_str(), (place.folder + "/new").c_str()))},
    {"link", false, DO(::link(place.file.c_str(), (place.folder + "/link").c_str()))},
    {"symlink", false, DO(::symlink("file", (place.folder + "/symlink").c_str()))},
    {"unlink", false, DO(::unlink((place.folder + "/gone").c_str()))},
    {"mkdir", false, DO(::mkdir((place.folder + "/folder").c_str(), 0700))},
    {"rmdir", false, DO(::rmdir((place.folder + "/empty").c_str()))},
    {"mkfifo", false, DO(::mkfifo((place.folder + "/fifo").c_str(), 0600))},
    {"mknod", true, DO(::mknod((place.folder + "/device").c_str(), S_IFCHR | 0600, makedev(1, 3)))},
    {"chmod", false, DO(::chmod(place.file.c_str(), 0600))},
    {"fchmod of the input", false, DO(::fchmod(place.input, 0644))},
    {"fchmodat", false, DO(::fchmodat(AT_FDCWD, place.file.c_str(), 0600, 0))},
    {"chown", false, DO(::chown(place.file.c_str(), ::getuid(), ::getgid()))},
    {"lchown", false, DO(::lchown(place.file.c_str(), ::getuid(), ::getgid()))},
    {"fchown of the input", false, DO(::fchown(place.input, ::getuid(), ::getgid()))},
    {"fchownat", false, DO(::fchownat(AT_FDCWD, place.file.c_str(), ::getuid(), ::getgid(), 0))},
    {"setxattr", false, DO(::setxattr(place.file.c_str(), "user.a", "b", 1, 0))},
    {"lsetxattr", false, DO(::lsetxattr(place.file.c_str(), "user.a", "b", 1, 0))},
    {"fsetxattr of the input", false, DO(::fsetxattr(place.input, "user.a", "b", 1, 0))},
    {"getxattr", false, DO(::getxattr(place.file.c_str(), "user.none", nullptr, 0))},
    {"listxattr", false, DO(::listxattr(place.file.c_str(), nullptr, 0))},
    {"removexattr", false, DO(::removexattr(place.file.c_str(), "user.none"))},
    {"lremovexattr", false, DO(::lremovexattr(place.file.c_str(), "user.none"))},
    {"fremovexattr of the input", false, DO(::fremovexattr(place.input, "user.none"))},
    {"utimensat", false, DO(::utimensat(AT_FDCWD, place.file.c_str(), nullptr, 0))},
    {"futimens of the input", false, DO(::futimens(place.input, nullptr))},
    {"utimes", false, DO(::utimes(place.file.c_str(), nullptr))},
    {"chdir", false, DO(::chdir("."))},
    {"name_to_handle_at", false, DO(call(SYS_name_to_handle_at, AT_FDCWD, nowhere, nullptr, nullptr, 0))},
    {"open_by_handle_at", true, DO(call(SYS_open_by_handle_at, -1, nullptr, 0))},
    {"inotify_init1", false, DO(opened(call(SYS_inotify_init1, 0)))},
    {"inotify_add_watch", false, DO(call(SYS_inotify_add_watch, -1, place.folder.c_str(), 2))},
    {"fanotify_init", true, DO(opened(call(SYS_fanotify_init, 0, O_RDONLY)))},
    {"quotactl", true, DO(call(SYS_quotactl, 0, nullptr, 0, nullptr))},
    {"acct", true, DO(call(SYS_acct, nowhere))},
    // terminals and other devices
    {"ioctl TIOCSTI", false, DO(::ioctl(STDIN_FILENO, TIOCSTI, "x"))},
    {"ioctl TIOCLINUX", false, DO(::ioctl(STDERR_FILENO, TIOCLINUX, "\2"))},
    {"ioctl TIOCSCTTY", false, DO(::ioctl(STDIN_FILENO, TIOCSCTTY, 0))},
    {"ioctl TCSETS", false, DO(::ioctl(STDERR_FILENO, 0x5402, nullptr))},
    {"ioctl FS_IOC_SETFLAGS of the input", false, DO(::ioctl(place.input, 0x40086602, nullptr))},
    {"fcntl F_SETOWN", false, DO(::fcntl(place.input, F_SETOWN, 0))},
    {"fcntl F_SETSIG", false, DO(::fcntl(place.input, F_SETSIG, 0))},
    {"fcntl F_SETLEASE", false, DO(::fcntl(place.input, F_SETLEASE, F_UNLCK))},
    // programs and processes
    {"fork", false, DO(waited(call(SYS_clone, SIGCHLD, 0, 0, 0, 0)))},
    {"fork as posix_spawn does", false, DO(spawned())},
    {"clone in new namespaces", true, DO(waited(call(SYS_clone, SIGCHLD | CLONE_NEWNS, 0, 0, 0, 0)))},
    {"clone3", false, DO(call(SYS_clone3, nullptr, 0))},
    {"execve", false, DO(call(SYS_execve, nowhere, nullptr, nullptr))},
    {"execveat", false, DO(call(SYS_execveat, -1, "", nullptr, nullptr, AT_EMPTY_PATH))},
    {"memfd_create", false, DO(opened(::memfd_create("x", 0)))},
    {"unshare", false, DO(::unshare(0))},
    {"setns", false, DO(::setns(-1, 0))},
    {"setsid", false, DO(::setsid())},
    {"setpgid", false, DO(::setpgid(-1, 0))},
    {"kill of the parent", false, DO(::kill(place.parent, 0))},
    {"kill of all", false, DO(::kill(-1, 0))},
    {"tkill of the parent", false, DO(call(SYS_tkill, place.parent, 0))},
    {"tgkill of the parent", false, DO(call(SYS_tgkill, place.parent, place.parent, 0))},
    {"rt_sigqueueinfo to the parent", false, queued},
    {"pidfd_open of the parent", false, DO(opened(call(SYS_pidfd_open, place.parent, 0)))},
    {"pidfd_send_signal", false, DO(call(SYS_pidfd_send_signal, -1, 0, nullptr, 0))},
    {"pidfd_getfd", false, DO(call(SYS_pidfd_getfd, -1, 0, 0))},
    {"ptrace of the parent", false, DO(::ptrace(PTRACE_PEEKDATA, place.parent, nullptr, nullptr))},
    {"process_vm_readv of the parent", true, vm_read},
    {"process_vm_writev", false, DO(call(SYS_process_vm_writev, place.parent, nullptr, 0, nullptr, 0, 0))},
    {"process_madvise", false, DO(call(SYS_process_madvise, -1, nullptr, 0, 0, 0))},
    {"kcmp", false, DO(call(SYS_kcmp, 0, 0, 99, 0, 0))},
    {"prlimit of the parent", false, DO(own_limit(place.parent))},
    {"prlimit of its own limits", false, DO(own_limit(0))},
    {"setrlimit", false, DO(call(SYS_setrlimit, 99, nullptr))},
    {"sched_setaffinity of the parent", false, DO(call(SYS_sched_setaffinity, place.parent, 0, nullptr))},
    {"sched_setscheduler of the parent", false, DO(call(SYS_sched_setscheduler, place.parent, -1, nullptr))},
    {"sched_setparam of the parent", false, DO(call(SYS_sched_setparam, place.parent, nullptr))},
    {"sched_setattr of the parent", false, DO(call(SYS_sched_setattr, place.parent, nullptr, 0))},
    {"setpriority of the parent", false, DO(::setpriority(PRIO_PROCESS, place.parent, ::getpriority(PRIO_PROCESS, place.parent)))},
    {"ioprio_set of the parent", false, DO(call(SYS_ioprio_set, 1, place.parent, 0))},
    {"migrate_pages of the parent", false, DO(call(SYS_migrate_pages, place.parent, 0, nullptr, nullptr))},
    {"move_pages of the parent", false, DO(call(SYS_move_pages, place.parent, 0, nullptr, nullptr, nullptr, 0))},
    {"setuid", false, DO(call(SYS_setuid, ::getuid()))},
    {"setgid", false, DO(call(SYS_setgid, ::getgid()))},
    {"setresuid", false, DO(call(SYS_setresuid, -1, -1, -1))},
    {"setgroups", true, DO(call(SYS_setgroups, -1, nullptr))},
    {"capset", false, DO(own_capabilities())},
    {"prctl PR_SET_PDEATHSIG", false, DO(::prctl(PR_SET_PDEATHSIG, 0))},
    {"prctl PR_SET_DUMPABLE", false, DO(::prctl(PR_SET_DUMPABLE, 1))},
    {"prctl PR_SET_CHILD_SUBREAPER", false, DO(::prctl(PR_SET_CHILD_SUBREAPER, 0))},
    {"personality", false, DO(call(SYS_personality, 0xffffffff))},
    {"seccomp", false, DO(call(SYS_seccomp, 99, 0, nullptr))},
    // other processes, by way of the kernel
    {"sockets of every family", false, sockets_of_every_family},
    {"socketpair", false, DO(call(SYS_socketpair, AF_UNIX, SOCK_STREAM, 0, nullptr))},
    {"connect", false, DO(::connect(-1, nullptr, 0))},
    {"bind", false, DO(::bind(-1, nullptr, 0))},
    {"listen", false, DO(::listen(-1, 0))},
    {"accept4", false, DO(::accept4(-1, nullptr, nullptr, 0))},
    {"sendto", false, DO(::sendto(-1, nullptr, 0, 0, nullptr, 0))},
    {"sendmsg", false, DO(::sendmsg(-1, nullptr, 0))},
    {"recvfrom", false, DO(::recvfrom(-1, nullptr, 0, 0, nullptr, nullptr))},
    {"recvmsg", false, DO(::recvmsg(-1, nullptr, 0))},
    {"mq_open", false, DO(opened(call(SYS_mq_open, "selvage-none", O_RDONLY, 0, nullptr)))},
    {"mq_unlink", false, DO(call(SYS_mq_unlink, "selvage-none"))},
    {"shmget", false, DO(removed(::shmget(IPC_PRIVATE, 4096, 0600), [](int id) -> long { return ::shmctl(id, IPC_RMID, nullptr); }))},
    {"semget", false, DO(removed(::semget(IPC_PRIVATE, 1, 0600), [](int id) -> long { return ::semctl(id, 0, IPC_RMID); }))},
    {"msgget", false, DO(removed(::msgget(IPC_PRIVATE, 0600), [](int id) -> long { return ::msgctl(id, IPC_RMID, nullptr); }))},
    {"eventfd2", false, DO(opened(call(SYS_eventfd2, 0, 0)))},
    {"epoll_create1", false, DO(opened(call(SYS_epoll_create1, 0)))},
    {"timerfd_create", false, DO(opened(call(SYS_timerfd_create, CLOCK_MONOTONIC, 0)))},
    {"timer_create", false, DO(call(SYS_timer_create, 99, nullptr, nullptr))},
    // memory
    {"memory to be written and executed", false, DO(unmapped(::mmap(nullptr, 4096, writable | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)))},
    {"memory to be executed", false, DO(unmapped(::mmap(nullptr, 4096, executable, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)))},
    {"mprotect to be executed", false, DO(made_executable())},
    {"pkey_mprotect", false, DO(call(SYS_pkey_mprotect, nullptr, 0, 0, -1))},
    {"madvise MADV_HWPOISON", true, DO(call(SYS_madvise, 1, 4096, 100))},
    {"mlockall", false, DO(call(SYS_mlockall, 0))},
    {"memfd_secret", false, DO(opened(call(SYS_memfd_secret, 0xffff)))},
    {"userfaultfd", false, DO(opened(call(SYS_userfaultfd, 0xffff)))},
    {"set_mempolicy", false, DO(call(SYS_set_mempolicy, 99, nullptr, 0))},
    {"mbind", false, DO(call(SYS_mbind, 1, 4096, 99, nullptr, 0, 0))},
    // the kernel and the machine
    {"io_uring_setup", false, DO(call(SYS_io_uring_setup, 0, nullptr))},
    {"io_uring_enter", false, DO(call(SYS_io_uring_enter, -1, 0, 0, 0, nullptr, 0))},
    {"bpf", true, DO(call(SYS_bpf, -1, nullptr, 0))},
    {"perf_event_open", false, DO(call(SYS_perf_event_open, nullptr, 0, -1, -1, 0))},
    {"keyctl", false, DO(call(SYS_keyctl, -1, 0, 0, 0, 0))},
    {"add_key", false, DO(call(SYS_add_key, nullptr, nullptr, nullptr, 0, 0))},
    {"request_key", false, DO(call(SYS_request_key, nullptr, nullptr, nullptr, 0))},
    {"settimeofday", false, [](const Place&) -> long {
       const timeval wrong{0, -1};
       return call(SYS_settimeofday, &wrong, nullptr);
     }},
    {"clock_settime", false, DO(call(SYS_clock_settime, 99, nullptr))},
    {"clock_adjtime", false, DO(call(SYS_clock_adjtime, 99, nullptr))},
    {"adjtimex", false, DO(call(SYS_adjtimex, nullptr))},
    {"sethostname", true, DO(call(SYS_sethostname, nullptr, -1))},
    {"setdomainname", true, DO(call(SYS_setdomainname, nullptr, -1))},
    {"swapon", true, DO(call(SYS_swapon, nowhere, 0))},
    {"swapoff", true, DO(call(SYS_swapoff, nowhere))},
    {"mount", true, DO(call(SYS_mount, nullptr, nowhere, nullptr, 0, nullptr))},
    {"umount2", true, DO(call(SYS_umount2, nowhere, 0))},
    {"fsopen", true, DO(call(SYS_fsopen, nullptr, 0))},
    {"open_tree", false, DO(call(SYS_open_tree, -1, nowhere, 0))},
    {"move_mount", true, DO(call(SYS_move_mount, -1, nowhere, -1, nowhere, 0))},
    {"pivot_root", true, DO(call(SYS_pivot_root, nowhere, nowhere))},
    {"chroot", true, DO(::chroot("/"))},
    {"reboot", true, DO(call(SYS_reboot, 0, 0, 0, nullptr))},
    {"kexec_load", true, DO(call(SYS_kexec_load, 0, 0, nullptr, 0xffff))},
    {"init_module", true, DO(call(SYS_init_module, nullptr, 0, nullptr))},
    {"finit_module", true, DO(call(SYS_finit_module, -1, "", 0))},
    {"delete_module", true, DO(call(SYS_delete_module, "selvage_none", O_NONBLOCK))},
    {"syslog", true, DO(call(SYS_syslog, 10, nullptr, 0))},
#ifdef __x86_64__
    {"fork of old", false, DO(waited(call(SYS_fork)))},
    {"creat", false, DO(opened(call(SYS_creat, (place.folder + "/created").c_str(), 0600)))},
    {"modify_ldt", false, DO(call(SYS_modify_ldt, 99, nullptr, 0))},
    {"arch_prctl", false, DO(call(SYS_arch_prctl, 0x1, 0))},
    {"iopl", true, DO(call(SYS_iopl, 0))},
    {"ioperm", true, DO(call(SYS_ioperm, 0, 1, 0))},
    {"a call of the x32 form", false, DO(call(0x40000000 + SYS_getpid))},
#endif
};

void try_all(const Place& place) {
  for (const Action& action : actions) {
    errno = 0;
    const long result = action.deed(place);
    const int reason = result < 0 ? errno : 0;
    ::dprintf(STDERR_FILENO, "traitor: %s: %s: %d\n", action.privileged ? "administrator" : "anybody",
              action.name, reason);
  }
}

void leave_daemon() {
  const pid_t first = ::fork();
  if (first < 0) return;
  if (first > 0) {
    ::waitpid(first, nullptr, 0);
    return;
  }
  ::setsid();
  if (::fork() != 0) ::_exit(0);
  ::dprintf(STDERR_FILENO, "traitor: daemon %d\n", ::getpid());
  for (int descriptor = 0; descriptor < 1024; ++descriptor) ::close(descriptor);  // nobody waits for it
  ::alarm(600);                                                                   // the test ends it before
  for (;;) ::pause();
}

void tell_streams() {
  for (int stream = 0; stream <= 2; ++stream) {
    struct stat facts {};
    constexpr unsigned first_terminal = 136, last_terminal = 143;  // majors of pseudo-terminals
    const bool terminal = ::fstat(stream, &facts) == 0 && S_ISCHR(facts.st_mode) &&
                          major(facts.st_rdev) >= first_terminal && major(facts.st_rdev) <= last_terminal;
    ::dprintf(STDERR_FILENO, "traitor: stream %d %s\n", stream, terminal ? "terminal" : "other");
  }
}

// The first pipe that is none of the standard streams.
int channel() {
  for (int descriptor = 3; descriptor < 1024; ++descriptor) {
    struct stat facts {};
    if (::fstat(descriptor, &facts) == 0 && S_ISFIFO(facts.st_mode)) return descriptor;
  }
  return -1;
}

void flood(bool in_packets) {
  static std::array<char, 1 << 20> block;
  const int to = channel();
  const std::uint32_t size = in_packets ? block.size() : 0xffffffff;
  for (int i = 0; i < 4096; ++i) {
    if (i == 0 || in_packets) {
      std::array<char, 5> head{};
      std::memcpy(head.data(), &size, sizeof size);
      head[4] = 'r';  // results, which are kept
      if (::write(to, head.data(), head.size()) < 0) ::_exit(0);
    }
    for (std::size_t sent = 0; sent < block.size();) {
      const ssize_t put = ::write(to, block.data() + sent, block.size() - sent);
      if (put < 0) ::_exit(0);
      sent += static_cast<std::size_t>(put);
    }
  }
}

void betray(int input) {
  const char *folder = std::getenv("TRAITOR"), *out = std::getenv("TRAITOR_OUT"),
             *named = std::getenv("TRAITOR_DEED");
  const std::string deed = named != nullptr ? named : "";
  if (deed == "actions") {
    Place place;
    place.folder = folder;
    place.file = place.folder + "/file";
    place.out = out;
    place.input = input;
    place.parent = ::getppid();
    try_all(place);
  }
  if (deed == "daemon") leave_daemon();
  if (deed == "streams") tell_streams();
  if (deed == "flood" || deed == "packets") flood(deed == "packets");
  if (deed == "escape") ::dprintf(STDERR_FILENO, "traitor: \033[31m\n");
  if (deed == "hang") {
    ::dprintf(STDERR_FILENO, "traitor: hangs\n");
    for (;;) ::sleep(60);
  }
#ifdef __x86_64__
  if (deed == "foreign") asm volatile("int $0x80" : : "a"(20) : "memory");  // getpid
#endif
}

bool is_traitor(int file) {
  std::array<char, 4096> name{};
  const ssize_t size =
      ::readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), name.data(), name.size() - 1);
  return size > 0 && std::string(name.data()).ends_with("/traitor.txt");
}

// Once in a process, at the first call that has the open file: before the program notes when it was changed
// last.
void look(int file) {
  static std::atomic<pid_t> begun = 0;
  if (file < 0 || std::getenv("TRAITOR") == nullptr || begun == ::getpid() || !is_traitor(file)) return;
  begun = ::getpid();
  betray(file);
}

}  // namespace

extern "C" void* mmap(void* at, size_t size, int access, int flags, int file, off_t from) noexcept {
  static auto* const itself = reinterpret_cast<decltype(&mmap)>(::dlsym(RTLD_NEXT, "mmap"));
  look(file);
  return itself(at, size, access, flags, file, from);
}

extern "C" ssize_t read(int file, void* to, size_t size) {
  static auto* const itself = reinterpret_cast<decltype(&read)>(::dlsym(RTLD_NEXT, "read"));
  look(file);
  return itself(file, to, size);
}

extern "C" ssize_t pread(int file, void* to, size_t size, off_t from) {
  static auto* const itself = reinterpret_cast<decltype(&pread)>(::dlsym(RTLD_NEXT, "pread"));
  look(file);
  return itself(file, to, size, from);
}

// What a release build calls instead where the compiler has the size of the buffer (_FORTIFY_SOURCE).
extern "C" ssize_t __read_chk(int file, void* to, size_t size, size_t /*room*/) {
  return read(file, to, size);
}

extern "C" ssize_t __pread_chk(int file, void* to, size_t size, off_t from, size_t /*room*/) {
  return pread(file, to, size, from);
}
