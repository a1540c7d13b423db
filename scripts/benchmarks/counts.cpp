// One hot path by name, for counting its instructions (scripts/counts): what it works on is made first, then
// it runs once inside `measured`, which callgrind watches. One thread; nothing depends on the clock.
//
//   counts PATH FOLDER    files are written to FOLDER
//   counts --list
#include <fmt/format.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cad/compare.h"
#include "cad/from_body.h"
#include "contact/contact.h"
#include "core/output.h"
#include "core/source.h"
#include "formats/registry.h"
#include "mechanics/woven.h"
#include "nurbs/basis.h"
#include "nurbs/restrict.h"
#include "scripts/benchmarks/built.h"
#include "scripts/benchmarks/cloth.h"
#include "solid/brep.h"
#include "tetrahedra/cell_mesher.h"

using Work = std::function<void()>;

// Callgrind is told this name, and counts from its beginning to its end.
extern "C" [[gnu::noinline]] void measured(const Work& work) {
  work();
  asm volatile("" ::: "memory");  // the call is no jump, so that the function ends after it
}

namespace {

using namespace selvage;
using benchmarks::fail;

template <class T>
T required(Result<T> result) {
  if (!result) fail(to_string(result.error()));
  return std::move(*result);
}

void require(const Status& status) {
  if (!status.ok()) fail(to_string(status.error()));
}

fabric::Fabric weave(int size) {
  fabric::Fabric cloth;
  fabric::Thread thread;
  thread.name = "cotton30";
  thread.section = yarn::Circle{0.2};
  cloth.threads = {thread};
  fabric::Weave item;
  item.warp.threads = item.weft.threads = {thread.name};
  item.warp.count = item.weft.count = size;
  item.warp.pitch = item.weft.pitch = 0.5;
  item.profile = fabric::Weave::Profile::peirce;
  cloth.items = {item};
  return cloth;
}

fabric::BuildOptions published() {
  fabric::BuildOptions options;
  options.as_published = true;
  return options;
}

Work building(fabric::Fabric cloth, fabric::BuildOptions options) {
  return [cloth = std::move(cloth), options = std::move(options)] { benchmarks::built(cloth, options); };
}

// Of a 5-end satin of cotton, 20 tex, 30 ends and 25 picks a cm.
Work equilibrating() {
  constexpr int repeat = 5, step = 2;
  mechanics::WovenYarn yarn;
  yarn.fibre_area = 20.0 / 1520.0;  // mm2
  mechanics::WovenCloth cloth;
  cloth.warps.assign(repeat, yarn);
  cloth.wefts.assign(repeat, yarn);
  cloth.warp_gaps.assign(repeat, 10.0 / 30.0);
  cloth.weft_gaps.assign(repeat, 10.0 / 25.0);
  for (int pick = 0; pick < repeat; ++pick)
    for (int end = 0; end < repeat; ++end) cloth.warp_on_top.push_back(end == step * pick % repeat ? 0 : 1);
  return [cloth] { required(mechanics::find_equilibrium(cloth)); };
}

// All of a file but the making of its yarns.
void write(const formats::Descriptor& format, const std::vector<yarn::Body>& bodies,
           const std::string& path) {
  OutputFile output = required(OutputFile::create(path));
  formats::SurfaceOptions options;
  options.file_name = "cloth";
  options.expected_bodies = bodies.size();
  options.date = "19700101.000000";
  auto writer = required(format.open_bodies(output, options));
  for (const yarn::Body& body : bodies) require(writer->add(body));
  required(writer->finish());
  require(output.commit());
}

std::vector<yarn::Body> cloth_of(int yarns) {
  benchmarks::Cloth cloth;
  std::vector<yarn::Body> bodies;
  for (int k = 0; k < yarns; ++k) bodies.push_back(cloth.yarn(k));
  return bodies;
}

Work writing(const formats::Descriptor& format, const std::string& path, int yarns) {
  write(format, cloth_of(1), path);  // opens the module where the format has one
  return [&format, path, bodies = cloth_of(yarns)] { write(format, bodies, path); };
}

Work reading(const formats::Descriptor& format, const std::string& path, int yarns) {
  write(format, cloth_of(yarns), path);
  return [&format, path, yarns] {
    const Source source = required(Source::open(path));
    Diagnostics diagnostics;
    const std::optional<cad::Model> model = format.read_model(source, diagnostics);
    if (!model) fail(to_string(*diagnostics.first_error()));
    if (model->face_count() != 3 * static_cast<std::size_t>(yarns)) fail("not all surfaces were read");
  };
}

Work searching() {
  return [bodies = benchmarks::built(benchmarks::jersey(6), published())] {
    if (required(contact::find_contacts(bodies, {})).list.empty()) fail("loops of the raw jersey overlap");
  };
}

// What `check` asks but for CGAL's part: valgrind knows no directed rounding, without which CGAL's predicates
// err.
Work checking() {
  const auto check = [](const std::vector<yarn::Body>& bodies) {
    for (const solid::BrepCheck& yarn : required(solid::check_breps(bodies)))
      if (!yarn.defects.empty()) fail(to_string(yarn.defects.front()));
    if (!required(contact::find_contacts(bodies, {})).list.empty()) fail("yarns of the weave overlap");
  };
  check(benchmarks::built(weave(1), {}));  // opens the module
  return [check, bodies = benchmarks::built(weave(4), {})] { check(bodies); };
}

// Of the second model a point is moved, and a yarn has twice as many spans along: one is told by control
// points, the other by the distance of the surfaces.
Work comparing() {
  cad::Subject before;
  for (const yarn::Body& body : benchmarks::built(benchmarks::jersey(16), published()))
    before.model.parts.push_back(cad::part_of(body));
  before.yarns = before.model.parts.size();
  cad::Subject after = before;
  after.model.parts[3].faces[0].surface.point(2, 100).z() += 0.03;
  nurbs::Surface& finer = after.model.parts[5].faces[0].surface;
  const std::vector<double> ends = nurbs::breakpoints(finer.knots_v, finer.degree_v);
  std::vector<double> middles;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) middles.push_back(0.5 * (ends[k] + ends[k + 1]));
  finer = nurbs::refined(finer, middles);
  return [before, after] {
    cad::CompareOptions options;
    options.tolerance = 1e-6;
    if (cad::compare(before, after, options).differences.size() != 1) fail("one yarn differs");
  };
}

