#include "nurbs/edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "core/wrapped.h"
#include "nurbs/basis.h"
#include "nurbs/measure.h"
#include "nurbs/roots.h"

namespace selvage::nurbs {

namespace {

// Positions nearer than this share of the control triangle's size are equal to move_joint_by_weight.
constexpr double position_tolerance = 1e-9;

// Coordinates of a message; what is rounding beside the others is shown as 0.
std::string text_of(const Vec3& p) {
  const double rounding = 1e-12 * p.lpNorm<Eigen::Infinity>();
  const auto shown = [&](double c) { return std::abs(c) < rounding ? 0.0 : c; };
  return fmt::format("({:.12g}, {:.12g}, {:.12g})", shown(p.x()), shown(p.y()), shown(p.z()));
}

// A control point with its weight.
struct Row {
  Vec3 point;
  double weight = 1;
};

// The control points that move a curve's joints: its own ones, or on a closed curve those of the periodic
// form. Row i of the latter is the one in the middle of joint i (from 0); rows 1 .. n - 1 are the points 2 ..
// n of the clamped form, and near the seam both forms are blends of each other (interpolate_periodic has the
// same ones).
class Rows {
 public:
  Rows(const Curve& curve, bool closed)
      : curve_(curve), closed_(closed), breaks_(breakpoints(curve.knots, curve.degree)) {
    if (!closed_) return;
    const auto share = [&](int i, int j) {  // of the later one of two rows, in the blend at the seam
      return (knot(0) - knot(i)) / (knot(j) - knot(i));
    };
    after_ = share(-1, 2);
    before_ = share(-2, 1);
    seam_ = share(-1, 1);
  }

  [[nodiscard]] const Curve& curve() const { return curve_; }
  [[nodiscard]] int spans() const { return static_cast<int>(breaks_.size()) - 1; }
  [[nodiscard]] double breakpoint(int i) const { return breaks_[at(i)]; }

  // Knots of the periodic form, any index; knot(0) is the seam.
  [[nodiscard]] double knot(int i) const {
    const int k = wrapped(i, spans()), turns = (i - k) / spans();
    return breaks_[at(k)] + turns * (breaks_.back() - breaks_.front());
  }

  [[nodiscard]] Row get(int i) const {
    if (!closed_) return own(i);
    if (i > 0) return own(i + 1);
    // The point after the seam is the blend of rows 0 and 1.
    const Row next = own(2), blend = own(1);
    Row row;
    row.weight = (blend.weight - after_ * next.weight) / (1.0 - after_);
    row.point =
        (blend.weight * blend.point - after_ * next.weight * next.point) / (1.0 - after_) / row.weight;
    return row;
  }

  void set(int i, const Row& row) {
    if (!closed_) return set_own(i, row);
    const Row old = get(i);
    if (i > 0) set_own(i + 1, row);
    const int last = spans() - 1;
    const double to_after = i == 0 ? 1.0 - after_ : i == 1 ? after_ : 0.0;
    const double to_before = i == 0 ? before_ : i == last ? 1.0 - before_ : 0.0;
    add(1, to_after, old, row);
    add(spans() + 1, to_before, old, row);
    add(0, (1.0 - seam_) * to_before + seam_ * to_after, old, row);
    set_own(spans() + 2, own(0));
  }

 private:
  [[nodiscard]] Row own(int i) const { return {curve_.points[at(i)], curve_.weight(at(i))}; }
  void set_own(int i, const Row& row) {
    if (!curve_.is_rational() && row.weight != 1.0) curve_.weights.assign(curve_.points.size(), 1.0);
    curve_.points[at(i)] = row.point;
    if (curve_.is_rational()) curve_.weights[at(i)] = row.weight;
  }
  // Adds a share of a row's change to one point, in homogeneous coordinates.
  void add(int i, double share, const Row& old, const Row& now) {
    if (share == 0.0) return;
    Row row = own(i);
    const double weight = row.weight + share * (now.weight - old.weight);
    row.point = (row.weight * row.point + share * (now.weight * now.point - old.weight * old.point)) / weight;
    row.weight = weight;
    set_own(i, row);
  }

