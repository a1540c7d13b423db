#include "garment/piece.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/plane.h"
#include "garment/piece_curve.h"
#include "nurbs/measure.h"

namespace selvage::fabric {

namespace {

using nurbs::Bezier;
using nurbs::Box2;
using nurbs::PointParameters;
using nurbs::TurningShape;

constexpr std::size_t most_edges = 50'000;
constexpr double default_tolerance = 1e-6;  // of the extent
constexpr double no_area = 1e-12;           // of the extent's square
constexpr double rational_error = 1e-10;    // of the extent: of the cubics that stand for a rational curve
constexpr double least_run_back = 1e-6;     // of the extent
constexpr std::size_t met_points = 4;       // that a cubic meets at any parameters
// Squares and their sums must stay within the range of doubles.
constexpr double largest_extent = 1e100, smallest_extent = 1e-100;

std::string words(const Vec2& p) {
  // A sum with 0 has no negative zero.
  return fmt::format("({:.6g}, {:.6g})", p.x() + 0.0, p.y() + 0.0);
}

std::string title_of(const PieceCurve& curve) {
  return fmt::format("{} '{}'", curve.is_line ? "line" : "curve", curve.name);
}

nurbs::Curve curve_of(const std::vector<Vec2>& control) {
  nurbs::Curve curve;
  curve.degree = static_cast<int>(control.size()) - 1;
  curve.knots.assign(control.size(), 0.0);
  curve.knots.insert(curve.knots.end(), control.size(), 1.0);
  for (const Vec2& p : control) curve.points.emplace_back(p.x(), p.y(), 0.0);
  return curve;
}

CurveFit fit_of(const std::vector<Vec2>& points, nurbs::PointParameters by) {
  CurveFit fit;
  fit.by = by;
  fit.bezier = nurbs::fit_bezier(points, by);
  const Bezier& curve = fit.bezier.solved;
  fit.shape = nurbs::turning_shape(curve);
  for (std::size_t i = 0; i < points.size(); ++i) {
    FixedPoint fixed;
    fixed.at = points[i];
    fixed.parameter = fit.bezier.parameters[i];
    fixed.error = (nurbs::evaluate(curve, fixed.parameter) - points[i]).norm();
    fixed.distance = std::min(
        fixed.error, (nurbs::evaluate(curve, nurbs::nearest_parameter(curve, points[i])) - points[i]).norm());
    fit.points.push_back(fixed);
  }
  return fit;
}

// Where the curve runs back the farthest between two of its points.
struct RunBack {
  std::size_t row = 0;  // and the next one, from 0
  double length = 0;
};

RunBack run_back(const CurveFit& fit) {
  RunBack most;
  for (std::size_t i = 1; i < fit.points.size(); ++i) {
    const double length =
        nurbs::run_back(fit.bezier.solved, fit.points[i - 1].parameter, fit.points[i].parameter);
    if (length > most.length) most = {i - 1, length};
  }
  return most;
}

class Builder {
 public:
  // Other pieces whose lengths were asked for; none: it is being built, or could not be.
  using Others = std::map<const Piece*, std::optional<PieceShape>>;

  Builder(const Fabric& fabric, const Piece& piece, Diagnostics& diagnostics, Others& others)
      : fabric_(fabric), piece_(piece), diagnostics_(diagnostics), others_(others) {
    for (const PieceCurve& curve : piece.curves) rows_.push_back(curve.points);
  }

  std::optional<PieceShape> build(double tolerance) {
    const int errors = diagnostics_.error_count();
    check_size();
    if (diagnostics_.error_count() == errors) join(tolerance > 0.0 ? tolerance : default_tolerance * extent_);
    if (diagnostics_.error_count() > errors) return std::nullopt;
    PieceShape shape;
    shape.name = piece_.name;
    shape.place = piece_.place;
    for (std::size_t i = 0; i < rows_.size(); ++i) shape.edges.push_back(edge(i));
    if (diagnostics_.error_count() == errors) apply_edits(shape);
    if (diagnostics_.error_count() > errors) return std::nullopt;
    check_outline(shape);
    if (diagnostics_.error_count() > errors) return std::nullopt;
    orient(shape);
    return shape;
  }

 private:
  void say(const Message& message, TextPlace place) { diagnostics_.add(message.placed(place, fabric_.file)); }

