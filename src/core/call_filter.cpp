#include "core/call_filter.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/sched.h>
#include <linux/seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace selvage {

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t this_processor = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t this_processor = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t this_processor = 0;  // no filter is known for it
#endif

// Calls that pass whatever their arguments are. What they reach is bounded by Landlock (names) or by what is
// open (descriptors).
constexpr std::array passing_calls = {
    // open files
    SYS_read,
    SYS_write,
    SYS_readv,
    SYS_writev,
    SYS_pread64,
    SYS_pwrite64,
    SYS_preadv,
    SYS_pwritev,
    SYS_lseek,
    SYS_close,
    SYS_fstat,
    SYS_fsync,
    SYS_fdatasync,
    SYS_ftruncate,
    SYS_fallocate,
    SYS_fadvise64,
    SYS_flock,
    SYS_getdents64,
    SYS_fstatfs,
    SYS_ppoll,
    SYS_pselect6,
    SYS_pipe2,
    SYS_dup,
    // names
    SYS_newfstatat,
    SYS_statx,
    SYS_statfs,
    SYS_faccessat,
    SYS_faccessat2,
    SYS_readlinkat,
    SYS_getcwd,
    SYS_renameat,
    SYS_renameat2,
    SYS_linkat,
    SYS_unlinkat,
    SYS_umask,
    // memory
    SYS_munmap,
    SYS_mremap,
    SYS_brk,
    SYS_mincore,
    SYS_msync,
    // threads, and facts about the process and the machine
    SYS_futex,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_set_robust_list,
    SYS_rseq,
    SYS_membarrier,
    SYS_getpid,
    SYS_getppid,
    SYS_gettid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_getcpu,
    SYS_getrusage,
    SYS_times,
    SYS_sysinfo,
    SYS_uname,
    SYS_getrandom,
    SYS_exit,
    SYS_exit_group,
    // time
    SYS_clock_gettime,
    SYS_clock_getres,
    SYS_gettimeofday,
    SYS_nanosleep,
    SYS_clock_nanosleep,
    SYS_setitimer,
    SYS_getitimer,
    // its own signals
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_sigaltstack,
    SYS_restart_syscall,
#ifdef __x86_64__  // which has older forms, too
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
    SYS_rename,
    SYS_link,
    SYS_unlink,
    SYS_poll,
    SYS_select,
    SYS_time,
    SYS_alarm,
    SYS_pause,
#endif
};

// Calls of this list's time that the C library can do without.
constexpr std::array replaceable_calls = {SYS_clone3,       SYS_openat2, SYS_close_range, SYS_copy_file_range,
                                          SYS_epoll_pwait2, SYS_preadv2, SYS_pwritev2};
// The last one of this list's time; all processors have the same numbers since Linux 5.1.
constexpr std::uint32_t last_listed_call = SYS_set_mempolicy_home_node;

// (argument & mask) == value, of its lower 32 bits or the upper ones. The kernel takes the lower ones of
// everything that is compared here but of pointers.
struct Condition {
  unsigned argument = 0;
  std::uint32_t mask = 0, value = 0;
  bool upper = false;
};
using Conditions = std::initializer_list<Condition>;
constexpr std::uint32_t all_bits = 0xffffffff;

constexpr Condition equals(unsigned argument, std::uint32_t value) {
  return {argument, all_bits, value};
}
constexpr Condition has(unsigned argument, std::uint32_t bits) {
  return {argument, bits, bits};
}
constexpr Condition has_none(unsigned argument, std::uint32_t bits) {
  return {argument, bits, 0};
}

constexpr std::uint32_t allow = SECCOMP_RET_ALLOW, refuse = SECCOMP_RET_ERRNO | EPERM,
                        unknown = SECCOMP_RET_ERRNO | ENOSYS;

class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, this_processor, 1, 0);
    answer(SECCOMP_RET_KILL_PROCESS);  // calls of another processor's form have other numbers
    load_number();
#ifdef __x86_64__
    constexpr std::uint32_t x32 = 0x40000000;  // the same calls once more, with this bit
    jump(BPF_JGE, x32, 0, 1);
    answer(refuse);
