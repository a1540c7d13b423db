#include <algorithm>
#include <map>
#include <utility>

#include "fem/cell_surfaces.h"
#include "fem/triangle_mesh.h"

namespace selvage::fem {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// A face of the box as a plane, seen from outside.
class FaceSupport final : public Support {
 public:
  FaceSupport(const Box3& box, int face) : box_(box), face_(face) {}

  [[nodiscard]] Vec3 point(const Vec2& q) const override { return cell::in_face(box_, face_, q); }
  [[nodiscard]] Vec3 normal(const Vec2& /*q*/) const override {
    Vec3 n = Vec3::Zero();
    n[cell::axis_of(face_)] = cell::is_high(face_) ? 1 : -1;
    return n;
  }
  [[nodiscard]] Place nearest(const Vec2& /*start*/, const Vec3& target) const override {
    const Vec2 q = cell::flat(target, face_);
    return {q, point(q)};
  }

 private:
  const Box3& box_;
  int face_;
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

// The region to the left of each directed edge in a face; without those of the matrix where there is none.
std::map<Edge, std::size_t> edges_of(const CellShape& shape, const CellCurves& curves, int face,
                                     bool matrix) {
  std::map<Edge, std::size_t> result;
  const auto& regions = shape.division.regions;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (regions[r].face != face || (!matrix && body_of(regions[r]) == CellTriangles::matrix)) continue;
    for (const cell::Outline& outline : regions[r].outlines) {
      const std::vector<std::uint32_t> nodes = outline_nodes(curves, outline);
      for (std::size_t k = 0; k < nodes.size(); ++k) result[{nodes[k], nodes[(k + 1) % nodes.size()]}] = r;
    }
  }
  return result;
}

struct FaceMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> known;  // the cell's nodes of its fixed points
};

Result<FaceMesh> mesh_face(const CellShape& shape, const std::map<Edge, std::size_t>& edges, int face,
                           const SizeField& field, const SurfaceOptions& options, const CellNodes& nodes) {
  const FaceSupport support(shape.box, face);
  PlanarRegion region;
  FaceMesh result;
  std::map<std::uint32_t, std::uint32_t> number;
  const auto point_of = [&](std::uint32_t node) {
    const auto [at, is_new] = number.emplace(node, static_cast<std::uint32_t>(result.known.size()));
    if (is_new) {
      result.known.push_back(node);
      region.points.push_back(nodes.points[node]);
      region.parameters.push_back(cell::flat(nodes.points[node], face));
    }
    return at->second;
  };
  for (const auto& [edge, left] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (back != edges.end() && edge.first > edge.second) continue;
    const std::int32_t right = back == edges.end() ? -1 : static_cast<std::int32_t>(back->second);
    region.segments.push_back(
        {point_of(edge.first), point_of(edge.second), static_cast<std::int32_t>(left), right});
  }
  Result<TriangleMesh> mesh = fill(region, support, field, options.most_triangles);
  if (!mesh) {
    mesh.error().text += " in the " + cell::name_of_face(face) + " face of the cell";
    return mesh.error();
  }
  result.mesh = std::move(*mesh);
  remesh(result.mesh, support, field);
  return result;
}

}  // namespace

Status add_box_faces(const CellShape& shape, const CellCurves& curves, const SizeField& field,
                     const SurfaceOptions& options, CellNodes& nodes, CellTriangles& result) {
  const auto& regions = shape.division.regions;
  const auto add = [&](const Triangle& t, const cell::FaceRegion& region) {
    result.add(t, {body_of(region), Sides::outside}, CellTriangles::Part::box);
  };
  for (int face = 0; face < cell::face_count; ++face) {
    const int a = cell::axis_of(face);
    const bool is_periodic = shape.periodic[static_cast<std::size_t>(a)];
    if (is_periodic && cell::is_high(face)) continue;
    const std::map<Edge, std::size_t> edges = edges_of(shape, curves, face, options.matrix);
    if (edges.empty()) continue;
    Result<FaceMesh> made = mesh_face(shape, edges, face, field, options, nodes);
    if (!made) return made.error();
    const TriangleMesh& mesh = made->mesh;
    std::vector<std::uint32_t> number = made->known, opposite;
    for (std::size_t k = number.size(); k < mesh.points.size(); ++k)
      number.push_back(nodes.add(mesh.points[k], {no_body, Vec2::Zero()}));
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const auto& t = mesh.triangles[k];
      add({number[t[0]], number[t[1]], number[t[2]]}, regions[static_cast<std::size_t>(mesh.domains[k])]);
    }
    if (!is_periodic) continue;

    const auto& across = curves.opposite[static_cast<std::size_t>(a)];
    for (std::size_t k = 0; k < number.size(); ++k) {
      if (k < made->known.size()) {
        opposite.push_back(across.at(number[k]));
        continue;
      }
      Vec3 moved = mesh.points[k];
      moved[a] = shape.box.max()[a];
      opposite.push_back(nodes.add(moved, {no_body, Vec2::Zero()}));
    }
    // What is behind the high face, region by region: by an edge of each.
    const std::map<Edge, std::size_t> high = edges_of(shape, curves, face + 1, options.matrix);
    std::map<std::int32_t, std::size_t> region_of;
    for (const auto& [edge, left] : edges) {
      const auto found = high.find({across.at(edge.second), across.at(edge.first)});
      if (found == high.end() || (body_of(regions[found->second]) == CellTriangles::matrix) !=
                                     (body_of(regions[left]) == CellTriangles::matrix)) {
        Message message = error(Kind::geometry,
                                "opposite faces of the cell are divided in different ways: "
                                "the yarns do not repeat there");
        message.at = nodes.points[edge.first];
        return message;
      }
      region_of[static_cast<std::int32_t>(left)] = found->second;
    }
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const auto& t = mesh.triangles[k];
      add({opposite[t[0]], opposite[t[2]], opposite[t[1]]}, regions[region_of.at(mesh.domains[k])]);
    }
  }
  return {};
}

}  // namespace selvage::fem
