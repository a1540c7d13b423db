#include "formats/tg3/yarn_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bounds.h"
#include "core/index.h"
#include "formats/tg3/outline_points.h"

namespace selvage::formats::tg3 {

namespace {

constexpr double same_place = 1e-6;      // of a section's size
constexpr double same_direction = 2e-3;  // radians by which a surface turns and still counts as smooth
constexpr int most_parts = 64;           // of a piece

using Row = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // a point of the outline each

struct RowJet {
  Row at, slope;  // the slope by the surface's parameter
};

struct PointJet {
  Vec2 at, by_u;
};
PointJet blended(const Vec2& p, const Vec2& q, double u, const Blend& blend) {
  const double share = blend.is_ramped ? u * u * (3 - 2 * u) : u;
  const double rate = blend.is_ramped ? 6 * u * (1 - u) : 1;
  if (!blend.is_polar) return {p + share * (q - p), rate * (q - p)};
  const double radius = p.norm(), growth = q.norm() - radius;
  const double angle = std::atan2(p.y(), p.x());
  const double turn = std::remainder(std::atan2(q.y(), q.x()) - angle, 2 * std::numbers::pi);
  const double a = angle + share * turn, r = radius + share * growth;
  const Vec2 out(std::cos(a), std::sin(a)), round(-out.y(), out.x());
  return {r * out, rate * (growth * out + r * turn * round)};
}

// An interval along the yarn, with a cubic of its own.
struct Interval {
  double width = 0;  // of the surface's parameter
  RowJet from, to;
  Row halfway, halfway_slope;
};

class Surface {
 public:
  explicit Surface(const YarnShape& shape)
      : shape_(shape),
        outline_(shape.sections, shape.adjustments.is_empty() ? shape.tolerance / 2 : 0.0),
        ts_(outline_.section_parameters()) {
    for (const BlendPiece& piece : shape.pieces) add_cut(piece);
    parts_.assign(pieces_.size(), 1);
    thinnest_ = infinity;
    for (const std::vector<Vec2>& points : outline_.points()) {
      const Vec2 sizes = bounds_of(points).sizes();
      thinnest_ = std::min(thinnest_, sizes.minCoeff());
      widest_ = std::max(widest_, sizes.maxCoeff());
    }
  }

  Result<YarnUnit> make(std::size_t most) {
    const std::size_t round = outline_.knots().size();
    while (true) {
      std::size_t intervals = 0;
      for (const int parts : parts_) intervals += at(parts);
      if (intervals * 2 * round > most)
        return error(Kind::limit,
                     fmt::format("the surface of this yarn would need more than {} control points; "
                                 "split the yarn",
                                 most));
      lay_intervals();
      agree_on_slopes();
      if (!refine()) break;
    }
    return written();
  }

 private:
  // A piece, cut where the line or its sections are adjusted.
  void add_cut(const BlendPiece& piece) {
    std::vector<double> cuts = {piece.t0}, bends = shape_.adjustments.bends_along(piece.span);
    const auto& adjustments = shape_.path.interpolation().adjustments;
    if (piece.span < adjustments.size())
      for (const Adjustment& adjustment : adjustments[piece.span]) bends.push_back(adjustment.t);
    std::sort(bends.begin(), bends.end());
    for (const double t : bends)
      if (t > cuts.back() + 1e-9 && t < piece.t1 - 1e-9) cuts.push_back(t);
    cuts.push_back(piece.t1);
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      BlendPiece part = piece;
      part.t0 = cuts[k];
      part.t1 = cuts[k + 1];
      const auto u_at = [&](double t) {
        return piece.u0 + (piece.u1 - piece.u0) * (t - piece.t0) / (piece.t1 - piece.t0);
      };
      part.u0 = u_at(part.t0);
      part.u1 = u_at(part.t1);
      pieces_.push_back(part);
    }
  }

  [[nodiscard]] RowJet row_at(const BlendPiece& piece, double t, double from) const {
    const PathJet jet = shape_.path.at(piece.span, t, from);
    const double pace = 1.0 / shape_.path.knot_span(piece.span);
    const double du = (piece.u1 - piece.u0) / (piece.t1 - piece.t0), u = piece.u0 + (t - piece.t0) * du;
    const std::vector<Vec2>&p = outline_.points()[piece.from], &q = outline_.points()[piece.to];
    RowJet row{Row(p.size(), 3), Row(p.size(), 3)};
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto [blend, by_u] = blended(p[i], q[i], u, shape_.blend);
      const auto [shift, shift_dt] = shape_.adjustments.at(piece.span, t, from, ts_[i]);
      const Vec2 point = blend + shift, by_t = du * by_u + shift_dt;
      const auto k = static_cast<Eigen::Index>(i);
      row.at.row(k) = jet.position + point.x() * jet.side + point.y() * jet.up;
      row.slope.row(k) = pace * (jet.position_dt + point.x() * jet.side_dt + point.y() * jet.up_dt +
                                 by_t.x() * jet.side + by_t.y() * jet.up);
    }
    return row;
  }

