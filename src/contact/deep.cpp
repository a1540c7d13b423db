#include "contact/deep.h"

#include <algorithm>
#include <cmath>

#include "contact/overlay.h"
#include "contact/shared_space.h"
#include "contact/spot.h"
#include "core/bounds.h"
#include "core/plane.h"

namespace selvage::contact {

namespace {

constexpr int close_lines = 24, close_steps = 8;

// The parts of a face's cells within `half` of a site.
std::vector<Part> parts_about(const CellModel& model, std::uint32_t index, const Vec2& site,
                              const Vec2& half) {
  const Face& face = model.faces()[index];
  const nurbs::Surface& s = *face.surface;
  const double period_u = s.last_u() - s.first_u(), period_v = s.last_v() - s.first_v();
  std::vector<Part> parts;
  for (std::uint32_t k = face.rows.front(); k < face.rows.back() + face.count_u; ++k)
    for (int i = face.round_u ? -1 : 0; i <= (face.round_u ? 1 : 0); ++i)
      for (int j = face.round_v ? -1 : 0; j <= (face.round_v ? 1 : 0); ++j) {
        const Vec2 middle = site + Vec2(i * period_u, j * period_v);
        const Cell& cell = model.cells()[k];
        const Vec2 low = cell.low.cwiseMax(middle - half), high = cell.high.cwiseMin(middle + half);
        if ((low.array() < high.array()).all()) parts.push_back({k, low, high});
      }
  return parts;
}

class DeepMeasurer {
 public:
  DeepMeasurer(const CellModel& model, std::size_t a, const Stretch& stretch_a, std::size_t b,
               const Stretch& stretch_b, double touching)
      : model_(model), a_(a), b_(b), stretch_a_(stretch_a), stretch_b_(stretch_b), touching_(touching) {}

  std::vector<Contact> run(const Box3& walls) {
    grow();
    const Box3 common = bounds_of(mesh_a_.vertices).intersection(bounds_of(mesh_b_.vertices));
    std::vector<Contact> contacts;
    if (common.isEmpty()) return contacts;
    std::vector<Vec3> corners;
    corners.reserve(8);
    for (int k = 0; k < 8; ++k) corners.push_back(common.corner(static_cast<Box3::CornerType>(k)));
    // Along the common box's shortest side the lines are the most useful.
    Eigen::Index axis = 0;
    common.sizes().minCoeff(&axis);
    // Not along an axis: grids of points often are.
    Vec3 direction = Vec3::Unit(axis) + Vec3(0.0123, 0.0231, 0.0317);
    for (std::vector<Vec3>& piece :
         SharedSpace(mesh_a_, mesh_b_, corners, grain()).pieces(direction.normalized()))
      if (bounds_of(piece).intersects(walls)) measure(std::move(piece), contacts);
    return contacts;
  }

 private:
  // Both stretches to their final lengths, and their meshes.
  void grow() {
    mesh_a_ = tube_mesh(model_, a_, stretch_a_);
    mesh_b_ = tube_mesh(model_, b_, stretch_b_);
    for (int round = 0; round < 12; ++round) {
      const Inside inside_a(mesh_a_), inside_b(mesh_b_);
      const bool more_a = grow(a_, stretch_a_, mesh_b_, inside_b),
                 more_b = grow(b_, stretch_b_, mesh_a_, inside_a);
      if (!more_a && !more_b) return;
      if (more_a) mesh_a_ = tube_mesh(model_, a_, stretch_a_);
      if (more_b) mesh_b_ = tube_mesh(model_, b_, stretch_b_);
    }
  }

