#include "tetrahedra/mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "core/module.h"
#include "core/parallel.h"
#include "fem/faces.h"
#include "fem/materials.h"
#include "fem/quality.h"
#include "tetrahedra/mesh_check.h"

namespace selvage::fem {
namespace {

constexpr double most_tetrahedra = 1e8;
// What TetGen makes on average of that bound, for the estimate (measured: 0.075 to 0.09 of the cube).
constexpr double mean_share = 0.075;

// One yarn meshed: a Mesh of one region, in mm.
struct YarnMesh {
  Mesh mesh;
  AngleTarget angles;
  std::vector<Message> notes;
};

double size_for(const yarn::Body& body, const MeshOptions& options) {
  const double extent = yarn::narrowest_section(body);
  return options.size > 0 ? std::min(options.size, extent) : extent / default_edges_per_extent;
}

// Finer where the triangles of a thin yarn come out as none.
Result<Skin> skin_of(const yarn::Body& body, const MeshOptions& options) {
  constexpr int tries = 3;
  double size = size_for(body, options);
  for (int k = 0;; ++k, size /= 2) {
    Result<Skin> skin = make_skin(body, size);
    if (!skin || k + 1 == tries ||
        check_surface(skin->nodes.points, skin->surface.triangles, skin->surface.sides))
      return skin;
  }
}

Message about(const Message& message, const yarn::Body& body, const fabric::Fabric& fabric) {
  return message.of_yarn(body.name, body.place).placed({}, fabric.file);
}

// The nodes of a set of boundary triangles, midside ones included, increasing.
std::vector<std::size_t> nodes_on(const Mesh& mesh, const std::vector<ElementSide>& faces) {
  std::vector<std::size_t> result;
  for (const SixNodes& face : six_node_faces(mesh, mesh.regions.front(), faces))
    result.insert(result.end(), face.begin(), face.begin() + (mesh.order == 1 ? 3 : 6));
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// Where the points of a yarn's skin are in the end; empty: where they are.
using Places = std::vector<Vec3>;

Result<YarnMesh> mesh_yarn(Block& block, const Places& kept, const MeshOptions& options,
                           const std::filesystem::path& program) {
  const yarn::Body& body = block.bodies.front();
  const double size = size_for(body, options), scale = millimetres_per(block.units);
  Result<TetMesh> tets = fill(block, kept, size, options, program);
  if (!tets) return tets.error();
  Improved improved = improve(*tets, block, size, options);
  YarnMesh result{assemble(block, *tets), improved.angles, std::move(improved.notes)};
  Mesh& mesh = result.mesh;
  for (Message& note : complete(mesh, block, options.order)) result.notes.push_back(std::move(note));
  Region& region = mesh.regions.front();
  region.start_nodes = nodes_on(mesh, region.start_faces);
  region.end_nodes = nodes_on(mesh, region.end_faces);
  region.last_node = mesh.nodes.size();
  region.exact_volume = body.volume * scale * scale * scale;
  region.length = body.length * scale;
  return result;
}

// Appends one yarn's mesh to the whole; every index moves up.
void append(Mesh& mesh, Mesh&& part) {
  const std::size_t nodes = mesh.nodes.size(), elements = mesh.elements.size();
  mesh.nodes.insert(mesh.nodes.end(), part.nodes.begin(), part.nodes.end());
  for (auto element : part.elements) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(mesh.nodes_per_element()); ++k) element[k] += nodes;
    mesh.elements.push_back(element);
  }
  mesh.along.insert(mesh.along.end(), part.along.begin(), part.along.end());
  mesh.across.insert(mesh.across.end(), part.across.begin(), part.across.end());
  mesh.fibre_fraction.insert(mesh.fibre_fraction.end(), part.fibre_fraction.begin(),
                             part.fibre_fraction.end());
  Region region = std::move(part.regions.front());
  region.first_element += elements;
  region.last_element += elements;
  region.first_node += nodes;
  region.last_node += nodes;
  for (auto* list : {&region.start_nodes, &region.end_nodes})
    for (std::size_t& node : *list) node += nodes;
  for (auto* list : {&region.side_faces, &region.start_faces, &region.end_faces})
    for (auto& face : *list)
      for (std::size_t& node : face) node += nodes;
  mesh.regions.push_back(std::move(region));
}

// Too many tetrahedra are refused before they are made.
Status check_count(std::span<const yarn::Body> bodies, const MeshOptions& options) {
  double estimate = 0;
  for (const yarn::Body& body : bodies) {
    const double size = size_for(body, options);
    if (size > 0) estimate += body.volume / (mean_share * size * size * size);
  }
  if (estimate > most_tetrahedra)
    return error(Kind::limit,
                 fmt::format("about {:.1e} tetrahedra would be needed, more than {:.0e}; choose a larger "
                             "--size, or mesh fewer yarns",
                             estimate, most_tetrahedra));
  return {};
}

// Something for every yarn, several at once. After a failure the yarns behind it are left out, those before
// it are not: the failure that is reported does not depend on the number of threads.
template <class Part, class Make>
std::vector<std::optional<Result<Part>>> for_all(std::size_t count, int threads, const Make& make) {
  std::vector<std::optional<Result<Part>>> parts(count);
  std::atomic<std::size_t> first_failed{count};
  for_each_index(count, threads, [&](std::size_t i) {
    if (i > first_failed) return;
    parts[i] = make(i);
    if (parts[i]->ok()) return;
    for (std::size_t before = first_failed; i < before && !first_failed.compare_exchange_weak(before, i);) {
    }
  });
  return parts;
}

// The surfaces of all yarns as one: their nodes leave the B-spline surfaces so that no volume is lost.
std::vector<Places> keep_volumes(std::span<const yarn::Body> bodies,
                                 const std::vector<std::optional<Result<Block>>>& blocks, int threads) {
  std::vector<std::vector<YarnFacet>> parts(bodies.size());
  for_each_index(bodies.size(), threads,
                 [&](std::size_t i) { parts[i] = facets_of(bodies.subspan(i, 1), (*blocks[i])->skin, 1); });
  std::vector<Vec3> points;
  std::vector<YarnFacet> facets;
  std::vector<double> volumes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(points.size());
    const std::vector<Vec3>& own = (*blocks[i])->skin.nodes.points;
    points.insert(points.end(), own.begin(), own.end());
    volumes.push_back(bodies[i].volume);
    for (YarnFacet& facet : parts[i]) {
      for (std::uint32_t& corner : facet.corners) corner += first;
      facet.yarn = static_cast<std::uint32_t>(i);
      facets.push_back(facet);
    }
  }
  keep_dry_volumes(points, facets, volumes);
  std::vector<Places> kept;
  auto next = points.begin();
  for (const auto& block : blocks) {
    const auto first = next;
    next += static_cast<std::ptrdiff_t>((*block)->skin.nodes.points.size());
    kept.emplace_back(first, next);
  }
  return kept;
}

}  // namespace