  Curve curve_;
  bool closed_;
  std::vector<double> breaks_;
  double after_ = 0, before_ = 0, seam_ = 0;
};

// The rows whose basis functions do not vanish at a joint, with the functions' values.
struct Joint {
  double parameter = 0;
  std::vector<int> rows;
  std::vector<double> values;
  std::vector<double> shares;  // R_i: values times weights, over their sum
  Vec3 position = Vec3::Zero();
  int main = 0;  // index of the row with the largest share; of equal ones the one in the middle
};

Joint joint_of(const Rows& rows, bool closed, int number) {
  const Curve& curve = rows.curve();
  Joint joint;
  joint.parameter = rows.breakpoint(number - 1);
  BasisRow values;
  if (closed) {
    const int j = number - 1, n = rows.spans();
    std::vector<double> knots;
    for (int i = j - 3; i <= j + 3; ++i) knots.push_back(rows.knot(i));
    basis(knots, 3, 3, rows.knot(j), values);
    joint.rows = {(j + n - 1) % n, j, (j + 1) % n};
    joint.values.assign(values.begin(), values.begin() + 3);
  } else {
    const int span =
        find_span(curve.knots, curve.degree, static_cast<int>(curve.points.size()), joint.parameter);
    basis(curve.knots, curve.degree, span, joint.parameter, values);
    for (int k = 0; k <= curve.degree; ++k) {
      if (values[at(k)] <= 0.0) continue;
      joint.rows.push_back(span - curve.degree + k);
      joint.values.push_back(values[at(k)]);
    }
  }
  double total = 0.0;
  for (std::size_t k = 0; k < joint.rows.size(); ++k) {
    joint.shares.push_back(joint.values[k] * rows.get(joint.rows[k]).weight);
    total += joint.shares.back();
  }
  joint.main = static_cast<int>(joint.rows.size()) / 2;
  for (std::size_t k = 0; k < joint.rows.size(); ++k) {
    joint.shares[k] /= total;
    joint.position += joint.shares[k] * rows.get(joint.rows[k]).point;
  }
  for (std::size_t k = 0; k < joint.rows.size(); ++k)
    if (joint.shares[k] > joint.shares[at(joint.main)]) joint.main = static_cast<int>(k);
  return joint;
}

Status check(const Curve& curve, bool closed, int number) {
  const int count = joint_count(curve, closed);
  if (number < 1 || number > count)
    return error(Kind::geometry, fmt::format("there is no joint {}: the centre line has {}", number, count));
  const std::vector<double> breaks = breakpoints(curve.knots, curve.degree);
  const int last = static_cast<int>(breaks.size()) - 1;
  if ((closed || (number > 1 && number <= last)) &&
      multiplicity(curve.knots, breaks[at(number - 1)]) == curve.degree)
    return error(
        Kind::geometry,
        fmt::format("joint {} stands on its control point, as where an arc meets a straight: moving it "
                    "would make a corner",
                    number));
  if (!closed) return {};
  const bool is_simple = std::all_of(breaks.begin() + 1, breaks.end() - 1,
                                     [&](double t) { return multiplicity(curve.knots, t) == 1; });
  if (curve.degree != 3 || last < 3 || !is_simple || multiplicity(curve.knots, breaks.front()) != 4 ||
      multiplicity(curve.knots, breaks.back()) != 4 || curve.points.front() != curve.points.back())
    return error(Kind::geometry,
                 "only a closed cubic with at least three segments and simple knots can be edited");
  return {};
}

// --- by weight

struct Triangle {
  std::array<Row, 3> rows;
  std::array<double, 3> values{};       // of the basis functions
  std::array<double, 2> low{}, high{};  // ranges of the outer weights
  Vec3 normal = Vec3::Zero();           // not unit: twice the area
  double size = 0;                      // longest edge