  // True where an end of the stretch had to go on, out of the other yarn.
  [[nodiscard]] bool grow(std::size_t body, Stretch& stretch, const Mesh& other, const Inside& inside) const {
    const Face& face = model_.faces()[model_.side(body)];
    const nurbs::Surface& s = *face.surface;
    const double whole = s.last_v() - s.first_v(), length = stretch.last - stretch.first;
    bool grown = false;
    for (const bool last : {false, true}) {
      double& end = last ? stretch.last : stretch.first;
      if (!face.round_v && (last ? end >= s.last_v() : end <= s.first_v())) continue;
      if (stretch.last - stretch.first >= whole || !is_cut_inside(s, end, face.round_v, other, inside))
        continue;
      end += last ? length : -length;
      if (!face.round_v) end = std::clamp(end, s.first_v(), s.last_v());
      grown = true;
    }
    if (face.round_v && stretch.last - stretch.first > whole) {
      const double excess = stretch.last - stretch.first - whole;
      stretch.first += 0.5 * excess;
      stretch.last -= 0.5 * excess;
    }
    return grown;
  }

  // The cut section lies in the other yarn somewhere.
  [[nodiscard]] static bool is_cut_inside(const nurbs::Surface& s, double v, bool round, const Mesh& other,
                                          const Inside& inside) {
    if (round) v = wrapped(v, s.first_v(), s.last_v());
    std::vector<Vec3> outline;
    constexpr int count = 24;
    Vec3 centre = Vec3::Zero();
    for (int k = 0; k < count; ++k) {
      outline.push_back(nurbs::evaluate(s, s.first_u() + (s.last_u() - s.first_u()) * (k + 0.37) / count, v));
      centre += outline.back() / count;
      if (inside.contains(outline.back())) return true;
    }
    Vec3 normal = Vec3::Zero();
    for (std::size_t k = 0; k < count; ++k)
      normal += (outline[k] - centre).cross(outline[(k + 1) % count] - centre);
    if (!(normal.norm() > 0.0)) return false;
    return passes_through(outline, centre, normal.normalized(), other);
  }

  // An edge of the mesh passes through the polygon (as seen along its normal).
  [[nodiscard]] static bool passes_through(const std::vector<Vec3>& outline, const Vec3& centre,
                                           const Vec3& normal, const Mesh& mesh) {
    const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
    const auto seen = [&](const Vec3& p) { return Vec2((p - centre).dot(x), (p - centre).dot(y)); };
    std::vector<Vec2> polygon;
    polygon.reserve(outline.size());
    for (const Vec3& p : outline) polygon.push_back(seen(p));
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &p = mesh.vertices[t[k]], &q = mesh.vertices[t[(k + 1) % 3]];
        const double hp = (p - centre).dot(normal), hq = (q - centre).dot(normal);
        if ((hp > 0.0) != (hq > 0.0) && selvage::contains(polygon, seen(p + (q - p) * (hp / (hp - hq)))))
          return true;
      }
    return false;
  }

  // Triangles tell no less from touching.
  [[nodiscard]] double grain() const {
    return std::max(touching_, 0.005 * std::min(model_.thickness(a_), model_.thickness(b_)));
  }

  void measure(std::vector<Vec3> walls, std::vector<Contact>& contacts) const {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : walls) middle += p / static_cast<double>(walls.size());
    // The piece may reach a line's width beyond what lines met.
    const Box3 box = bounds_of(walls);
    const Vec3 margin = 0.03 * box.sizes();
    for (int k = 0; k < 8; ++k)
      walls.push_back(
          box.corner(static_cast<Box3::CornerType>(k)) +
          (box.corner(static_cast<Box3::CornerType>(k)) - box.center()).cwiseSign().cwiseProduct(margin));
    const SharedSpace space(mesh_a_, mesh_b_, std::move(walls), grain());
    const Vec3 n = space.easiest_direction(directions_all_round());
    const Parting parting = space.parting(n);
    if (!(parting.distance > touching_)) return;
    Contact contact;
    contact.a = a_;
    contact.b = b_;
    contact.at = middle;
    contact.on_a = parting.p;
    contact.on_b = parting.q;
    contact.direction = n;
    contact.gap = -parting.distance;
    if (!settle_all(space, n, contact)) {
      if (!settle(space, parting, n, contact)) close_in(parting, n, contact);
      Minimum minimum{{}, {}, contact.on_a, contact.on_b, contact.direction, contact.gap};
      if (contact.site_a) minimum.site_a = *contact.site_a;
      if (contact.site_b) minimum.site_b = *contact.site_b;
      contact.spots.push_back(minimum);
    }
    contact.at = 0.5 * (contact.on_a + contact.on_b);
    contact.area = area_inside();
    contacts.push_back(contact);
  }

