// How fast IGES is written: our writer, OpenCASCADE's writer, and a bare loop that sends the same doubles
// through std::to_chars into the same buffered write. All in one run, to the same folder; medians of several
// repeats; one JSON object to standard output. Yarns are made on the fly, one at a time, so that the memory
// seen is the writers' own.
//
//   iges_write [--repeats N] [--sizes N,N,...] [--folder DIR] [--no-occt]
#include <fmt/format.h>
#include <unistd.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "formats/registry.h"
#include "scripts/benchmarks/cloth.h"
#include "scripts/benchmarks/measuring.h"

namespace {

using namespace selvage;
using benchmarks::Cloth;
using benchmarks::fail;
using benchmarks::measure;

std::uint64_t doubles_of(const nurbs::Surface& s) {
  return s.knots_u.size() + s.knots_v.size() + 4 * s.points.size() + 4;
}
std::uint64_t doubles_of(const yarn::Body& body) {
  return doubles_of(body.surface) + doubles_of(body.start.surface) + doubles_of(body.end.surface);
}

void require(const Status& status) {
  if (!status.ok()) fail(to_string(status.error()));
}

struct Job {
  int yarns;
  std::string path;
};

// Only the writing is timed, not the making of the yarns; the file is not made durable (fsync) by any of the
// three.
class Stopwatch {
 public:
  void start() { from_ = std::chrono::steady_clock::now(); }
  void stop() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - from_).count(); }
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  std::chrono::steady_clock::time_point from_;
  double seconds_ = 0;
};

struct Outcome {
  double seconds = 0;
  std::uint64_t bytes = 0, doubles = 0;
};
using Measured = benchmarks::Measured<Outcome>;

Outcome ours(const Job& job) {
  Cloth cloth;
  Stopwatch watch;
  Outcome outcome;
  watch.start();
  Result<OutputFile> output = OutputFile::create(job.path);
  if (!output) fail(to_string(output.error()));
  formats::SurfaceOptions options;
  options.file_name = "cloth.igs";
  options.expected_bodies = static_cast<std::uint64_t>(job.yarns);
  auto writer = formats::iges::descriptor().open_bodies(*output, options);
  if (!writer) fail(to_string(writer.error()));
  watch.stop();
  for (int k = 0; k < job.yarns; ++k) {
    const yarn::Body& body = cloth.yarn(k);
    outcome.doubles += doubles_of(body);
    watch.start();
    require((*writer)->add(body));
    watch.stop();
  }
  watch.start();
  auto facts = (*writer)->finish();
  if (!facts) fail(to_string(facts.error()));
  watch.stop();
  outcome.seconds = watch.seconds();
  outcome.bytes = output->size();
  return outcome;
}

// The same doubles, weights included, each followed by a comma; a buffer of the size that our writer has.
Outcome bare(const Job& job) {
  Cloth cloth;
  Stopwatch watch;
  Outcome outcome;
  watch.start();
  Result<OutputFile> output = OutputFile::create(job.path);
  if (!output) fail(to_string(output.error()));
  constexpr std::size_t room = 13'000 * 81;
  const auto buffer = std::make_unique_for_overwrite<char[]>(room + max_number_length + 1);
  char* at = buffer.get();
  char* const full = buffer.get() + room;
  const auto send = [&](const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      at = std::to_chars(at, at + max_number_length, values[i]).ptr;
      *at++ = ',';
      if (at >= full) {
        require(output->write({buffer.get(), static_cast<std::size_t>(at - buffer.get())}));
        at = buffer.get();
      }
    }
  };
  watch.stop();
  const std::vector<double> ones(1000, 1.0);
  for (int k = 0; k < job.yarns; ++k) {
    const yarn::Body& body = cloth.yarn(k);
    outcome.doubles += doubles_of(body);
    watch.start();
    for (const nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface}) {
      send(s->knots_u.data(), s->knots_u.size());
      send(s->knots_v.data(), s->knots_v.size());
      send(ones.data(), s->points.size());
      send(s->points.data()->data(), 3 * s->points.size());
      const double ranges[] = {s->first_u(), s->last_u(), s->first_v(), s->last_v()};
      send(ranges, 4);
    }
    watch.stop();
  }
  watch.start();
  require(output->write({buffer.get(), static_cast<std::size_t>(at - buffer.get())}));
  watch.stop();
  outcome.seconds = watch.seconds();
  outcome.bytes = output->size();
  return outcome;
}