  [[nodiscard]] Vec3 joint(double first, double last) const {
    const double a = values[0] * first, b = values[1] * rows[1].weight, c = values[2] * last;
    return (a * rows[0].point + b * rows[1].point + c * rows[2].point) / (a + b + c);
  }
  [[nodiscard]] bool is_flat() const { return normal.norm() <= position_tolerance * size * size; }
};

Triangle triangle_of(const Rows& rows, const Joint& joint) {
  Triangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.rows[k] = rows.get(joint.rows[k]);
    triangle.values[k] = joint.values[k];
  }
  const auto& [a, b, c] = triangle.rows;
  for (std::size_t k = 0; k < 2; ++k) {
    const double own = triangle.rows[2 * k].weight;
    triangle.low[k] = std::min(own, b.weight / largest_weight_ratio);
    triangle.high[k] = std::max(own, b.weight * largest_weight_ratio);
  }
  triangle.normal = (c.point - a.point).cross(b.point - a.point);
  triangle.size =
      std::max({(b.point - a.point).norm(), (c.point - b.point).norm(), (a.point - c.point).norm()});
  return triangle;
}

Vec3 nearest_reachable(const Triangle& t, const Vec3& target) {
  const std::array<Vec3, 4> corners = {t.joint(t.low[0], t.low[1]), t.joint(t.high[0], t.low[1]),
                                       t.joint(t.high[0], t.high[1]), t.joint(t.low[0], t.high[1])};
  if (!t.is_flat()) {
    const Vec3 normal = t.normal.normalized();
    Vec3 foot = target - (target - t.rows[1].point).dot(normal) * normal;
    int left = 0, right = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 &from = corners[k], &to = corners[(k + 1) % 4];
      const double side = (to - from).cross(foot - from).dot(normal);
      if (side > 0.0) ++left;
      if (side < 0.0) ++right;
    }
    if (left == 0 || right == 0) return foot;
  }
  Vec3 best = corners[0];
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 &from = corners[k], &to = corners[(k + 1) % 4];
    const Vec3 point = from + nearest_share(target, from, to) * (to - from);
    if ((point - target).norm() < (best - target).norm()) best = point;
  }
  return best;
}

// The outer weights that bring the joint to a point of the reachable quadrilateral.
std::array<double, 2> outer_weights(const Triangle& t, const Vec3& point) {
  const auto& [a, b, c] = t.rows;
  const Vec3 to_a = a.point - point, to_c = c.point - point, from_b = point - b.point;
  const double middle = t.values[1] * b.weight;
  std::array<double, 2> weights = {a.weight, c.weight};
  if (!t.is_flat()) {
    // w1 B1 (v1 - p) + w3 B3 (v3 - p) = w2 B2 (p - v2), crossed with (v3 - p) and (v1 - p): the paper's
    // quotients of determinants.
    const double area = to_a.cross(to_c).dot(t.normal);
    weights[0] = from_b.cross(to_c).dot(t.normal) / area * middle / t.values[0];
    weights[1] = to_a.cross(from_b).dot(t.normal) / area * middle / t.values[2];
  } else {
    // On a line there is one equation: the first weight goes as far as it may, the last one the rest.
    const Vec3 along = (c.point - a.point).norm() > 0.0 ? c.point - a.point : b.point - a.point;
    const double x = t.values[0] * to_a.dot(along), z = t.values[2] * to_c.dot(along);
    const double y = middle * -from_b.dot(along);
    if (x != 0.0) weights[0] = std::clamp(-(y + z * weights[1]) / x, t.low[0], t.high[0]);
    if (z != 0.0) weights[1] = -(y + x * weights[0]) / z;
  }
  for (std::size_t k = 0; k < 2; ++k) weights[k] = std::clamp(weights[k], t.low[k], t.high[k]);
  return weights;
}

// The weight of row k that alone brings the joint to the target; 0 when there is none. With w_k times s the
// joint is J + l (v_k - J), where l = (s - 1) R_k / (1 + (s - 1) R_k).
double single_weight(const Triangle& t, const Joint& joint, std::size_t k, const Vec3& target) {
  const Vec3 along = t.rows[k].point - joint.position, move = target - joint.position;
  if (along.squaredNorm() == 0.0) return 0.0;
  const double l = move.dot(along) / along.squaredNorm();
  if (l >= 1.0 || (move - l * along).norm() > position_tolerance * t.size) return 0.0;
  const double weight = t.rows[k].weight * (1.0 + l / (joint.shares[k] * (1.0 - l)));
  const auto is_in_range = [&](std::size_t outer, double ratio) {  // ratio: to the middle one's
    const double middle = t.rows[1].weight;
    return ratio * middle >= t.low[outer / 2] && ratio * middle <= t.high[outer / 2];
  };
  if (k != 1) return is_in_range(k, weight / t.rows[1].weight) ? weight : 0.0;
  const bool fits =
      weight > 0.0 && is_in_range(0, t.rows[0].weight / weight) && is_in_range(2, t.rows[2].weight / weight);
  return fits ? weight : 0.0;
}

