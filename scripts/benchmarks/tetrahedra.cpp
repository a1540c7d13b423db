// What a unit cell's tetrahedra cost: the mesh of samples/cell_plain.txt, and how much of the time TetGen and
// the improvement take. For other programs the same surfaces are written (Gmsh 2.2: one discrete surface for
// each pair of regions), with a .geo beside each that makes volumes of them. One JSON object.
//
//   tetrahedra --sample FILE --folder DIR [--sizes H,H,...]
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "core/source.h"
#include "fabric/build.h"
#include "fem/cell_mesher.h"
#include "fem/sides.h"
#include "formats/txt/txt.h"
#include "scripts/benchmarks/built.h"

namespace {

using namespace selvage;
using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
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

void row(const fabric::Fabric& cloth, const std::vector<yarn::Body>& bodies, double size, std::size_t number,
         const std::string& folder) {
  std::map<std::string, double> seconds;
  std::string step = "starting";
  auto since = Clock::now();
  fem::CellMeshOptions options;
  options.size = size;
  options.periodic = {cloth.cell->periodic_x, cloth.cell->periodic_y, cloth.cell->periodic_z};
  options.min_dihedral = 15;
  options.timeout = 3600;
  options.memory = 16384;
  options.progress = [&](const char* name, std::size_t, std::size_t) {
    const auto now = Clock::now();
    seconds[step] += seconds_between(since, now);
    step = name;
    since = now;
  };
  Diagnostics diagnostics;
  const auto begin = Clock::now();
  const Result<fem::Mesh> mesh = fem::mesh_cell(cloth, bodies, options, diagnostics);
  if (!mesh) benchmarks::fail(to_string(mesh.error()));
  const double all = seconds_between(begin, Clock::now());
  const std::string path = fmt::format("{}/cell{}", folder, number);
  const std::size_t triangles = write_surfaces(*mesh, path);
  fmt::print(
      "{}  {{\"size\": {}, \"triangles\": {}, \"nodes\": {}, \"tets\": {}, \"tetgen_seconds\": {:.4f}, "
      "\"improve_seconds\": {:.4f}, \"seconds\": {:.4f}, \"min_dihedral\": {:.4f}, \"geo\": \"{}.geo\"}}",
      number == 0 ? "" : ",\n", size, triangles, mesh->nodes.size(), mesh->elements.size(),
      seconds["filling with tetrahedra"], seconds["improving tetrahedra"], all, mesh->quality.min_dihedral,
      path);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::string sample, folder;
  std::vector<double> sizes = {0.1, 0.05, 0.03};
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--sample") == 0) sample = argv[i + 1];
    if (std::strcmp(argv[i], "--folder") == 0) folder = argv[i + 1];
    if (std::strcmp(argv[i], "--sizes") == 0) {
      sizes.clear();
      for (char* at = argv[i + 1]; *at != '\0'; at += *at == ',' ? 1 : 0)
        sizes.push_back(std::strtod(at, &at));
    }
  }
  fmt::print("{{\"rows\": [\n");
  const fabric::Fabric cloth = read(sample);
  const std::vector<yarn::Body> bodies = benchmarks::built(cloth, {});
  for (std::size_t k = 0; k < sizes.size(); ++k) row(cloth, bodies, sizes[k], k, folder);
  fmt::print("\n]}}\n");
}
