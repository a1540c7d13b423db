#include "fem/mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "core/module.h"
#include "core/parallel.h"
#include "fem/faces.h"
#include "fem/fibre.h"
#include "fem/improve.h"
#include "fem/kept_volume.h"
#include "fem/materials.h"
#include "fem/midside.h"
#include "fem/quality.h"
#include "fem/surface_mesh.h"
#include "fem/tet_complex.h"
#include "fem/worker.h"

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
  return options.size > 0 ? options.size : smallest_section_extent(body) / 4;
}

Message about(Message message, const yarn::Body& body, const fabric::Fabric& fabric) {
  message.yarn = body.name;
  message.file = fabric.file;
  message.place = body.place;
  return message;
}

// The mesh of one region out of the tetrahedra, in the body's units.
Mesh assemble(const TetMesh& tets, const SurfaceMesh& surface, const yarn::Body& body) {
  Mesh mesh;
  mesh.nodes = tets.points;
  mesh.elements.reserve(tets.cells.size());
  for (const auto& cell : tets.cells) mesh.elements.push_back({cell[0], cell[1], cell[2], cell[3]});
  Region region;
  region.name = body.name;
  region.last_element = mesh.elements.size();
  auto faces = [](std::span<const Triangle> triangles) {
    std::vector<std::array<std::size_t, 3>> result;
    for (const Triangle& t : triangles) result.push_back({t[0], t[1], t[2]});
    return result;
  };
  region.side_faces = faces(surface.side());
  region.start_faces = faces(surface.start());
  region.end_faces = faces(surface.end());
  mesh.regions.push_back(std::move(region));
  return mesh;
}

// The nodes of a set of boundary triangles, midside ones included, increasing.
std::vector<std::size_t> nodes_on(const Mesh& mesh, const std::vector<std::array<std::size_t, 3>>& faces) {
  std::vector<std::size_t> result;
  for (const SixNodes& face : six_node_faces(mesh, mesh.regions.front(), faces))
    result.insert(result.end(), face.begin(), face.begin() + (mesh.order == 1 ? 3 : 6));
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

double least_quality(const TetMesh& tets) {
  double least = 1;
  for (const Tetrahedron& t : tets.cells)
    least = std::min(least,
                     tet_quality(tets.points[t[0]], tets.points[t[1]], tets.points[t[2]], tets.points[t[3]]));
  return least;
}

// Where the points of a yarn's surface are in the end; empty: where they are.
using Places = std::vector<Vec3>;

// TetGen's tetrahedra inside the surface as it is, then with the surface's points in their places. They go a
// short way, and cost a little of the angles; `target`, where it is 0, becomes what the smallest one was
// before. (For a surface that is moved first TetGen makes other tetrahedra, whose smallest angle may be any.)
// Where a tetrahedron would turn inside out, the moved surface is filled.
Result<TetMesh> fill(const SurfaceMesh& surface, const Places& kept, double size, const MeshOptions& options,
                     const std::filesystem::path& program, double& target) {
  TetgenJob job{.points = surface.points, .triangles = surface.triangles};
  job.max_volume = largest_volume(size);
  job.smallest_feature = size;
  const TetgenLimits limits{.timeout = options.timeout, .memory = options.memory};
  Result<TetMesh> tets = run_tetgen(program, job, limits);
  if (!tets || kept.empty()) return tets;
  const double before = least_quality(*tets);
  std::copy(kept.begin(), kept.end(), tets->points.begin());
  const double after = least_quality(*tets);
  if (after == inverted_quality) {
    job.points = kept;
    return run_tetgen(program, job, limits);
  }
  if (target == 0 && after < before) target = angle_of_quality(before);
  return tets;
}

Result<YarnMesh> mesh_yarn(const yarn::Body& body, const SurfaceMesh& surface, const Places& kept, Unit units,
                           const MeshOptions& options, const std::filesystem::path& program) {
  const double size = std::min(size_for(body, options), surface.coarsest), scale = millimetres_per(units);
  double target = options.min_dihedral;
  Result<TetMesh> tets = fill(surface, kept, size, options, program, target);
  if (!tets) return tets.error();

  YarnMesh result;
  if (target > 0) {
    tets->regions.assign(tets->cells.size(), 0);
    const Improvement improvement =
        improve(tets->points, tets->cells, tets->regions, surface.points.size(), {.target = target});
    if (options.min_dihedral > 0) {
      result.angles = count(improvement, target);
      result.notes = describe(improvement, target, name_of(units));
    }
  }
  result.mesh = assemble(*tets, surface, body);
  Mesh& mesh = result.mesh;
  std::vector<double> known(mesh.nodes.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < surface.parameters.size(); ++i) known[i] = surface.parameters[i].y();
  add_fibres(mesh, mesh.regions.front(), body, parameters_along(mesh, mesh.regions.front(), body, known, 1));
  if (options.order == 2) {
    const MidsideNodes nodes = add_midside_nodes(mesh, surface, body);
    if (nodes.held > 0) {
      Message note =
          warning(Kind::geometry, fmt::format("{} midside nodes were held back from the yarn's surface, by "
                                              "up to {:.2g} mm, so that no element folds",
                                              nodes.held, nodes.farthest * scale));
      note.severity = Severity::note;
      result.notes.push_back(std::move(note));
    }
  }
  Region& region = mesh.regions.front();
  region.start_nodes = nodes_on(mesh, region.start_faces);
  region.end_nodes = nodes_on(mesh, region.end_faces);
  region.last_node = mesh.nodes.size();
  region.exact_volume = body.volume * scale * scale * scale;
  for (Vec3& node : mesh.nodes) node *= scale;
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

Status check_options(std::span<const yarn::Body> bodies, const MeshOptions& options) {
  if (bodies.empty()) return error(Kind::geometry, "there is no yarn to mesh");
  if (options.order != 1 && options.order != 2) return error(Kind::usage, "the order of a mesh is 1 or 2");
  if (!(options.size >= 0) || !std::isfinite(options.size))
    return error(Kind::usage, "the mesh size must be a positive number");
  if (!(options.min_dihedral >= 0 && options.min_dihedral <= 30))
    return error(Kind::usage, "the smallest dihedral angle wanted must be from 0 to 30 degrees");
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
                                 const std::vector<std::optional<Result<SurfaceMesh>>>& all, int threads) {
  std::vector<Vec3> points;
  std::vector<YarnFacet> facets;
  std::vector<double> volumes;
  std::vector<std::size_t> first_facet;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const SurfaceMesh& surface = **all[i];
    const auto first = static_cast<std::uint32_t>(points.size());
    first_facet.push_back(facets.size());
    points.insert(points.end(), surface.points.begin(), surface.points.end());
    volumes.push_back(bodies[i].volume);
    for (const Triangle& t : surface.triangles)
      facets.push_back({.corners = {first + t[0], first + t[1], first + t[2]},
                        .yarn = static_cast<std::uint32_t>(i),
                        .part = YarnFacet::Part::end});
  }
  for_each_index(bodies.size(), threads, [&](std::size_t i) {
    const SurfaceMesh& surface = **all[i];
    for (std::size_t k = 0; k < surface.side_triangles; ++k) {
      YarnFacet& facet = facets[first_facet[i] + k];
      facet.part = YarnFacet::Part::side;
      std::array<SurfaceEnd, 3> corners;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t point = surface.triangles[k][c];
        corners[c] = {surface.parameters[point], surface.points[point]};
      }
      facet.height = mean_height(bodies[i], corners);
    }
  });
  // In a cloth that is jammed there is no room beside its gaps: nothing is meshed in them, they need only
  // stay.
  constexpr double right = 1e-3;
  const std::vector<Vec3> on_surface = points;
  for (const double gap_share : {0.05, 0.4}) {
    points = on_surface;
    if (fem::keep_volumes(points, {.facets = facets, .volumes = volumes, .gap_share = gap_share}) < right)
      break;
  }
  std::vector<Places> kept;
  auto next = points.begin();
  for (const auto& surface : all) {
    const auto first = next;
    next += static_cast<std::ptrdiff_t>((*surface)->points.size());
    kept.emplace_back(first, next);
  }
  return kept;
}