  void lay_intervals() {
    intervals_.clear();
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      const BlendPiece& piece = pieces_[k];
      const double step = (piece.t1 - piece.t0) / parts_[k];
      for (int i = 0; i < parts_[k]; ++i) {
        const double t0 = piece.t0 + i * step, t1 = i + 1 < parts_[k] ? t0 + step : piece.t1;
        const double halfway = (t0 + t1) / 2;
        RowJet middle = row_at(piece, halfway, halfway);
        intervals_.push_back({(t1 - t0) * shape_.path.knot_span(piece.span), row_at(piece, t0, halfway),
                              row_at(piece, t1, halfway), std::move(middle.at), std::move(middle.slope)});
      }
    }
  }

  static bool is_smooth(const Row& before, const Row& behind) {
    for (Eigen::Index i = 0; i < before.rows(); ++i) {
      const Vec3 a = before.row(i), b = behind.row(i);
      if (a.dot(b) < 0 || a.cross(b).norm() > same_direction * a.norm() * b.norm()) return false;
    }
    return true;
  }
  // One slope for both sides where they have one direction: sections slide on the surface then, no more.
  void agree_on_slopes() {
    bends_.assign(intervals_.size() + 1, false);
    for (std::size_t j = 0; j < intervals_.size(); ++j) {
      const bool is_last = j + 1 == intervals_.size();
      RowJet& before = intervals_[j].to;
      RowJet& behind = intervals_[is_last ? 0 : j + 1].from;
      if (is_last && !goes_on()) continue;
      bends_[j + 1] = !is_smooth(before.slope, behind.slope);
      if (bends_[j + 1]) continue;
      before.slope = behind.slope = Row(0.5 * (before.slope + behind.slope));
    }
  }
  [[nodiscard]] Vec3 shift() const {
    return shape_.path.nodes().back().position - shape_.path.nodes().front().position;
  }
  [[nodiscard]] bool goes_on() const {
    const Row moved = intervals_.front().from.at.rowwise() + shift().transpose();
    return (intervals_.back().to.at - moved).rowwise().norm().maxCoeff() <= same_place * widest_;
  }

  // Doubles the parts of the pieces that are too far off; false: none is.
  bool refine() {
    bool any = false;
    deviation_ = 0;
    std::size_t j = 0;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      double worst = 0;
      for (int i = 0; i < parts_[k]; ++i, ++j) {
        const Interval& one = intervals_[j];
        const Row cubic = 0.5 * (one.from.at + one.to.at) + one.width / 8 * (one.from.slope - one.to.slope);
        for (Eigen::Index r = 0; r < cubic.rows(); ++r) {
          const Vec3 miss = cubic.row(r) - one.halfway.row(r), along = one.halfway_slope.row(r);
          worst = std::max(worst, (miss - miss.dot(along) / along.squaredNorm() * along).norm());
        }
      }
      deviation_ = std::max(deviation_, worst);
      if (worst <= std::max(along_share * thinnest_, shape_.tolerance / 2) || parts_[k] >= most_parts)
        continue;
      parts_[k] *= 2;
      any = true;
    }
    return any;
  }

  [[nodiscard]] YarnUnit written() const {
    // Rows of control points along, still through the outlines' points.
    std::vector<Row> rows = {intervals_.front().from.at};
    std::vector<double> knots(4, 0.0);
    for (std::size_t j = 0; j < intervals_.size(); ++j) {
      const Interval& one = intervals_[j];
      const bool is_last = j + 1 == intervals_.size();
      rows.emplace_back(one.from.at + one.width / 3 * one.from.slope);
      rows.emplace_back(one.to.at - one.width / 3 * one.to.slope);
      if (is_last || bends_[j + 1]) rows.push_back(one.to.at);
      const double knot = knots.back() + one.width;
      knots.insert(knots.end(), is_last ? 4 : bends_[j + 1] ? 3 : 2, knot);
    }
    const Eigen::Index points = rows.front().rows();
    Eigen::MatrixXd data(points, 3 * static_cast<Eigen::Index>(rows.size()));
    for (std::size_t j = 0; j < rows.size(); ++j)
      data.middleCols(3 * static_cast<Eigen::Index>(j), 3) = rows[j];
    const Eigen::MatrixXd control = outline_.controls(data);
    YarnUnit unit;
    fabric::Grid& grid = unit.grid;
    grid.sections = static_cast<int>(rows.size());
    grid.per_section = static_cast<int>(control.rows());
    grid.degree_along = 3;
    grid.degree_round = outline_.degree();
    grid.knots_along = std::move(knots);
    grid.knots_round = outline_.knots();
    grid.open_round = true;
    for (std::size_t j = 0; j < rows.size(); ++j)
      for (Eigen::Index i = 0; i < control.rows(); ++i)
        grid.points.emplace_back(control.row(i).segment<3>(3 * static_cast<Eigen::Index>(j)).transpose());
    unit.deviation = outline_.deviation() + deviation_;
    unit.goes_on = goes_on();
    return unit;
  }

  const YarnShape& shape_;
  OutlinePoints outline_;
  std::vector<double> ts_;  // of its points
  std::vector<BlendPiece> pieces_;
  std::vector<int> parts_;
  std::vector<Interval> intervals_;
  std::vector<bool> bends_;  // behind interval j - 1
  double thinnest_ = 0, widest_ = 0, deviation_ = 0;
};

}  // namespace

