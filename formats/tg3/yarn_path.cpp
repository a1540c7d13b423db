#include "formats/tg3/yarn_path.h"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace selvage::formats::tg3 {

namespace {

using Form = Interpolation::Form;

// Cubic Hermite over [0, 1]: value, first and second derivative.
std::array<Vec3, 3> hermite(const Vec3& p, const Vec3& q, const Vec3& dp, const Vec3& dq, double t) {
  const Vec3 c = 3 * (q - p) - 2 * dp - dq, d = 2 * (p - q) + dp + dq;
  return {p + t * (dp + t * (c + t * d)), dp + t * (2 * c + 3 * t * d), 2 * c + 6 * t * d};
}

// The unit vector of v, and its derivative.
std::pair<Vec3, Vec3> unit_jet(const Vec3& v, const Vec3& dv) {
  const double size = v.norm();
  const Vec3 unit = v / size;
  return {unit, (dv - unit * unit.dot(dv)) / size};
}

Adjustment shift_at(const std::vector<Adjustment>& adjustments, double t, double from) {
  if (adjustments.empty()) return {};
  // The piece on the side of `from`.
  const double inside = t + 1e-9 * (from - t);
  if (inside <= adjustments.front().t) return {0, adjustments.front().by};
  if (inside >= adjustments.back().t) return {0, adjustments.back().by};
  const auto next = std::ranges::upper_bound(adjustments, inside, {}, &Adjustment::t), last = next - 1;
  return {t, last->by + (t - last->t) / (next->t - last->t) * (next->by - last->by)};
}

Vec3 slope_at(const std::vector<Adjustment>& adjustments, double t, double from) {
  const double inside = t + 1e-9 * (from - t);
  if (adjustments.empty() || inside <= adjustments.front().t || inside >= adjustments.back().t)
    return Vec3::Zero();
  const auto next = std::ranges::upper_bound(adjustments, inside, {}, &Adjustment::t), last = next - 1;
  return (next->by - last->by) / (next->t - last->t);
}

bool is_across(const Vec3& up, const Vec3& tangent) {
  constexpr double least = 1e-9;  // sine of the angle between them
  return up.normalized().cross(tangent.normalized()).norm() >= least;
}

Message at_node(const PathNode& node, std::string text) {
  return error(Kind::geometry, std::move(text)).placed(node.place).at_point(node.position);
}

}  // namespace

Result<YarnPath> YarnPath::make(std::vector<PathNode> nodes, Interpolation interpolation) {
  YarnPath path;
  path.nodes_ = std::move(nodes);
  path.interpolation_ = std::move(interpolation);
  for (std::size_t i = 1; i < path.nodes_.size(); ++i)
    if (path.nodes_[i].position == path.nodes_[i - 1].position)
      return at_node(path.nodes_[i], "this node stands where the one before it stands; remove one of them");
  if (Status set = path.set_tangents(); !set) return set.error();
  if (path.interpolation_.form == Form::cubic) path.set_cubics();
  path.replace_ups();
  if (Status checked = path.check_frames(); !checked) return checked.error();
  // Composite Gauss of three points, 16 to a span.
  constexpr int parts = 16;
  const double far = std::sqrt(0.6);
  for (std::size_t i = 0; i < path.spans(); ++i) {
    double length = 0;
    for (int k = 0; k < parts; ++k)
      for (const auto& [x, weight] :
           {std::pair{-far, 5.0 / 18}, std::pair{0.0, 8.0 / 18}, std::pair{far, 5.0 / 18}}) {
        const double t = (k + 0.5 + 0.5 * x) / parts;
        length += weight / parts * path.line_at(i, t, t).d1.norm();
      }
    path.lengths_.push_back(length);
  }
  return path;
}

Status YarnPath::set_tangents() {
  const std::size_t last = nodes_.size() - 1;
  const Vec3 period = nodes_[last].position - nodes_[0].position;
  for (std::size_t i = 0; i <= last; ++i) {
    const bool is_periodic = interpolation_.is_periodic;
    Vec3 before = nodes_[i == 0 ? 0 : i - 1].position, after = nodes_[i == last ? last : i + 1].position;
    if (i == 0 && is_periodic) before = nodes_[last - 1].position - period;
    if (i == last && is_periodic) after = nodes_[1].position + period;
    const bool is_given = nodes_[i].tangent != Vec3::Zero();
    Vec3 tangent = is_given ? nodes_[i].tangent.normalized() : unit_or_zero(after - before);
    if (interpolation_.has_flat_nodes) tangent.z() = 0;
    if (interpolation_.form != Form::cubic && tangent.norm() < 1e-9)
      return at_node(nodes_[i],
                     "the line has no direction at this node: its neighbours are in one place, or its "
                     "tangent is made flat; give it a tangent");
    tangents_.push_back(tangent);
  }
  return {};
}

// Derivatives at the nodes of the cubic spline over the nodes' numbers: periodic, or natural (no curvature at
// its ends).
void YarnPath::set_cubics() {
  const auto count = static_cast<Eigen::Index>(nodes_.size()), last = count - 1;
  const auto p = [&](Eigen::Index i) { return nodes_[static_cast<std::size_t>(i)].position.transpose(); };
  const Eigen::Index unknowns = interpolation_.is_periodic ? last : count;
  std::vector<Eigen::Triplet<double>> left;  // what stands at one place is added
  const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
    left.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  Eigen::MatrixXd right(unknowns, 3);
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    if (interpolation_.is_periodic) {
      add(i, i, 4);
      add(i, (i + 1) % unknowns, 1);
      add(i, (i + unknowns - 1) % unknowns, 1);
      right.row(i) = 3 * (p(i + 1) - p(i));
      right.row(i) += i == 0 ? 3 * (p(last) - p(last - 1)) : 3 * (p(i) - p(i - 1));
    } else {
      add(i, i, i == 0 || i == last ? 2 : 4);
      if (i > 0) add(i, i - 1, 1);
      if (i < last) add(i, i + 1, 1);
      right.row(i) = 3 * (p(std::min(i + 1, last)) - p(std::max<Eigen::Index>(i - 1, 0)));
    }
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(left.begin(), left.end());
  const Eigen::MatrixXd slopes = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  for (Eigen::Index i = 0; i < count; ++i)
    tangents_[static_cast<std::size_t>(i)] = slopes.row(i % unknowns).transpose();
}

