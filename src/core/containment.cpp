#include "core/containment.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "core/call_filter.h"
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

Status bound_files(const Allowed& allowed, int version) {
  const Ruleset rules(version);
  if (!rules.is_open()) return step_failed("Landlock's rules");
  bool well = rules.allow("/dev/null", right::read | right::write);
  for (const fs::path& place : allowed.read) well = well && rules.allow(place, right::read);
  for (const fs::path& place : allowed.write) well = well && rules.allow(place, right::write);
  if (allowed.libraries)
    for (const fs::path& place : library_places()) well = well && rules.allow(place, right::read);
  if (!well || !rules.enforce()) return step_failed("Landlock");
  return {};
}

}  // namespace

Kernel this_kernel() {
  Kernel kernel;
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, std::size_t{0}, version_flag);
  kernel.landlock = static_cast<int>(std::max(version, 0L));
  kernel.filters = can_filter_calls();
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
  if (kernel.filters && !filter_calls(allowed.requests)) return step_failed("seccomp");
  return {};
}

}  // namespace selvage