TopoDS_Face occt_face(const nurbs::Surface& s) {
  const auto knots = [](const std::vector<double>& all, auto& values, auto& multiplicities) {
    int at = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k == 0 || all[k] != all[k - 1]) {
        values.SetValue(++at, all[k]);
        multiplicities.SetValue(at, 1);
      } else {
        multiplicities.ChangeValue(at)++;
      }
    }
  };
  const auto different = [](const std::vector<double>& all) {
    int count = 1;
    for (std::size_t k = 1; k < all.size(); ++k) count += all[k] != all[k - 1] ? 1 : 0;
    return count;
  };
  TColgp_Array2OfPnt points(1, s.count_u, 1, s.count_v);
  for (int j = 0; j < s.count_v; ++j)
    for (int i = 0; i < s.count_u; ++i) {
      const Vec3& p = s.point(i, j);
      points.SetValue(i + 1, j + 1, gp_Pnt(p.x(), p.y(), p.z()));
    }
  const int nu = different(s.knots_u), nv = different(s.knots_v);
  TColStd_Array1OfReal knots_u(1, nu), knots_v(1, nv);
  TColStd_Array1OfInteger mults_u(1, nu), mults_v(1, nv);
  knots(s.knots_u, knots_u, mults_u);
  knots(s.knots_v, knots_v, mults_v);
  Handle(Geom_BSplineSurface) surface =
      new Geom_BSplineSurface(points, knots_u, knots_v, mults_u, mults_v, s.degree_u, s.degree_v);
  return BRepBuilderAPI_MakeFace(surface, 1e-7);
}

// Its faces are made before the clock starts; all that it does with them is timed.
Outcome occt(const Job& job) {
  IGESControl_Controller::Init();
  Cloth cloth;
  Outcome outcome;
  std::vector<TopoDS_Face> faces;
  for (int k = 0; k < job.yarns; ++k) {
    const yarn::Body& body = cloth.yarn(k);
    outcome.doubles += doubles_of(body);
    for (const nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
      faces.push_back(occt_face(*s));
  }
  Stopwatch watch;
  watch.start();
  IGESControl_Writer writer("MM", 0);
  for (const TopoDS_Face& face : faces) writer.AddShape(face);
  writer.ComputeModel();
  if (!writer.Write(job.path.c_str())) fail("OpenCASCADE did not write " + job.path);
  watch.stop();
  outcome.seconds = watch.seconds();
  FILE* file = std::fopen(job.path.c_str(), "rb");
  if (file == nullptr) fail("OpenCASCADE's file is missing");
  std::fseek(file, 0, SEEK_END);
  outcome.bytes = static_cast<std::uint64_t>(std::ftell(file));
  std::fclose(file);
  ::unlink(job.path.c_str());
  return outcome;
}

std::string row(std::string_view writer, int yarns, const Measured& m, const std::string& ratios = {}) {
  const double s = m.outcome.seconds;
  return fmt::format(
      R"(  {{"writer": "{}", "yarns": {}, "seconds": {:.6g}, "bytes": {}, "mb_per_s": {:.1f}, "yarns_per_s": {:.0f}, )"
      R"("doubles_per_s": {:.0f}, "peak_rss_growth_mib": {:.1f}{}}})",
      writer, yarns, s, m.outcome.bytes, static_cast<double>(m.outcome.bytes) / s / 1e6, yarns / s,
      static_cast<double>(m.outcome.doubles) / s, m.peak_mib, ratios);
}

}  // namespace

int main(int count, char** words) {
  benchmarks::Arguments given;
  given.read(count, words);
  ::Message::DefaultMessenger()->ChangePrinters().Clear();

  std::vector<std::string> rows;
  for (const int yarns : given.sizes) {
    const Job job{yarns, fmt::format("{}/selvage-bench-{}.igs", given.folder, ::getpid())};
    const Job small{std::min(yarns, 8), job.path};
    std::vector<Measured> a, b, c;
    measure(ours, small, job);  // warm-up
    for (int r = 0; r < given.repeats; ++r) {
      a.push_back(measure(ours, small, job));
      b.push_back(measure(bare, small, job));
      if (given.is_occt_repeated(r, yarns)) c.push_back(measure(occt, small, job));
    }
    std::string ratios = fmt::format(R"(, "time_to_bare_loop": {:.3f})", median_ratio(a, b));
    if (given.with_occt) ratios += fmt::format(R"(, "times_occt": {:.1f})", median_ratio(c, a));
    rows.push_back(row("selvage", yarns, median(a), ratios));
    rows.push_back(row("bare loop", yarns, median(b)));
    if (given.with_occt) rows.push_back(row("OpenCASCADE", yarns, median(c)));
  }
  benchmarks::print_rows("iges_write", "\"control_points\": [18, 16], ", given.repeats, rows);
  return 0;
}