#endif
    jump(BPF_JGT, last_listed_call, 0, 1);
    answer(unknown);
  }

  // From here on of this call.
  void always(long call, std::uint32_t what) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 1);
    answer(what);
  }
  // `what` where one of the lists of conditions holds, all of it; else the other of allow and refuse.
  void decide(long call, std::uint32_t what, std::initializer_list<Conditions> lists) {
    const std::size_t at = program_.size();
    jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 0);
    for (const Conditions& conditions : lists) {
      // Each condition takes three steps; where it does not hold, the rest of its list is left out.
      std::size_t left = conditions.size();
      for (const Condition& condition : conditions) {
        --left;
        static_assert(std::endian::native == std::endian::little);
        load(offsetof(seccomp_data, args) + 8 * condition.argument + (condition.upper ? 4 : 0));
        program_.push_back(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, condition.mask));
        jump(BPF_JEQ, condition.value, 0, static_cast<std::uint8_t>(3 * left + 1));
      }
      answer(what);
    }
    answer(what == allow ? refuse : allow);
    program_[at].jf = static_cast<std::uint8_t>(program_.size() - at - 1);
  }

  bool enforce() {
    answer(refuse);
    const sock_fprog program{static_cast<unsigned short>(program_.size()), program_.data()};
    return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  void load(std::size_t offset) {
    program_.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  }
  void load_number() {
    load(offsetof(seccomp_data, nr));
  }
  void jump(unsigned how, std::uint32_t with, std::uint8_t if_true, std::uint8_t if_false) {
    program_.push_back(BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | BPF_K | how), with, if_true, if_false));
  }
  void answer(std::uint32_t value) {
    program_.push_back(BPF_STMT(BPF_RET | BPF_K, value));
  }

  std::vector<sock_filter> program_;
};

// Memory is written or executed, never both, and only files are executed.
void decide_memory(Filter& filter) {
  filter.decide(SYS_mmap, refuse,
                {{has(2, PROT_WRITE | PROT_EXEC)}, {has(2, PROT_EXEC), has(3, MAP_ANONYMOUS)}});
  filter.decide(SYS_mprotect, refuse, {{has(2, PROT_EXEC)}});
  // Pages can be declared broken by the administrator.
  constexpr std::uint32_t poison = 100, soft_offline = 101;
  filter.decide(SYS_madvise, refuse, {{equals(2, poison)}, {equals(2, soft_offline)}});
}

// What is made has no rights but those of reading, writing and execution: no set-user-ID program.
void decide_files(Filter& filter) {
  filter.decide(SYS_openat, refuse, {{has(3, S_ISUID)}, {has(3, S_ISGID)}});
#ifdef __x86_64__
  filter.decide(SYS_open, refuse, {{has(2, S_ISUID)}, {has(2, S_ISGID)}});
#endif
  filter.decide(SYS_fcntl, allow,
                {{equals(1, F_GETFD)},
                 {equals(1, F_SETFD)},
                 {equals(1, F_GETFL)},
                 {equals(1, F_SETFL), has_none(2, O_ASYNC)},  // no signals to others
                 {equals(1, F_DUPFD)},
                 {equals(1, F_DUPFD_CLOEXEC)},
                 {equals(1, F_GETLK)},
                 {equals(1, F_SETLK)},
                 {equals(1, F_SETLKW)}});
  filter.decide(SYS_ioctl, allow, {{equals(1, FIONREAD)}});
}

// Threads, no processes; no signals and no limits but its own.
void decide_processes(Filter& filter) {
  const auto self = static_cast<std::uint32_t>(::getpid());
  constexpr std::uint32_t elsewhere = CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC |
                                      CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET | CLONE_PIDFD |
                                      CLONE_PTRACE | CLONE_VFORK;
  filter.decide(SYS_clone, allow, {{has(0, CLONE_THREAD), has_none(0, elsewhere)}});
  filter.decide(SYS_kill, allow, {{equals(0, self)}});
  filter.decide(SYS_tgkill, allow, {{equals(0, self)}});
  const Condition no_pointer_below = equals(2, 0), no_pointer_above = {2, all_bits, 0, true};
  filter.decide(SYS_prlimit64, allow,
                {{equals(0, 0), no_pointer_below, no_pointer_above},
                 {equals(0, self), no_pointer_below, no_pointer_above}});
  constexpr std::uint32_t name_memory = 0x53564d41;  // PR_SET_VMA
  filter.decide(SYS_prctl, allow,
                {{equals(0, PR_SET_NAME)}, {equals(0, PR_GET_NAME)}, {equals(0, name_memory)}});
}

}  // namespace

bool can_filter_calls() {
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return this_processor != 0 && ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0U, &action) == 0;
}

bool filter_calls(int requests) {
  Filter filter;
  for (const long call : passing_calls) filter.always(call, allow);
  for (const long call : replaceable_calls) filter.always(call, unknown);
  decide_memory(filter);
  decide_files(filter);
  decide_processes(filter);
  if (requests >= 0) filter.decide(SYS_sendmsg, allow, {{equals(0, static_cast<std::uint32_t>(requests))}});
  return filter.enforce();
}

}  // namespace selvage
