#include "formats/iges/files.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "construction/build.h"
#include "formats/iges/writer.h"
#include "formats/registry.h"
#include "places.h"

namespace selvage::test {

namespace fs = std::filesystem;

namespace {

constexpr const char* epoch = "1500000000";
constexpr const char* epoch_time = "20170714.024000";

struct Scratch {
  fs::path path = fs::temp_directory_path() / ("selvage-iges-" + std::to_string(::getpid()));
  Scratch() { fs::create_directories(path); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

void add_all(formats::BodyWriter& writer, const std::vector<yarn::Body>& bodies) {
  for (const yarn::Body& body : bodies) {
    const Status status = writer.add(body);
    ASSERT_TRUE(status.ok()) << to_string(status.error());
  }
  const Result<formats::WriteFacts> facts = writer.finish();
  ASSERT_TRUE(facts.ok()) << to_string(facts.error());
}

void dump_numbers(std::FILE* file, const char* word, const std::vector<double>& values) {
  std::fputs(word, file);
  for (const double value : values) std::fprintf(file, " %a", value);
  std::fputc('\n', file);
}

std::vector<double> flat(const std::vector<Vec3>& points) {
  std::vector<double> values;
  for (const Vec3& p : points) values.insert(values.end(), p.data(), p.data() + 3);
  return values;
}

void dump_surface(std::FILE* file, const char* kind, const nurbs::Surface& s) {
  std::fprintf(file, "surface %s %d %d %d %d\n", kind, s.degree_u, s.degree_v, s.count_u, s.count_v);
  dump_numbers(file, "knots_u", s.knots_u);
  dump_numbers(file, "knots_v", s.knots_v);
  dump_numbers(file, "weights", s.weights);
  dump_numbers(file, "points", flat(s.points));
  for (const double a : {0.0, 0.13, 0.5, 0.77, 1.0})
    for (const double b : {0.0, 0.29, 0.6, 1.0}) {
      const double u = std::lerp(s.first_u(), s.last_u(), a), v = std::lerp(s.first_v(), s.last_v(), b);
      const Vec3 p = nurbs::evaluate(s, u, v);
      dump_numbers(file, "sample", {u, v, p.x(), p.y(), p.z()});
    }
}

void dump_outline(std::FILE* file, const nurbs::Curve& c) {
  std::fprintf(file, "outline %d %zu\n", c.degree, c.points.size());
  dump_numbers(file, "knots", c.knots);
  dump_numbers(file, "weights", c.weights);
  dump_numbers(file, "points", flat(c.points));
  for (const double a : {0.0, 0.31, 0.5, 0.9}) {
    const double t = std::lerp(c.first_parameter(), c.last_parameter(), a);
    const Vec3 p = nurbs::evaluate(c, t);
    dump_numbers(file, "sample", {t, p.x(), p.y(), p.z()});
  }
}

}  // namespace

formats::SurfaceOptions surfaces(Unit units) {
  formats::SurfaceOptions options;
  options.units = units;
  return options;
}

formats::SurfaceOptions solids(Unit units) {
  formats::SurfaceOptions options = surfaces(units);
  options.yarns_are_solids = true;
  return options;
}

const fs::path& scratch() {
  static const Scratch folder;
  return folder.path;
}

fs::path write_iges(const std::string& name, const std::vector<yarn::Body>& bodies,
                    formats::SurfaceOptions options) {
  ::setenv("SOURCE_DATE_EPOCH", epoch, 1);
  fs::path path = scratch() / name;
  options.file_name = name;
  Result<OutputFile> output = OutputFile::create(path);
  EXPECT_TRUE(output.ok());
  auto writer = formats::iges::descriptor().open_bodies(*output, options);
  EXPECT_TRUE(writer.ok());
  add_all(**writer, bodies);
  EXPECT_TRUE(output->commit().ok());
  return path;
}

std::string iges_bytes(const std::vector<yarn::Body>& bodies, const formats::SurfaceOptions& options,
                       const formats::iges::Records::Limits& limits) {
  ::setenv("SOURCE_DATE_EPOCH", epoch, 1);
  Result<OutputFile> output = OutputFile::in_memory();
  EXPECT_TRUE(output.ok());
  auto writer = formats::iges::open_writer(*output, options, limits);
  EXPECT_TRUE(writer.ok());
  add_all(**writer, bodies);
  Result<std::string> bytes = output->contents();
  EXPECT_TRUE(bytes.ok());
  return *bytes;
}

fs::path dump_model(const std::string& name, const std::vector<yarn::Body>& bodies,
                    const formats::SurfaceOptions& options) {
  fs::path path = scratch() / (name + ".model");
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) std::abort();
  double largest = 0;
  for (const yarn::Body& body : bodies)
    for (const nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
      for (const Vec3& p : s->points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  std::fprintf(file, "file %s\ntitle %s\nunits %s\ntime %s\nlargest %a\n", name.c_str(),
               options.title.c_str(), std::string(name_of(options.units)).c_str(), epoch_time, largest);
  std::fprintf(file, "solid %d\n", options.yarns_are_solids ? 1 : 0);
  for (const yarn::Body& body : bodies) {
    std::fprintf(file, "body %s\nrole %s\ncolor %d %d %d\nvolume %a\nring %d\ninward %d\nstart %s\nend %s\n",
                 body.name.c_str(), std::string(yarn::name_of(body.role)).c_str(), body.color.red,
                 body.color.green, body.color.blue, body.volume, body.closed_along, body.inward,
                 std::string(yarn::name_of(body.start.style)).c_str(),
                 std::string(yarn::name_of(body.end.style)).c_str());
    dump_surface(file, "body", body.surface);
    for (const bool last : {false, true}) {
      const yarn::EndFace& end = last ? body.end : body.start;
      if (!end.surface.is_empty()) dump_surface(file, "end", end.surface);
      if (end.style == yarn::EndStyle::planar) dump_outline(file, yarn::end_curve(body, last));
    }
  }
  std::fclose(file);
  return path;
}

Output run(const std::string& command) {
  Output output;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  char block[4096];
  for (std::size_t got = 0; (got = std::fread(block, 1, sizeof block, pipe)) > 0;)
    output.text.append(block, got);
  const int state = ::pclose(pipe);
  if (WIFEXITED(state)) output.exit_code = WEXITSTATUS(state);
  return output;
}

Output judge(const fs::path& file, const fs::path& model) {
  std::string command =
      places::python() + " -B " + places::tests() + "/formats/iges/iges_oracle.py " + file.string();
  if (!model.empty()) command += " " + model.string();
  return run(command);
}

std::vector<yarn::Body> sample(const std::string& name, yarn::EndStyle ends, Unit* units) {
  std::vector<yarn::Body> bodies;
  Diagnostics diagnostics;
  Result<Source> source = Source::open(fs::path(places::samples()) / name);
  EXPECT_TRUE(source.ok());
  if (!source.ok()) return bodies;
  const std::optional<fabric::Fabric> fabric = formats::txt::descriptor().read_fabric(*source, diagnostics);
  EXPECT_TRUE(fabric.has_value());
  if (!fabric) return bodies;
  fabric::BuildOptions options;
  options.ends = ends;
  const auto builder = fabric::YarnBuilder::create(*fabric, options, diagnostics);
  EXPECT_TRUE(builder.has_value());
  for (std::size_t i = 0; builder && i < builder->count(); ++i) {
    Result<yarn::Body> body = builder->build(i);
    EXPECT_TRUE(body.ok()) << to_string(body.error());
    if (body.ok()) bodies.push_back(std::move(*body));
  }
  if (units != nullptr) *units = fabric->units;
  return bodies;
}

}  // namespace selvage::test