  [[nodiscard]] static Vec2 site_of(const Mesh& mesh, std::uint32_t k, const Vec3& p) {
    const auto& t = mesh.triangles[k];
    const Vec3 e1 = mesh.vertices[t[1]] - mesh.vertices[t[0]], e2 = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const Vec3 normal = e1.cross(e2), way = p - mesh.vertices[t[0]];
    const double size = normal.squaredNorm();
    if (size == 0.0) return mesh.sites[t[0]];
    const double s1 = std::clamp(way.cross(e2).dot(normal) / size, 0.0, 1.0);
    const double s2 = std::clamp(e1.cross(way).dot(normal) / size, 0.0, 1.0 - s1);
    return (1.0 - s1 - s2) * mesh.sites[t[0]] + s1 * mesh.sites[t[1]] + s2 * mesh.sites[t[2]];
  }

  [[nodiscard]] const Face* face_at(const Mesh& mesh, std::uint32_t triangle) const {
    const std::int32_t k = mesh.faces[triangle];
    return k == Mesh::cut ? nullptr : &model_.faces()[static_cast<std::size_t>(k)];
  }

  // The partings as critical pairs of the surfaces, when all of them are: the least translation ends all of
  // them at once, and is exact. One along which the two would be deeper elsewhere is none.
  bool settle_all(const SharedSpace& space, const Vec3& n, Contact& contact) const {
    constexpr double share = 0.95;  // a mesh is not the surface
    std::vector<Spot> spots;
    for (const Parting& late : space.late_partings(n, share)) {
      const std::optional<Spot> spot = critical_at(late, n);
      if (!spot) return false;
      const double near = 1e-3 * std::min(model_.thickness(a_), model_.thickness(b_));
      if (std::none_of(spots.begin(), spots.end(), [&](const Spot& other) {
            return (other.p - spot->p).norm() < near && (other.q - spot->q).norm() < near;
          }))
        spots.push_back(*spot);
    }
    if (spots.empty()) return false;
    std::stable_sort(spots.begin(), spots.end(),
                     [](const Spot& x, const Spot& y) { return x.depth > y.depth; });
    const std::optional<Vec3> shift = parting_shift(spots, touching_);
    if (!shift || !(shift->norm() > touching_)) return false;
    const double depth = shift->norm();
    if (space.parting(*shift / depth).distance > 1.005 * depth) return false;
    place_at(spots.front(), contact);
    contact.direction = *shift / depth;
    contact.gap = -depth;
    for (const Spot& spot : spots) contact.spots.push_back(minimum_of(spot));
    return true;
  }

  static void place_at(const Spot& spot, Contact& contact) {
    contact.on_a = spot.p;
    contact.on_b = spot.q;
    if (spot.face_a->is_side) contact.site_a = spot.site_a;
    if (spot.face_b->is_side) contact.site_b = spot.site_b;
  }

  // The critical pair of the surfaces that belongs to a parting along n; a crease of one may be in the other.
  [[nodiscard]] std::optional<Spot> critical_at(const Parting& parting, const Vec3& n) const {
    const Face *fa = face_at(mesh_a_, parting.a), *fb = face_at(mesh_b_, parting.b);
    if (fa == nullptr || fb == nullptr) return std::nullopt;
    const Vec2 site_a = site_of(mesh_a_, parting.a, parting.p),
               site_b = site_of(mesh_b_, parting.b, parting.q);
    const auto belongs = [&](const std::optional<Critical>& found) {
      return found && found->normal.dot(n) >= 0.7 &&
             std::abs(found->depth - parting.distance) <= 0.12 * parting.distance;
    };
    if (const auto found = find_critical(*fa, site_a, *fb, site_b); belongs(found))
      return Spot{*found, fa, fb};
    if (auto spot = crease_spot(*fa, site_a, *fb, site_b); spot && belongs(*spot)) return spot;
    return std::nullopt;
  }

