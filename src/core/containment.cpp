#include "core/containment.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <link.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "core/module.h"
#include "core/words.h"

namespace selvage {

namespace fs = std::filesystem;

namespace {

// Landlock's interface, which older headers know in part only:
// https://docs.kernel.org/userspace-api/landlock.html
struct RulesetAttributes {
  std::uint64_t files = 0, network = 0, scoped = 0;
};
struct [[gnu::packed]] PathRule {
  std::uint64_t allowed = 0;
  std::int32_t parent = -1;
};
constexpr unsigned version_flag = 1;
constexpr unsigned path_rule_type = 1;

namespace right {
constexpr std::uint64_t execute = 1U << 0, write_file = 1U << 1, read_file = 1U << 2, read_folder = 1U << 3,
                        remove_file = 1U << 5, make_file = 1U << 8, refer = 1U << 13, truncate = 1U << 14,
                        device_control = 1U << 15;
constexpr std::uint64_t first_version = refer - 1;
constexpr std::uint64_t of_files = execute | write_file | read_file | truncate | device_control;
constexpr std::uint64_t read = read_file | read_folder;
constexpr std::uint64_t write = read | write_file | truncate | make_file | remove_file;
}  // namespace right

std::uint64_t known_rights(int version) {
  std::uint64_t known = right::first_version;
  if (version >= 2) known |= right::refer;
  if (version >= 3) known |= right::truncate;
  if (version >= 5) known |= right::device_control;
  return known;
}

Message step_failed(std::string_view step) {
  return error(Kind::internal, fmt::format("cannot be contained: {}: {}; --sandbox off does without", step,
                                           std::strerror(errno)));
}

class Ruleset {
 public:
  explicit Ruleset(int version) : rights_(known_rights(version)) {
    RulesetAttributes wanted;
    wanted.files = rights_;
    if (version >= 4) wanted.network = 3;  // bind and connect, of TCP
    if (version >= 6) wanted.scoped = 3;   // abstract sockets, and signals to processes outside
    descriptor_ = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &wanted, sizeof wanted, 0U));
  }
  Ruleset(const Ruleset&) = delete;
  Ruleset& operator=(const Ruleset&) = delete;
  ~Ruleset() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

  // False: the rule was refused, or no file can be opened now. What is not there gets none.
  [[nodiscard]] bool allow(const fs::path& path, std::uint64_t rights) const {
    const int place = ::open(path.c_str(), O_PATH | O_CLOEXEC);
    if (place < 0) return errno != EMFILE && errno != ENFILE && errno != ENOMEM;
    struct stat facts {};
    bool well = ::fstat(place, &facts) == 0;
    if (!S_ISDIR(facts.st_mode)) rights &= right::of_files;
    PathRule rule;
    rule.allowed = rights & rights_;
    rule.parent = place;
    well = well && ::syscall(SYS_landlock_add_rule, descriptor_, path_rule_type, &rule, 0U) == 0;
    const int reason = errno;
    ::close(place);
    errno = reason;
    return well;
  }

  [[nodiscard]] bool enforce() const { return ::syscall(SYS_landlock_restrict_self, descriptor_, 0U) == 0; }

 private:
  std::uint64_t rights_;
  int descriptor_ = -1;
};

// Where the modules' libraries may be, and what those look at to know the machine.
std::vector<fs::path> library_places() {
  const fs::path here = program_folder();
  std::vector<fs::path> places = {here,          here / "../lib", "/usr",          "/lib",
                                  "/lib64",      "/nix/store",    "/opt",          "/etc/ld.so.cache",
                                  "/proc/self",  "/proc/cpuinfo", "/proc/meminfo", "/sys/devices/system",
                                  "/dev/urandom"};
  const char* listed = std::getenv("LD_LIBRARY_PATH");
  for (const std::string_view place : words_of(listed == nullptr ? "" : listed, ':'))
    places.emplace_back(place);
  return places;
}

// The dynamic loader that started this program, which is the one of its worker programs, too.
fs::path loader() {
  std::string name;
  const auto look = [](dl_phdr_info* program, std::size_t, void* found) {
    for (int i = 0; i < program->dlpi_phnum; ++i)
      if (program->dlpi_phdr[i].p_type == PT_INTERP)
        *static_cast<std::string*>(found) =
            // NOLINTNEXTLINE(performance-no-int-to-ptr): an address, as the loader tells it
            reinterpret_cast<const char*>(program->dlpi_addr + program->dlpi_phdr[i].p_vaddr);
    return 1;  // the first one is the program
  };
  ::dl_iterate_phdr(look, &name);
  return name;
}

