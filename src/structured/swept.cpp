#include "structured/swept.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "fem/fibre.h"
#include "fem/hexahedron.h"
#include "fem/materials.h"
#include "fem/quality.h"
#include "structured/section_pattern.h"
#include "structured/stations.h"
#include "surface_mesh/end_cap.h"
#include "surface_mesh/kept_volume.h"

namespace selvage::fem {
namespace {

constexpr double pieces_per_extent = 3;                       // where no size is given
constexpr double longest_sizes = 8, longest_wedge_sizes = 4;  // along the yarn
constexpr double deviation_share = 0.03;                      // of the thickness
constexpr std::size_t most_elements = 20'000'000;

// A yarn divided: `rows` of nodes, each of pattern.size() in its order, one at each station; of a ring the
// last station is the first row again.
struct Sweep {
  const yarn::Body* body = nullptr;
  SectionPattern pattern;
  std::vector<double> vs;
  std::vector<Vec3> nodes;  // file units

  [[nodiscard]] std::size_t parts() const { return vs.size() - 1; }
  [[nodiscard]] std::size_t rows() const { return body->closed_along ? parts() : vs.size(); }
  [[nodiscard]] std::size_t node(std::size_t row, std::size_t k) const {
    return row % rows() * pattern.size() + k;
  }
  [[nodiscard]] std::span<Vec3> row(std::size_t j) {
    return std::span(nodes).subspan(j * pattern.size(), pattern.size());
  }
  [[nodiscard]] std::size_t elements() const { return parts() * pattern.pieces.size(); }
};

// The nodes inside each row, from those on the outline; those of end faces that are not flat lie on them.
void fill_rows(Sweep& sweep) {
  const std::size_t ring = sweep.pattern.ring.size();
  for (std::size_t j = 0; j < sweep.rows(); ++j) {
    const std::span<Vec3> row = sweep.row(j);
    const std::vector<Vec3> inner = sweep.pattern.fill(row.first(ring));
    std::copy(inner.begin(), inner.end(), row.begin() + static_cast<std::ptrdiff_t>(ring));
  }
  if (sweep.body->closed_along) return;
  for (const bool last : {false, true}) {
    const std::span<Vec3> row = sweep.row(last ? sweep.rows() - 1 : 0);
    std::vector<Vec3> rim(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(ring));
    if (last == sweep.body->inward) std::reverse(rim.begin(), rim.end());
    const EndCap cap(rim, last ? sweep.body->end : sweep.body->start);
    if (cap.is_flat()) continue;
    for (Vec3& point : row.subspan(ring)) point = cap.lift(cap.project(point));
  }
}

bool has_triangles(const SectionPattern& pattern) {
  return std::any_of(pattern.pieces.begin(), pattern.pieces.end(),
                     [](const auto& piece) { return piece[2] == piece[3]; });
}

double size_for(const yarn::Body& body, const SweptOptions& options) {
  const double extent = yarn::narrowest_section(body);
  return options.size > 0 ? std::min(options.size, extent) : extent / pieces_per_extent;
}

Sweep sweep_of(const yarn::Body& body, double size) {
  const double extent = yarn::narrowest_section(body);
  Sweep sweep{&body, section_pattern(body, size), {}, {}};
  // The pieces run counter-clockwise seen against the way along the yarn.
  if (body.inward)
    for (auto& piece : sweep.pattern.pieces)
      piece = piece[2] == piece[3] ? std::array{piece[0], piece[2], piece[1], piece[1]}
                                   : std::array{piece[0], piece[3], piece[2], piece[1]};
  sweep.vs = stations(body, sweep.pattern.ring,
                      {.longest = (has_triangles(sweep.pattern) ? longest_wedge_sizes : longest_sizes) * size,
                       .deviation = deviation_share * extent,
                       .least = body.closed_along ? 6 : 2});
  const std::vector<double> rows(sweep.vs.begin(),
                                 sweep.vs.begin() + static_cast<std::ptrdiff_t>(sweep.rows()));
  const std::size_t ring = sweep.pattern.ring.size();
  const std::vector<Vec3> outlines = nurbs::evaluate_grid(body.surface, sweep.pattern.ring, rows);
  sweep.nodes.resize(rows.size() * sweep.pattern.size());
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t k = 0; k < ring; ++k) sweep.row(j)[k] = outlines[j * ring + k];
  fill_rows(sweep);
  return sweep;
}

// A quadrilateral of the surface between two nodes of the outline and two stations, outward.
struct SurfacePiece {
  std::array<std::size_t, 4> nodes{};
  double height = 0;  // mean, of the surface above it
};

SurfacePiece surface_piece(const Sweep& sweep, std::size_t j, std::size_t k) {
  const nurbs::Surface& surface = sweep.body->surface;
  const std::vector<double>& ring = sweep.pattern.ring;
  const std::size_t next = (k + 1) % ring.size();
  SurfacePiece piece{{sweep.node(j, k), sweep.node(j, next), sweep.node(j + 1, next), sweep.node(j + 1, k)}};
  if (sweep.body->inward) std::swap(piece.nodes[1], piece.nodes[3]);
  const double period = surface.last_u() - surface.first_u();
  double u = (ring[k] + (ring[next] > ring[k] ? ring[next] : ring[next] + period)) / 2;
  if (u > surface.last_u()) u -= period;
  std::array<Vec3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = sweep.nodes[piece.nodes[i]];
  const Vec3 normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).stableNormalized();
  const Vec3 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
  const Vec3 above = nurbs::evaluate(surface, u, (sweep.vs[j] + sweep.vs[j + 1]) / 2);
  piece.height = 2.0 / 3 * normal.dot(above - middle);  // of a paraboloid
  return piece;
}

