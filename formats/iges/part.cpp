#include "formats/iges/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "formats/iges/header.h"

namespace selvage::formats::iges {

namespace {

bool is_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}
bool is_finite(const std::vector<Vec3>& points) {
  return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
}
bool is_finite(const nurbs::Curve& curve) {
  return is_finite(curve.points) && is_finite(curve.knots) && is_finite(curve.weights);
}

// A pole: an edge that has no length.
bool is_pole(const cad::Edge& edge) {
  return edge.curve.points.empty();
}

bool has_all_flats(const cad::Loop& loop) {
  return std::none_of(loop.edges.begin(), loop.edges.end(),
                      [](const cad::Edge& edge) { return edge.flat.points.empty(); });
}
// An edge that has a length, but no curve in space.
bool lacks_curve(const cad::Edge& edge, const nurbs::Surface& surface) {
  if (!is_pole(edge) || edge.flat.points.empty()) return false;
  const auto at = [&](double share) {
    const Vec3 p =
        nurbs::evaluate(edge.flat, std::lerp(edge.flat.first_parameter(), edge.flat.last_parameter(), share));
    return nurbs::evaluate(surface, p.x(), p.y());
  };
  Box3 box;
  for (const Vec3& p : surface.points) box.extend(p);
  const Vec3 start = at(0);
  for (const double share : {0.31, 0.5, 0.77, 1.0})
    if ((at(share) - start).norm() > 1e-6 * box.sizes().norm()) return true;
  return false;
}
// Poles aside; their places can be told by their neighbours, unless there are none.
bool has_all_curves(const cad::Loop& loop, const nurbs::Surface& surface) {
  return !std::all_of(loop.edges.begin(), loop.edges.end(), is_pole) &&
         std::none_of(loop.edges.begin(), loop.edges.end(),
                      [&](const cad::Edge& edge) { return lacks_curve(edge, surface); });
}

// What is written of one entity: colour, level, label and name.
struct Look {
  Common common;
  std::string name;  // ASCII: what `common` looks at
};

struct Shared;

class PartWriter {
 public:
  PartWriter(Records& records, ColorSource& colors) : records_(records), colors_(colors) {}

  int part(const cad::Part& part);
  int curve(const cad::NamedCurve& curve);

 private:
  // Its 406, too: written at once, so that the pointer is known.
  void look(Look& look, const std::string& name, const std::optional<cad::Color>& color, int level) {
    look.name = ascii(name);
    look.common.color = colors_.pointer(color);
    look.common.level = level;
    look.common.label = look.name;
    look.common.name = look.name.empty() ? 0 : write_name(records_, look.common, look.name);
  }
  int chain(const Common& common, const std::vector<const nurbs::Curve*>& curves, std::string_view status);
  int boundary(const Common& common, int pointer, const nurbs::Surface& surface, const cad::Loop& loop);
  int face(const cad::Face& face);
  void lists(Shared& shared, const Common& common, const cad::Part& part);
  int loop(Shared& shared, const Common& common, const cad::Loop& loop);
  int face_of_solid(Shared& shared, const cad::Face& face);
  int solid(const cad::Part& part);

