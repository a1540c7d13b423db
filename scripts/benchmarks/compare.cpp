// How long the comparison of two cloths takes, and whether it grows with their size: the models are in
// memory, as after reading. Three pairs each: equal to the bit but for one control point moved by 1e-9; every
// coordinate rounded to 10 digits, without names and in another order; over other knots (one inserted). One
// JSON object.
//
//   compare [--repeats N] [--sizes N,N,...] [--threads N]
#include "cad/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "cad/from_body.h"
#include "scripts/benchmarks/cloth.h"
#include "scripts/benchmarks/measuring.h"

namespace {

using namespace selvage;
using Clock = std::chrono::steady_clock;

cad::Subject cloth_of(int yarns) {
  benchmarks::Cloth cloth;
  cad::Subject subject;
  for (int k = 0; k < yarns; ++k) subject.model.parts.push_back(cad::part_of(cloth.yarn(k)));
  subject.yarns = subject.model.parts.size();
  return subject;
}

cad::Subject with_one_change(cad::Subject subject) {
  subject.model.parts[subject.model.parts.size() / 2].faces[0].surface.point(5, 7).z() += 1e-9;
  return subject;
}

cad::Subject as_others_write_it(cad::Subject subject) {
  std::reverse(subject.model.parts.begin(), subject.model.parts.end());
  for (cad::Part& part : subject.model.parts) {
    part.name.clear();
    for (cad::Face& face : part.faces) {
      face.name.clear();
      for (Vec3& p : face.surface.points)
        for (double& x : p) x = std::strtod(fmt::format("{:.10g}", x).c_str(), nullptr);
    }
  }
  return subject;
}

cad::Subject with_other_knots(cad::Subject subject) {
  for (cad::Part& part : subject.model.parts) {
    nurbs::Surface& s = part.faces[0].surface;
    const nurbs::Surface old = s;
    s.count_v += 1;
    s.points.assign(static_cast<std::size_t>(s.count_u) * static_cast<std::size_t>(s.count_v), Vec3::Zero());
    for (int i = 0; i < s.count_u; ++i) {
      nurbs::Curve curve{old.degree_v, old.knots_v, {}, {}};
      for (int j = 0; j < old.count_v; ++j) curve.points.push_back(old.point(i, j));
      curve = nurbs::insert_knot(curve, 6.3);
      s.knots_v = curve.knots;
      for (int j = 0; j < s.count_v; ++j) s.point(i, j) = curve.points[static_cast<std::size_t>(j)];
    }
  }
  return subject;
}

double median_seconds(const cad::Subject& a, const cad::Subject& b, double tolerance, int threads,
                      int repeats, std::size_t expected) {
  std::vector<double> all;
  for (int r = 0; r < repeats; ++r) {
    cad::CompareOptions options;
    options.tolerance = tolerance;
    options.threads = threads;
    const Clock::time_point begin = Clock::now();
    const cad::Comparison found = cad::compare(a, b, options);
    all.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
    if (found.differences.size() == expected) continue;
    fmt::print(stderr, "error: {} differences instead of {}\n", found.differences.size(), expected);
    std::exit(1);
  }
  return benchmarks::median(all);
}

}  // namespace

int main(int count, char** words) {
  benchmarks::Arguments given;
  given.repeats = 5;
  given.sizes = {1250, 2500, 5000, 10000};
  given.read(count, words);
  const int repeats = given.repeats, threads = given.threads;
  std::string rows;
  const auto add = [&](const char* pair, int yarns, double seconds) {
    rows += fmt::format(
        "{}  {{\"pair\": \"{}\", \"yarns\": {}, \"seconds\": {:.4g}, \"microseconds_a_yarn\": {:.4g}}}",
        rows.empty() ? "" : ",\n", pair, yarns, seconds, seconds / yarns * 1e6);
  };
  for (const int yarns : given.sizes) {
    const cad::Subject cloth = cloth_of(yarns);
    add("one point moved", yarns, median_seconds(cloth, with_one_change(cloth), 0, threads, repeats, 1));
    add("ten digits, no names", yarns,
        median_seconds(cloth, as_others_write_it(cloth), 1e-5, threads, repeats, 0));
    add("other knots", yarns, median_seconds(cloth, with_other_knots(cloth), 1e-9, threads, repeats, 0));
  }
  fmt::print(
      "{{\"benchmark\": \"compare\", \"control_points\": [18, 16], \"threads\": {}, \"repeats\": {}, "
      "\"rows\": [\n{}\n]}}\n",
      threads, repeats, rows);
  return 0;
}
