#include "core/containment.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <thread>

#include "core/memory_files.h"
#include "core/module.h"
#include "core/output.h"
#include "core/process.h"
#include "unit/core/forked.h"
#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

using test::bytes_of;
using test::in_a_child;
using test::put_bytes;
using test::ScratchFolder;

bool can_read(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  if (file >= 0) ::close(file);
  return file >= 0;
}

bool can_write(const std::filesystem::path& path) {
  Result<OutputFile> file = OutputFile::create(path);
  return file && file->write("x").ok() && file->commit().ok();
}

bool can_run(const char* program) {
  pid_t child = 0;
  std::string name = program;
  std::array<char*, 2> words = {name.data(), nullptr};
  if (::posix_spawn(&child, program, nullptr, nullptr, words.data(), environ) != 0) return false;
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool can_connect() {
  const int end = ::socket(AF_INET, SOCK_STREAM, 0);
  if (end >= 0) ::close(end);
  return end >= 0;
}

struct Places {
  ScratchFolder folder;
  std::filesystem::path in = folder / "in", out = folder / "out", other = folder / "other";
  Places() {
    for (const auto& place : {in, out, other}) std::filesystem::create_directory(place);
    for (const auto& place : {in, out, other}) put_bytes(place / "file", "old");
  }
  [[nodiscard]] Allowed allowed() const { return {.read = {in}, .write = {out}, .libraries = false}; }
};

// Every version of Landlock that this kernel knows, as older kernels would have it, and none.
std::vector<Kernel> kernels() {
  std::vector<Kernel> all;
  for (int version = 0; version <= this_kernel().landlock; ++version)
    all.push_back({version, this_kernel().filters});
  return all;
}

TEST(Containment, FilesOfItsOwnPlacesOnly) {
  for (const Kernel& kernel : kernels()) {
    if (kernel.landlock == 0) continue;
    const Places places;
    const int wrong = in_a_child([&] {
      if (!contain(places.allowed(), kernel)) return 1;
      if (!can_read(places.in / "file")) return 2;
      if (can_write(places.in / "file")) return 3;
      if (!can_write(places.out / "new") || !can_write(places.out / "file")) return 4;
      if (can_read(places.other / "file") || can_read("/etc/passwd")) return 5;
      if (can_write(places.other / "file") || can_write(places.other / "new")) return 6;
      if (::unlink((places.other / "file").c_str()) == 0) return 7;
      if (::rename((places.out / "file").c_str(), (places.other / "file").c_str()) == 0) return 8;
      return 0;
    });
    EXPECT_EQ(wrong, 0) << "version " << kernel.landlock;
    EXPECT_EQ(bytes_of(places.out / "file"), "x");
    EXPECT_EQ(bytes_of(places.other / "file"), "old");
    EXPECT_EQ(bytes_of(places.in / "file"), "old");
  }
}

TEST(Containment, NoNetworkAndNoPrograms) {
  for (const Kernel& kernel : kernels()) {
    if (!kernel.filters) continue;
    EXPECT_EQ(in_a_child([&] {
                if (!can_connect() || !can_run("/bin/true")) return 1;  // before it, they can
                const Places places;
                if (!contain(places.allowed(), kernel)) return 2;
                if (can_connect()) return 3;
                if (can_run("/bin/true")) return 4;
                if (::chmod(places.out.c_str(), 0700) == 0) return 5;
                return 0;
              }),
              0)
        << "version " << kernel.landlock;
  }
}

TEST(Containment, ThreadsAndNoProcesses) {
  for (const Kernel& kernel : kernels()) {
    if (!kernel.filters) continue;
    EXPECT_EQ(in_a_child([&] {
                if (!contain({}, kernel)) return 1;
                bool has_run = false;
                std::thread([&] { has_run = true; }).join();
                if (!has_run) return 2;
                if (::fork() >= 0 || errno != EPERM) return 3;
                if (::kill(::getppid(), 0) == 0 || errno != EPERM) return 4;
                return ::kill(::getpid(), 0) == 0 ? 0 : 5;
              }),
              0)
        << "version " << kernel.landlock;
  }
}

// So that the C library falls back to an older one.
TEST(Containment, UnknownCallsAreTakenForMissing) {
  if (!this_kernel().filters) return;
  EXPECT_EQ(in_a_child([&] {
              if (!contain({}, this_kernel())) return 1;
              constexpr long newer = 451, invented = 100'000;
              for (const long call : {newer, invented})
                if (::syscall(call) != -1 || errno != ENOSYS) return 2;
              return ::syscall(SYS_clone3, nullptr, 0) == -1 && errno == ENOSYS ? 0 : 3;
            }),
            0);
}

// Messages go to the socket that was named, and to no other.
TEST(Containment, OneSocketForRequests) {
  if (!this_kernel().filters) return;
  EXPECT_EQ(in_a_child([&] {
              std::array<int, 2> ends{};
              if (::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()) != 0) return 1;
              Allowed allowed;
              allowed.requests = ends[0];
              if (!contain(allowed, this_kernel())) return 2;
              char byte = 'x';
              iovec content{&byte, 1};
              msghdr message{};
              message.msg_iov = &content;
              message.msg_iovlen = 1;
              if (::sendmsg(ends[0], &message, 0) != 1) return 3;
              return ::sendmsg(ends[1], &message, 0) == -1 && errno == EPERM ? 0 : 4;
            }),
            0);
}

