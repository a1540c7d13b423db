#include "formats/step/yarn_faces.h"

#include <bit>

namespace selvage::formats::step {

namespace {

using nurbs::Curve;
using nurbs::Surface;
using yarn::EndStyle;

constexpr const char* no_form = ".UNSPECIFIED.";

// Knots as STEP has them: each value once, with its multiplicity.
struct KnotList {
  std::vector<int> multiplicities;
  std::vector<double> values;
};

KnotList knot_list(const std::vector<double>& knots) {
  KnotList list;
  for (const double knot : knots) {
    if (list.values.empty() || knot != list.values.back()) {
      list.values.push_back(knot);
      list.multiplicities.push_back(0);
    }
    ++list.multiplicities.back();
  }
  return list;
}

// Weights as STEP has what stands in a net: a row for each u, in it v.
std::vector<std::vector<double>> weight_rows(const Surface& surface) {
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(surface.count_u));
  for (int i = 0; i < surface.count_u; ++i)
    for (int j = 0; j < surface.count_v; ++j)
      rows[static_cast<std::size_t>(i)].push_back(surface.weights[surface.index(i, j)]);
  return rows;
}

}  // namespace

std::pair<Id, bool> YarnFaces::number_of(const Vec3& at) {
  const Bits bits{{std::bit_cast<std::uint64_t>(at.x()), std::bit_cast<std::uint64_t>(at.y()),
                   std::bit_cast<std::uint64_t>(at.z())}};
  const auto [known, is_new] = points_.try_emplace(bits);
  if (is_new) known->second = text_.reserve();
  return {known->second, is_new};
}

Id YarnFaces::point(const Vec3& at) {
  const auto [id, is_new] = number_of(at);
  if (is_new) text_.put_points({{id, at}});
  return id;
}

Id YarnFaces::curve(const Curve& curve) {
  std::vector<Id> points;
  for (const Vec3& at : curve.points) points.push_back(point(at));
  const KnotList knots = knot_list(curve.knots);
  const Flag is_closed{points.front().number == points.back().number};
  if (!curve.is_rational())
    return text_.put("B_SPLINE_CURVE_WITH_KNOTS", "''", curve.degree, points, no_form, is_closed, Flag{false},
                     knots.multiplicities, knots.values, no_form);
  const Id id = text_.reserve();
  text_.begin(id);
  text_.token("( ");
  text_.part("BOUNDED_CURVE");
  text_.token(" ");
  text_.part("B_SPLINE_CURVE", curve.degree, points, no_form, is_closed, Flag{false});
  text_.token(" ");
  text_.part("B_SPLINE_CURVE_WITH_KNOTS", knots.multiplicities, knots.values, no_form);
  text_.token(" CURVE() GEOMETRIC_REPRESENTATION_ITEM() ");
  text_.part("RATIONAL_B_SPLINE_CURVE", curve.weights);
  text_.token(" REPRESENTATION_ITEM('') )");
  text_.end();
  return id;
}

Id YarnFaces::surface(const Surface& surface, bool is_closed_u, bool is_closed_v) {
  const auto rows = static_cast<std::size_t>(surface.count_u),
             length = static_cast<std::size_t>(surface.count_v);
  std::vector<Id> grid(rows * length);
  std::vector<EntityText::Point> new_points;
  new_points.reserve(grid.size());
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 0; i < surface.count_u; ++i) {
      const bool is_border = i == 0 || j == 0 || i == surface.count_u - 1 || j == surface.count_v - 1;
      const Vec3& at = surface.point(i, j);
      const auto [id, is_new] = is_border ? number_of(at) : std::pair(text_.reserve(), true);
      grid[static_cast<std::size_t>(i) * length + static_cast<std::size_t>(j)] = id;
      if (is_new) new_points.push_back({id, at});
    }
  text_.put_points(std::move(new_points));
  const Net points{std::move(grid), rows};
  const KnotList u = knot_list(surface.knots_u), v = knot_list(surface.knots_v);
  const Flag closed_u{is_closed_u}, closed_v{is_closed_v}, crosses_itself{false};
  if (!surface.is_rational())
    return text_.put("B_SPLINE_SURFACE_WITH_KNOTS", "''", surface.degree_u, surface.degree_v, points, no_form,
                     closed_u, closed_v, crosses_itself, u.multiplicities, v.multiplicities, u.values,
                     v.values, no_form);
  const Id id = text_.reserve();
  text_.begin(id);
  text_.token("( ");
  text_.part("BOUNDED_SURFACE");
  text_.token(" ");
  text_.part("B_SPLINE_SURFACE", surface.degree_u, surface.degree_v, points, no_form, closed_u, closed_v,
             crosses_itself);
  text_.token(" ");
  text_.part("B_SPLINE_SURFACE_WITH_KNOTS", u.multiplicities, v.multiplicities, u.values, v.values, no_form);
  text_.token(" ");
  text_.token("GEOMETRIC_REPRESENTATION_ITEM() ");
  text_.part("RATIONAL_B_SPLINE_SURFACE", weight_rows(surface));
  text_.token(" ");
  text_.token("REPRESENTATION_ITEM('') SURFACE() )");
  text_.end();
  return id;
}

