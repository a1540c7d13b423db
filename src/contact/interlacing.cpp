#include "contact/interlacing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>

#include "core/box_tree.h"
#include "nurbs/spline.h"

namespace selvage::contact {

namespace {

// A chord may be this far from its line, of the yarn's width: yarns that touch are many times farther apart.
constexpr double chord_share = 0.01;
constexpr std::size_t most_pieces = 10'000;  // of a span
constexpr int most_steps = 1000;             // of one advancement

// A centre line before and after, sampled at the same parameters.
struct Line {
  std::vector<double> parameters;
  std::vector<Vec3> before, after;
  std::vector<double> lengths;     // along it from its start, before
  std::vector<double> deviations;  // of each chord
  double width = 0;
  bool closed = false;
};

struct Chord {
  std::uint32_t line = 0, index = 0;
};

// Of the second derivative over a span; the one of a polynomial cubic is largest at an end.
double largest_second_derivative(const nurbs::Curve& curve, double from, double to) {
  const int looks = curve.is_rational() ? 8 : 2;
  const double inside = 1e-9 * (to - from);
  double largest = 0.0;
  for (int k = 0; k <= looks; ++k) {
    const double t = std::clamp(from + (to - from) * k / looks, from + inside, to - inside);
    largest = std::max(largest, nurbs::evaluate_jet(curve, t).d2.norm());
  }
  return curve.is_rational() ? 1.2 * largest : largest;
}

double largest_speed(const nurbs::Curve& curve, double from, double to) {
  double largest = 0.0;
  for (int k = 0; k <= 4; ++k)
    largest = std::max(largest, nurbs::evaluate_jet(curve, from + (to - from) * k / 4).d1.norm());
  return largest;
}

void add_point(Line& line, const nurbs::Curve& before, const nurbs::Curve& after, double t) {
  line.parameters.push_back(t);
  line.before.push_back(nurbs::evaluate(before, t));
  line.after.push_back(nurbs::evaluate(after, t));
  const std::size_t n = line.before.size();
  line.lengths.push_back(n < 2 ? 0.0
                               : line.lengths.back() + (line.before[n - 1] - line.before[n - 2]).norm());
}

Line line_of(const yarn::Body& old_body, const yarn::Body& new_body) {
  const nurbs::Curve &before = old_body.axis, &after = new_body.axis;
  Line line;
  line.width = yarn::widest_section(old_body);
  line.closed = old_body.closed_along;
  std::vector<double> breaks;
  std::ranges::set_union(nurbs::breakpoints(before.knots, before.degree),
                         nurbs::breakpoints(after.knots, after.degree), std::back_inserter(breaks));
  const double allowed = chord_share * line.width;
  add_point(line, before, after, breaks.front());
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double from = breaks[k], to = breaks[k + 1], span = to - from;
    const double bend =
        std::max(largest_second_derivative(before, from, to), largest_second_derivative(after, from, to));
    const double reach = span * std::max(largest_speed(before, from, to), largest_speed(after, from, to));
    const double wanted = std::max(span * std::sqrt(bend / (8.0 * allowed)), reach / line.width);
    const auto pieces =
        static_cast<std::size_t>(std::clamp(std::ceil(wanted), 1.0, static_cast<double>(most_pieces)));
    const double step = span / static_cast<double>(pieces);
    for (std::size_t i = 1; i <= pieces; ++i) {
      add_point(line, before, after, i == pieces ? to : from + step * static_cast<double>(i));
      line.deviations.push_back(step * step * bend / 8.0);
    }
  }
  return line;
}

// The least distance of the segments p + s d and q + u e, s and u in [0, 1], and where it is.
struct Approach {
  double distance = 0, s = 0, u = 0;
};
Approach approach(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e) {
  const Vec3 r = p - q;
  const double dd = d.squaredNorm(), ee = e.squaredNorm(), de = d.dot(e), dr = d.dot(r), er = e.dot(r);
  const auto unit = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const double turn = dd * ee - de * de;
  Approach best;
  if (dd == 0.0) {
    best.u = ee > 0.0 ? unit(er / ee) : 0.0;
  } else if (ee == 0.0) {
    best.s = unit(-dr / dd);
  } else {
    best.s = turn > 1e-14 * dd * ee ? unit((de * er - dr * ee) / turn) : 0.0;
    best.u = (de * best.s + er) / ee;
    if (best.u < 0.0 || best.u > 1.0) {
      best.u = unit(best.u);
      best.s = unit((de * best.u - dr) / dd);
    }
  }
  best.distance = (r + best.s * d - best.u * e).norm();
  return best;
}

// A chord on its way.
struct Moving {
  Vec3 start, end, start_speed, end_speed;
  Moving(const Line& line, std::size_t i)
      : start(line.before[i]),
        end(line.before[i + 1]),
        start_speed(line.after[i] - line.before[i]),
        end_speed(line.after[i + 1] - line.before[i + 1]) {}
};

struct Meeting {
  double time = 0, s = 0, u = 0;
  Vec3 at = Vec3::Zero();
};

// When the chords come nearer to each other than `limit` for the first time.
std::optional<Meeting> meeting(const Moving& a, const Moving& b, double limit) {
  double speed = 0.0;  // of approach, at most: the speed along a chord lies between those of its ends
  for (const Vec3* of_a : {&a.start_speed, &a.end_speed})
    for (const Vec3* of_b : {&b.start_speed, &b.end_speed}) speed = std::max(speed, (*of_a - *of_b).norm());
  double time = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    const Vec3 p = a.start + time * a.start_speed, q = b.start + time * b.start_speed;
    const Vec3 d = a.end + time * a.end_speed - p, e = b.end + time * b.end_speed - q;
    const Approach now = approach(p, d, q, e);
    if (now.distance <= 1.001 * limit)
      return Meeting{time, now.s, now.u, 0.5 * (p + now.s * d + q + now.u * e)};
    if (time >= 1.0 || speed == 0.0) return std::nullopt;
    time = std::min(1.0, time + (now.distance - limit) / speed);
  }
  return Meeting{time, 0.5, 0.5, a.start + time * a.start_speed};
}

