#include "contact/tube_mesh.h"

#include <algorithm>
#include <cmath>

#include "nurbs/divided.h"
#include "nurbs/samples.h"

namespace selvage::contact {

namespace {

constexpr int quads_round = 64;
constexpr double quads_a_thickness = 6.0;

class TubeMesher {
 public:
  TubeMesher(const CellModel& model, std::size_t body, const Stretch& stretch)
      : model_(model), body_(body), stretch_(stretch), side_(model.side(body)) {}

  Mesh run() {
    const Face& face = model_.faces()[side_];
    const nurbs::Surface& s = *face.surface;
    const std::vector<double> us = nurbs::divided(s.knots_u, s.degree_u, 1, quads_round);
    std::vector<double> vs = rows(us);
    for (double& v : vs) v = within(v);
    add_points(s, us, vs);
    side_rows_ = vs.size();
    add_grid(us.size(), 0, side_, face.inward);
    for (const bool last : {false, true}) close(us.size(), last);
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] double within(double v) const {
    const Face& face = model_.faces()[side_];
    return face.round_v ? wrapped(v, face.surface->first_v(), face.surface->last_v()) : v;
  }

  void add_points(const nurbs::Surface& s, const std::vector<double>& us, const std::vector<double>& vs) {
    for (const Vec3& p : nurbs::evaluate_grid(s, us, vs)) mesh_.vertices.push_back(p);
    for (const double v : vs)
      for (const double u : us) mesh_.sites.emplace_back(u, v);
  }

  // Knots in the stretch, and rows between them so that no quad is too long.
  [[nodiscard]] std::vector<double> rows(const std::vector<double>& us) const {
    const Face& face = model_.faces()[side_];
    const nurbs::Surface& s = *face.surface;
    const double period = s.last_v() - s.first_v();
    std::vector<double> places = {stretch_.first};
    for (int turn = face.round_v ? -1 : 0; turn <= (face.round_v ? 1 : 0); ++turn)
      for (const double v : nurbs::breakpoints(s.knots_v, s.degree_v))
        if (v + turn * period > places.back() && v + turn * period < stretch_.last)
          places.push_back(v + turn * period);
    places.push_back(stretch_.last);
    const double longest = model_.thickness(body_) / quads_a_thickness;
    const std::vector<double> some = {us[0], us[us.size() / 4], us[us.size() / 2], us[3 * us.size() / 4]};
    return nurbs::divided(places, [&](std::size_t k) {
      std::vector<double> vs;
      for (int i = 0; i <= 4; ++i) vs.push_back(within(places[k] + (places[k + 1] - places[k]) * i / 4.0));
      const nurbs::Samples samples(s, some, vs);
      const double length = samples.largest<5>(true, 0, nurbs::length_of<std::array<Vec3, 5>>);
      return nurbs::whole_parts(length / longest, 1, 10'000);
    });
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool flip, std::int32_t face) {
    if (flip) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
    mesh_.faces.push_back(face);
  }

  // The grid of vertices from `first` on, to the end of the list.
  void add_grid(std::size_t columns, std::size_t first, std::uint32_t face, bool inward) {
    const auto n = static_cast<std::uint32_t>(columns);
    const auto index = static_cast<std::int32_t>(face);
    for (auto k = static_cast<std::uint32_t>(first); k + n < mesh_.vertices.size(); ++k) {
      if ((k - first) % n + 1 == n) continue;
      add_triangle(k, k + 1, k + n + 1, inward, index);
      add_triangle(k, k + n + 1, k + n, inward, index);
    }
  }

  void close(std::size_t columns, bool last) {
    const Face& face = model_.faces()[side_];
    const nurbs::Surface& s = *face.surface;
    const bool at_end = !face.round_v && (last ? stretch_.last >= s.last_v() : stretch_.first <= s.first_v());
    if (const std::optional<std::uint32_t> end = at_end ? model_.end(body_, last) : std::nullopt) {
      const nurbs::Surface& e = *model_.faces()[*end].surface;
      const std::vector<double> us = nurbs::divided(e.knots_u, e.degree_u, 1, 16),
                                vs = nurbs::divided(e.knots_v, e.degree_v, 1, 16);
      const std::size_t first = mesh_.vertices.size();
      add_points(e, us, vs);
      add_grid(us.size(), first, *end, model_.faces()[*end].inward);
      return;
    }
    const auto begin = static_cast<std::uint32_t>(last ? (side_rows_ - 1) * columns : 0);
    Vec3 centre = Vec3::Zero();
    for (std::uint32_t i = 0; i + 1 < columns; ++i)
      centre += mesh_.vertices[begin + i] / static_cast<double>(columns - 1);
    const auto middle = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(centre);
    mesh_.sites.emplace_back(Vec2::Zero());
    for (std::uint32_t i = 0; i + 1 < columns; ++i)
      add_triangle(middle, begin + i, begin + i + 1, face.inward == last, Mesh::cut);
  }

  const CellModel& model_;
  std::size_t body_;
  Stretch stretch_;
  std::uint32_t side_;
  Mesh mesh_;
  std::size_t side_rows_ = 0;
};

}  // namespace

Mesh tube_mesh(const CellModel& model, std::size_t body, const Stretch& stretch) {
  return TubeMesher(model, body, stretch).run();
}

bool ray_meets(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  // The sides of the triangle as seen along x: the same sign all round when the ray passes inside.
  const auto side = [&](const Vec3& from, const Vec3& to) {
    return (to.y() - from.y()) * (point.z() - from.z()) - (to.z() - from.z()) * (point.y() - from.y());
  };
  const double ab = side(a, b), bc = side(b, c), ca = side(c, a);
  if ((ab > 0.0) != (bc > 0.0) || (ab > 0.0) != (ca > 0.0)) return false;
  const double sum = ab + bc + ca;
  if (sum == 0.0) return false;
  return (bc * a.x() + ca * b.x() + ab * c.x()) / sum > point.x();
}

namespace {

Eigen::Matrix3d odd_turn() {
  return (Eigen::AngleAxisd(0.7321, Vec3(0.31, 0.52, 0.77).normalized())).toRotationMatrix();
}

std::vector<Vec3> turned(const std::vector<Vec3>& points) {
  const Eigen::Matrix3d turn = odd_turn();
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Vec3& p : points) out.emplace_back(turn * p);
  return out;
}

}  // namespace

Inside::Inside(const Mesh& mesh)
    : mesh_(mesh), turned_(turned(mesh.vertices)), tree_(boxes_of(turned_, mesh.triangles)) {}

bool Inside::contains(const Vec3& point) const {
  const Vec3 p = odd_turn() * point;
  bool inside = false;
  tree_.along_ray(p, [&](std::uint32_t k) {
    const auto& t = mesh_.triangles[k];
    if (ray_meets(p, turned_[t[0]], turned_[t[1]], turned_[t[2]])) inside = !inside;
  });
  return inside;
}

}  // namespace selvage::contact
