#include "surface_mesh/cell_surfaces.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "surface_mesh/body_support.h"
#include "surface_mesh/stagger.h"
#include "surface_mesh/triangle_mesh.h"
#include "surface_mesh/unrolled.h"

namespace selvage::fem {

namespace {

// A yarn's end inside the box, over the mean plane of its rim.
class CapSupport final : public Support {
 public:
  CapSupport(const EndCap& cap, double step) : cap_(cap), step_(step) {}
  [[nodiscard]] Vec3 point(const Vec2& q) const override { return cap_.lift(q); }
  [[nodiscard]] Vec3 normal(const Vec2& q) const override {
    const Vec3 here = point(q);
    return (point(q + Vec2(step_, 0)) - here).cross(point(q + Vec2(0, step_)) - here).stableNormalized();
  }
  [[nodiscard]] Place nearest(const Vec2& /*start*/, const Vec3& target) const override {
    const Vec2 q = cap_.project(target);
    return {q, point(q)};
  }

 private:
  const EndCap& cap_;
  double step_;
};

// A face of the cell as a plane, seen from outside. Its chart is without distortion: the first of the two
// axes in it, and what is at a right angle to that.
class FaceSupport final : public Support {
 public:
  FaceSupport(const Parallelepiped& cell, int face) : cell_(cell), face_(face) {
    const auto [first, second] = cell::axes_in(face);
    const Vec3 x = cell.axes.unit(first), y = cell.axes.unit(second);
    cosine_ = x.dot(y);
    sine_ = x.cross(y).norm();
  }

  [[nodiscard]] Vec2 chart(const Vec3& point) const {
    const Vec2 own = cell::flat(cell_.axes.own(point), face_);
    return {own.x() + cosine_ * own.y(), sine_ * own.y()};
  }
  [[nodiscard]] Vec3 point(const Vec2& q) const override {
    const double y = q.y() / sine_;
    return cell_.axes.place(cell::in_face(cell_.box, face_, {q.x() - cosine_ * y, y}));
  }
  [[nodiscard]] Vec3 normal(const Vec2& /*q*/) const override {
    return (cell::is_high(face_) ? 1 : -1) * cell_.axes.normal(cell::axis_of(face_));
  }
  [[nodiscard]] Place nearest(const Vec2& /*start*/, const Vec3& target) const override {
    const Vec2 q = chart(target);
    return {q, point(q)};
  }

 private:
  const Parallelepiped& cell_;
  int face_;
  double cosine_ = 0, sine_ = 1;
};

std::uint32_t body_of(const cell::FaceRegion& region) {
  return region.body == cell::FaceRegion::matrix ? CellTriangles::matrix
                                                 : static_cast<std::uint32_t>(region.body);
}

// Nodes of an outline in its own direction, closed.
std::vector<std::uint32_t> outline_nodes(const CellCurves& curves, const cell::Outline& outline) {
  std::vector<std::uint32_t> result;
  for (const cell::Side& side : outline) {
    std::vector<std::uint32_t> nodes = curves.chains[side.edge].nodes;
    if (side.backward) std::reverse(nodes.begin(), nodes.end());
    result.insert(result.end(), nodes.begin(), nodes.end() - 1);
  }
  return result;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// The region to the left of each directed edge in a face; without those of the matrix where there is none.
std::map<Edge, std::size_t> edges_of(const CellShape& shape, const CellCurves& curves, int face) {
  std::map<Edge, std::size_t> result;
  const auto& regions = shape.division.regions;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (regions[r].face != face || (!shape.matrix && body_of(regions[r]) == CellTriangles::matrix)) continue;
    for (const cell::Outline& outline : regions[r].outlines) {
      const std::vector<std::uint32_t> nodes = outline_nodes(curves, outline);
      for (std::size_t k = 0; k < nodes.size(); ++k) result[{nodes[k], nodes[(k + 1) % nodes.size()]}] = r;
    }
  }
  return result;
}

class Surfaces {
 public:
  Surfaces(const CellShape& shape, const CellCurves& curves, const SizeField& field, CellNodes& nodes)
      : shape_(shape), curves_(curves), field_(field), nodes_(nodes) {}