  void check_size() {
    if (rows_.size() > most_edges)
      return say(
          error(Kind::limit, fmt::format("piece '{}' has {} lines and curves; at most {} can be checked",
                                         piece_.name, rows_.size(), most_edges)),
          piece_.place);
    Box2 box;
    for (const std::vector<Vec2>& points : rows_)
      for (const Vec2& p : points) box.extend(p);
    extent_ = box.isEmpty() ? 0.0 : box.diagonal().norm();
    const double largest =
        box.isEmpty() ? 0.0 : std::max(box.max().cwiseAbs().maxCoeff(), box.min().cwiseAbs().maxCoeff());
    if (!(largest <= largest_extent) || !(extent_ >= smallest_extent))
      say(error(Kind::geometry, fmt::format("piece '{}' is {:.3g} {} large: nothing can be computed of it",
                                            piece_.name, extent_, selvage::name_of(fabric_.units))),
          piece_.place);
  }

  // Each start goes onto the end before it.
  void join(double tolerance) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::size_t next = (i + 1) % rows_.size();
      const Vec2 end = rows_[i].back(), start = rows_[next].front();
      if ((end - start).norm() <= tolerance) {
        rows_[next].front() = end;
        continue;
      }
      report_gap(i, next, tolerance);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t k = 1; k < rows_[i].size(); ++k)
        if (rows_[i][k] == rows_[i][k - 1] && piece_.curves[i].shape != PieceCurve::Shape::control)
          return say(error(Kind::geometry,
                           fmt::format("{} is shorter than the tolerance {:.3g} within which ends are joined",
                                       title_of(piece_.curves[i]), tolerance)),
                     piece_.curves[i].place);
  }

  void report_gap(std::size_t i, std::size_t next, double tolerance) {
    const PieceCurve &before = piece_.curves[i], &after = piece_.curves[next];
    const Vec2 &end = rows_[i].back(), &start = rows_[next].front();
    const std::string gap = fmt::format("{:.4g} {}", (end - start).norm(), selvage::name_of(fabric_.units));
    if (next == 0)
      return say(
          error(Kind::malformed,
                fmt::format("the outline of piece '{}' is not closed: {} ends at {}, {} from the start of "
                            "{} at {}",
                            piece_.name, title_of(before), words(end), gap, title_of(after), words(start))),
          before.place);
    const bool turned = (end - rows_[next].back()).norm() <= tolerance;
    say(error(Kind::malformed, fmt::format("{} starts at {}, {} from the end of {} at {}{}", title_of(after),
                                           words(start), gap, title_of(before), words(end),
                                           turned ? "; its other end is there: turn its points round" : "")),
        after.place);
  }

  PieceEdge edge(std::size_t i) {
    const PieceCurve& source = piece_.curves[i];
    PieceEdge edge;
    edge.name = source.name;
    edge.place = source.place;
    if (source.is_line) {
      edge.curve = curve_of({rows_[i].front(), rows_[i].back()});
      return edge;
    }
    if (source.shape == PieceCurve::Shape::control || source.shape == PieceCurve::Shape::spline) {
      if (Result<nurbs::Curve> curve = spline_of(source, rows_[i]); curve.ok())
        edge.curve = std::move(*curve);
      else
        say(error(Kind::geometry, fmt::format("{}: {}", title_of(source), curve.error().text)), source.place);
      return edge;
    }
    const std::vector<Vec2>& points = rows_[i];
    edge.fit = source.by ? fit_of(points, *source.by) : best_fit(points);
    const Bezier& solved = edge.fit->bezier.solved;
    edge.curve = curve_of({solved.begin(), solved.end()});
    if (!std::ranges::all_of(solved, [](const Vec2& p) { return p.allFinite(); }))
      say(error(Kind::geometry,
                fmt::format("{} is given by points that stand too near each other", title_of(source))),
          source.place);
    else
      judge(source, points, *edge.fit);
    return edge;
  }

  // Points that a cubic cannot meet at any parameters are met as nearly as it can, unless that takes turns
  // that they do not ask for.
  [[nodiscard]] CurveFit best_fit(const std::vector<Vec2>& points) const {
    if (points.size() <= met_points) return fit_of(points, PointParameters::uniform);
    CurveFit by_distance = fit_of(points, PointParameters::distance);
    if (run_back(by_distance).length <= least_run_back * extent_) return by_distance;
    CurveFit by_chord = fit_of(points, PointParameters::chord);
    return run_back(by_chord).length <= least_run_back * extent_ ? by_chord : by_distance;
  }