std::vector<BlendPiece> constant_pieces(const YarnPath& path) {
  std::vector<BlendPiece> pieces;
  for (std::size_t span = 0; span < path.spans(); ++span) pieces.push_back({.span = span});
  return pieces;
}

std::vector<BlendPiece> pieces_of_positions(const YarnPath& path, const std::vector<double>& positions) {
  double total = 0;
  for (std::size_t i = 0; i < path.spans(); ++i) total += path.length(i);
  // Sections on both sides of a position, as if the yarn began anew before 0 and behind 1.
  const auto around = [&](double position) {
    const auto above =
        static_cast<std::size_t>(std::ranges::upper_bound(positions, position) - positions.begin());
    const std::size_t count = positions.size();
    const std::size_t from = (above + count - 1) % count, to = above % count;
    const double p0 = positions[from] - (above == 0 ? 1 : 0), p1 = positions[to] + (above == count ? 1 : 0);
    return std::tuple(from, to, p0, p1);
  };
  std::vector<BlendPiece> pieces;
  double begin = 0;  // of the span, as a share of the length
  for (std::size_t span = 0; span < path.spans(); ++span) {
    const double width = path.length(span) / total;
    std::vector<double> cuts = {0.0};
    for (const double position : positions) {
      const double t = (position - begin) / width;
      if (t > 1e-9 && t < 1 - 1e-9) cuts.push_back(t);
    }
    cuts.push_back(1.0);
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const auto [from, to, p0, p1] = around(begin + width * (cuts[k] + cuts[k + 1]) / 2);
      const auto share = [&, first = p0, last = p1](double t) {
        return std::clamp((begin + width * t - first) / (last - first), 0.0, 1.0);
      };
      pieces.push_back({span, cuts[k], cuts[k + 1], from, to, share(cuts[k]), share(cuts[k + 1])});
    }
    begin += width;
  }
  return pieces;
}

Result<YarnUnit> surface_of(const YarnShape& shape, std::size_t most) {
  // Each section is taken apart at the corners of all of them; curved ones are looked at closely on the way.
  constexpr std::size_t most_straight = 2'000'000, most_curved = 50'000;
  std::size_t corners = 0;
  bool is_straight = true;
  for (const Section& section : shape.sections) {
    corners += section.corners.size();
    is_straight = is_straight && section.is_straight;
  }
  if (corners * shape.sections.size() > (is_straight ? most_straight : most_curved))
    return error(
        Kind::limit,
        fmt::format("the {} sections of this yarn have {} corners in all, each of which each section "
                    "gets: give them corners at the same places, or split the yarn",
                    shape.sections.size(), corners));
  return Surface(shape).make(most);
}

fabric::Grid chained(const fabric::Grid& unit, const Vec3& shift, int count) {
  fabric::Grid chain = unit;
  const auto round = static_cast<std::size_t>(unit.per_section);
  const double period = unit.knots_along.back() - unit.knots_along.front();
  for (int k = 1; k < count; ++k) {
    // The joint's row is left out where the slopes on both sides are one: a double knot.
    const std::size_t rows = chain.points.size() / round;
    const double before = chain.knots_along.back() - chain.knots_along[rows - 1];
    const double behind = unit.knots_along[4] - unit.knots_along.front();
    double miss = 0, size = 0;
    for (std::size_t i = 0; i < round; ++i) {
      const Vec3 into =
          (chain.points[(rows - 1) * round + i] - chain.points[(rows - 2) * round + i]) / before;
      const Vec3 out = (unit.points[round + i] - unit.points[i]) / behind;
      miss = std::max(miss, (out - into).norm());
      size = std::max(size, out.norm());
    }
    const bool is_smooth = miss <= 1e-9 * size;
    const std::size_t kept = is_smooth ? 2 : 3;
    chain.knots_along.resize(chain.knots_along.size() - 4 + kept);
    if (is_smooth) chain.points.resize(chain.points.size() - round);
    for (std::size_t i = round; i < unit.points.size(); ++i)
      chain.points.push_back(unit.points[i] + k * shift);
    for (std::size_t i = 4; i < unit.knots_along.size(); ++i)
      chain.knots_along.push_back(unit.knots_along[i] + k * period);
  }
  chain.sections = static_cast<int>(chain.points.size() / round);
  return chain;
}

}  // namespace selvage::formats::tg3