void YarnPath::replace_ups() {
  const double steep = std::sin(6 * std::numbers::pi / 180);  // to z, as in Fabric TXT
  std::vector<Vec3> along;
  std::vector<bool> is_good;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::size_t span = std::min(i, spans() - 1);
    along.push_back(unit_or_zero(line_at(span, i == span ? 0 : 1, 0.5).tangent));
    is_good.push_back(along[i] == Vec3::Zero() || is_across(nodes_[i].up, along[i]));
  }
  const auto nearest_good = [&](std::size_t i) -> std::optional<std::size_t> {
    for (std::size_t away = 1; away < nodes_.size(); ++away) {
      if (i >= away && is_good[i - away]) return i - away;
      if (i + away < nodes_.size() && is_good[i + away]) return i + away;
    }
    return std::nullopt;
  };
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (is_good[i]) continue;
    ++num_replaced_ups_;
    if (const std::optional<std::size_t> other = nearest_good(i))
      nodes_[i].up = Eigen::Quaterniond::FromTwoVectors(along[*other], along[i]) * nodes_[*other].up;
    else
      nodes_[i].up = along[i].cross(Vec3::UnitZ()).norm() < steep ? Vec3::UnitY() : Vec3::UnitZ();
  }
}

Status YarnPath::check_frames() const {
  constexpr int samples = 8;
  for (std::size_t i = 0; i < spans(); ++i)
    for (int k = 0; k <= samples; ++k) {
      const double t = static_cast<double>(k) / samples;
      const Vec3 tangent = line_at(i, t, 0.5).tangent;
      const Vec3 up = nodes_[i].up + t * (nodes_[i + 1].up - nodes_[i].up);
      if (tangent.norm() < 1e-9) return at_node(nodes_[i], "the line stands still behind this node; move it");
      if (up.norm() < 1e-9)
        return at_node(nodes_[i],
                       "the directions `Up` of this node and of the next cancel each other between them; "
                       "turn one of them");
      if (!is_across(up, tangent))
        return at_node(nodes_[i], "the direction `Up` lies along the line at or behind this node; turn it");
    }
  return {};
}

double YarnPath::knot_span(std::size_t span) const {
  if (interpolation_.form == Form::cubic) return 1.0;
  return (nodes_[span + 1].position - nodes_[span].position).norm();
}

YarnPath::Line YarnPath::line_at(std::size_t span, double t, double from) const {
  const Vec3 &p = nodes_[span].position, &q = nodes_[span + 1].position;
  const double chord = (q - p).norm();
  Line line;
  switch (interpolation_.form) {
    case Form::linear:
      line.position = p + t * (q - p);
      line.d1 = q - p;
      line.tangent = tangents_[span] + t * (tangents_[span + 1] - tangents_[span]);
      line.tangent_dt = tangents_[span + 1] - tangents_[span];
      break;
    case Form::bezier:
    case Form::cubic: {
      const double size = interpolation_.form == Form::bezier ? chord : 1.0;
      const auto [position, d1, d2] = hermite(p, q, size * tangents_[span], size * tangents_[span + 1], t);
      line = {position, d1, d1, d2};
      break;
    }
  }
  if (interpolation_.has_flat_frames) line.tangent.z() = line.tangent_dt.z() = 0;
  if (span < interpolation_.adjustments.size()) {
    const std::vector<Adjustment>& adjustments = interpolation_.adjustments[span];
    line.position += shift_at(adjustments, t, from).by;
    line.d1 += slope_at(adjustments, t, from);
  }
  return line;
}

PathJet YarnPath::at(std::size_t span, double t, double from) const {
  const Line line = line_at(span, t, from);
  const PathNode &first = nodes_[span], &second = nodes_[span + 1];
  const auto [tangent, tangent_dt] = unit_jet(line.tangent, line.tangent_dt);
  // TexGen's `up` between two nodes, less its part along the line.
  const Vec3 raw = first.up + t * (second.up - first.up), raw_dt = second.up - first.up;
  const Vec3 across = raw - tangent * tangent.dot(raw);
  const Vec3 across_dt =
      raw_dt - tangent_dt * tangent.dot(raw) - tangent * (tangent_dt.dot(raw) + tangent.dot(raw_dt));
  const auto [up, up_dt] = unit_jet(across, across_dt);
  const Vec3 side = tangent.cross(up), side_dt = tangent_dt.cross(up) + tangent.cross(up_dt);
  const double angle = first.angle + t * (second.angle - first.angle), angle_dt = second.angle - first.angle;
  const double c = std::cos(angle), s = std::sin(angle);
  // Turned about `up`, in which plane the tangent is a quarter turn ahead of the side.
  PathJet jet;
  jet.position = line.position;
  jet.position_dt = line.d1;
  jet.up = up;
  jet.up_dt = up_dt;
  jet.side = c * side + s * tangent;
  jet.side_dt = c * side_dt + s * tangent_dt + angle_dt * (c * tangent - s * side);
  return jet;
}

}  // namespace selvage::formats::tg3