// The facets of a yarn whose first node has the number `first`. A twisted quadrilateral has the mean of the
// volumes that its two diagonals give: they take turns.
void add_facets(const Sweep& sweep, std::uint32_t yarn, std::size_t first, std::vector<YarnFacet>& facets) {
  const auto add = [&](std::array<std::size_t, 4> nodes, CellTriangles::Part part, double height,
                       bool turned = false) {
    if (turned) std::rotate(nodes.begin(), nodes.begin() + 1, nodes.end());
    std::array<std::uint32_t, 4> n{};
    for (std::size_t i = 0; i < 4; ++i) n[i] = static_cast<std::uint32_t>(first + nodes[i]);
    facets.push_back({{n[0], n[1], n[2]}, yarn, part, height});
    if (n[3] != n[2]) facets.push_back({{n[0], n[2], n[3]}, yarn, part, height});
  };
  for (std::size_t j = 0; j < sweep.parts(); ++j)
    for (std::size_t k = 0; k < sweep.pattern.ring.size(); ++k) {
      const SurfacePiece piece = surface_piece(sweep, j, k);
      add(piece.nodes, CellTriangles::Part::side, piece.height, (j + k) % 2 == 1);
    }
  if (sweep.body->closed_along) return;
  for (const auto& piece : sweep.pattern.pieces) {
    std::array<std::size_t, 4> start{}, end{};
    for (std::size_t i = 0; i < 4; ++i) {
      start[i] = sweep.node(0, piece[i]);
      end[i] = sweep.node(sweep.parts(), piece[i]);
    }
    std::swap(start[0], start[1]);
    std::swap(start[2], start[3]);
    if (piece[2] == piece[3]) start = {start[1], start[2], start[0], start[0]};
    add(start, CellTriangles::Part::start, 0);
    add(end, CellTriangles::Part::end, 0);
  }
}