  Result<CellTriangles> run(int threads) {
    const std::size_t count = shape_.cut.pieces.size();
    std::vector<std::optional<Result<TriangleMesh>>> made(count);
    for_each_index(count, threads, [&](std::size_t k) { made[k] = mesh_piece(k); });
    std::deque<BodySupport> supports;
    std::vector<StaggeredMesh> meshes;
    for (std::size_t k = 0; k < count; ++k) {
      if (!made[k]->ok()) return made[k]->error();
      meshes.push_back({&**made[k], &supports.emplace_back(shape_.bodies[shape_.cut.pieces[k].body])});
    }
    if (shape_.matrix) stagger(meshes, field_, threads);
    for (std::size_t k = 0; k < count; ++k) {
      if (Status added = add_piece(k, **made[k]); !added) return added.error();
      made[k].reset();
    }
    for (int face = 0; face < cell::face_count; ++face)
      if (!cell::is_high(face) || !is_periodic(face))
        if (Status added = add_face(face); !added) return added.error();
    return std::move(result_);
  }

 private:
  using Part = CellTriangles::Part;

  [[nodiscard]] bool is_periodic(int face) const {
    return shape_.periodic[static_cast<std::size_t>(cell::axis_of(face))];
  }
  [[nodiscard]] Result<TriangleMesh> mesh_piece(std::size_t number) const;
  Status add_piece(std::size_t number, const TriangleMesh& mesh);
  Status add_end(const cell::Piece& piece, bool is_end, const Chain& chain);
  Status add_face(int face);
  Status add_opposite(int face, const std::map<Edge, std::size_t>& edges, const TriangleMesh& mesh,
                      const std::vector<std::uint32_t>& numbers);

  // The nodes of a mesh's points: new ones but for those that it knows, on a body's surface or none.
  std::vector<std::uint32_t> numbers_of(const TriangleMesh& mesh, std::size_t body = no_body) {
    std::vector<std::uint32_t> numbers = mesh.known;
    numbers.resize(mesh.points.size(), PlanarRegion::none);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (numbers[k] != PlanarRegion::none) continue;
      numbers[k] = body == no_body ? nodes_.add(mesh.points[k])
                                   : nodes_.add(mesh.points[k], shape_.place(body, mesh.parameters[k]));
    }
    return numbers;
  }
  void add(const Triangle& corners, const std::vector<std::uint32_t>& numbers, const Sides& sides,
           Part part) {
    result_.triangles.push_back({numbers[corners[0]], numbers[corners[1]], numbers[corners[2]]});
    result_.sides.push_back(sides);
    result_.parts.push_back(part);
  }
  [[nodiscard]] Sides sides_of(const cell::Piece& piece) const {
    return {static_cast<std::uint32_t>(piece.body), shape_.matrix ? CellTriangles::matrix : Sides::outside};
  }

