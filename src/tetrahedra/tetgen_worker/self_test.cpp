// Two of TetGen's functions are replaced by name, and its own steps are called past its front door: that
// holds for a shared library whose symbols can be replaced and whose classes are those of its header, which
// nothing but a trial can tell.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "tetrahedra/tetgen_worker/job.h"

namespace selvage::fem {
namespace {

// What fails with a signal fails here.
Trial current = Trial::mesh;

constexpr std::array<int, 5> deadly = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};

void end_here(int /*signal*/) {
  leave(Outcome::other_library, static_cast<int>(current));
}

// One that is never a mesh: all points in a plane.
Job flat_job() {
  Job job;
  job.points = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.25, 0.25};
  job.triangles = {0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 2, 1};
  return job;
}

// The unit cube, its sides parted by diagonals.
Job cube_job() {
  Job job;
  for (const double z : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (const double x : {0.0, 1.0}) job.points.insert(job.points.end(), {x, y, z});
  job.triangles = {0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                   1, 3, 7, 1, 7, 5, 3, 2, 7, 2, 6, 7, 2, 0, 6, 0, 4, 6};
  return job;
}

// All its sides have a diagonal through one of two opposite corners, so that six tetrahedra round the line
// between these, a sixth each, fill it without a further point, and no others do.
bool is_cube(const Job& job, const Tetrahedra& mesh) {
  if (mesh.points != job.points || mesh.cells.size() != std::size_t{4} * 6) return false;
  for (std::size_t k = 0; k < mesh.cells.size(); k += 4) {
    std::array<std::array<double, 3>, 3> edge{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto from = static_cast<std::size_t>(mesh.cells[k]),
                   to = static_cast<std::size_t>(mesh.cells[k + 1 + i]);
        if (from >= 8 || to >= 8) return false;
        edge[i][axis] = mesh.points[3 * to + axis] - mesh.points[3 * from + axis];
      }
    const auto& [a, b, c] = edge;
    const double six = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                       a[2] * (b[0] * c[1] - b[1] * c[0]);
    if (std::abs(std::abs(six) - 1) > 1e-12) return false;
  }
  return true;
}

// What TetGen prints meanwhile is about no one's yarn.
class Silence {
 public:
  Silence() : kept_(::dup(STDOUT_FILENO)) {
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDOUT_FILENO);
    if (nowhere >= 0) ::close(nowhere);
  }
  ~Silence() {
    std::fflush(stdout);
    if (kept_ >= 0 && ::dup2(kept_, STDOUT_FILENO) >= 0) ::close(kept_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int kept_;
};

void require(bool holds) {
  if (!holds) leave(Outcome::other_library, static_cast<int>(current));
}

}  // namespace

void test_library() {
  const Silence silence;
  for (const int signal : deadly) std::signal(signal, end_here);
  current = Trial::mesh;
  const Job cube = cube_job();
  require(is_cube(cube, tetrahedralize(cube)));
  current = Trial::random_numbers;
  require(random_numbers() > 0);
  current = Trial::giving_up;
  require(gives_up([] { tetrahedralize(flat_job()); }));
  for (const int signal : deadly) std::signal(signal, SIG_DFL);
}

}  // namespace selvage::fem
