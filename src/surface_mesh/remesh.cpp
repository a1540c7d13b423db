#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "fem/edge_key.h"
#include "surface_mesh/triangle_mesh.h"

namespace selvage::fem {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr double longest = 1.4, shortest = 0.7;  // edges, over the wanted length
constexpr double least_alignment = 0.5;          // cosine between a triangle and its support
constexpr int rounds = 6, last_rounds = 6;
constexpr double good_angle = 35;   // degrees: smoothing may take from angles above it
constexpr double least_angle = 25;  // degrees: so may a point that is moved to a target

class Remesher {
 public:
  Remesher(TriangleMesh& mesh, const Support& support) : mesh_(mesh), support_(support) {
    for (const auto& edge : mesh.fixed_edges) fixed_.insert(edge_key(edge[0], edge[1]));
    stars_.resize(mesh.points.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t corner : mesh.triangles[t]) stars_[corner].push_back(t);
    alive_.assign(mesh.triangles.size(), true);
  }

  void run(const SizeField& field) {
    find_wanted(field);
    turn_all();
    for (int round = 0; round < rounds; ++round) {
      split_long();
      collapse_short();
      turn_all();
      smooth_all();
    }
    for (int round = 0; round < last_rounds; ++round) {
      const bool turned = turn_all();
      const bool moved = raise_worst();
      if (!turned && !moved) break;
    }
    compact();
  }

  void move_points(std::span<const PointTarget> targets) {
    for (const auto& [vertex, at] : targets) {
      const Support::Place old{mesh_.parameters[vertex], mesh_.points[vertex]};
      const Support::Place place = support_.nearest(old.parameters, at);
      if (star_angle(vertex, place) < std::min(least_angle, star_angle(vertex, old)) ||
          !stays_upright(vertex, place))
        continue;
      mesh_.points[vertex] = place.point;
      mesh_.parameters[vertex] = place.parameters;
    }
    turn_all();
  }

  void split(const SizeField& field) {
    find_wanted(field);
    split_long();
    turn_all();
  }

 private:
  [[nodiscard]] bool is_fixed(std::uint32_t vertex) const { return vertex < mesh_.fixed_points; }
  [[nodiscard]] double length(std::uint32_t a, std::uint32_t b) const {
    return (mesh_.points[a] - mesh_.points[b]).norm();
  }
  [[nodiscard]] double ratio(std::uint32_t a, std::uint32_t b) const {
    return length(a, b) / std::min(wanted_[a], wanted_[b]);
  }
  [[nodiscard]] double angle(const Triangle& t) const {
    return smallest_angle(mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]);
  }

  void find_wanted(const SizeField& field) {
    field_ = &field;
    for (const Vec3& point : mesh_.points) wanted_.push_back(field.at(point));
  }

