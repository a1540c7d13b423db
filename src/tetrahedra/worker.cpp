#include "tetrahedra/worker.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "core/bounds.h"
#include "tetrahedra/mesh_check.h"
#include "tetrahedra/tetgen_worker/protocol.h"
#include "tetrahedra/worker_process.h"

namespace selvage::fem {
namespace {

using Clock = std::chrono::steady_clock;

double relative_epsilon(const TetgenJob& job) {
  if (job.smallest_feature <= 0) return 1e-8;
  return std::clamp(1e-5 * job.smallest_feature / bounds_of(job.points).diagonal().norm(), 1e-13, 1e-8);
}

RequestHead head_of(const TetgenJob& job, const TetgenLimits& limits, bool look) {
  RequestHead head;
  head.points = job.points.size();
  head.triangles = job.triangles.size();
  head.epsilon = relative_epsilon(job);
  head.memory = limits.memory * 1024 * 1024;
  head.cpu_seconds = std::ceil(limits.timeout) + 1;
  head.look = look ? 1 : 0;
  return head;
}

template <class T>
std::string_view bytes_of(std::span<const T> items) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes
  return {reinterpret_cast<const char*>(items.data()), items.size_bytes()};
}

// TetGen's own words on one line, as an addition to a message.
std::string quoted(std::string words) {
  for (char& letter : words)
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  while (!words.empty() && words.back() == ' ') words.pop_back();
  return words.empty() ? "" : fmt::format(" (TetGen: '{}')", words);
}

constexpr std::string_view change_size = "try another --size, or look at the yarn with 'selvage check'";

Message judge_end(const WorkerEnd& ended, const TetgenLimits& limits) {
  if (ended.timed_out)
    return error(Kind::limit, fmt::format("meshing took longer than {} s; allow more with --timeout, or "
                                          "choose a coarser --size",
                                          limits.timeout));
  if (WIFSIGNALED(ended.status)) {
    if (WTERMSIG(ended.status) == SIGXCPU)
      return error(Kind::limit, fmt::format("meshing used more than {} s of processor time; allow more with "
                                            "--timeout, or choose a coarser --size",
                                            limits.timeout));
    return error(Kind::internal, fmt::format("TetGen crashed (signal {}); {}{}", WTERMSIG(ended.status),
                                             change_size, quoted(ended.words)));
  }
  return error(Kind::internal, fmt::format("the mesh worker gave no usable answer (exit status {}); {}{}",
                                           WEXITSTATUS(ended.status), change_size, quoted(ended.words)));
}

std::string_view what_failed(Trial trial) {
  switch (trial) {
    case Trial::mesh:
      return "it does not divide a cube as it should";
    case Trial::random_numbers:
      return "it does not take its random numbers from the worker";
    case Trial::giving_up:
      return "it does not tell the worker when it gives up";
  }
  return "an unknown trial";
}

Message judge_refusal(const AnswerHead& head, const WorkerEnd& ended, const TetgenLimits& limits) {
  if (head.outcome == Outcome::memory)
    return error(Kind::limit,
                 fmt::format("meshing needs more than {} MiB; allow more with --memory, or choose "
                             "a coarser --size",
                             limits.memory));
  if (head.outcome == Outcome::bad_request)
    return error(Kind::internal, "the mesh worker did not understand its request");
  if (head.outcome == Outcome::other_library)
    return error(Kind::internal,
                 fmt::format("TetGen's library on this machine is not the one that the mesh worker was built "
                             "for ({}); build the program anew here, with TetGen 1.5",
                             what_failed(static_cast<Trial>(head.code))));
  std::string_view why = "TetGen failed";
  Kind kind = Kind::internal;
  if (head.code >= 3 && head.code <= 5) {
    kind = Kind::geometry;
    why = head.code == 3   ? "facets of the yarn's surface cross"
          : head.code == 4 ? "the yarn's surface has a feature too small to mesh"
                           : "two facets of the yarn's surface lie too close together";
  }
  return error(kind,
               fmt::format("{} (TetGen's code {}); {}{}", why, head.code, change_size, quoted(ended.words)));
}

Vec3 centre(const TetgenJob& job, const Triangle& triangle) {
  return (job.points[triangle[0]] + job.points[triangle[1]] + job.points[triangle[2]]) / 3;
}

// Takes the arrays out of the answer behind its head.
template <class T>
const char* take(const char* from, std::vector<T>& to, std::size_t count) {
  to.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(to.data()), from, count * sizeof(T));
  return from + count * sizeof(T);
}

Message crossing(const TetgenJob& job, const std::vector<Triangle>& triangles) {
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= job.points.size()) return error(Kind::internal, "the mesh worker's answer is damaged");
  const Vec3 at = centre(job, triangles.front());
  const std::string_view why =
      job.sides.empty()
          ? "the surface intersects itself there; widen the bend or make the section smaller, or try "
            "a finer --size"
          : "yarns overlap there, or are too near to each other for triangles of this size; try "
            "a finer --size, or move them apart with --relax where they have room";
  return error(Kind::geometry,
               fmt::format("{} facets cross each other, the first at ({:.6g}, {:.6g}, {:.6g}): {}",
                           triangles.size(), at.x(), at.y(), at.z(), why))
      .at_point(at);
}

