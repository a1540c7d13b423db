#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "fem/cell_surfaces.h"
#include "fem/triangle_mesh.h"
#include "fem/unrolled.h"

namespace selvage::fem {

namespace {

class BodySupport final : public Support {
 public:
  explicit BodySupport(const yarn::Body& body)
      : body_(body),
        period_(body.surface.last_u() - body.surface.first_u(),
                body.surface.last_v() - body.surface.first_v()) {}

  [[nodiscard]] Vec3 point(const Vec2& q) const override { return cell::position(body_, q); }

  [[nodiscard]] Vec3 normal(const Vec2& q) const override {
    const nurbs::SurfaceJet s = cell::jet(body_, q);
    return s.du.cross(s.dv).stableNormalized();
  }

  // Gauss-Newton's method.
  [[nodiscard]] Place nearest(const Vec2& start, const Vec3& target) const override {
    Vec2 q = start;
    for (int step = 0; step < 8; ++step) {
      const nurbs::SurfaceJet s = cell::jet(body_, q);
      const Vec3 way = target - s.position;
      const double a = s.du.squaredNorm(), b = s.du.dot(s.dv), c = s.dv.squaredNorm();
      const double determinant = a * c - b * b;
      if (!(determinant > 1e-12 * a * c)) break;
      const double x = s.du.dot(way), y = s.dv.dot(way);
      Vec2 change((c * x - b * y) / determinant, (a * y - b * x) / determinant);
      const double size = std::sqrt(a) * std::abs(change.x()) + std::sqrt(c) * std::abs(change.y());
      q += change;
      if (!body_.closed_along) q.y() = std::clamp(q.y(), body_.surface.first_v(), body_.surface.last_v());
      if (size < 1e-4 * way.norm() + 1e-14) break;
    }
    return {q, point(q)};
  }

  [[nodiscard]] Vec2 beside(const Vec2& a, const Vec2& b) const override {
    Vec2 result = b;
    result.x() += period_.x() * std::round((a.x() - b.x()) / period_.x());
    if (body_.closed_along) result.y() += period_.y() * std::round((a.y() - b.y()) / period_.y());
    return result;
  }