  // Does the curve do what its word and its points say?
  void judge(const PieceCurve& source, const std::vector<Vec2>& points, const CurveFit& fit) {
    const auto turns = [](TurningShape shape) {
      return shape == TurningShape::straight ? "is straight"
             : shape == TurningShape::c      ? "turns one way only, as a C does"
                                             : "turns both ways, as an S does";
    };
    const TurningShape polygon = nurbs::turning_shape(points);
    const TurningShape said = source.shape == PieceCurve::Shape::s ? TurningShape::s : TurningShape::c;
    if (source.shape != PieceCurve::Shape::found && said != fit.shape)
      say(warning(Kind::geometry,
                  fmt::format("curve '{}' is called {}, but {}{}", source.name, fabric::name_of(said),
                              turns(fit.shape),
                              polygon == said ? remedy(points, fit, polygon) : ", and so do its points")),
          source.place);
    else if (source.shape == PieceCurve::Shape::found && polygon == TurningShape::c &&
             fit.shape == TurningShape::s)
      say(warning(Kind::geometry, fmt::format("curve '{}' {}, but its points turn one way only{}",
                                              source.name, turns(fit.shape), remedy(points, fit, polygon))),
          source.place);
    if (const RunBack back = run_back(fit); back.length > least_run_back * extent_)
      say(warning(Kind::geometry,
                  fmt::format("curve '{}' doubles back: between its rows {} and {} it runs {:.3g} {} against "
                              "the direction from one to the other{}",
                              source.name, back.row + 1, back.row + 2, back.length,
                              selvage::name_of(fabric_.units), remedy(points, fit, polygon))),
          source.place);
  }

  // Another way to place the points by which the curve turns as the polygon does, and does not run back.
  [[nodiscard]] std::string remedy(const std::vector<Vec2>& points, const CurveFit& fit,
                                   TurningShape polygon) const {
    for (const PointParameters by :
         {PointParameters::distance, PointParameters::chord, PointParameters::uniform}) {
      if (by == fit.by || (by == PointParameters::distance && points.size() <= met_points)) continue;
      const CurveFit other = fit_of(points, by);
      if (other.shape == polygon && run_back(other).length <= least_run_back * extent_)
        return fmt::format("; 'by {}' does not", fabric::name_of(by));
    }
    return "; one row more where it strays holds it, or two curves instead of one";
  }

  void apply_edits(PieceShape& shape) {
    for (const Edit& edit : piece_.edits) {
      const auto edge = std::ranges::find(shape.edges, edit.yarn, &PieceEdge::name);
      if (edge == shape.edges.end()) {
        say(error(Kind::geometry,
                  fmt::format("there is no curve '{}' in piece '{}'", edit.yarn, piece_.name)),
            edit.place);
        continue;
      }
      Result<double> length = edit.like ? length_like(*edit.like, shape) : edit.length;
      if (!length) return say(length.error(), edit.place);
      Result<nurbs::Curve> curve = edited(edge->curve, edit, *length);
      if (!curve) return say(curve.error(), edit.place);
      edge->curve = std::move(*curve);
    }
  }

  // What an edit by the length of other curves asks for. Pieces are built for that once, with the edits of
  // their own.
  Result<double> length_like(const LengthOf& like, const PieceShape& own) {
    const PieceShape* shape = &own;
    if (like.piece != piece_.name) {
      const auto pieces = pieces_of(fabric_);
      const auto other = std::ranges::find(pieces, like.piece, [](const Piece* p) { return p->name; });
      if (other == pieces.end())
        return error(Kind::geometry, fmt::format("there is no piece '{}'", like.piece));
      const auto [known, is_new] = others_.try_emplace(*other);
      if (is_new) {
        Diagnostics unsaid;
        known->second = Builder(fabric_, **other, unsaid, others_).build(fabric_.tolerance.value_or(0.0));
      }
      if (!known->second)
        return error(Kind::geometry,
                     fmt::format("the length of piece '{}' is not known: it could not be built, or its own "
                                 "lengths follow from this piece",
                                 like.piece));
      shape = &*known->second;
    }
    double sum = like.ease;
    for (const std::string& name : like.curves) {
      const auto edge = std::ranges::find(shape->edges, name, &PieceEdge::name);
      if (edge == shape->edges.end())
        return error(Kind::geometry, fmt::format("there is no curve '{}' in piece '{}'", name, like.piece));
      sum += nurbs::arc_length(edge->curve);
    }
    if (!(sum > 0.0))
      return error(Kind::geometry, fmt::format("the length {:.6g}, with the ease, is not above 0", sum));
    return sum;
  }