Result<Mesh> mesh_yarns(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                        const MeshOptions& options, Diagnostics& diagnostics) {
  if (bodies.empty()) return error(Kind::geometry, "there is no yarn to mesh");
  if (Status right = check_options(options); !right) return right.error();
  if (Status right = check_count(bodies, options); !right) return right.error();
  const Result<std::filesystem::path> program = find_worker("selvage-tetgen");
  if (!program) return program.error();
  std::mutex one_at_a_time;
  const auto count_up = [&](const char* step, std::size_t& done) {
    const std::scoped_lock lock(one_at_a_time);
    if (options.progress) options.progress(step, ++done, bodies.size());
  };
  std::size_t skinned = 0, filled = 0;
  auto blocks = for_all<Block>(bodies.size(), options.threads, [&](std::size_t i) -> Result<Block> {
    Result<Skin> skin = skin_of(bodies[i], options);
    count_up("meshing the surface of yarn", skinned);
    if (!skin) return skin.error();
    return Block(bodies.subspan(i, 1), units, box_round(bodies[i]), {}, std::move(*skin));
  });
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!blocks[i]->ok()) return about(blocks[i]->error(), bodies[i], fabric);
  std::vector<Places> kept(bodies.size());
  if (options.order == 1) kept = keep_volumes(bodies, blocks, options.threads);
  MeshOptions one_thread = options;  // for each
  one_thread.threads = 1;
  auto parts = for_all<YarnMesh>(bodies.size(), options.threads, [&](std::size_t i) {
    Result<YarnMesh> part = mesh_yarn(**blocks[i], kept[i], one_thread, *program);
    blocks[i].reset();
    kept[i] = {};
    count_up("filling yarn", filled);
    return part;
  });

  Mesh mesh;
  mesh.order = options.order;
  mesh.title = fabric.title.value_or("");
  mesh.angles.emplace().wanted = options.min_dihedral;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!parts[i]->ok()) return about(parts[i]->error(), bodies[i], fabric);
    for (Message& note : (*parts[i])->notes) diagnostics.add(about(std::move(note), bodies[i], fabric));
    mesh.angles->below += (*parts[i])->angles.below;
    mesh.angles->in_wedges += (*parts[i])->angles.in_wedges;
    append(mesh, std::move((*parts[i])->mesh));
    parts[i].reset();
  }
  MaterialChoice choice = choose_materials(fabric, bodies, diagnostics);
  mesh.materials = std::move(choice.materials);
  for (std::size_t i = 0; i < bodies.size(); ++i) mesh.regions[i].material = choice.of_body[i];
  measure(mesh);
  if (Status sound = check_elements(mesh, units); !sound) return sound.error().placed({}, fabric.file);
  return mesh;
}

}  // namespace selvage::fem