Result<TetMesh> read_answer(const TetgenJob& job, const WorkerEnd& ended, const TetgenLimits& limits) {
  AnswerHead head;
  if (ended.answer.size() < sizeof head) return judge_end(ended, limits);
  std::memcpy(&head, ended.answer.data(), sizeof head);
  if (head.magic != answer_magic) return judge_end(ended, limits);
  if (head.outcome != Outcome::mesh && head.outcome != Outcome::crossing)
    return judge_refusal(head, ended, limits);
  const std::size_t cell = (head.outcome == Outcome::mesh ? 4 : 3) * sizeof(std::int32_t);
  const std::size_t room = ended.answer.size() - sizeof head;
  if (head.points > room || head.cells > room || head.points * sizeof(Vec3) + head.cells * cell != room)
    return judge_end(ended, limits);
  const char* data = ended.answer.data() + sizeof head;
  if (head.outcome == Outcome::crossing) {
    std::vector<Triangle> triangles;
    take(data, triangles, head.cells);
    if (triangles.empty()) return judge_end(ended, limits);
    return crossing(job, triangles);
  }
  TetMesh mesh;
  data = take(data, mesh.points, head.points);
  take(data, mesh.cells, head.cells);
  return mesh;
}

// A request and the worker that has it: for a mesh that nobody has checked yet, or (`look`) for nothing but
// the message that names crossing facets.
class Run {
 public:
  Run(const std::filesystem::path& program, const TetgenJob& job, const TetgenLimits& limits, bool look)
      : program_(program), job_(job), limits_(limits), head_(head_of(job, limits, look)) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::int32_t));
    Result<WorkerProcess> process = WorkerProcess::start(
        program,
        {bytes_of(std::span<const RequestHead>(&head_, 1)), bytes_of(job.points), bytes_of(job.triangles)});
    if (!process)
      failure_ = process.error();
    else
      process_ = std::move(*process);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  ~Run() {
    if (process_) process_->finish(false);
  }
  // True when the answer is whole, or there will be none.
  bool wait(Clock::time_point deadline) {
    if (process_ && !has_ended_ && !failure_) {
      const WorkerProcess::Heard heard = process_->exchange(deadline);
      if (heard == WorkerProcess::Heard::nothing) failure_ = system_error("exchange data");
      has_ended_ = heard == WorkerProcess::Heard::all;
    }
    return failure_ || has_ended_;
  }
  // Once.
  Result<TetMesh> answer(Clock::time_point deadline) {
    wait(deadline);
    if (failure_) return *failure_;
    const WorkerEnd ended = process_->finish(has_ended_);
    process_.reset();
    if (ended.not_started != 0) {
      errno = ended.not_started;
      return system_error(fmt::format("start '{}'", program_.string()));
    }
    return ended.timed_out ? judge_end(ended, limits_) : read_answer(job_, ended, limits_);
  }

 private:
  const std::filesystem::path& program_;
  const TetgenJob& job_;
  const TetgenLimits& limits_;
  const RequestHead head_;
  std::optional<Message> failure_;
  std::optional<WorkerProcess> process_;
  bool has_ended_ = false;
};

}  // namespace

Result<TetMesh> run_tetgen(const std::filesystem::path& program, const TetgenJob& job,
                           const TetgenLimits& limits) {
  const std::vector<Sides> one_region(job.sides.empty() ? job.triangles.size() : 0);
  const std::span<const Sides> sides = job.sides.empty() ? one_region : job.sides;
  if (Status sound = check_surface(job.points, job.triangles, sides); !sound) return sound.error();
  const auto after = [start = Clock::now()](double seconds) {
    return start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  };
  const auto deadline = after(std::min(limits.timeout, 1e8));
  // Facets that cross, with their place: looked for where no mesh came out, and beside a mesher that takes
  // long: there it may run without end. (Before every mesh it would double the work.)
  const auto crossing = [&]() -> std::optional<Message> {
    const Result<TetMesh> seen = Run(program, job, limits, true).answer(deadline);
    if (!seen && seen.error().at) return seen.error();
    return std::nullopt;
  };
  Run meshing(program, job, limits, false);
  const double patience = 0.5 + 1e-4 * static_cast<double>(job.triangles.size());
  const bool takes_long = !meshing.wait(std::min(deadline, after(patience)));
  if (takes_long)
    if (std::optional<Message> found = crossing()) return *found;
  Result<TetMesh> mesh = meshing.answer(deadline);
  Status right = mesh ? Status() : Status(mesh.error());
  if (mesh) right = find_regions(*mesh, job.points, job.triangles, sides);
  if (right) return mesh;
  if (!takes_long)
    if (std::optional<Message> found = crossing()) return *found;
  return right.error();
}

}  // namespace selvage::fem