Id YarnFaces::edge(const Curve& along, Id from, Id to) {
  return text_.put("EDGE_CURVE", "''", from, to, curve(along), Flag{true});
}

YarnFaces::Outline YarnFaces::outline(const yarn::Body& body, bool last) {
  Outline outline;
  if ((last ? body.end : body.start).style == EndStyle::patch) {
    const std::array<Curve, 4> quarters = yarn::end_quarters(body, last);
    for (const Curve& quarter : quarters) outline.corners.push_back(vertex(quarter.points.front()));
    for (std::size_t i = 0; i < 4; ++i)
      outline.edges.push_back(edge(quarters[i], outline.corners[i], outline.corners[(i + 1) % 4]));
  } else {
    const Curve whole = yarn::end_curve(body, last);
    outline.corners.push_back(vertex(whole.points.front()));
    outline.edges.push_back(edge(whole, outline.corners[0], outline.corners[0]));
  }
  return outline;
}

// A loop runs counter-clockwise about the normal of its face, which is the surface's or points against it.
void YarnFaces::face(Id surface, const std::vector<Use>& loop, bool is_inward) {
  std::vector<Id> uses;
  uses.reserve(loop.size());
  for (const Use& use : loop)
    uses.push_back(text_.put("ORIENTED_EDGE", "''", "*", "*", use.edge, Flag{use.is_forward}));
  const Id bound = text_.put("FACE_OUTER_BOUND", "''", text_.put("EDGE_LOOP", "''", uses), Flag{!is_inward});
  faces_.push_back(text_.put("ADVANCED_FACE", "''", std::array{bound}, surface, Flag{!is_inward}));
}

void YarnFaces::tube(const yarn::Body& body, const Outline& start, const Outline& end) {
  const Id side = surface(body.surface, true, false);
  const Id seam = edge(nurbs::boundary_column(body.surface, false), start.corners[0], end.corners[0]);
  std::vector<Use> loop;
  for (const Id along : start.edges) loop.push_back({along, true});
  loop.push_back({seam, true});
  for (auto along = end.edges.rbegin(); along != end.edges.rend(); ++along) loop.push_back({*along, false});
  loop.push_back({seam, false});
  face(side, loop, body.inward);
}

void YarnFaces::ring(const yarn::Body& body) {
  const Id side = surface(body.surface, true, true);
  const Id corner = vertex(body.surface.point(0, 0));
  const Id round = edge(yarn::end_curve(body, false), corner, corner);
  const Id along = edge(nurbs::boundary_column(body.surface, false), corner, corner);
  face(side, {{round, true}, {along, true}, {round, false}, {along, false}}, body.inward);
}

void YarnFaces::end_face(const yarn::Body& body, const Outline& outline, bool last) {
  const yarn::EndFace& end = last ? body.end : body.start;
  std::vector<Use> loop;
  if (end.style == EndStyle::patch) {
    const Id cap = surface(end.surface, false, false);
    for (const Id along : outline.edges) loop.push_back({along, true});
    face(cap, loop, end.inward);
  } else if (end.style == EndStyle::fan) {
    const Id cap = surface(end.surface, true, false);
    const Id centre = vertex(end.surface.point(0, end.surface.count_v - 1));
    const Id seam = edge(nurbs::boundary_column(end.surface, false), outline.corners[0], centre);
    face(cap, {{outline.edges[0], true}, {seam, true}, {seam, false}}, end.inward);
  } else if (end.style == EndStyle::planar) {
    const Id place = text_.put("AXIS2_PLACEMENT_3D", "''", new_point(end.origin), direction(end.normal),
                               direction(end.normal.unitOrthogonal()));
    // Seen from outside, the outline runs against the body's use of it.
    face(text_.put("PLANE", "''", place), {{outline.edges[0], last != body.inward}}, false);
  }
}

YarnFaces::Shape YarnFaces::write(const yarn::Body& body) {
  points_.clear();
  faces_.clear();
  bool is_closed = true;
  if (body.closed_along) {
    ring(body);
  } else {
    const Outline start = outline(body, false), end = outline(body, true);
    tube(body, start, end);
    end_face(body, start, false);
    end_face(body, end, true);
    is_closed = body.start.style != EndStyle::none && body.end.style != EndStyle::none;
  }
  const Quoted name{body.name};
  const Id shell = text_.put(is_closed ? "CLOSED_SHELL" : "OPEN_SHELL", "''", faces_);
  if (is_closed) return {text_.put("MANIFOLD_SOLID_BREP", name, shell), true};
  return {text_.put("SHELL_BASED_SURFACE_MODEL", name, std::array{shell}), false};
}

}  // namespace selvage::formats::step