// What is wrong with the finished mesh.
Status judge(const Mesh& mesh, const fabric::Fabric& fabric, double scale) {
  for (const BadElement& bad : mesh.worst) {
    if (mesh.quality.min_scaled_jacobian > 0) break;
    Message message =
        error(Kind::geometry, "the mesh has an element with a negative Jacobian; try another --size");
    message.file = fabric.file;
    message.at = bad.at / scale;
    return message;
  }
  return {};
}

}  // namespace

Result<Mesh> mesh_yarns(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                        const MeshOptions& options, Diagnostics& diagnostics) {
  if (Status right = check_options(bodies, options); !right) return right.error();
  const Result<std::filesystem::path> program = find_worker("selvage-tetgen");
  if (!program) return program.error();
  const double scale = millimetres_per(units);
  auto surfaces = for_all<SurfaceMesh>(bodies.size(), options.threads, [&](std::size_t i) {
    return mesh_surface(bodies[i], size_for(bodies[i], options));
  });
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!surfaces[i]->ok()) return about(surfaces[i]->error(), bodies[i], fabric);
  std::vector<Places> kept(bodies.size());
  if (options.order == 1) kept = keep_volumes(bodies, surfaces, options.threads);
  std::mutex one_at_a_time;
  std::size_t done = 0;
  auto parts = for_all<YarnMesh>(bodies.size(), options.threads, [&](std::size_t i) {
    Result<YarnMesh> part = mesh_yarn(bodies[i], **surfaces[i], kept[i], units, options, *program);
    surfaces[i].reset();
    kept[i] = {};
    const std::scoped_lock lock(one_at_a_time);
    if (options.progress) options.progress(++done, bodies.size());
    return part;
  });

  Mesh mesh;
  mesh.order = options.order;
  mesh.title = fabric.title.value_or("");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!parts[i]->ok()) return about(parts[i]->error(), bodies[i], fabric);
    for (Message& note : (*parts[i])->notes) diagnostics.add(about(std::move(note), bodies[i], fabric));
    if (options.min_dihedral > 0) {
      if (!mesh.angles) mesh.angles.emplace();
      mesh.angles->wanted = options.min_dihedral;
      mesh.angles->below += (*parts[i])->angles.below;
      mesh.angles->in_wedges += (*parts[i])->angles.in_wedges;
    }
    append(mesh, std::move((*parts[i])->mesh));
    parts[i].reset();
  }
  MaterialChoice choice = choose_materials(fabric, bodies, diagnostics);
  mesh.materials = std::move(choice.materials);
  for (std::size_t i = 0; i < bodies.size(); ++i) mesh.regions[i].material = choice.of_body[i];
  measure(mesh);
  if (Status sound = judge(mesh, fabric, scale); !sound) return sound.error();
  return mesh;
}

}  // namespace selvage::fem
