// Preloaded into the program (LD_PRELOAD), makes the worker that reads a file named traitor.txt do what a
// flaw in a reader could make it do: open a socket, run a program, and write beside what it was told to.
//
//   TRAITOR=FOLDER   where it tries to write; each deed that succeeds is told on standard error
#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

namespace {

// Standard error was open from the start: to tell of a deed is none.
void tell(const char* deed, bool done) {
  if (done) ::dprintf(STDERR_FILENO, "traitor: %s\n", deed);
}

void betray(const std::string& folder) {
  const int end = ::socket(AF_INET, SOCK_STREAM, 0);
  tell("socket", end >= 0);
  if (end >= 0) ::close(end);
  tell("file", ::open((folder + "/file").c_str(), O_CREAT | O_WRONLY, 0600) >= 0);
  std::string shell = "/bin/sh", option = "-c", text = "exit 7";
  std::array<char*, 4> words = {shell.data(), option.data(), text.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  const bool started = ::posix_spawn(&child, shell.c_str(), nullptr, nullptr, words.data(), environ) == 0 &&
                       ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 7;
  tell("program", started);
}

// A file that is read is mapped first.
bool is_traitor(int file) {
  std::array<char, 4096> name{};
  const ssize_t size =
      ::readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), name.data(), name.size() - 1);
  return size > 0 && std::string(name.data()).ends_with("/traitor.txt");
}

}  // namespace

extern "C" void* mmap(void* at, size_t size, int access, int flags, int file, off_t from) noexcept {
  static auto* const itself = reinterpret_cast<decltype(&mmap)>(::dlsym(RTLD_NEXT, "mmap"));
  const char* folder = std::getenv("TRAITOR");
  if (folder != nullptr && file >= 0 && is_traitor(file)) betray(folder);
  return itself(at, size, access, flags, file, from);
}