  // Does it lie on its support the right way round, where vertex `moved` stands at `place`?
  [[nodiscard]] bool is_upright(const Triangle& t, std::uint32_t moved, const Support::Place& place) const {
    std::array<Vec3, 3> p;
    std::array<Vec2, 3> q;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = t[k] == moved ? place.point : mesh_.points[t[k]];
      q[k] = t[k] == moved ? place.parameters : mesh_.parameters[t[k]];
      if (k > 0) q[k] = support_.beside(q[0], q[k]);
    }
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    const double size = normal.norm();
    if (!(size > 0)) return false;
    return normal.dot(support_.normal((q[0] + q[1] + q[2]) / 3)) > least_alignment * size;
  }
  [[nodiscard]] bool is_upright(const Triangle& t) const {
    return is_upright(t, t[0], {mesh_.parameters[t[0]], mesh_.points[t[0]]});
  }

  [[nodiscard]] bool stays_upright(std::uint32_t vertex, const Support::Place& place) const {
    return std::all_of(stars_[vertex].begin(), stars_[vertex].end(),
                       [&](std::uint32_t t) { return is_upright(mesh_.triangles[t], vertex, place); });
  }

  // The triangles that have the edge; more than two: an edge that was bent together.
  [[nodiscard]] std::vector<std::uint32_t> at_edge(std::uint32_t a, std::uint32_t b) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t t : stars_[a])
      for (const std::uint32_t corner : mesh_.triangles[t])
        if (corner == b) result.push_back(t);
    return result;
  }

  [[nodiscard]] std::uint32_t opposite(std::uint32_t t, std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t corner : mesh_.triangles[t])
      if (corner != a && corner != b) return corner;
    return a;
  }

  void set_triangle(std::uint32_t t, const Triangle& corners) {
    for (const std::uint32_t corner : mesh_.triangles[t]) std::erase(stars_[corner], t);
    mesh_.triangles[t] = corners;
    for (const std::uint32_t corner : corners) stars_[corner].push_back(t);
  }

  void add_triangle(const Triangle& corners, std::int32_t domain) {
    const auto t = static_cast<std::uint32_t>(mesh_.triangles.size());
    mesh_.triangles.push_back(corners);
    mesh_.domains.push_back(domain);
    alive_.push_back(true);
    for (const std::uint32_t corner : corners) stars_[corner].push_back(t);
  }

  // Every edge once, in an order that depends on the mesh alone.
  [[nodiscard]] std::vector<std::uint64_t> edges() const {
    std::vector<std::uint64_t> keys;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; alive_[t] && k < 3; ++k)
        keys.push_back(edge_key(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
  }

  struct Rated {
    double ratio;  // length over the wanted one
    std::uint32_t a, b;
  };
  [[nodiscard]] std::vector<Rated> rated_edges() const {
    std::vector<Rated> all;
    for (const std::uint64_t key : edges()) {
      const auto a = static_cast<std::uint32_t>(key >> 32U), b = static_cast<std::uint32_t>(key);
      all.push_back({ratio(a, b), a, b});
    }
    return all;
  }

  void split_long();
  bool split(std::uint32_t a, std::uint32_t b);
  void collapse_short();
  bool collapse(std::uint32_t gone, std::uint32_t kept);
  bool turn_all();
  bool turn(std::uint32_t a, std::uint32_t b, const std::vector<std::uint32_t>& sides);
  void smooth_all();
  bool raise_worst();
  [[nodiscard]] double star_angle(std::uint32_t vertex, const Support::Place& place) const;
  void move(std::uint32_t vertex, const Support::Place& place) {
    mesh_.points[vertex] = place.point;
    mesh_.parameters[vertex] = place.parameters;
    wanted_[vertex] = field_->at(place.point);
  }
  void compact();

  TriangleMesh& mesh_;
  const Support& support_;
  const SizeField* field_ = nullptr;  // find_wanted()
  std::unordered_set<std::uint64_t> fixed_;
  std::vector<std::vector<std::uint32_t>> stars_;
  std::vector<double> wanted_;
  std::vector<bool> alive_;
};

void Remesher::split_long() {
  std::vector<Rated> found = rated_edges();
  std::erase_if(found, [&](const Rated& edge) {
    return !(edge.ratio > longest) || fixed_.contains(edge_key(edge.a, edge.b));
  });
  std::stable_sort(found.begin(), found.end(),
                   [](const Rated& x, const Rated& y) { return x.ratio > y.ratio; });
  for (const Rated& edge : found) split(edge.a, edge.b);
}

bool Remesher::split(std::uint32_t a, std::uint32_t b) {
  const std::vector<std::uint32_t> sides = at_edge(a, b);
  if (sides.size() != 2) return false;
  const Vec2 other = support_.beside(mesh_.parameters[a], mesh_.parameters[b]);
  const Support::Place middle =
      support_.nearest((mesh_.parameters[a] + other) / 2, (mesh_.points[a] + mesh_.points[b]) / 2);
  const auto vertex = static_cast<std::uint32_t>(mesh_.points.size());
  mesh_.points.push_back(middle.point);
  mesh_.parameters.push_back(middle.parameters);
  wanted_.push_back(field_->at(middle.point));
  stars_.emplace_back();
  const auto with = [&](Triangle t, std::uint32_t from, std::uint32_t to) {
    std::replace(t.begin(), t.end(), from, to);
    return t;
  };
  bool sound = true;
  for (const std::uint32_t t : sides)
    sound = sound && is_upright(with(mesh_.triangles[t], a, vertex)) &&
            is_upright(with(mesh_.triangles[t], b, vertex));
  if (!sound) {
    mesh_.points.pop_back();
    mesh_.parameters.pop_back();
    wanted_.pop_back();
    stars_.pop_back();
    return false;
  }
  for (const std::uint32_t t : sides) {
    const Triangle old = mesh_.triangles[t];
    set_triangle(t, with(old, b, vertex));
    add_triangle(with(old, a, vertex), mesh_.domains[t]);
  }
  return true;
}