  // The parting as a critical pair of the surfaces, when it is one: then it is exact, and n the easiest
  // direction near it.
  bool settle(const SharedSpace& space, const Parting& parting, const Vec3& n, Contact& contact) const {
    const std::optional<Spot> found = critical_at(parting, n);
    if (!found) return false;
    // A line along the normal on which the two are deeper in each other: this is no largest one.
    if (space.parting(found->normal).distance > found->depth * 1.005) return false;
    place_at(*found, contact);
    contact.direction = found->normal;
    contact.gap = -found->depth;
    return true;
  }

  // The parting along n on sheets that close in on where it is largest.
  void close_in(const Parting& parting, const Vec3& n, Contact& contact) const {
    const Face *fa = face_at(mesh_a_, parting.a), *fb = face_at(mesh_b_, parting.b);
    if (fa == nullptr || fb == nullptr) return;
    const auto half = [](const Face& face, double share) {
      return Vec2(share * (face.surface->last_u() - face.surface->first_u()),
                  share * (face.surface->last_v() - face.surface->first_v()) /
                      std::max(1.0, 0.2 * static_cast<double>(face.count_v)));
    };
    std::vector<Part> pa = parts_about(model_, static_cast<std::uint32_t>(mesh_a_.faces[parting.a]),
                                       site_of(mesh_a_, parting.a, parting.p), half(*fa, 1.0 / 16.0));
    std::vector<Part> pb = parts_about(model_, static_cast<std::uint32_t>(mesh_b_.faces[parting.b]),
                                       site_of(mesh_b_, parting.b, parting.q), half(*fb, 1.0 / 16.0));
    const std::optional<Deepest> found =
        contact::close_in(model_, std::move(pa), std::move(pb), n, parting.p, model_.thickness(a_) / 16.0);
    if (!found || std::abs(found->depth - parting.distance) > 0.1 * parting.distance) return;
    contact.on_a = found->a.point;
    contact.on_b = found->b.point;
    contact.gap = -found->depth;
    if (fa->is_side) contact.site_a = found->a.site;
    if (fb->is_side) contact.site_b = found->b.site;
  }

  // Of a's surface inside b, by the middles of the triangles.
  [[nodiscard]] double area_inside() const {
    const Inside inside(mesh_b_);
    double sum = 0.0;
    for (std::size_t k = 0; k < mesh_a_.triangles.size(); ++k) {
      if (mesh_a_.faces[k] == Mesh::cut) continue;
      const auto& t = mesh_a_.triangles[k];
      const Vec3 &p = mesh_a_.vertices[t[0]], &q = mesh_a_.vertices[t[1]], &r = mesh_a_.vertices[t[2]];
      const Vec3 middle = (p + q + r) / 3.0;
      if (inside.contains(middle)) sum += 0.5 * (q - p).cross(r - p).norm();
    }
    return sum;
  }

  const CellModel& model_;
  std::size_t a_, b_;
  Stretch stretch_a_, stretch_b_;
  double touching_;
  Mesh mesh_a_, mesh_b_;
};

}  // namespace

std::vector<Contact> measure_deep(const CellModel& model, std::size_t a, const Stretch& stretch_a,
                                  std::size_t b, const Stretch& stretch_b, const Box3& walls,
                                  double touching) {
  return DeepMeasurer(model, a, stretch_a, b, stretch_b, touching).run(walls);
}

}  // namespace selvage::contact
