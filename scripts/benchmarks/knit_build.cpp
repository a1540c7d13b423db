// How long a jersey takes: its centre lines by each parameterization, its tubes, its IGES file; and whether
// the cost of a loop stays the same from 50 x 50 to 500 x 500. The peer of the centre lines, in the same run
// and in turns with them, solves the very same systems as Eigen's general sparse LU. One JSON object to
// standard output.
//
//   knit_build [--repeats N] [--sizes N,N,...] [--folder DIR]
#include <fmt/format.h>
#include <unistd.h>

#include <Eigen/SparseLU>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "construction/build.h"
#include "core/output.h"
#include "formats/registry.h"
#include "nurbs/basis.h"
#include "nurbs/interpolate.h"
#include "scripts/benchmarks/measuring.h"

namespace {

using namespace selvage;
using benchmarks::fail;
using benchmarks::median;

template <class T>
T required(Result<T> result) {
  if (!result) fail(to_string(result.error()));
  return std::move(*result);
}

fabric::Fabric jersey(int size, nurbs::Parameterization method) {
  fabric::Fabric cloth;
  fabric::Thread thread;
  thread.name = "cotton30";
  thread.linear_density = fabric::LinearDensity{30, fabric::LinearDensity::Measure::tex};
  thread.density = 1.52;
  thread.packing = 0.75;
  cloth.threads = {thread};
  fabric::Knit knit;
  knit.threads = {thread.name};
  knit.courses = knit.wales = size;
  knit.method = method;
  cloth.items = {knit};
  return cloth;
}

fabric::YarnBuilder builder_of(const fabric::Fabric& cloth) {
  Diagnostics diagnostics;
  std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(cloth, {}, diagnostics);
  if (!builder) fail(to_string(*diagnostics.first_error()));
  return std::move(*builder);
}

template <class Work>
double seconds(Work work) {
  const auto from = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
}

// From the text's model to every centre line; the builder is made anew each time.
void centre_lines(const fabric::Fabric& cloth) {
  const fabric::YarnBuilder builder = builder_of(cloth);
  for (std::size_t i = 0; i < builder.count(); ++i)
    if (!builder.plan(i).ok()) fail("a course has no plan");
}

// The inner control points of one course by a general sparse solver: rows as the interpolation states them.
double solved_by_lu(const std::vector<Vec3>& points, const std::vector<double>& t) {
  const auto count = static_cast<Eigen::Index>(points.size());
  const std::vector<double> knots = nurbs::clamped_knots(t);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    right.row(i) = points[static_cast<std::size_t>(i)].transpose();
    if (i == 0 || i + 1 == count) {
      entries.emplace_back(i, i, 1.0);
      continue;
    }
    nurbs::BasisRow values{};
    nurbs::basis(knots, 3, static_cast<int>(i) + 3, t[static_cast<std::size_t>(i)], values);
    for (int k = 0; k < 3; ++k) entries.emplace_back(i, i - 1 + k, values[static_cast<std::size_t>(k)]);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) fail("the peer's factorization failed");
  return Eigen::MatrixXd(solver.solve(right)).sum();
}

struct Tubes {
  int loops = 0;
  double tube_seconds = 0, iges_seconds = 0;
  std::uint64_t bytes = 0;
};

// Tubes and their file, of as many whole courses as have 5,000 loops.
Tubes tubes(const fabric::Fabric& cloth, int size, const std::string& path) {
  const fabric::YarnBuilder builder = builder_of(cloth);
  const int courses = std::clamp(5'000 / size, 1, size);
  OutputFile output = required(OutputFile::create(path));
  formats::SurfaceOptions options;
  options.file_name = "jersey.igs";
  options.expected_bodies = static_cast<std::uint64_t>(courses);
  auto writer = required(formats::iges::descriptor().open_bodies(output, options));
  Tubes measured;
  measured.loops = courses * size;
  for (int i = 0; i < courses; ++i) {
    std::optional<yarn::Body> body;
    measured.tube_seconds += seconds([&] { body = required(builder.build(static_cast<std::size_t>(i))); });
    measured.iges_seconds += seconds([&] {
      if (Status added = writer->add(*body); !added) fail(to_string(added.error()));
    });
  }
  measured.iges_seconds += seconds([&] { required(writer->finish()); });
  measured.bytes = output.size();
  return measured;
}

// Medians of runs in turns: ours, and the peer on the same data points and parameters.
std::string line_row(std::string_view name, nurbs::Parameterization method, int size, int repeats) {
  const fabric::Fabric cloth = jersey(size, method);
  const fabric::YarnBuilder builder = builder_of(cloth);
  const fabric::YarnPlan plan = required(builder.plan(0));
  std::vector<double> ours, peer, ratios;
  double sum = 0;
  for (int r = 0; r <= repeats; ++r) {
    const double a = seconds([&] { centre_lines(cloth); });
    const double b = seconds([&] {
      for (int course = 0; course < size; ++course) sum += solved_by_lu(plan.points, plan.line.parameters);
    });
    if (r == 0) continue;  // warm-up
    ours.push_back(a);
    peer.push_back(b);
    ratios.push_back(b / a);
  }
  if (!(sum * 0 == 0)) fail("the peer's solution is not finite");
  return fmt::format(
      R"(  {{"method": "{}", "size": {}, "seconds": {:.6g}, "seconds_a_loop": {:.6g}, "peer_seconds": {:.6g}, "times_peer": {:.3f}}})",
      name, size, median(ours), median(ours) / size / size, median(peer), median(ratios));
}

std::string joined(const std::vector<std::string>& rows) {
  return fmt::format("[\n{}\n]", fmt::join(rows, ",\n"));
}

}  // namespace

int main(int count, char** words) {
  benchmarks::Arguments given;
  given.repeats = 15;
  given.sizes = {50, 158, 500};
  given.read(count, words);
  using Method = nurbs::Parameterization;
  const std::vector<std::pair<std::string_view, Method>> methods = {
      {"uniform", Method::uniform}, {"chord", Method::chord}, {"centripetal", Method::centripetal}};
  std::vector<std::string> lines, bodies;
  for (const int size : given.sizes) {
    const int repeats = size > 200 ? std::max(1, given.repeats / 5) : given.repeats;
    for (const auto& [name, method] : methods) lines.push_back(line_row(name, method, size, repeats));
    const std::string path = fmt::format("{}/selvage-knit-{}.igs", given.folder, ::getpid());
    const Tubes measured = tubes(jersey(size, Method::chord), size, path);
    bodies.push_back(fmt::format(
        R"(  {{"size": {}, "loops": {}, "tube_seconds": {:.6g}, "tube_seconds_a_loop": {:.6g}, "iges_seconds": {:.6g}, "iges_seconds_a_loop": {:.6g}, "bytes": {}}})",
        size, measured.loops, measured.tube_seconds, measured.tube_seconds / measured.loops,
        measured.iges_seconds, measured.iges_seconds / measured.loops, measured.bytes));
  }
  fmt::print("{{\"benchmark\": \"knit_build\", \"lines\": {}, \"bodies\": {}}}\n", joined(lines),
             joined(bodies));
  return 0;
}