void Remesher::collapse_short() {
  std::vector<Rated> found = rated_edges();
  std::erase_if(found, [](const Rated& edge) { return !(edge.ratio < shortest); });
  std::stable_sort(found.begin(), found.end(),
                   [](const Rated& x, const Rated& y) { return x.ratio < y.ratio; });
  for (const auto& [ratio_before, a, b] : found) {
    if (stars_[a].empty() || stars_[b].empty() || at_edge(a, b).size() != 2 || ratio(a, b) >= shortest)
      continue;
    if (!is_fixed(b) && collapse(b, a)) continue;
    if (!is_fixed(a)) collapse(a, b);
  }
}

// Moves `gone` into `kept`. Not where the surface would fold, angles become small, or edges long.
bool Remesher::collapse(std::uint32_t gone, std::uint32_t kept) {
  std::vector<std::uint32_t> around, beside;
  for (const std::uint32_t t : stars_[gone])
    for (const std::uint32_t c : mesh_.triangles[t])
      if (c != gone && std::find(around.begin(), around.end(), c) == around.end()) around.push_back(c);
  for (const std::uint32_t t : stars_[kept])
    for (const std::uint32_t c : mesh_.triangles[t])
      if (c != kept && std::find(beside.begin(), beside.end(), c) == beside.end()) beside.push_back(c);
  std::size_t common = 0;
  for (const std::uint32_t c : around) {
    if (c == kept) continue;
    if (std::find(beside.begin(), beside.end(), c) != beside.end()) ++common;
    if (ratio(c, kept) > longest) return false;
  }
  if (common != 2) return false;
  double before = 180, after = 180;
  for (const std::uint32_t t : stars_[gone]) {
    Triangle changed = mesh_.triangles[t];
    before = std::min(before, angle(changed));
    if (std::find(changed.begin(), changed.end(), kept) != changed.end()) continue;
    std::replace(changed.begin(), changed.end(), gone, kept);
    after = std::min(after, angle(changed));
    if (after < 15 && after < before) return false;
    if (!is_upright(changed)) return false;
  }
  const std::vector<std::uint32_t> star = stars_[gone];
  for (const std::uint32_t t : star) {
    Triangle changed = mesh_.triangles[t];
    if (std::find(changed.begin(), changed.end(), kept) != changed.end()) {
      for (const std::uint32_t corner : changed) std::erase(stars_[corner], t);
      alive_[t] = false;
    } else {
      std::replace(changed.begin(), changed.end(), gone, kept);
      set_triangle(t, changed);
    }
  }
  return true;
}

bool Remesher::turn_all() {
  bool any = false;
  std::vector<std::uint64_t> open = edges();
  for (int pass = 0; pass < 8 && !open.empty(); ++pass) {
    // An edge may want to be turned later on where one beside it was.
    std::vector<std::uint64_t> next;
    for (const std::uint64_t key : open) {
      const auto a = static_cast<std::uint32_t>(key >> 32U), b = static_cast<std::uint32_t>(key);
      if (fixed_.contains(key)) continue;
      const std::vector<std::uint32_t> sides = at_edge(a, b);
      if (sides.size() != 2 || !turn(a, b, sides)) continue;
      any = true;
      for (const std::uint32_t t : sides)
        for (std::size_t k = 0; k < 3; ++k)
          next.push_back(edge_key(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]));
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    open = std::move(next);
  }
  return any;
}

// The other diagonal of the two triangles at an edge, where that makes the smallest angle larger.
bool Remesher::turn(std::uint32_t a, std::uint32_t b, const std::vector<std::uint32_t>& sides) {
  std::uint32_t left = sides[0], right = sides[1];
  const auto runs = [&](std::uint32_t t) {
    const Triangle& c = mesh_.triangles[t];
    return (c[0] == a && c[1] == b) || (c[1] == a && c[2] == b) || (c[2] == a && c[0] == b);
  };
  if (!runs(left)) std::swap(left, right);
  const std::uint32_t c = opposite(left, a, b), d = opposite(right, a, b);
  const double before = std::min(angle(mesh_.triangles[left]), angle(mesh_.triangles[right]));
  const Triangle one = {c, d, b}, two = {d, c, a};
  if (std::min(angle(one), angle(two)) <= before + 1e-6) return false;
  if (!at_edge(c, d).empty() || !is_upright(one) || !is_upright(two)) return false;
  set_triangle(left, one);
  set_triangle(right, two);
  return true;
}

