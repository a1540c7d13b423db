#include "fem/worker.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/bounds.h"
#include "fem/mesh_check.h"
#include "fem/tetgen_worker/protocol.h"

namespace selvage::fem {
namespace {

using Clock = std::chrono::steady_clock;

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

Message system_error(std::string_view what) {
  return error(Kind::internal, fmt::format("cannot {} for the mesh worker: {}", what, std::strerror(errno)));
}

bool write_all(int to, const void* from, std::size_t size) {
  const auto* bytes = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t put = ::write(to, bytes, size);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

double relative_epsilon(const TetgenJob& job) {
  if (job.smallest_feature <= 0) return 1e-8;
  return std::clamp(1e-5 * job.smallest_feature / bounds_of(job.points).diagonal().norm(), 1e-13, 1e-8);
}

// The request in an anonymous file: it need not be fed while the worker runs.
Result<Descriptor> write_request(const TetgenJob& job, const TetgenLimits& limits, bool look) {
  Descriptor file(::memfd_create("selvage-tetgen request", MFD_CLOEXEC));
  if (!file.is_open()) return system_error("make a request");
  RequestHead head;
  head.points = job.points.size();
  head.triangles = job.triangles.size();
  head.epsilon = relative_epsilon(job);
  head.memory = limits.memory * 1024 * 1024;
  head.cpu_seconds = std::ceil(limits.timeout) + 1;
  head.parent = ::getpid();
  head.look = look ? 1 : 0;
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::int32_t));
  if (!write_all(file.number(), &head, sizeof head) ||
      !write_all(file.number(), job.points.data(), job.points.size_bytes()) ||
      !write_all(file.number(), job.triangles.data(), job.triangles.size_bytes()) ||
      ::lseek(file.number(), 0, SEEK_SET) != 0)
    return system_error("write a request");
  return file;
}

struct Running {
  pid_t process = -1;
  Descriptor answers;  // the reading end of its standard output
  Descriptor words;    // its standard error, an anonymous file
};

Result<Running> start(const std::filesystem::path& program, const Descriptor& request) {
  Running result;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return system_error("make a pipe");
  result.answers = Descriptor(ends[0]);
  const Descriptor output(ends[1]);
  result.words = Descriptor(::memfd_create("selvage-tetgen words", MFD_CLOEXEC));
  if (!result.words.is_open()) return system_error("make a file");

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  int failure = 0;
  const auto step = [&](int outcome) { failure = failure == 0 ? outcome : failure; };
  step(::posix_spawn_file_actions_adddup2(&actions, request.number(), STDIN_FILENO));
  step(::posix_spawn_file_actions_adddup2(&actions, output.number(), STDOUT_FILENO));
  step(::posix_spawn_file_actions_adddup2(&actions, result.words.number(), STDERR_FILENO));
  // A process group of its own, so that Ctrl-C reaches the program only, which decides.
  step(::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK));
  step(::posix_spawnattr_setpgroup(&attributes, 0));
  step(::posix_spawnattr_setsigmask(&attributes, &none));
  std::string name = program.string();
  std::array<char*, 2> arguments = {name.data(), nullptr};
  if (failure == 0)
    failure = ::posix_spawn(&result.process, name.c_str(), &actions, &attributes, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (failure != 0) {
    errno = failure;
    return system_error(fmt::format("start '{}'", name));
  }
  return result;
}

struct Ended {
  bool timed_out = false;
  int status = 0;  // of waitpid
  std::string answer;
  std::string words;  // the last of what TetGen printed
};

enum class Heard {
  all,
  not_yet,
  nothing,  // it cannot be read: errno says why
};

// Adds to the answer what comes until its end or the deadline.
Heard read_until(const Running& running, Clock::time_point deadline, std::string& answer) {
  std::vector<char> block(1 << 20);
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd watched{running.answers.number(), POLLIN, 0};
    const int ready =
        left <= 0 ? 0 : ::poll(&watched, 1, static_cast<int>(std::min<long long>(left, 60'000)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0 && Clock::now() < deadline) continue;
    if (ready < 0) return Heard::nothing;
    if (ready == 0) return Heard::not_yet;
    const ssize_t got = ::read(running.answers.number(), block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return Heard::nothing;
    if (got == 0) return Heard::all;
    answer.append(block.data(), static_cast<std::size_t>(got));
  }
}

// Its answer has ended, or it is killed; the process is gone afterwards.
Ended finish(const Running& running, bool has_ended, std::string answer) {
  Ended result;
  result.answer = std::move(answer);
  result.timed_out = !has_ended;
  // A worker that closed its output is done or dying; one that hangs there is not waited for.
  for (int tries = 0; !result.timed_out && tries < 2000; ++tries) {
    const pid_t gone = ::waitpid(running.process, &result.status, WNOHANG);
    if (gone == running.process || (gone < 0 && errno != EINTR)) break;
    ::usleep(1000);
    if (tries == 1999) result.timed_out = true;
  }
  if (result.timed_out) {
    ::kill(-running.process, SIGKILL);
    while (::waitpid(running.process, &result.status, 0) < 0 && errno == EINTR) {
    }
  }
  std::array<char, 400> last{};
  const off_t size = ::lseek(running.words.number(), 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(last.size()));
  const ssize_t got = ::pread(running.words.number(), last.data(), last.size(), from);
  if (got > 0) result.words.assign(last.data(), static_cast<std::size_t>(got));
  return result;
}

// TetGen's own words on one line, as an addition to a message.
std::string quoted(std::string words) {
  for (char& letter : words)
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  while (!words.empty() && words.back() == ' ') words.pop_back();
  return words.empty() ? "" : fmt::format(" (TetGen: '{}')", words);
}

constexpr std::string_view change_size = "try another --size, or look at the yarn with 'selvage check'";

Message judge_end(const Ended& ended, const TetgenLimits& limits) {
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

Message judge_refusal(const AnswerHead& head, const Ended& ended, const TetgenLimits& limits) {
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

Result<TetMesh> read_answer(const TetgenJob& job, const Ended& ended, const TetgenLimits& limits) {
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
      : job_(job), limits_(limits) {
    Result<Descriptor> request = write_request(job, limits, look);
    if (!request) {
      failure_ = request.error();
      return;
    }
    Result<Running> running = start(program, *request);
    if (!running)
      failure_ = running.error();
    else
      running_ = std::move(*running);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  ~Run() {
    if (running_) finish(*running_, false, {});
  }
  // True when the answer is whole, or there will be none.
  bool wait(Clock::time_point deadline) {
    if (running_ && !has_ended_) {
      const Heard heard = read_until(*running_, deadline, answer_);
      if (heard == Heard::nothing) failure_ = system_error("read an answer");
      has_ended_ = heard == Heard::all;
    }
    return failure_ || has_ended_;
  }
  // Once.
  Result<TetMesh> answer(Clock::time_point deadline) {
    wait(deadline);
    if (failure_) return *failure_;
    const Ended ended = finish(*running_, has_ended_, std::move(answer_));
    running_.reset();
    return ended.timed_out ? judge_end(ended, limits_) : read_answer(job_, ended, limits_);
  }

 private:
  const TetgenJob& job_;
  const TetgenLimits& limits_;
  std::optional<Message> failure_;
  std::optional<Running> running_;
  std::string answer_;
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