Status bound_files(const Allowed& allowed, int version) {
  const Ruleset rules(version);
  if (!rules.is_open()) return step_failed("Landlock's rules");
  bool well = rules.allow("/dev/null", right::read | right::write);
  for (const fs::path& place : allowed.read) well = well && rules.allow(place, right::read);
  for (const fs::path& place : allowed.write) well = well && rules.allow(place, right::write);
  if (allowed.libraries)
    for (const fs::path& place : library_places()) well = well && rules.allow(place, right::read);
  for (const fs::path& place : allowed.run) well = well && rules.allow(place, right::read | right::execute);
  if (!allowed.run.empty()) well = well && rules.allow(loader(), right::read | right::execute);
  if (!well || !rules.enforce()) return step_failed("Landlock");
  return {};
}

#if defined(__x86_64__)
constexpr std::uint32_t this_processor = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t this_processor = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t this_processor = 0;  // no filter is known for it
#endif

// Calls that no reader, builder, mesher or writer has a use for.
constexpr std::array refused_calls = {
    // the network, also through sockets that were open already
    SYS_socket, SYS_connect, SYS_bind, SYS_listen, SYS_accept, SYS_accept4, SYS_sendto, SYS_sendmsg,
    SYS_sendmmsg,
    // other processes
    SYS_ptrace, SYS_process_vm_readv, SYS_process_vm_writev, SYS_pidfd_getfd,
    // what Landlock leaves open: attributes of files by their names
    SYS_fchmodat, SYS_fchownat, SYS_setxattr, SYS_lsetxattr, SYS_removexattr, SYS_lremovexattr,
#ifdef SYS_chmod
    SYS_chmod, SYS_chown, SYS_lchown,
#endif
    // ways past the filter, and doors into the kernel
    SYS_io_uring_setup, SYS_bpf, SYS_perf_event_open, SYS_userfaultfd, SYS_keyctl, SYS_add_key,
    SYS_request_key, SYS_mount, SYS_umount2, SYS_pivot_root, SYS_chroot, SYS_unshare, SYS_setns,
    SYS_open_by_handle_at, SYS_init_module, SYS_finit_module, SYS_delete_module, SYS_kexec_load};
constexpr std::array program_calls = {SYS_execve, SYS_execveat};

Status filter_calls(bool may_run) {
  std::vector<sock_filter> filter;
  const auto load = [&](std::size_t offset) {
    filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  };
  const auto answer = [&](std::uint32_t value) { filter.push_back(BPF_STMT(BPF_RET | BPF_K, value)); };
  const auto refuse = [&](long call) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1));
    answer(SECCOMP_RET_ERRNO | EPERM);
  };
  load(offsetof(seccomp_data, arch));
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, this_processor, 1, 0));
  answer(SECCOMP_RET_KILL_PROCESS);  // calls of another processor's form have other numbers
  load(offsetof(seccomp_data, nr));
#ifdef __x86_64__
  constexpr std::uint32_t x32 = 0x40000000;  // the same calls once more, with this bit
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, x32, 0, 1));
  answer(SECCOMP_RET_ERRNO | EPERM);
#endif
  for (const long call : refused_calls) refuse(call);
  if (!may_run)
    for (const long call : program_calls) refuse(call);
  answer(SECCOMP_RET_ALLOW);
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) return step_failed("seccomp");
  return {};
}

}  // namespace

Kernel this_kernel() {
  Kernel kernel;
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, std::size_t{0}, version_flag);
  kernel.landlock = static_cast<int>(std::max(version, 0L));
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  kernel.filters = this_processor != 0 && ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0U, &action) == 0;
  return kernel;
}

Status check_sandbox(Sandbox wanted, const Kernel& kernel) {
  if (wanted != Sandbox::required || (kernel.landlock > 0 && kernel.filters)) return {};
  return error(
      Kind::usage,
      fmt::format("--sandbox require: this kernel has no {}; --sandbox auto takes what there is",
                  kernel.landlock == 0
                      ? "Landlock (Linux 5.13 or newer, with 'landlock' in its list of security modules)"
                      : "filters of system calls (seccomp)"));
}

Status contain(const Allowed& allowed, const Kernel& kernel) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return step_failed("no_new_privs");
  if (kernel.landlock > 0)
    if (Status bounded = bound_files(allowed, kernel.landlock); !bounded) return bounded;
  if (kernel.filters) return filter_calls(!allowed.run.empty());
  return {};
}

}  // namespace selvage