double Remesher::star_angle(std::uint32_t vertex, const Support::Place& place) const {
  double least = 180;
  for (const std::uint32_t t : stars_[vertex]) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = mesh_.triangles[t][k];
      p[k] = corner == vertex ? place.point : mesh_.points[corner];
    }
    least = std::min(least, smallest_angle(p[0], p[1], p[2]));
  }
  return least;
}

// To the middle of the triangles round it, each weighted by its area over the wanted one.
void Remesher::smooth_all() {
  for (std::uint32_t v = static_cast<std::uint32_t>(mesh_.fixed_points); v < mesh_.points.size(); ++v) {
    if (stars_[v].empty()) continue;
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (const std::uint32_t t : stars_[v]) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const Vec3 &pa = mesh_.points[a], &pb = mesh_.points[b], &pc = mesh_.points[c];
      const double h = (wanted_[a] + wanted_[b] + wanted_[c]) / 3;
      const double w = (pb - pa).cross(pc - pa).norm() / (h * h);
      sum += w * (pa + pb + pc) / 3;
      weight += w;
    }
    const Support::Place old{mesh_.parameters[v], mesh_.points[v]};
    const Support::Place place = support_.nearest(old.parameters, sum / weight);
    if (star_angle(v, place) < std::min(good_angle, star_angle(v, old))) continue;
    if (stays_upright(v, place)) move(v, place);
  }
}

// Moves each free vertex of a poor triangle to where the smallest angle round it is larger.
bool Remesher::raise_worst() {
  constexpr int directions = 8;
  bool any = false;
  for (std::uint32_t v = static_cast<std::uint32_t>(mesh_.fixed_points); v < mesh_.points.size(); ++v) {
    if (stars_[v].empty()) continue;
    Support::Place best{mesh_.parameters[v], mesh_.points[v]};
    double least = star_angle(v, best);
    if (least >= good_angle) continue;
    const double start = least;
    double step = 0.3 * wanted_[v];
    for (int k = 0; k < 5; ++k, step /= 2) {
      const Vec3 normal = support_.normal(best.parameters), x = normal.unitOrthogonal(), y = normal.cross(x);
      const Support::Place from = best;
      for (int d = 0; d < directions; ++d) {
        const double turn = 2 * std::numbers::pi * d / directions;
        const Support::Place place =
            support_.nearest(from.parameters, from.point + step * (std::cos(turn) * x + std::sin(turn) * y));
        const double angle = star_angle(v, place);
        if (angle <= least || !stays_upright(v, place)) continue;
        least = angle;
        best = place;
      }
    }
    if (least > start + 0.1) {
      move(v, best);
      any = true;
    }
  }
  return any;
}

void Remesher::compact() {
  std::vector<std::uint32_t> number(mesh_.points.size());
  std::size_t kept = 0;
  for (std::size_t v = 0; v < mesh_.points.size(); ++v) {
    if (v >= mesh_.fixed_points && stars_[v].empty()) continue;
    mesh_.points[kept] = mesh_.points[v];
    mesh_.parameters[kept] = mesh_.parameters[v];
    number[v] = static_cast<std::uint32_t>(kept++);
  }
  mesh_.points.resize(kept);
  mesh_.parameters.resize(kept);
  std::size_t last = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (!alive_[t]) continue;
    const Triangle& old = mesh_.triangles[t];
    mesh_.triangles[last] = {number[old[0]], number[old[1]], number[old[2]]};
    mesh_.domains[last++] = mesh_.domains[t];
  }
  mesh_.triangles.resize(last);
  mesh_.domains.resize(last);
}

}  // namespace

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double A = (b - c).squaredNorm(), B = (c - a).squaredNorm(), C = (a - b).squaredNorm();
  // The one opposite the shortest edge.
  const double least = std::min({A, B, C});
  const double product = A * B * C / least;  // of the other two
  if (!(product > 0)) return 0;
  const double cosine = (A + B + C - 2 * least) / (2 * std::sqrt(product));
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

void remesh(TriangleMesh& mesh, const Support& support, const SizeField& field) {
  Remesher(mesh, support).run(field);
}

void move_points(TriangleMesh& mesh, const Support& support, std::span<const PointTarget> targets) {
  Remesher(mesh, support).move_points(targets);
}

void split_long_edges(TriangleMesh& mesh, const Support& support, const SizeField& field) {
  Remesher(mesh, support).split(field);
}

}  // namespace selvage::fem
