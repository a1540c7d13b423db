#include "fabric/repeat.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/box_tree.h"
#include "nurbs/divided.h"

namespace selvage::fabric {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 across_axis(Vec3 v, int axis) {
  v[axis] = 0.0;
  return v;
}

struct Crossing {
  std::size_t body = 0;
  Vec3 at = Vec3::Zero(), direction = Vec3::Zero();  // unit
};

// Where a curve crosses a plane; touching it is no crossing.
std::vector<Crossing> crossings(const nurbs::Curve& curve, int axis, double plane) {
  constexpr int a_span = 8, halvings = 60;
  constexpr double along = 1e-9;  // what runs in the plane is on both sides of it by rounding
  const std::vector<double> parameters = nurbs::divided(curve.knots, curve.degree, a_span);
  std::vector<Crossing> found;
  const auto height = [&](double t) { return nurbs::evaluate(curve, t)[axis] - plane; };
  for (std::size_t k = 0; k + 1 < parameters.size(); ++k) {
    double from = parameters[k], to = parameters[k + 1];
    const bool rises = height(from) < 0.0;
    if (rises == (height(to) < 0.0)) continue;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (from + to);
      ((height(middle) < 0.0) == rises ? from : to) = middle;
    }
    const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, 0.5 * (from + to));
    const Vec3 direction = jet.d1.normalized();
    if (std::abs(direction[axis]) > along) found.push_back({0, jet.position, direction});
  }
  return found;
}

std::vector<Crossing> crossings_in(std::span<const yarn::Body> bodies, const Box3& box, int axis, bool high) {
  const double plane = high ? box.max()[axis] : box.min()[axis];
  std::vector<Crossing> found;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (const Crossing& crossing : crossings(bodies[i].axis, axis, plane))
      found.push_back({i, crossing.at, crossing.direction});
  return found;
}

bool is_in_face(const Vec3& at, const Box3& box, int axis) {
  for (int k = 0; k < 3; ++k)
    if (k != axis && (at[k] <= box.min()[k] || at[k] >= box.max()[k])) return false;
  return true;
}

// Of two crossings that are one yarn's a repeat apart, the sine of the angle between them: 1 degree.
constexpr double most_turned = 0.0175;

// The first of these that lies inside the face and has none of the others opposite.
std::optional<LooseEnd> first_without(const std::vector<Crossing>& crossings, std::vector<Crossing> others,
                                      const Box3& box, int axis, bool high, double tolerance) {
  const int across = axis == 0 ? 1 : 0;
  const auto place = [across](const Crossing& crossing) { return crossing.at[across]; };
  std::ranges::sort(others, {}, place);
  for (const Crossing& crossing : crossings) {
    if (!is_in_face(crossing.at, box, axis)) continue;
    const auto first = std::ranges::lower_bound(others, place(crossing) - tolerance, {}, place);
    const auto last = std::ranges::upper_bound(others, place(crossing) + tolerance, {}, place);
    const bool has_partner = std::any_of(first, last, [&](const Crossing& other) {
      // A yarn may be given from its other end.
      return across_axis(other.at - crossing.at, axis).norm() <= tolerance &&
             other.direction.cross(crossing.direction).norm() <= most_turned;
    });
    if (!has_partner) return LooseEnd{crossing.body, crossing.at, high};
  }
  return std::nullopt;
}