Message unreachable(const Triangle& t, int number, const Vec3& target, const Vec3& nearest) {
  std::string reason;
  const double height = t.is_flat() ? 0.0 : std::abs((target - nearest).dot(t.normal.normalized()));
  const bool is_off = height > position_tolerance * t.size;
  if (t.is_flat())
    reason = "its control points lie in one line, and the target is not between them on it";
  else if (is_off)
    reason = fmt::format("the target lies {:.6g} off the plane of its three control points", height);
  else
    reason = fmt::format(
        "the target lies outside the triangle of its control points, or so near its edge that a weight would "
        "have to pass {:g} times another",
        largest_weight_ratio);
  Message message =
      error(Kind::geometry,
            fmt::format("no weights bring joint {} to {}: {}; the nearest point that they reach is {}",
                        number, text_of(target), reason, text_of(nearest)));
  return message;
}

Status check_weights(const Joint& joint, int number) {
  if (joint.rows.size() == 3) return {};
  const std::string reason = joint.rows.size() == 1
                                 ? "it is an end, which stands on its control point; the nearest point "
                                   "that they reach is where it is, " +
                                       text_of(joint.position)
                                 : "they can where three control points hold it, at a simple knot of a cubic";
  return error(Kind::geometry, fmt::format("weights do not move joint {}: {}", number, reason));
}

// --- to a length

// The curve as one joint slides along a direction; everything but its control point stands still.
class Slide {
 public:
  Slide(const Curve& curve, bool closed, int number, const Vec3& direction)
      : still_(curve, closed), rows_(still_), closed_(closed), joint_(joint_of(rows_, closed, number)) {
    row_ = joint_.rows[at(joint_.main)];
    start_ = rows_.get(row_);
    step_ = direction.stableNormalized() / joint_.shares[at(joint_.main)];
    from_ = curve.first_parameter();
    to_ = curve.last_parameter();
    if (!closed) {
      from_ = std::max(from_, curve.knots[at(row_)]);
      to_ = std::min(to_, curve.knots[at(row_ + curve.degree + 1)]);
    }
    fixed_ =
        arc_length(curve, curve.first_parameter(), from_) + arc_length(curve, to_, curve.last_parameter());
  }

  double length(double displacement) {
    if (closed_) rows_ = still_;  // near the seam a change is added to what is there
    rows_.set(row_, {start_.point + displacement * step_, start_.weight});
    return fixed_ + arc_length(rows_.curve(), from_, to_);
  }
  // As it is after the last call of length().
  [[nodiscard]] const Curve& curve() const { return rows_.curve(); }

  // A displacement at which the curve is at least so long.
  double beyond(double wanted, double first_step) {
    double displacement = first_step;
    while (length(displacement) < wanted) displacement *= 2.0;
    return displacement;
  }

  // Where it is shortest between 0 and `most` (golden section: the length is convex).
  double shortest(double most) {
    constexpr double golden = 0.6180339887498949;
    double low = 0.0, high = most;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double length_a = length(a), length_b = length(b);
    for (int i = 0; i < 80; ++i) {
      if (length_a <= length_b) {
        high = b;
        b = a;
        length_b = length_a;
        a = high - golden * (high - low);
        length_a = length(a);
      } else {
        low = a;
        a = b;
        length_a = length_b;
        b = low + golden * (high - low);
        length_b = length(b);
      }
    }
    return length(0.0) <= length_a ? 0.0 : a;
  }

  // The displacement between two at which the length is the wanted one, given that it is on different sides
  // at them.
  double solve(double wanted, double a, double b) {
    FalsePosition root{a, length(a) - wanted, b, length(b) - wanted};
    for (int i = 0; i < 200; ++i) {
      const double middle = root.crossing(), excess = length(middle) - wanted;
      if (std::abs(excess) <= 1e-14 * wanted || middle == root.from || middle == root.to) return middle;
      root.take(middle, excess);
    }
    return std::abs(root.at_from) < std::abs(root.at_to) ? root.from : root.to;
  }

 private:
  Rows still_, rows_;
  bool closed_;
  Joint joint_;
  int row_ = 0;
  Row start_;
  Vec3 step_ = Vec3::Zero();
  double from_ = 0, to_ = 0;  // what changes
  double fixed_ = 0;          // length of the rest
};

}  // namespace

