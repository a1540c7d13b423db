// A part of a test in a process of its own, which it may spoil.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <functional>

namespace selvage::test {

// What `work` returns (0-99); 100 and the signal's number where it was killed, as it is after two minutes.
inline int in_a_child(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(120);
    ::_exit(work());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 100 + WTERMSIG(status);
}

}  // namespace selvage::test