class Search {
 public:
  explicit Search(std::vector<Line> lines) : lines_(std::move(lines)) {
    for (std::size_t l = 0; l < lines_.size(); ++l)
      for (std::size_t i = 0; i < lines_[l].deviations.size(); ++i)
        chords_.push_back({static_cast<std::uint32_t>(l), static_cast<std::uint32_t>(i)});
  }

  std::vector<Passage> run() {
    std::vector<Box3> boxes;
    boxes.reserve(chords_.size());
    for (const Chord& chord : chords_) boxes.push_back(box_of(chord));
    BoxTree(std::move(boxes)).near_pairs(0.0, [&](std::uint32_t i, std::uint32_t k) {
      look_at(chords_[i], chords_[k]);
    });
    return one_a_place();
  }

 private:
  // Of the chord all along its way, with the room that its line may take beside it.
  [[nodiscard]] Box3 box_of(const Chord& chord) const {
    const Line& line = lines_[chord.line];
    Box3 box(line.before[chord.index]);
    box.extend(line.before[chord.index + 1]);
    box.extend(line.after[chord.index]);
    box.extend(line.after[chord.index + 1]);
    const double room = margin(chord);
    box.min().array() -= room;
    box.max().array() += room;
    return box;
  }
  [[nodiscard]] double margin(const Chord& chord) const {
    const Line& line = lines_[chord.line];
    return 1.1 * std::max(line.deviations[chord.index], 1e-9 * line.width);
  }
  [[nodiscard]] bool are_neighbours(const Chord& a, const Chord& b) const {
    if (a.line != b.line) return false;
    const Line& line = lines_[a.line];
    const auto [low, high] = std::minmax(a.index, b.index);
    double along = line.lengths[high] - line.lengths[low + 1];
    if (line.closed)
      along = std::min(along, line.lengths.back() - line.lengths[high + 1] + line.lengths[low]);
    return along < 1.5 * line.width;
  }

  void look_at(const Chord& a, const Chord& b) {
    if (are_neighbours(a, b)) return;
    const Line &line_a = lines_[a.line], &line_b = lines_[b.line];
    const std::optional<Meeting> met =
        meeting(Moving(line_a, a.index), Moving(line_b, b.index), margin(a) + margin(b));
    if (!met) return;
    const auto parameter = [](const Line& line, std::size_t i, double share) {
      return line.parameters[i] + share * (line.parameters[i + 1] - line.parameters[i]);
    };
    found_.push_back({a.line, b.line, parameter(line_a, a.index, met->s), parameter(line_b, b.index, met->u),
                      met->time, met->at});
  }

  // Neighbouring chords that meet in one place are one passage.
  std::vector<Passage> one_a_place() {
    std::sort(found_.begin(), found_.end(), [](const Passage& a, const Passage& b) {
      return std::tie(a.a, a.b, a.at_a, a.at_b) < std::tie(b.a, b.b, b.at_a, b.at_b);
    });
    std::vector<Passage> passages;
    for (const Passage& passage : found_) {
      const double near = std::min(lines_[passage.a].width, lines_[passage.b].width);
      bool known = false;
      for (auto other = passages.rbegin();
           !known && other != passages.rend() && other->a == passage.a && other->b == passage.b; ++other)
        known = (other->at - passage.at).norm() < near;
      if (!known) passages.push_back(passage);
    }
    return passages;
  }

  std::vector<Line> lines_;
  std::vector<Chord> chords_;
  std::vector<Passage> found_;
};

Status check_pair(const yarn::Body& before, const yarn::Body& after) {
  const auto fail = [&](std::string_view why) {
    return error(Kind::geometry, fmt::format("yarn '{}' {}", before.name, why));
  };
  for (const yarn::Body* body : {&before, &after}) {
    if (body->axis.points.empty() || body->surface.is_empty())
      return fail("has no centre line or no surface");
    for (const Vec3& p : body->axis.points)
      if (!p.allFinite()) return fail("has a centre line with numbers that are not finite");
  }
  if (before.axis.first_parameter() != after.axis.first_parameter() ||
      before.axis.last_parameter() != after.axis.last_parameter())
    return fail("has other parameters after than before");
  if (!(yarn::widest_section(before) > 0.0)) return fail("has sections without a size");
  return {};
}

}  // namespace

Result<std::vector<Passage>> find_passages(std::span<const yarn::Body> before,
                                           std::span<const yarn::Body> after) {
  if (before.size() != after.size())
    return error(Kind::geometry, fmt::format("{} yarns before, {} after", before.size(), after.size()));
  std::vector<Line> lines;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (Status fits = check_pair(before[i], after[i]); !fits) return fits.error();
    lines.push_back(line_of(before[i], after[i]));
  }
  return Search(std::move(lines)).run();
}

}  // namespace selvage::contact