// Moves the nodes of all surfaces so that no volume is lost, and those inside after them.
void keep_volumes(std::vector<Sweep>& sweeps) {
  std::vector<Vec3> points;
  std::vector<YarnFacet> facets;
  std::vector<double> volumes;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    add_facets(sweeps[i], static_cast<std::uint32_t>(i), points.size(), facets);
    points.insert(points.end(), sweeps[i].nodes.begin(), sweeps[i].nodes.end());
    volumes.push_back(sweeps[i].body->volume);
  }
  keep_dry_volumes(points, facets, volumes);
  auto next = points.begin();
  for (Sweep& sweep : sweeps) {
    const auto count = static_cast<std::ptrdiff_t>(sweep.nodes.size());
    std::copy(next, next + count, sweep.nodes.begin());
    next += count;
    fill_rows(sweep);
  }
}

// Of its elements, as a share of the yarn's own.
double volume_error(const Sweep& sweep) {
  double volume = 0;
  for (std::size_t j = 0; j < sweep.parts(); ++j)
    for (const auto& piece : sweep.pattern.pieces) {
      EightNodes nodes;
      for (std::size_t i = 0; i < 4; ++i) {
        nodes[i] = sweep.nodes[sweep.node(j, piece[i])];
        nodes[i + 4] = sweep.nodes[sweep.node(j + 1, piece[i])];
      }
      volume += volume_of_hexahedron(nodes);
    }
  return std::abs(volume / sweep.body->volume - 1);
}

// Yarns divided, finer where their neighbours leave no room for their volume.
class Sweeps {
 public:
  Sweeps(std::span<const yarn::Body> bodies, const SweptOptions& options)
      : bodies_(bodies), options_(options), on_surface_(bodies.size()) {
    for (const yarn::Body& body : bodies) sizes_.push_back(size_for(body, options));
  }
  // Error: limit.
  Result<std::vector<Sweep>> make() {
    std::vector<std::size_t> open(bodies_.size());
    for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
    for (int round = 0;; ++round) {
      for_each_index(
          open.size(), options_.threads,
          [&](std::size_t k) { on_surface_[open[k]] = sweep_of(bodies_[open[k]], sizes_[open[k]]); },
          options_.progress);
      if (Status few = check_count(); !few) return few.error();
      std::vector<Sweep> sweeps = on_surface_;
      keep_volumes(sweeps);
      open.clear();
      for (std::size_t i = 0; i < sweeps.size(); ++i)
        if (volume_error(sweeps[i]) > right) open.push_back(i);
      if (open.empty() || round == most_rounds) return sweeps;
      if (round == 0) refined_ = open.size();
      for (const std::size_t i : open) sizes_[i] *= finer;
    }
  }
  [[nodiscard]] std::size_t refined() const { return refined_; }

 private:
  static constexpr double right = 0.004, finer = 0.65;
  static constexpr int most_rounds = 4;
  [[nodiscard]] Status check_count() const {
    std::size_t count = 0;
    for (const Sweep& sweep : on_surface_) count += sweep.elements();
    if (count <= most_elements) return {};
    return error(Kind::limit,
                 fmt::format("{} hexahedra would be needed, more than {}; choose a larger --size, or mesh "
                             "fewer yarns",
                             count, most_elements));
  }
  std::span<const yarn::Body> bodies_;
  const SweptOptions& options_;
  std::vector<double> sizes_;
  std::vector<Sweep> on_surface_;
  std::size_t refined_ = 0;
};

