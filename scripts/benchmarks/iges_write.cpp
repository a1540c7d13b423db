// How fast IGES is written: our writer, OpenCASCADE's writer, and a bare loop that sends the same doubles
// through std::to_chars into the same buffered write. All in one run, to the same folder; medians of several
// repeats; one JSON object to standard output. Yarns are made on the fly, one at a time, so that the memory
// seen is the writers' own.
//
//   iges_write [--repeats N] [--yarns N,N,...] [--folder DIR] [--no-occt]
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
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
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "formats/iges/iges.h"
#include "scripts/benchmarks/cloth.h"

namespace {

using namespace selvage;
using benchmarks::Cloth;

std::uint64_t doubles_of(const nurbs::Surface& s) {
  return s.knots_u.size() + s.knots_v.size() + 4 * s.points.size() + 4;
}
std::uint64_t doubles_of(const yarn::Body& body) {
  return doubles_of(body.surface) + doubles_of(body.start.surface) + doubles_of(body.end.surface);
}

[[noreturn]] void fail(const std::string& text) {
  fmt::print(stderr, "error: {}\n", text);
  std::exit(1);
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

struct Measured {
  Outcome outcome;
  double peak_mib = 0;  // growth of the largest resident set over that of the process before the job
};

long peak_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// In a process of its own, so that the peak memory is this job's.
Measured measure(const std::function<Outcome(const Job&)>& run, const Job& job) {
  int ends[2];
  if (::pipe(ends) != 0) fail("pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    const long before = peak_kib();
    run({std::min(job.yarns, 8),
         job.path});  // code and tables are in memory afterwards: starting up is not writing
    Measured measured{run(job), 0};
    measured.peak_mib = static_cast<double>(peak_kib() - before) / 1024;
    const bool sent = ::write(ends[1], &measured, sizeof measured) == sizeof measured;
    ::_exit(sent ? 0 : 1);
  }
  ::close(ends[1]);
  Measured measured;
  const bool got = ::read(ends[0], &measured, sizeof measured) == sizeof measured;
  ::close(ends[0]);
  int state = 0;
  ::waitpid(child, &state, 0);
  if (!got || state != 0) fail("a job of the benchmark failed");
  return measured;
}

Measured median(std::vector<Measured> all) {
  std::sort(all.begin(), all.end(),
            [](const Measured& a, const Measured& b) { return a.outcome.seconds < b.outcome.seconds; });
  return all[all.size() / 2];
}

// The median of the ratios of time of neighbouring runs: what else the machine does changes slowly against
// them.
double median_ratio(const std::vector<Measured>& above, const std::vector<Measured>& below) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < std::min(above.size(), below.size()); ++r)
    ratios.push_back(above[r].outcome.seconds / below[r].outcome.seconds);
  std::sort(ratios.begin(), ratios.end());
  return ratios[ratios.size() / 2];
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
  int repeats = 9;
  std::vector<int> sizes = {8, 64, 512, 2048};
  std::string folder = ".";
  bool with_occt = true;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--no-occt") {
      with_occt = false;
      continue;
    }
    if (i + 1 == count) fail("a value is missing after " + word);
    const char* value = words[++i];
    if (word == "--repeats") {
      repeats = std::max(1, std::atoi(value));
    } else if (word == "--folder") {
      folder = value;
    } else if (word == "--yarns") {
      sizes.clear();
      for (char* part = std::strtok(words[i], ","); part != nullptr; part = std::strtok(nullptr, ","))
        sizes.push_back(std::max(1, std::atoi(part)));
    } else {
      fail("unknown word " + word);
    }
  }
  ::Message::DefaultMessenger()->ChangePrinters().Clear();

  std::vector<std::string> rows;
  for (const int yarns : sizes) {
    const Job job{yarns, fmt::format("{}/selvage-bench-{}.igs", folder, ::getpid())};
    std::vector<Measured> a, b, c;
    measure(ours, job);  // warm-up
    for (int r = 0; r < repeats; ++r) {
      a.push_back(measure(ours, job));
      b.push_back(measure(bare, job));
      if (with_occt && (r < 5 || yarns <= 64)) c.push_back(measure(occt, job));
    }
    std::string ratios = fmt::format(R"(, "time_to_bare_loop": {:.3f})", median_ratio(a, b));
    if (with_occt) ratios += fmt::format(R"(, "times_occt": {:.1f})", median_ratio(c, a));
    rows.push_back(row("selvage", yarns, median(a), ratios));
    rows.push_back(row("bare loop", yarns, median(b)));
    if (with_occt) rows.push_back(row("OpenCASCADE", yarns, median(c)));
  }
  std::string all;
  for (const std::string& text : rows) all += (all.empty() ? "" : ",\n") + text;
  fmt::print(
      "{{\"benchmark\": \"iges_write\", \"control_points\": [18, 16], \"repeats\": {}, \"rows\": "
      "[\n{}\n]}}\n",
      repeats, all);
  return 0;
}