  Records& records_;
  ColorSource& colors_;
};

// A 102 of 126s, or the only one.
int PartWriter::chain(const Common& common, const std::vector<const nurbs::Curve*>& curves,
                      std::string_view status) {
  const Vec3 up = Vec3::UnitZ();
  const Vec3* const normal = status == dependent_in_2d ? &up : nullptr;
  std::vector<int> parts;
  parts.reserve(curves.size());
  for (const nurbs::Curve* const curve : curves)
    parts.push_back(write_curve(records_, common.entity(126, 0, status), *curve, normal));
  if (parts.size() == 1) return parts.front();
  const int pointer = records_.begin(common.entity(102, 0, status));
  records_.integer(static_cast<std::int64_t>(parts.size()));
  for (const int part : parts) records_.integer(part);
  records_.end();
  return pointer;
}

nurbs::Curve still(const Vec3& at) {
  return {.degree = 1, .knots = {0, 0, 1, 1}, .points = {at, at}, .weights = {}};
}

// The poles as curves without length, so that edges in space and in the parameters go together.
int PartWriter::boundary(const Common& common, int pointer, const nurbs::Surface& surface,
                         const cad::Loop& loop) {
  std::vector<const nurbs::Curve*> flats, curves;
  std::vector<nurbs::Curve> poles(loop.edges.size());
  for (std::size_t i = 0; i < loop.edges.size(); ++i) {
    const cad::Edge& edge = loop.edges[i];
    flats.push_back(&edge.flat);
    curves.push_back(&edge.curve);
    if (!is_pole(edge)) continue;
    for (std::size_t k = 1; k < loop.edges.size(); ++k) {
      const cad::Edge& before = loop.edges[(i + loop.edges.size() - k) % loop.edges.size()];
      if (is_pole(before)) continue;
      poles[i] = still(nurbs::evaluate(before.curve, before.curve.last_parameter()));
      break;
    }
    curves.back() = &poles[i];
  }
  const int flat = has_all_flats(loop) ? chain(common, flats, dependent_in_2d) : 0;
  const int spatial = has_all_curves(loop, surface) ? chain(common, curves, dependent) : 0;
  return write_boundary(records_, common, pointer, flat, spatial);
}

int PartWriter::face(const cad::Face& face) {
  Look own;
  look(own, face.name, face.color, face.level);
  if (face.loops.empty())
    return write_surface(records_, own.common.entity(128), face.surface, own.common.name);
  Common inner = own.common;
  inner.name = 0;
  const int surface = write_surface(records_, inner.entity(128, 0, dependent), face.surface);
  std::vector<int> boundaries;
  for (const cad::Loop& loop : face.loops) boundaries.push_back(boundary(inner, surface, face.surface, loop));
  const int pointer = records_.begin(own.common.entity(144));
  records_.integer(surface);
  records_.integer(1);  // the outer boundary is not the surface's own
  records_.integer(static_cast<std::int64_t>(boundaries.size()) - 1);
  for (const int each : boundaries) records_.integer(each);
  records_.end(own.common.name);
  return pointer;
}

// One edge of a solid, in the direction in which it was first met.
struct SharedEdge {
  const nurbs::Curve* curve = nullptr;
  std::size_t index = 0, from = 0, to = 0;
};

// Vertices that two edges share to the bit, or nearly, are one.
class Vertices {
 public:
  explicit Vertices(double tolerance) : tolerance_(tolerance) {}
  std::size_t at(const Vec3& p) {
    const auto known = exact_.find({p.x(), p.y(), p.z()});
    if (known != exact_.end()) return known->second;
    std::size_t index = 0;
    while (index < points_.size() && (points_[index] - p).norm() > tolerance_) ++index;
    if (index == points_.size()) points_.push_back(p);
    exact_[{p.x(), p.y(), p.z()}] = index;
    return index;
  }
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }

 private:
  double tolerance_;
  std::vector<Vec3> points_;
  std::map<std::array<double, 3>, std::size_t> exact_;
};

// Does it run as the shared curve does?
bool runs_along(const cad::Edge& edge, const nurbs::Curve& curve) {
  const Vec3 start = nurbs::evaluate(edge.curve, edge.curve.first_parameter());
  const Vec3 from = nurbs::evaluate(curve, curve.first_parameter());
  const Vec3 to = nurbs::evaluate(curve, curve.last_parameter());
  if ((from - to).norm() > 1e-9 * ((from - start).norm() + (to - start).norm()))
    return (start - from).norm() <= (start - to).norm();
  // A closed one: by a place inside.
  const auto inside = [](const nurbs::Curve& c, double share) {
    return nurbs::evaluate(c, std::lerp(c.first_parameter(), c.last_parameter(), share));
  };
  const Vec3 p = inside(edge.curve, 0.3);
  return (p - inside(curve, 0.3)).norm() <= (p - inside(curve, 0.7)).norm();
}

// What the faces of a solid share.
struct Shared {
  explicit Shared(double tolerance) : vertices(tolerance) {}

  std::size_t end_of(const cad::Edge& edge) {
    return vertices.at(nurbs::evaluate(edge.curve, edge.curve.last_parameter()));
  }

  Vertices vertices;
  std::map<int, SharedEdge> edges;          // by id
  std::vector<const SharedEdge*> in_order;  // as met
  int vertex_list = 0, edge_list = 0;
};