// The sides of its elements on the yarn's surface and ends; `first` is the number of its first node.
void add_faces(const Sweep& sweep, std::size_t first, Region& region) {
  for (std::size_t j = 0; j < sweep.parts(); ++j)
    for (std::size_t k = 0; k < sweep.pattern.ring.size(); ++k) {
      ElementSide side = surface_piece(sweep, j, k).nodes;
      for (std::size_t& node : side) node += first;
      region.side_faces.push_back(side);
    }
  if (sweep.body->closed_along) return;
  for (const auto& p : sweep.pattern.pieces) {
    const bool is_triangle = p[2] == p[3];
    const auto at = [&](std::size_t row, std::size_t k) { return first + sweep.node(row, p[k]); };
    region.start_faces.push_back(
        {at(0, 0), at(0, is_triangle ? 2 : 3), at(0, is_triangle ? 1 : 2), at(0, 1)});
    region.end_faces.push_back(
        {at(sweep.parts(), 0), at(sweep.parts(), 1), at(sweep.parts(), 2), at(sweep.parts(), 3)});
  }
  for (std::size_t k = 0; k < sweep.pattern.size(); ++k) {
    region.start_nodes.push_back(first + sweep.node(0, k));
    region.end_nodes.push_back(first + sweep.node(sweep.parts(), k));
  }
}

void append(Mesh& mesh, const Sweep& sweep, double scale) {
  const yarn::Body& body = *sweep.body;
  Region& region = mesh.regions.emplace_back();
  region.name = body.name;
  region.first_node = mesh.nodes.size();
  region.first_element = mesh.elements.size();
  std::vector<double> along;
  for (std::size_t j = 0; j < sweep.parts(); ++j)
    for (const auto& piece : sweep.pattern.pieces) {
      auto& element = mesh.elements.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) {
        element[i] = region.first_node + sweep.node(j, piece[i]);
        element[i + 4] = region.first_node + sweep.node(j + 1, piece[i]);
      }
      along.push_back((sweep.vs[j] + sweep.vs[j + 1]) / 2);
    }
  for (const Vec3& point : sweep.nodes) mesh.nodes.emplace_back(point * scale);
  region.last_node = mesh.nodes.size();
  region.last_element = mesh.elements.size();
  region.exact_volume = body.volume * scale * scale * scale;
  region.length = body.length * scale;
  add_faces(sweep, region.first_node, region);
  add_fibres(mesh, region, body, along, scale);
}

// Of a measured mesh: the first element that is turned inside out, somewhere.
Status check(const Mesh& mesh, std::span<const yarn::Body> bodies, double scale) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Region& region = mesh.regions[i];
    if (region.quality.min_scaled_jacobian > 0) continue;
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      if (!(shape_of(mesh, e).scaled_jacobian > 0))
        return error(Kind::geometry,
                     "hexahedra swept along this yarn turn inside out here, where it bends more tightly than "
                     "it is thick, or its section is too hollow; try another --size, or --elements tet")
            .of_yarn(bodies[i].name, bodies[i].place)
            .at_point(mesh.nodes[mesh.elements[e][0]] / scale);
  }
  return {};
}

}  // namespace

Result<Mesh> mesh_swept(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                        const SweptOptions& options, Diagnostics& diagnostics) {
  if (bodies.empty()) return error(Kind::geometry, "there is no yarn to mesh");
  Sweeps maker(bodies, options);
  const Result<std::vector<Sweep>> sweeps = maker.make();
  if (!sweeps) return sweeps.error();
  if (maker.refined() > 0)
    diagnostics.add(
        note(Kind::geometry,
             fmt::format("{} of {} yarns got smaller hexahedra: their neighbours leave no room for "
                         "the volume that larger ones lose",
                         maker.refined(), bodies.size()))
            .placed({}, fabric.file));

  Mesh mesh;
  mesh.shape = Mesh::Shape::hexahedron;
  mesh.title = fabric.title.value_or("");
  const double scale = millimetres_per(units);
  for (const Sweep& sweep : *sweeps) append(mesh, sweep, scale);
  MaterialChoice choice = choose_materials(fabric, bodies, diagnostics);
  mesh.materials = std::move(choice.materials);
  for (std::size_t i = 0; i < bodies.size(); ++i) mesh.regions[i].material = choice.of_body[i];
  measure(mesh);
  if (Status sound = check(mesh, bodies, scale); !sound) return sound.error().placed({}, fabric.file);
  return mesh;
}

}  // namespace selvage::fem