 private:
  const yarn::Body& body_;
  Vec2 period_;
};

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

// One piece as triangles of its own, with what joins it to the cell.
struct PieceMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> known;  // the cell's nodes of its first points; Unrolled::none: a new one
};

// Points of the plane that stand for one node become one.
PieceMesh joined(TriangleMesh filled, const Unrolled& unrolled) {
  PieceMesh result;
  TriangleMesh& mesh = result.mesh;
  std::vector<std::uint32_t> number(unrolled.nodes.size());
  std::vector<bool> used(unrolled.nodes.size(), false);
  for (const std::uint32_t owner : unrolled.owner) used[owner] = true;
  for (const bool fixed : {true, false})
    for (std::size_t k = 0; k < unrolled.nodes.size(); ++k) {
      const Unrolled::Node& node = unrolled.nodes[k];
      if (node.is_fixed != fixed || !used[k]) continue;
      number[k] = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(node.point);
      mesh.parameters.push_back(node.parameters);
      if (fixed) {
        ++mesh.fixed_points;
        result.known.push_back(node.known);
      }
    }
  const auto shared = static_cast<std::uint32_t>(mesh.points.size());
  const auto owned = static_cast<std::uint32_t>(unrolled.owner.size());
  for (std::size_t k = owned; k < filled.points.size(); ++k) {
    mesh.points.push_back(filled.points[k]);
    mesh.parameters.push_back(filled.parameters[k]);
  }
  for (auto& t : filled.triangles)
    for (std::uint32_t& corner : t)
      corner = corner < owned ? number[unrolled.owner[corner]] : shared + (corner - owned);
  mesh.triangles = std::move(filled.triangles);
  mesh.domains = std::move(filled.domains);
  for (const auto& edge : unrolled.fixed_edges)
    mesh.fixed_edges.push_back({number[edge[0]], number[edge[1]]});
  return result;
}

Message about(Message message, const yarn::Body& body) {
  message.yarn = body.name;
  message.place = body.place;
  return message;
}

Result<PieceMesh> mesh_piece(const CellShape& shape, const CellCurves& curves, std::size_t piece,
                             const SizeField& field, const SurfaceOptions& options, const CellNodes& nodes) {
  const yarn::Body& body = shape.bodies[shape.cut.pieces[piece].body];
  const Result<Unrolled> unrolled = unroll(shape, curves, piece, field, nodes);
  if (!unrolled) return about(unrolled.error(), body);
  const BodySupport support(body);
  Result<TriangleMesh> filled = fill(unrolled->region, support, field, options.most_triangles);
  if (!filled) return about(filled.error(), body);
  PieceMesh result = joined(std::move(*filled), *unrolled);
  remesh(result.mesh, support, field);
  return result;
}

// The end face at a border that runs along the yarn's own end.
Status add_end(const CellShape& shape, const cell::Piece& piece, const cell::Border& border,
               const Chain& chain, const SizeField& field, const SurfaceOptions& options, CellNodes& nodes,
               CellTriangles& result) {
  const yarn::Body& body = shape.bodies[piece.body];
  std::vector<std::uint32_t> rim(chain.nodes.begin(), chain.nodes.end() - 1);
  if (!body.inward) std::reverse(rim.begin(), rim.end());
  std::vector<Vec3> points;
  PlanarRegion region;
  points.reserve(rim.size());
  for (const std::uint32_t node : rim) points.push_back(nodes.points[node]);
  const bool is_end = border.arcs.front().face == cell::Arc::own_end;
  const EndCap cap(points, is_end ? body.end : body.start);
  region.parameters = cap.rim();
  region.points = points;
  const auto count = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t k = 0; k < count; ++k) region.segments.push_back({k, (k + 1) % count, 0, -1});
  const CapSupport support(cap, 1e-4 * field.largest());
  Result<TriangleMesh> mesh = fill(region, support, field, options.most_triangles);
  if (!mesh) return about(mesh.error(), body);
  remesh(*mesh, support, field);
  std::vector<std::uint32_t> number = rim;
  for (std::size_t k = rim.size(); k < mesh->points.size(); ++k)
    number.push_back(nodes.add(mesh->points[k], {no_body, Vec2::Zero()}));
  const Sides sides{static_cast<std::uint32_t>(piece.body),
                    options.matrix ? CellTriangles::matrix : Sides::outside};
  result.caps.push_back({cap, result.triangles.size(), mesh->triangles.size()});
  for (const auto& t : mesh->triangles)
    result.add({number[t[0]], number[t[1]], number[t[2]]}, sides,
               is_end ? CellTriangles::Part::end : CellTriangles::Part::start);
  return {};
}

}  // namespace

Status add_yarn_surfaces(const CellShape& shape, const CellCurves& curves, const SizeField& field,
                         const SurfaceOptions& options, int threads, CellNodes& nodes,
                         CellTriangles& result) {
  const std::size_t count = shape.cut.pieces.size();
  std::vector<std::optional<Result<PieceMesh>>> made(count);
  for_each_index(count, threads,
                 [&](std::size_t k) { made[k] = mesh_piece(shape, curves, k, field, options, nodes); });
  for (std::size_t p = 0; p < count; ++p) {
    if (!made[p]->ok()) return made[p]->error();
    const cell::Piece& piece = shape.cut.pieces[p];
    const yarn::Body& body = shape.bodies[piece.body];
    PieceMesh& part = **made[p];
    std::vector<std::uint32_t> number;
    for (std::size_t k = 0; k < part.mesh.points.size(); ++k) {
      const bool known = k < part.known.size() && part.known[k] != Unrolled::none;
      number.push_back(known ? part.known[k]
                             : nodes.add(part.mesh.points[k],
                                         {piece.body, cell::in_domain(body, part.mesh.parameters[k])}));
    }
    const Sides sides{static_cast<std::uint32_t>(piece.body),
                      options.matrix ? CellTriangles::matrix : Sides::outside};
    for (auto t : part.mesh.triangles) {
      if (body.inward) std::swap(t[1], t[2]);
      result.add({number[t[0]], number[t[1]], number[t[2]]}, sides, CellTriangles::Part::side);
    }
    made[p].reset();
    for (std::size_t b = 0; b < piece.borders.size(); ++b)
      if (piece.borders[b].arcs.front().face >= cell::face_count)
        if (Status added =
                add_end(shape, piece, piece.borders[b], curves.chains[shape.division.first_edges[p][b]],
                        field, options, nodes, result);
            !added)
          return added;
  }
  return {};
}

}  // namespace selvage::fem