// All centre lines as polygons.
class Lines {
 public:
  // Distances are looked for up to twice the tolerance.
  Lines(std::span<const yarn::Body> bodies, double tolerance) : reach_(2.0 * tolerance), near_({}) {
    constexpr int a_span = 16;
    for (const yarn::Body& body : bodies) {
      std::vector<Vec3> line;
      for (const double t : nurbs::divided(body.axis.knots, body.axis.degree, a_span))
        line.push_back(nurbs::evaluate(body.axis, t));
      for (const Vec3& p : line) box_.extend(p);
      lines_.push_back(std::move(line));
    }
    std::vector<Box3> boxes;
    for (const std::vector<Vec3>& line : lines_)
      for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        segments_.push_back(&line[k]);
        boxes.push_back(Box3(line[k]).extend(line[k + 1]));
      }
    near_ = BoxTree(std::move(boxes));
  }
  [[nodiscard]] const Box3& box() const { return box_; }
  [[nodiscard]] const std::vector<std::vector<Vec3>>& list() const { return lines_; }

  // The nearest segment's distance, where it is at most the reach; else the reach or more.
  [[nodiscard]] double distance(const Vec3& p) const {
    double least = infinity;
    near_.near_point(p, reach_, [&](std::uint32_t i) {
      const Vec3 &from = segments_[i][0], &to = segments_[i][1];
      least = std::min(least, (from + nearest_share(p, from, to) * (to - from) - p).norm());
      return std::min(least, reach_);
    });
    return least;
  }

  // The first point, moved by the repeat and back, that comes where no line is; counts(from, to): which moves
  // are looked at.
  template <class Counts>
  [[nodiscard]] std::optional<LooseEnd> missing_copy(double repeat, int axis, double tolerance,
                                                     const Counts& counts) const {
    for (std::size_t i = 0; i < lines_.size(); ++i)
      for (const Vec3& p : lines_[i])
        for (const double way : {-repeat, repeat}) {
          Vec3 copy = p;
          copy[axis] += way;
          if (counts(p, copy) && distance(copy) > tolerance) return LooseEnd{i, copy, way > 0.0};
        }
    return std::nullopt;
  }

  // Does a translation take every line to lines, as far as they go? Near their ends, where splines swing,
  // they are not looked at.
  [[nodiscard]] bool repeats_after(double shift, int axis, double tolerance) const {
    const double margin = margin_share * box_.diagonal()[axis];
    for (const std::vector<Vec3>& line : lines_)
      for (Vec3 p : line) {
        if (p[axis] < box_.min()[axis] + margin) continue;
        p[axis] += shift;
        if (p[axis] <= box_.max()[axis] - margin && distance(p) > tolerance) return false;
      }
    return true;
  }

  // The same of any translation within a region.
  [[nodiscard]] bool repeats_after(const Vec3& shift, const Box3& region, double tolerance) const {
    for (const std::vector<Vec3>& line : lines_)
      for (const Vec3& p : line)
        if (region.contains(p) && region.contains(p + shift) && distance(p + shift) > tolerance) return false;
    return true;
  }

  // Shifts by which a point of a line comes to one: those of a point of the line that goes most across the
  // axis, for there they are fewest.
  struct Candidate {
    double shift = 0, distance = 0;
  };
  [[nodiscard]] std::vector<Candidate> candidates(int axis, double tolerance) const {
    const std::vector<Vec3>* most = nullptr;
    double widest = -1.0;
    for (const std::vector<Vec3>& line : lines_) {
      Box3 box;
      for (const Vec3& p : line) box.extend(across_axis(p, axis));
      if (const double width = box.diagonal().norm(); width > widest) {
        widest = width;
        most = &line;
      }
    }
    std::vector<Candidate> shifts;
    if (most == nullptr) return shifts;
    const double start = box_.min()[axis] + margin_share * box_.diagonal()[axis];
    const Vec3 from =
        *std::min_element(most->begin(), most->end(), [axis, start](const Vec3& a, const Vec3& b) {
          return std::abs(a[axis] - start) < std::abs(b[axis] - start);
        });
    for (const std::vector<Vec3>& line : lines_)
      for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const Vec3 a = across_axis(line[k] - from, axis), way = across_axis(line[k + 1] - line[k], axis);
        const double s = nearest_share<Vec3>(-a, Vec3::Zero(), way);
        const double distance = (a + s * way).norm();
        if (distance > tolerance) continue;
        const double shift = (line[k] + s * (line[k + 1] - line[k]) - from)[axis];
        if (shift > tolerance) shifts.push_back({shift, distance});
      }
    std::sort(shifts.begin(), shifts.end(),
              [](const Candidate& a, const Candidate& b) { return a.shift < b.shift; });
    // Of those that lie together, the nearest pass; a line along the axis gives one after the other.
    std::vector<Candidate> best;
    double group = -infinity;
    for (const Candidate& candidate : shifts) {
      if (candidate.shift - group > 4.0 * tolerance) {
        group = candidate.shift;
        best.push_back(candidate);
      } else if (candidate.distance < best.back().distance) {
        best.back() = candidate;
      }
    }
    return best;
  }

 private:
  static constexpr double margin_share = 0.25;  // of what the lines fill, at each side

  std::vector<std::vector<Vec3>> lines_;
  double reach_;
  std::vector<const Vec3*> segments_;  // from this point of a line to the next
  BoxTree near_;                       // of the segments
  Box3 box_;
};

}  // namespace

long long smallest_shift(long long count, const std::function<bool(long long, long long)>& are_same) {
  const auto is_same_after = [&](long long shift) {
    for (long long k = 0; k < count; ++k)
      if (!are_same(k + shift, k)) return false;
    return true;
  };
  for (long long shift = 1; shift < count; ++shift)
    if (count % shift == 0 && is_same_after(shift)) return shift;
  return count;
}