void PartWriter::lists(Shared& shared, const Common& common, const cad::Part& part) {
  for (const cad::Face& face : part.faces)
    for (const cad::Loop& loop : face.loops)
      for (const cad::Edge& edge : loop.edges) {
        if (is_pole(edge) || shared.edges.count(edge.id) != 0) continue;
        SharedEdge& made = shared.edges[edge.id];
        made.curve = &edge.curve;
        made.from = shared.vertices.at(nurbs::evaluate(edge.curve, edge.curve.first_parameter()));
        made.to = shared.end_of(edge);
        made.index = shared.in_order.size();
        shared.in_order.push_back(&made);
      }
  std::vector<int> curves;
  for (const SharedEdge* const edge : shared.in_order)
    curves.push_back(write_curve(records_, common.entity(126, 0, dependent), *edge->curve, nullptr));
  shared.vertex_list = records_.begin(common.entity(502, 1, dependent));
  records_.integer(static_cast<std::int64_t>(shared.vertices.points().size()));
  records_.points(shared.vertices.points());
  records_.end();
  shared.edge_list = records_.begin(common.entity(504, 1, dependent));
  records_.integer(static_cast<std::int64_t>(shared.in_order.size()));
  for (const SharedEdge* const edge : shared.in_order) {
    records_.integer(curves[edge->index]);
    for (const std::size_t vertex : {edge->from, edge->to}) {
      records_.integer(shared.vertex_list);
      records_.integer(static_cast<std::int64_t>(vertex) + 1);
    }
  }
  records_.end();
}

int PartWriter::loop(Shared& shared, const Common& common, const cad::Loop& loop) {
  std::vector<int> flats;
  std::size_t vertex = 0;  // where a pole that comes first stands
  for (const cad::Edge& edge : loop.edges) {
    flats.push_back(edge.flat.points.empty() ? 0 : chain(common, {&edge.flat}, dependent_in_2d));
    if (!is_pole(edge)) vertex = shared.end_of(edge);
  }
  const int pointer = records_.begin(common.entity(508, 1, dependent));
  records_.integer(static_cast<std::int64_t>(loop.edges.size()));
  for (std::size_t i = 0; i < loop.edges.size(); ++i) {
    const cad::Edge& edge = loop.edges[i];
    const bool pole = is_pole(edge);
    if (!pole) vertex = shared.end_of(edge);
    records_.integer(pole ? 1 : 0);
    records_.integer(pole ? shared.vertex_list : shared.edge_list);
    records_.integer(static_cast<std::int64_t>(pole ? vertex : shared.edges[edge.id].index) + 1);
    records_.integer(pole || runs_along(edge, *shared.edges[edge.id].curve) ? 1 : 0);
    records_.integer(flats[i] != 0 ? 1 : 0);
    if (flats[i] == 0) continue;
    records_.integer(0);  // not said to be along a parameter
    records_.integer(flats[i]);
  }
  records_.end();
  return pointer;
}

int PartWriter::face_of_solid(Shared& shared, const cad::Face& face) {
  Look own;
  look(own, face.name, face.color, face.level);
  Common inner = own.common;
  inner.name = 0;
  const int surface = write_surface(records_, inner.entity(128, 0, dependent), face.surface);
  std::vector<int> loops;
  for (const cad::Loop& each : face.loops) loops.push_back(loop(shared, inner, each));
  const int pointer = records_.begin(own.common.entity(510, 1, dependent));
  records_.integer(surface);
  records_.integer(static_cast<std::int64_t>(loops.size()));
  records_.integer(1);  // the first is the outer one
  for (const int each : loops) records_.integer(each);
  records_.end(own.common.name);
  return pointer;
}

int PartWriter::solid(const cad::Part& part) {
  Box3 box;
  for (const cad::Face& face : part.faces)
    for (const Vec3& p : face.surface.points) box.extend(p);
  Shared shared(1e-7 * box.sizes().norm());
  Look own;
  look(own, part.name, part.color, part.level);
  Common inner = own.common;
  inner.name = 0;
  lists(shared, inner, part);
  std::vector<int> faces;
  for (const cad::Face& face : part.faces) faces.push_back(face_of_solid(shared, face));
  const int shell = records_.begin(inner.entity(514, 1, dependent));
  records_.integer(static_cast<std::int64_t>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) {
    records_.integer(faces[i]);
    records_.integer(part.faces[i].reversed ? 0 : 1);
  }
  records_.end();
  const int pointer = records_.begin(own.common.entity(186));
  records_.integer(shell);
  records_.integer(1);  // the shell's orientation is that of its faces
  records_.integer(0);  // no voids
  records_.end(own.common.name);
  return pointer;
}