  void check_outline(const PieceShape& shape) {
    std::vector<Bezier> outline;
    std::vector<std::size_t> edge_of;  // each of these cubics
    for (std::size_t i = 0; i < shape.edges.size(); ++i)
      for (const Bezier& cubic : nurbs::cubics_of(shape.edges[i].curve, rational_error * extent_)) {
        outline.push_back(cubic);
        edge_of.push_back(i);
      }
    if (outline.size() > most_edges)
      return say(error(Kind::limit, fmt::format("the outline of piece '{}' consists of {} cubics; at most {} "
                                                "can be checked",
                                                piece_.name, outline.size(), most_edges)),
                 piece_.place);
    if (is_flat(outline))
      return say(
          error(Kind::geometry, fmt::format("piece '{}' encloses no area: all of its outline lies on one "
                                            "straight line",
                                            piece_.name)),
          piece_.place);
    const std::optional<nurbs::Crossing> crossing = nurbs::find_crossing(outline);
    if (!crossing) return;
    const PieceCurve &a = piece_.curves[edge_of[crossing->a]], &b = piece_.curves[edge_of[crossing->b]];
    const std::string where = &a == &b ? fmt::format("{} meets itself", title_of(a))
                                       : fmt::format("{} and {} meet", title_of(a), title_of(b));
    say(error(Kind::geometry, fmt::format("the outline of piece '{}' crosses or touches itself: {} at {}",
                                          piece_.name, where, words(crossing->at))),
        b.place);
  }

  [[nodiscard]] bool is_flat(const std::vector<Bezier>& outline) const {
    const Vec2 origin = outline.front().front();
    Vec2 farthest = origin;
    for (const Bezier& curve : outline)
      for (const Vec2& p : curve)
        if ((p - origin).squaredNorm() > (farthest - origin).squaredNorm()) farthest = p;
    const Vec2 along = farthest - origin;
    for (const Bezier& curve : outline)
      for (const Vec2& p : curve)
        if (std::abs(cross(along, Vec2(p - origin))) > no_area * extent_ * extent_) return false;
    return true;
  }

  void orient(PieceShape& shape) const {
    const Vec2 origin = shape.edges.front().curve.points.front().head<2>();
    for (const PieceEdge& edge : shape.edges) {
      for (const Bezier& cubic : nurbs::cubics_of(edge.curve, rational_error * extent_))
        shape.area += nurbs::swept_area(cubic, origin);
      shape.perimeter += nurbs::arc_length(edge.curve);
    }
    if (shape.area <= 0.0) {
      shape.area = -shape.area;
      std::reverse(shape.edges.begin() + 1, shape.edges.end());
      for (PieceEdge& edge : shape.edges) edge.curve = nurbs::reversed(edge.curve);
    }
    shape.box = box_of(shape.edges);
  }

  const Fabric& fabric_;
  const Piece& piece_;
  Diagnostics& diagnostics_;
  Others& others_;
  std::vector<std::vector<Vec2>> rows_;  // of each line and curve, joined
  double extent_ = 0;
};

}  // namespace

std::string_view name_of(TurningShape shape) {
  constexpr std::array<std::string_view, 3> names = {"straight", "C", "S"};
  return names[static_cast<std::size_t>(shape)];
}

std::string_view name_of(PointParameters by) {
  constexpr std::array<std::string_view, 3> names = {"uniform", "chord", "distance"};
  return names[static_cast<std::size_t>(by)];
}

double CurveFit::largest_error() const {
  return std::ranges::max(points, {}, &FixedPoint::error).error;
}

double CurveFit::largest_distance() const {
  return std::ranges::max(points, {}, &FixedPoint::distance).distance;
}

nurbs::Box2 box_of(const std::vector<PieceEdge>& edges) {
  nurbs::Box2 box;
  nurbs::Box2 control;
  for (const PieceEdge& edge : edges)
    for (const Vec3& p : edge.curve.points) control.extend(Vec2(p.head<2>()));
  for (const PieceEdge& edge : edges)
    for (const Bezier& cubic : nurbs::cubics_of(edge.curve, rational_error * control.diagonal().norm()))
      box.extend(nurbs::bounds(cubic));
  return box;
}

std::vector<const Piece*> pieces_of(const Fabric& fabric) {
  std::vector<const Piece*> pieces;
  for (const Item& item : fabric.items)
    if (const auto* piece = std::get_if<Piece>(&item)) pieces.push_back(piece);
  return pieces;
}

std::optional<PieceShape> build_piece(const Fabric& fabric, const Piece& piece, double tolerance,
                                      Diagnostics& diagnostics) {
  if (!(tolerance > 0.0)) tolerance = fabric.tolerance.value_or(0.0);
  Builder::Others others;
  others[&piece] = std::nullopt;
  return Builder(fabric, piece, diagnostics, others).build(tolerance);
}

}  // namespace selvage::fabric