// What an output waits in is there before.
TEST(Containment, OutputsInMemory) {
  if (!this_kernel().filters) return;
  EXPECT_EQ(in_a_child([&] {
              reserve_memory_files(1);
              if (!contain({}, this_kernel())) return 1;
              Result<OutputFile> file = OutputFile::in_memory();
              if (!file || !file->write("text").ok()) return 2;
              return *file->contents() == "text" ? 0 : 3;
            }),
            0);
}

TEST(Containment, Modules) {
  EXPECT_EQ(in_a_child([&] {
              Allowed allowed;
              allowed.libraries = true;
              if (!contain(allowed, this_kernel())) return 1;
              return open_module("cgal", "selvage_cgal").ok() ? 0 : 2;
            }),
            0);
}

// The start of a second containment must not be a way out of the first.
TEST(Containment, IsForGood) {
  const Places places;
  const Kernel kernel = this_kernel();
  if (kernel.landlock == 0) return;
  EXPECT_EQ(in_a_child([&] {
              if (!contain(places.allowed(), kernel)) return 1;
              Allowed all;
              all.write = {"/"};
              // Its calls are refused; where there are no filters it takes away more.
              if (contain(all, kernel).ok() == kernel.filters) return 2;
              return can_write(places.other / "new") ? 3 : 0;
            }),
            0);
}

TEST(Containment, RequiredIsAllOrAnError) {
  EXPECT_TRUE(check_sandbox(Sandbox::required, {1, true}).ok());
  EXPECT_TRUE(check_sandbox(Sandbox::automatic, {0, false}).ok());
  EXPECT_TRUE(check_sandbox(Sandbox::off, {0, false}).ok());
  const Status no_landlock = check_sandbox(Sandbox::required, {0, true});
  ASSERT_FALSE(no_landlock.ok());
  EXPECT_NE(no_landlock.error().text.find("Landlock"), std::string::npos);
  const Status no_filters = check_sandbox(Sandbox::required, {4, false});
  ASSERT_FALSE(no_filters.ok());
  EXPECT_NE(no_filters.error().text.find("seccomp"), std::string::npos);
}

// Of three jobs one tries all that it may not; the others do their work.
TEST(Containment, TheRunGoesOn) {
  const Kernel kernel = this_kernel();
  const Places places;
  JobPool pool;
  pool.count = 3;
  pool.at_once = 2;
  pool.run = [&](std::size_t job, const Channel&) {
    if (!contain(places.allowed(), kernel)) return 99;
    if (job != 1) return can_write(places.out / std::to_string(job)) ? 0 : 98;
    return (can_connect() ? 1 : 0) + (can_run("/bin/true") ? 2 : 0) +
           (can_write(places.other / "new") ? 4 : 0);
  };
  std::vector<int> statuses(3, -1);
  pool.received = [](std::size_t, char, std::string_view) {};
  pool.finished = [&](std::size_t job, const JobEnd& end) { statuses[job] = end.status; };
  ASSERT_TRUE(run_jobs(pool).ok());
  const int open_doors = (kernel.filters ? 0 : 3) + (kernel.landlock > 0 ? 0 : 4);
  EXPECT_EQ(statuses, (std::vector<int>{0, open_doors, 0}));
  EXPECT_EQ(bytes_of(places.out / "0") + bytes_of(places.out / "2"), "xx");
}

}  // namespace
}  // namespace selvage