  const CellShape& shape_;
  const CellCurves& curves_;
  const SizeField& field_;
  CellNodes& nodes_;
  CellTriangles result_;
};

Result<TriangleMesh> Surfaces::mesh_piece(std::size_t number) const {
  const yarn::Body& body = shape_.bodies[shape_.cut.pieces[number].body];
  const Result<PlanarRegion> region = unroll(shape_, curves_, number, field_, nodes_);
  if (!region) return region.error().of_yarn(body.name, body.place);
  Result<TriangleMesh> mesh = fill(*region, BodySupport(body), field_);
  if (!mesh) return mesh.error().of_yarn(body.name, body.place);
  return mesh;
}

Status Surfaces::add_piece(std::size_t number, const TriangleMesh& mesh) {
  const cell::Piece& piece = shape_.cut.pieces[number];
  const std::vector<std::uint32_t> numbers = numbers_of(mesh, piece.body);
  for (auto t : mesh.triangles) {
    if (shape_.bodies[piece.body].inward) std::swap(t[1], t[2]);
    add(t, numbers, sides_of(piece), Part::side);
  }
  for (std::size_t b = 0; b < piece.borders.size(); ++b)
    if (const int face = piece.borders[b].arcs.front().face; face >= cell::face_count)
      if (Status added = add_end(piece, face == cell::Arc::own_end,
                                 curves_.chains[shape_.division.first_edges[number][b]]);
          !added)
        return added;
  return {};
}

// The end face at a border that runs along the yarn's own end.
Status Surfaces::add_end(const cell::Piece& piece, bool is_end, const Chain& chain) {
  const yarn::Body& body = shape_.bodies[piece.body];
  std::vector<std::uint32_t> rim(chain.nodes.begin(), chain.nodes.end() - 1);
  if (!body.inward) std::reverse(rim.begin(), rim.end());
  std::vector<Vec3> points;
  points.reserve(rim.size());
  for (const std::uint32_t node : rim) points.push_back(nodes_.points[node]);
  const EndCap cap(points, is_end ? body.end : body.start);
  PlanarRegion region;
  for (std::size_t k = 0; k < rim.size(); ++k) region.add({points[k], cap.rim()[k], rim[k]});
  region.close(0);
  const Result<TriangleMesh> mesh = fill(region, CapSupport(cap, 1e-4 * field_.largest()), field_);
  if (!mesh) return mesh.error().of_yarn(body.name, body.place);
  const std::vector<std::uint32_t> numbers = numbers_of(*mesh);
  result_.caps.push_back({cap, result_.triangles.size(), mesh->triangles.size()});
  for (const auto& t : mesh->triangles) add(t, numbers, sides_of(piece), is_end ? Part::end : Part::start);
  return {};
}

Status Surfaces::add_face(int face) {
  const std::map<Edge, std::size_t> edges = edges_of(shape_, curves_, face);
  if (edges.empty()) return {};
  PlanarRegion region;
  const FaceSupport plane(shape_.cell, face);
  std::map<std::uint32_t, std::uint32_t> places;
  const auto place_of = [&](std::uint32_t node) {
    const auto [at, is_new] = places.emplace(node, static_cast<std::uint32_t>(places.size()));
    const Vec3& point = nodes_.points[node];
    if (is_new) region.add({point, plane.chart(point), node});
    return at->second;
  };
  for (const auto& [edge, left] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (back != edges.end() && edge.first > edge.second) continue;
    const std::int32_t right = back == edges.end() ? -1 : static_cast<std::int32_t>(back->second);
    const std::uint32_t from = place_of(edge.first), to = place_of(edge.second);
    region.segments.push_back({from, to, static_cast<std::int32_t>(left), right});
  }
  Result<TriangleMesh> mesh = fill(region, plane, field_);
  if (!mesh) {
    mesh.error().text += " in the " + cell::name_of_face(face) + " face of the cell";
    return mesh.error();
  }
  const std::vector<std::uint32_t> numbers = numbers_of(*mesh);
  for (std::size_t k = 0; k < mesh->triangles.size(); ++k) {
    const auto region_number = static_cast<std::size_t>(mesh->domains[k]);
    add(mesh->triangles[k], numbers, {body_of(shape_.division.regions[region_number]), Sides::outside},
        Part::box);
  }
  if (!is_periodic(face)) return {};
  return add_opposite(face, edges, *mesh, numbers);
}

// A low face's triangles, moved to the high one.
Status Surfaces::add_opposite(int face, const std::map<Edge, std::size_t>& edges, const TriangleMesh& mesh,
                              const std::vector<std::uint32_t>& numbers) {
  const int a = cell::axis_of(face);
  const auto& across = curves_.opposite[static_cast<std::size_t>(a)];
  std::vector<std::uint32_t> opposite;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const Vec3 moved = shape_.cell.with(mesh.points[k], a, shape_.cell.box.max()[a]);
    opposite.push_back(k < mesh.known.size() ? across.at(numbers[k]) : nodes_.add(moved));
  }
  // What is behind the high face, region by region: by an edge of each.
  const std::map<Edge, std::size_t> high = edges_of(shape_, curves_, face + 1);
  std::map<std::int32_t, std::uint32_t> behind;
  for (const auto& [edge, left] : edges) {
    const auto found = high.find({across.at(edge.second), across.at(edge.first)});
    const std::uint32_t body =
        found == high.end() ? Sides::outside : body_of(shape_.division.regions[found->second]);
    if (found == high.end() ||
        (body == CellTriangles::matrix) != (body_of(shape_.division.regions[left]) == CellTriangles::matrix))
      return error(Kind::geometry,
                   "opposite faces of the cell are divided in different ways: the yarns do not repeat there")
          .at_point(nodes_.points[edge.first]);
    behind[static_cast<std::int32_t>(left)] = body;
  }
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& t = mesh.triangles[k];
    add({t[0], t[2], t[1]}, opposite, {behind.at(mesh.domains[k]), Sides::outside}, Part::box);
  }
  return {};
}

}  // namespace

Result<CellTriangles> mesh_surfaces(const CellShape& shape, const CellCurves& curves, const SizeField& field,
                                    int threads, CellNodes& nodes) {
  return Surfaces(shape, curves, field, nodes).run(threads);
}

}  // namespace selvage::fem
