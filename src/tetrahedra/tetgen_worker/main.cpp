// selvage-tetgen PARENT: one job of TetGen in a process of its own, with limits, which ends with its parent,
// the process of that number. See protocol.h for what goes in and out. `selvage-tetgen start PROGRAM` starts
// such processes: see starter.h.
//
// TetGen 1.5.0 may end in a segmentation fault, run for hours or eat all memory; all of that stays here. It
// meshes, or only looks for crossing facets (TetGen's -d, which does not crash on them).
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "core/containment.h"
#include "core/sanitized.h"
#include "tetrahedra/tetgen_worker/job.h"
#include "tetrahedra/tetgen_worker/protocol.h"
#include "tetrahedra/tetgen_worker/starter.h"

namespace selvage::fem {
namespace {

// The real standard output: descriptor 1 is given to TetGen's own words.
int answer_descriptor = -1;

bool read_all(void* to, std::size_t size) {
  auto* bytes = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = ::read(STDIN_FILENO, bytes, size);
    if (got <= 0) return false;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

void write_all(const void* from, std::size_t size) {
  const auto* bytes = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t put = ::write(answer_descriptor, bytes, size);
    if (put <= 0) ::_exit(1);  // nobody listens
    bytes += put;
    size -= static_cast<std::size_t>(put);
  }
}

// A lower limit that is in force already stays.
void limit(__rlimit_resource_t resource, double value) {
  if (value <= 0) return;
  const auto amount = static_cast<rlim_t>(value);
  rlimit both{};
  if (::getrlimit(resource, &both) != 0) ::_exit(1);
  both.rlim_max = std::min(both.rlim_max, amount + 2);  // processor time: SIGXCPU first
  both.rlim_cur = std::min(both.rlim_max, amount);
  if (::setrlimit(resource, &both) != 0) ::_exit(1);
}

// The request's arrays; false: they do not make sense.
bool read_job(const RequestHead& head, Job& job) {
  if (head.points > 500'000'000 || head.triangles > 500'000'000) return false;
  job.points.resize(3 * head.points);
  job.triangles.resize(3 * head.triangles);
  if (!read_all(job.points.data(), job.points.size() * sizeof(double)) ||
      !read_all(job.triangles.data(), job.triangles.size() * sizeof(std::int32_t)))
    return false;
  for (const double value : job.points)
    if (!std::isfinite(value)) return false;
  for (const std::int32_t index : job.triangles)
    if (index < 0 || static_cast<std::uint64_t>(index) >= head.points) return false;
  return head.points >= 4 && head.triangles >= 4;
}

int run() {
  RequestHead head;
  if (!read_all(&head, sizeof head) || head.magic != request_magic) leave(Outcome::bad_request, 0);
  if (!sanitized) limit(RLIMIT_AS, head.memory);
  limit(RLIMIT_CPU, head.cpu_seconds);
  const rlimit no_core{0, 0};
  if (::setrlimit(RLIMIT_CORE, &no_core) != 0) return 1;

  test_library();
  // It has all that it needs: no file, no network, no program.
  if (!contain({}, this_kernel())) return 1;

  Job job;
  job.settings = head;
  if (!read_job(head, job)) leave(Outcome::bad_request, 0);
  AnswerHead answer;
  if (head.look != 0) {
    const std::vector<std::int32_t> crossing = find_crossings(job);
    answer.outcome = crossing.empty() ? Outcome::mesh : Outcome::crossing;
    answer.cells = crossing.size() / 3;
    write_all(&answer, sizeof answer);
    write_all(crossing.data(), crossing.size() * sizeof(std::int32_t));
    return 0;
  }
  const Tetrahedra mesh = tetrahedralize(job);
  answer.outcome = Outcome::mesh;
  answer.points = mesh.points.size() / 3;
  answer.cells = mesh.cells.size() / 4;
  write_all(&answer, sizeof answer);
  write_all(mesh.points.data(), mesh.points.size() * sizeof(double));
  write_all(mesh.cells.data(), mesh.cells.size() * sizeof(std::int32_t));
  return 0;
}

}  // namespace

void leave(Outcome outcome, int code) {
  AnswerHead answer;
  answer.outcome = outcome;
  answer.code = code;
  write_all(&answer, sizeof answer);
  ::_exit(0);
}

}  // namespace selvage::fem

int main(int count, char** words) {
  using namespace selvage::fem;
  if (count == 3 && std::strcmp(words[1], start_word) == 0) return start_programs(words[2]);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (count != 2 || std::to_string(::getppid()) != words[1]) return 1;  // it died before the line above
  answer_descriptor = ::dup(STDOUT_FILENO);
  if (answer_descriptor < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return 1;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::set_new_handler([] { leave(Outcome::memory, 0); });
  return run();
}
