// What a unit cell's tetrahedra cost: the mesh of samples/cell_plain.txt, to each of several smallest angles;
// the time from its surface on, and the processor time, TetGen's worker included. For other programs the same
// surfaces are written (Gmsh 2.2: one discrete surface for each pair of regions), with a .geo beside each
// that makes volumes of them. One JSON object.
//
//   tetrahedra --sample FILE --folder DIR [--sizes H,H,...] [--targets DEGREES,...] [--threads N,...]
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "construction/build.h"
#include "core/source.h"
#include "fem/quality.h"
#include "fem/sides.h"
#include "formats/registry.h"
#include "scripts/benchmarks/built.h"
#include "tetrahedra/cell_mesher.h"

namespace {

using namespace selvage;
using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// Of this process and of those that it waited for.
double processor_seconds() {
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    ::getrusage(who, &used);
    for (const timeval& time : {used.ru_utime, used.ru_stime})
      sum += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  }
  return sum;
}

fabric::Fabric read(const std::string& path) {
  Diagnostics diagnostics;
  Result<Source> source = Source::open(path);
  if (!source) benchmarks::fail(to_string(source.error()));
  std::optional<fabric::Fabric> cloth = formats::txt::descriptor().read_fabric(*source, diagnostics);
  if (!cloth || !cloth->cell) benchmarks::fail("no fabric with a cell in " + path);
  return std::move(*cloth);
}

// The triangles between regions, and the volumes that they enclose.
std::size_t write_surfaces(const fem::Mesh& mesh, const std::string& path) {
  using Pair = std::pair<std::size_t, std::size_t>;
  std::map<Pair, std::vector<std::array<std::size_t, 3>>> surfaces;
  std::map<std::size_t, std::size_t> numbers;  // of the nodes on them, from 1
  std::size_t count = 0;
  for (const fem::OuterSide& side : fem::outer_sides(mesh)) {
    if (side.behind != fem::OuterSide::outside && side.behind < side.region) continue;
    surfaces[{side.region, side.behind}].push_back({side.nodes[0], side.nodes[1], side.nodes[2]});
    for (std::size_t k = 0; k < 3; ++k) numbers[side.nodes[k]] = 0;
    ++count;
  }
  std::FILE* file = std::fopen((path + ".msh").c_str(), "w");
  std::FILE* geo = std::fopen((path + ".geo").c_str(), "w");
  if (file == nullptr || geo == nullptr) benchmarks::fail("cannot write " + path);
  fmt::print(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", numbers.size());
  std::size_t next = 0;
  for (auto& [node, number] : numbers) {
    number = ++next;
    const Vec3& p = mesh.nodes[node];
    fmt::print(file, "{} {} {} {}\n", number, p.x(), p.y(), p.z());
  }
  fmt::print(file, "$EndNodes\n$Elements\n{}\n", count);
  std::map<std::size_t, std::string> loops;
  std::size_t element = 0, surface = 0;
  for (const auto& [pair, triangles] : surfaces) {
    ++surface;
    for (const std::size_t region : {pair.first, pair.second})
      if (region != fem::OuterSide::outside)
        loops[region] += fmt::format("{}{}", loops[region].empty() ? "" : ",", surface);
    for (const auto& t : triangles)
      fmt::print(file, "{} 2 2 0 {} {} {} {}\n", ++element, surface, numbers[t[0]], numbers[t[1]],
                 numbers[t[2]]);
  }
  fmt::print(file, "$EndElements\n");
  fmt::print(geo, "Merge \"{}.msh\";\n", path);
  for (const auto& [region, list] : loops)
    fmt::print(geo, "Surface Loop({0}) = {{{1}}};\nVolume({0}) = {{{0}}};\n", region + 1, list);
  std::fclose(file);
  std::fclose(geo);
  return count;
}

struct Case {
  double size = 0, target = 0;
  int threads = 1;
};

void row(const fabric::Fabric& cloth, const std::vector<yarn::Body>& bodies, const Case& one, bool is_first,
         const std::string& path) {
  double seconds = 0, processor = 0;
  auto since = Clock::now();
  bool is_filling = false;
  fem::CellMeshOptions options;
  options.size = one.size;
  options.periodic = cloth.cell->periodic;
  options.min_dihedral = one.target;
  options.timeout = 3600;
  options.memory = 16384;
  options.threads = one.threads;
  options.progress = [&](const std::string_view name, std::size_t, std::size_t) {
    const bool fills = name == "filling with tetrahedra" || name == "improving tetrahedra";
    if (fills == is_filling) return;
    is_filling = fills;
    if (fills) {
      since = Clock::now();
      processor -= processor_seconds();
    } else {
      seconds += seconds_between(since, Clock::now());
      processor += processor_seconds();
    }
  };
  Diagnostics diagnostics;
  const Result<fem::Mesh> mesh = fem::mesh_cell(cloth, bodies, options, diagnostics);
  if (!mesh) benchmarks::fail(to_string(mesh.error()));
  const std::size_t triangles = write_surfaces(*mesh, path);
  fmt::print(
      "{}  {{\"size\": {}, \"target\": {}, \"threads\": {}, \"triangles\": {}, \"nodes\": {}, \"tets\": {}, "
      "\"seconds\": {:.4f}, \"processor_seconds\": {:.4f}, \"min_dihedral\": {:.4f}, "
      "\"first_percentile\": {:.4f}, \"geo\": \"{}.geo\"}}",
      is_first ? "" : ",\n", one.size, one.target, one.threads, triangles, mesh->nodes.size(),
      mesh->elements.size(), seconds, processor, mesh->quality.min_dihedral,
      fem::first_percentile_angle(*mesh), path);
  std::fflush(stdout);
}

std::vector<double> numbers(const char* at) {
  std::vector<double> result;
  for (char* end = nullptr; *at != '\0'; at = *end == ',' ? end + 1 : end) {
    result.push_back(std::strtod(at, &end));
    if (end == at) benchmarks::fail(fmt::format("not numbers: '{}'", at));
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  std::string sample, folder;
  std::vector<double> sizes = {0.1, 0.05, 0.03}, targets = {15}, threads = {1};
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--sample") == 0) sample = argv[i + 1];
    if (std::strcmp(argv[i], "--folder") == 0) folder = argv[i + 1];
    if (std::strcmp(argv[i], "--sizes") == 0) sizes = numbers(argv[i + 1]);
    if (std::strcmp(argv[i], "--targets") == 0) targets = numbers(argv[i + 1]);
    if (std::strcmp(argv[i], "--threads") == 0) threads = numbers(argv[i + 1]);
  }
  fmt::print("{{\"rows\": [\n");
  const fabric::Fabric cloth = read(sample);
  fabric::BuildOptions options;  // as `selvage mesh` has them
  options.gap = fabric::meshed_gap(cloth);
  const std::vector<yarn::Body> bodies = benchmarks::built(cloth, options);
  bool is_first = true;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    for (const double target : targets)
      for (const double count : threads) {
        row(cloth, bodies, {sizes[k], target, static_cast<int>(count)}, is_first,
            fmt::format("{}/cell{}", folder, k));
        is_first = false;
      }
  fmt::print("\n]}}\n");
}