// One crossing of elliptic tows in a matrix. TetGen is a process of its own, and counts nothing.
Work meshing() {
  fabric::Fabric cloth = weave(1);
  cloth.threads.front().section = yarn::Ellipse{0.8, 0.3};
  auto& item = std::get<fabric::Weave>(cloth.items.front());
  item.profile = fabric::Weave::Profile::sine;
  item.warp.pitch = item.weft.pitch = 1.5;
  fabric::Material resin, tow;
  resin.name = "resin";
  resin.elastic = fabric::IsotropicElastic{3400, 0.35};
  tow.name = "tow";
  tow.elastic = fabric::IsotropicElastic{70000, 0.2};
  cloth.materials = {resin, tow};
  cloth.threads.front().material = tow.name;
  fabric::Cell& cell = cloth.cell.emplace();
  cell.matrix = resin.name;
  cell.low = Vec3(0, 0, -0.36);
  cell.high = Vec3(1.5, 1.5, 0.36);
  return [cloth, bodies = benchmarks::built(cloth, {})] {
    fem::CellMeshOptions options;
    options.size = 0.3;
    Diagnostics diagnostics;
    if (required(fem::mesh_cell(cloth, bodies, options, diagnostics)).elements.empty()) fail("no mesh");
  };
}

using Maker = std::function<Work(const std::string& folder)>;

const std::map<std::string, Maker>& paths() {
  static const std::map<std::string, Maker> all = {
      {"build-jersey", [](const std::string&) { return building(benchmarks::jersey(16), published()); }},
      {"build-weave", [](const std::string&) { return building(weave(12), {}); }},
      {"equilibrium", [](const std::string&) { return equilibrating(); }},
      {"mend-knit", [](const std::string&) { return building(benchmarks::jersey(8), {}); }},
      {"iges-write",
       [](const std::string& folder) {
         return writing(formats::iges::descriptor(), folder + "/written.igs", 256);
       }},
      {"iges-read",
       [](const std::string& folder) {
         return reading(formats::iges::descriptor(), folder + "/read.igs", 256);
       }},
      {"step-write",
       [](const std::string& folder) {
         return writing(formats::step::descriptor(), folder + "/written.stp", 16);
       }},
      {"contact", [](const std::string&) { return searching(); }},
      {"check", [](const std::string&) { return checking(); }},
      {"diff", [](const std::string&) { return comparing(); }},
      {"mesh-cell", [](const std::string&) { return meshing(); }},
  };
  return all;
}

}  // namespace

int main(int count, char** words) {
  const std::vector<std::string> given(words + 1, words + count);
  if (given == std::vector<std::string>{"--list"}) {
    for (const auto& [name, maker] : paths()) fmt::print("{}\n", name);
    return 0;
  }
  if (given.size() != 2) fail("usage: counts PATH FOLDER, or counts --list");
  const auto found = paths().find(given[0]);
  if (found == paths().end()) fail("no path '" + given[0] + "': counts --list names them");
  measured(found->second(given[1]));
  return 0;
}