int PartWriter::part(const cad::Part& part) {
  if (is_written_as_solid(part)) return solid(part);
  std::vector<int> faces;
  for (const cad::Face& each : part.faces) faces.push_back(face(each));
  const cad::Face& first = part.faces.front();
  if (faces.size() == 1 && part.group.empty() && first.name == part.name && first.color == part.color &&
      first.level == part.level)
    return faces.front();
  Look own;
  look(own, part.name, part.color, part.level);
  return write_group(records_, own.common, faces);
}

int PartWriter::curve(const cad::NamedCurve& curve) {
  Look own;
  look(own, curve.name, curve.color, curve.level);
  return write_curve(records_, own.common.entity(126), curve.curve, nullptr, own.common.name);
}

}  // namespace

std::string fault_of(const cad::Part& part) {
  if (part.faces.empty()) return "has no faces";
  for (const cad::Face& face : part.faces) {
    if (!is_finite(face.surface.points) || !is_finite(face.surface.weights) ||
        !is_finite(face.surface.knots_u) || !is_finite(face.surface.knots_v))
      return "has a coordinate, weight or knot that is not a finite number";
    for (const cad::Loop& loop : face.loops) {
      for (const cad::Edge& edge : loop.edges)
        if (!is_finite(edge.curve) || !is_finite(edge.flat))
          return "has an edge with a number that is not finite";
      if (!has_all_flats(loop) && !has_all_curves(loop, face.surface))
        return "has a loop whose curves are known neither all in space nor all in the surface's parameters";
    }
  }
  return {};
}

namespace {

// Do all faces hang together by edges of one id?
bool is_one_shell(const cad::Part& part) {
  std::map<int, std::vector<std::size_t>> faces_of;
  for (std::size_t i = 0; i < part.faces.size(); ++i)
    for (const cad::Loop& loop : part.faces[i].loops)
      for (const cad::Edge& edge : loop.edges) faces_of[edge.id].push_back(i);
  std::vector<bool> reached(part.faces.size(), false);
  std::vector<std::size_t> open = {0};
  reached[0] = true;
  std::size_t count = 0;
  while (!open.empty()) {
    const cad::Face& face = part.faces[open.back()];
    open.pop_back();
    ++count;
    for (const cad::Loop& loop : face.loops)
      for (const cad::Edge& edge : loop.edges) {
        if (is_pole(edge)) continue;
        for (const std::size_t next : faces_of[edge.id]) {
          if (reached[next]) continue;
          reached[next] = true;
          open.push_back(next);
        }
      }
  }
  return count == part.faces.size();
}

}  // namespace

bool is_written_as_solid(const cad::Part& part) {
  if (part.kind != cad::Part::Kind::solid || !cad::has_shared_edges(part)) return false;
  for (const cad::Face& face : part.faces)
    for (const cad::Loop& loop : face.loops)
      for (const cad::Edge& edge : loop.edges)
        if (lacks_curve(edge, face.surface)) return false;
  return is_one_shell(part);
}

std::int64_t most_values_of_part(const cad::Part& part) {
  std::size_t values = 1000;
  for (const cad::Face& face : part.faces) {
    values +=
        100 + 4 * face.surface.points.size() + face.surface.knots_u.size() + face.surface.knots_v.size();
    for (const cad::Loop& loop : face.loops)
      for (const cad::Edge& edge : loop.edges)
        values += 100 + 5 * (edge.curve.points.size() + edge.flat.points.size()) + edge.curve.knots.size() +
                  edge.flat.knots.size();
  }
  return static_cast<std::int64_t>(values);
}

int write_part(Records& records, ColorSource& colors, const cad::Part& part) {
  return PartWriter(records, colors).part(part);
}

int write_free_curve(Records& records, ColorSource& colors, const cad::NamedCurve& curve) {
  return PartWriter(records, colors).curve(curve);
}

}  // namespace selvage::formats::iges