Repeat common_repeat(const Repeat& a, const Repeat& b) {
  constexpr int most = 1000;
  constexpr double near = 1e-9;
  Repeat both;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!a[k] || !b[k]) continue;
    if (*a[k] == 0.0 || *b[k] == 0.0) {
      both[k] = std::max(*a[k], *b[k]);
      continue;
    }
    for (int n = 1; n <= most && !both[k]; ++n) {
      const double multiple = n * *a[k], share = multiple / *b[k];
      if (std::abs(share - std::round(share)) <= near * share && share >= 0.5 && share <= most)
        both[k] = multiple;
    }
  }
  return both;
}

std::optional<LooseEnd> find_loose_end(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                       double tolerance) {
  const std::vector<Crossing> low = crossings_in(bodies, box, axis, false),
                              high = crossings_in(bodies, box, axis, true);
  if (auto loose = first_without(low, high, box, axis, false, tolerance)) return loose;
  return first_without(high, low, box, axis, true, tolerance);
}

std::optional<LooseEnd> find_missing_copy(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                          double repeat, double tolerance) {
  const Box3 inside(box.min().array() + tolerance, box.max().array() - tolerance);
  return Lines(bodies, tolerance).missing_copy(repeat, axis, tolerance, [&](const Vec3&, const Vec3& to) {
    return inside.contains(to);
  });
}

std::optional<LooseEnd> find_missing_in_faces(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                              double repeat, double margin, double tolerance) {
  const auto is_in_a_face = [&](const Vec3& p) {
    for (int k = 0; k < 3; ++k)
      if (k != axis && (p[k] < box.min()[k] || p[k] > box.max()[k])) return false;
    return std::abs(p[axis] - box.min()[axis]) <= margin || std::abs(p[axis] - box.max()[axis]) <= margin;
  };
  return Lines(bodies, tolerance).missing_copy(repeat, axis, tolerance, [&](const Vec3& p, const Vec3& to) {
    return is_in_a_face(p) && is_in_a_face(to);
  });
}

bool runs_through(std::span<const yarn::Body> bodies, const Box3& box, int axis, bool high) {
  const std::vector<Crossing> all = crossings_in(bodies, box, axis, high);
  return std::any_of(all.begin(), all.end(),
                     [&](const Crossing& crossing) { return is_in_face(crossing.at, box, axis); });
}

std::array<Vec3, 2> oblique_repeat(std::span<const yarn::Body> bodies, const Box3& region,
                                   const std::array<double, 2>& along_x_and_y, double tolerance) {
  constexpr int most_parts = 16;
  const Lines lines(bodies, tolerance);
  const Vec3 x(along_x_and_y[0], 0, 0), y(0, along_x_and_y[1], 0);
  std::vector<Vec3> found = {x, y};
  for (int parts = 2; parts <= most_parts; ++parts)
    for (int i = 0; i < parts; ++i)
      for (int j = 0; j < parts; ++j) {
        const Vec3 shift = x * i / parts + y * j / parts;
        if (std::gcd(std::gcd(i, j), parts) == 1 && lines.repeats_after(shift, region, tolerance))
          for (const Vec3& whole : {Vec3(0, 0, 0), x, y, Vec3(x + y)}) found.push_back(shift - whole);
      }
  const auto length = [](const Vec3& v) { return v.norm(); };
  std::ranges::stable_sort(found, {}, length);
  const Vec3 first = found.front();
  const auto second = std::ranges::find_if(
      found, [&](const Vec3& v) { return std::abs(first.cross(v).z()) > 1e-6 * first.norm() * v.norm(); });
  return first.cross(*second).z() > 0 ? std::array{first, *second} : std::array{first, Vec3(-*second)};
}

std::optional<double> repeat_of_lines(std::span<const yarn::Body> bodies, int axis, double tolerance) {
  const Lines lines(bodies, tolerance);
  const double most = 0.5 * lines.box().diagonal()[axis];
  bool moves_freely = lines.list().empty();
  for (const auto& [shift, distance] : lines.candidates(axis, tolerance)) {
    if (shift > most) break;
    if (!lines.repeats_after(shift, axis, tolerance)) continue;
    moves_freely = lines.repeats_after(0.5 * shift, axis, tolerance) &&
                   lines.repeats_after(0.375 * shift, axis, tolerance);
    if (!moves_freely) return shift;
    break;
  }
  return moves_freely ? std::optional(0.0) : std::nullopt;
}

}  // namespace selvage::fabric