int joint_count(const Curve& curve, bool closed) {
  return static_cast<int>(breakpoints(curve.knots, curve.degree).size()) - (closed ? 1 : 0);
}

Result<Curve> move_joint_by_control(const Curve& curve, bool closed, int number, const Vec3& target) {
  if (Status status = check(curve, closed, number); !status) return status.error();
  Rows rows(curve, closed);
  const Joint joint = joint_of(rows, closed, number);
  const int moved = joint.rows[at(joint.main)];
  const double share = joint.shares[at(joint.main)];
  const Row row = rows.get(moved);
  // An end becomes the target to the bit.
  rows.set(moved, {joint.rows.size() == 1 ? target : Vec3(row.point + (target - joint.position) / share),
                   row.weight});
  if (!rows.get(moved).point.allFinite())
    return error(Kind::geometry,
                 fmt::format("joint {} cannot go so far: no number holds its control point", number));
  return rows.curve();
}

Result<Vec3> nearest_by_weight(const Curve& curve, bool closed, int number, const Vec3& target) {
  if (Status status = check(curve, closed, number); !status) return status.error();
  const Rows rows(curve, closed);
  const Joint joint = joint_of(rows, closed, number);
  if (joint.rows.size() == 1) return joint.position;
  if (Status status = check_weights(joint, number); !status) return status.error();
  return nearest_reachable(triangle_of(rows, joint), target);
}

Result<Curve> move_joint_by_weight(const Curve& curve, bool closed, int number, const Vec3& target) {
  if (Status status = check(curve, closed, number); !status) return status.error();
  Rows rows(curve, closed);
  const Joint joint = joint_of(rows, closed, number);
  if (target == joint.position) return curve;
  if (Status status = check_weights(joint, number); !status) return status.error();
  const Triangle triangle = triangle_of(rows, joint);
  for (const std::size_t k : {1U, 0U, 2U}) {
    const double weight = single_weight(triangle, joint, k, target);
    if (weight <= 0.0) continue;
    rows.set(joint.rows[k], {triangle.rows[k].point, weight});
    return rows.curve();
  }
  const Vec3 nearest = nearest_reachable(triangle, target);
  if ((nearest - target).norm() > position_tolerance * triangle.size)
    return unreachable(triangle, number, target, nearest);
  const std::array<double, 2> weights = outer_weights(triangle, nearest);
  rows.set(joint.rows[0], {triangle.rows[0].point, weights[0]});
  rows.set(joint.rows[2], {triangle.rows[2].point, weights[1]});
  return rows.curve();
}

Result<Curve> move_joint_to_length(const Curve& curve, bool closed, int number, double wanted,
                                   const Vec3& direction) {
  if (Status status = check(curve, closed, number); !status) return status.error();
  Slide slide(curve, closed, number, direction);
  const double present = slide.length(0.0);
  if (wanted > 1e6 * present)
    return error(
        Kind::geometry,
        fmt::format("a length of {:.6g} is more than a million times the present {:.6g}", wanted, present));
  if (std::abs(wanted - present) <= 1e-14 * wanted) return curve;
  const double scale = std::max(present, wanted) / 16.0;
  const auto reached = [&](double displacement) -> Result<Curve> {
    const double length = slide.length(displacement);
    if (std::abs(length - wanted) <= 1e-12 * wanted) return slide.curve();
    return error(Kind::geometry,
                 fmt::format("joint {} cannot be placed so that the length is {:.9g}: rounding leaves "
                             "{:.9g}",
                             number, wanted, length));
  };
  if (wanted > present) return reached(slide.solve(wanted, 0.0, slide.beyond(wanted, scale)));
  const double turn = slide.shortest(slide.beyond(present, scale)), least = slide.length(turn);
  if (least <= wanted) return reached(slide.solve(wanted, 0.0, turn));
  Slide opposite(curve, closed, number, -direction);
  const double other_way = opposite.length(opposite.shortest(opposite.beyond(present, scale)));
  return error(Kind::geometry,
               fmt::format("joint {} moved along {} makes it {:.9g} long at the shortest, and {:.9g} "
                           "is asked for; the other way it can be {:.9g} at the shortest",
                           number, text_of(direction), least, wanted, other_way));
}

}  // namespace selvage::nurbs
