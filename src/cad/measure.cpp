#include "cad/measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "cad/feet.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "cad/sphere.h"
#include "nurbs/basis.h"
#include "nurbs/chain.h"
#include "nurbs/measure.h"

namespace selvage::cad {

namespace {

using nurbs::Curve;
using nurbs::Surface;

// Area, area vector, volume, and the area in the parameters.
using Integrals = Eigen::Matrix<double, 6, 1>;

constexpr int order = 8;  // of Gauss's rules

// A place of a boundary in the parameters, and how far it goes on there (derivative times weight).
struct Step {
  Vec2 at, along;
};

// An edge in the parameters.
struct Trace {
  std::vector<Step> steps;
  Vec2 first = Vec2::Zero(), last = Vec2::Zero();
};

class FaceTracer {
 public:
  // `breaks`: of the surface, in u and in v.
  FaceTracer(const Surface& surface, const std::array<std::vector<double>, 2>& breaks)
      : feet_(surface), breaks_(breaks) {}

  [[nodiscard]] const std::array<double, 2>& periods() const { return feet_.periods(); }

  std::optional<Trace> trace(const Edge& edge) {
    return flat_holds(feet_.surface(), edge) ? along(edge.flat) : follow(edge.curve);
  }
  std::optional<Trace> straight(const Vec2& from, const Vec2& to) {
    return along({1, {0, 0, 1, 1}, {Vec3(from.x(), from.y(), 0), Vec3(to.x(), to.y(), 0)}, {}});
  }

 private:
  static constexpr std::size_t most_parts = 20'000;  // of an edge

  // Parameters of an edge between which it stays in one span of the curve and one of the surface; `place`
  // tells where in the surface's parameters it is. Nothing where these are too many.
  template <class Place>
  std::optional<std::vector<double>> parts_of(const Curve& curve, const Place& place) const {
    constexpr int looks = 4;  // a span
    const std::vector<double> spans = nurbs::breakpoints(curve.knots, curve.degree);
    std::vector<double> parts = {spans.front()};
    for (std::size_t k = 0; k + 1 < spans.size(); ++k)
      for (int i = 0; i < looks; ++i) {
        double from = std::lerp(spans[k], spans[k + 1], static_cast<double>(i) / looks);
        const double to = std::lerp(spans[k], spans[k + 1], static_cast<double>(i + 1) / looks);
        const std::array<double, 2> last = cell_of(place(to));
        for (std::array<double, 2> here = cell_of(place(from)); here != last;) {
          double low = from, high = to;  // the cell is another at `high`
          while (high - low > 1e-13 * (spans.back() - spans.front())) {
            const double middle = 0.5 * (low + high);
            if (!(middle > low && middle < high)) break;
            (cell_of(place(middle)) == here ? low : high) = middle;
          }
          parts.push_back(high);
          if (parts.size() > most_parts) return std::nullopt;
          from = high;
          here = cell_of(place(high));
        }
        if (i + 1 == looks) parts.push_back(to);
      }
    std::ranges::sort(parts);
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    return parts;
  }

  // The spans of the surface that hold a place, counted through all turns.
  [[nodiscard]] std::array<double, 2> cell_of(const Vec2& at) const {
    std::array<double, 2> cell{};
    for (std::size_t d = 0; d < 2; ++d) {
      const std::vector<double>& breaks = breaks_[d];
      const double width = breaks.back() - breaks.front();
      double value = at[static_cast<Eigen::Index>(d)] + 1e-9 * width;
      const double turn = periods()[d] > 0 ? std::floor((value - breaks.front()) / width) : 0;
      value -= turn * width;
      auto span = std::upper_bound(breaks.begin(), breaks.end(), value) - breaks.begin();
      // The end of an open range is in its last span: a part of its own there, as short as rounding, would
      // stand where a pole has no direction.
      if (!(periods()[d] > 0))
        span = std::clamp<std::ptrdiff_t>(span, 1, static_cast<std::ptrdiff_t>(breaks.size()) - 1);
      cell[d] = turn * static_cast<double>(breaks.size()) + static_cast<double>(span);
    }
    return cell;
  }

  struct Node {
    double t, weight;
  };
  static std::vector<Node> nodes_of(const std::vector<double>& parts) {
    const nurbs::GaussRule& rule = nurbs::gauss_rule(order);
    std::vector<Node> nodes;
    for (std::size_t k = 0; k + 1 < parts.size(); ++k)
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double half = 0.5 * (parts[k + 1] - parts[k]);
        nodes.push_back({0.5 * (parts[k] + parts[k + 1]) + half * rule.nodes[i], half * rule.weights[i]});
      }
    return nodes;
  }

  std::optional<Trace> along(const Curve& flat) const {
    const auto place = [&](double t) { return Vec2(nurbs::evaluate(flat, t).head<2>()); };
    const std::optional<std::vector<double>> parts = parts_of(flat, place);
    if (!parts) return std::nullopt;
    Trace trace;
    for (const Node& node : nodes_of(*parts)) {
      const nurbs::CurveJet jet = nurbs::evaluate_jet(flat, node.t);
      trace.steps.push_back({jet.position.head<2>(), node.weight * jet.d1.head<2>()});
    }
    trace.first = place(flat.first_parameter());
    trace.last = place(flat.last_parameter());
    return trace;
  }

  // By its feet on the surface.
  std::optional<Trace> follow(const Curve& curve) {
    CurveFeet feet(feet_, curve);
    Trace trace{.steps = {}, .first = feet.first(), .last = feet.last()};
    const auto parts = parts_of(curve, [&](double t) { return feet.at(t); });
    if (!parts) return std::nullopt;
    for (const Node& node : nodes_of(*parts)) {
      const std::optional<Vec2> step = feet.derivative(node.t);
      if (!step) return std::nullopt;
      trace.steps.push_back({feet.at(node.t), node.weight * *step});
    }
    return trace;
  }

  Feet feet_;
  const std::array<std::vector<double>, 2>& breaks_;
};

// A loop in the parameters, closed by straight steps where its edges leave gaps, and how often it goes round
// the surface in either direction.
struct Round {
  std::vector<Step> steps;
  std::array<int, 2> turns = {0, 0};
};

class Integrator {
 public:
  Integrator(const Face& face, const Vec3& origin) : surface_(face.surface), origin_(origin) {
    breaks_ = {nurbs::breakpoints(surface_.knots_u, surface_.degree_u),
               nurbs::breakpoints(surface_.knots_v, surface_.degree_v)};
  }

  std::optional<FaceIntegrals> over(const std::vector<Loop>& loops) {
    std::vector<Round> rounds;
    FaceTracer tracer(surface_, breaks_);
    periods_ = tracer.periods();
    for (const Loop& loop : loops) {
      std::optional<Round> round = round_of(loop, tracer);
      if (!round) return std::nullopt;
      if (!round->steps.empty()) rounds.push_back(std::move(*round));
    }
    std::array<std::size_t, 2> around = {0, 0};
    for (const Round& round : rounds)
      for (std::size_t d = 0; d < 2; ++d) around[d] += round.turns[d] != 0 ? 1 : 0;
    if (rounds.empty() || (around[0] > 0 && around[1] > 0) || !is_near(rounds)) return std::nullopt;
    // Lines across what goes round; else those that cross fewer spans.
    across_ = around[0] > 0 ? 1 : around[1] > 0 ? 0 : (breaks_[0].size() <= breaks_[1].size() ? 0 : 1);
    base_ = rounds.front().steps.front().at[static_cast<Eigen::Index>(across_)];
    for (const Round& round : rounds)
      for (const Step& step : round.steps)
        base_ = std::min(base_, step.at[static_cast<Eigen::Index>(across_)]);
    if (around[1 - across_] == 1) return beside_one(rounds);
    return combined(rounds, around[1 - across_]);
  }

 private:
  [[nodiscard]] bool is_near(const std::vector<Round>& rounds) const {
    const Vec2 centre = middle();
    for (const Round& round : rounds)
      for (const Step& step : round.steps)
        for (std::size_t d = 0; d < 2; ++d) {
          const auto k = static_cast<Eigen::Index>(d);
          if (periods_[d] > 0 && !(std::abs(step.at[k] - centre[k]) < most_turns * periods_[d])) return false;
        }
    return true;
  }

  std::optional<Round> round_of(Loop loop, FaceTracer& tracer) {
    Round round;
    const bool is_at_pole = begin_at_pole(loop, surface_);
    std::optional<Vec2> first, last;
    for (const Edge& edge : loop.edges) {
      if (edge.flat.points.empty() && edge.curve.points.empty()) continue;  // a pole
      std::optional<Trace> trace = tracer.trace(edge);
      if (!trace) return std::nullopt;
      const Vec2 shift = turns_towards(trace->first, last.value_or(middle()), periods_);
      for (Step& step : trace->steps) step.at += shift;
      if (last && !add_straight(round, tracer, *last, trace->first + shift)) return std::nullopt;
      if (!first) first = trace->first + shift;
      last = trace->last + shift;
      round.steps.insert(round.steps.end(), trace->steps.begin(), trace->steps.end());
    }
    if (!first) return round;
    const Vec2 end = *first + (is_at_pole ? Vec2(0, 0) : turns_towards(*first, *last, periods_));
    for (std::size_t d = 0; d < 2; ++d)
      if (periods_[d] > 0) {
        const auto k = static_cast<Eigen::Index>(d);
        round.turns[d] = static_cast<int>(std::lround((end[k] - (*first)[k]) / periods_[d]));
        if (std::abs(round.turns[d]) > 1) return std::nullopt;
      }
    if (!add_straight(round, tracer, *last, end)) return std::nullopt;
    return round;
  }

  [[nodiscard]] Vec2 middle() const {
    return {0.5 * (surface_.first_u() + surface_.last_u()), 0.5 * (surface_.first_v() + surface_.last_v())};
  }

  static bool add_straight(Round& round, FaceTracer& tracer, const Vec2& from, const Vec2& to) {
    if (from == to) return true;
    const std::optional<Trace> trace = tracer.straight(from, to);
    if (trace) round.steps.insert(round.steps.end(), trace->steps.begin(), trace->steps.end());
    return trace.has_value();
  }

  // One goes round the surface, and the face is what is on one side of it.
  std::optional<FaceIntegrals> beside_one(const std::vector<Round>& rounds) {
    if (periods_[across_] > 0) return std::nullopt;
    base_ = breaks_[across_].front();
    Integrals sum = Integrals::Zero();
    for (const Round& round : rounds) {
      Integrals values = along(round);
      values *= values[5] < 0 ? -1 : 1;
      const int turns = round.turns[1 - across_];
      if (turns == 0) {
        sum -= values;
        continue;
      }
      const std::optional<bool> is_high = is_high_side(surface_, across_, turns);
      if (!is_high) return std::nullopt;
      if (*is_high) {
        const nurbs::Moments whole = nurbs::moments(surface_, origin_);
        Integrals all;
        all << whole.area, whole.area_vector, whole.volume,
            (breaks_[0].back() - breaks_[0].front()) * (breaks_[1].back() - breaks_[1].front());
        values = all - values;
      }
      sum += values;
    }
    if (!(sum[5] > 0) || !sum.allFinite()) return std::nullopt;
    return FaceIntegrals{sum[0], sum.segment<3>(1), sum[4]};
  }

  // `around`: how many of them go round. The largest one, or the two that go round, hold the others.
  std::optional<FaceIntegrals> combined(const std::vector<Round>& rounds, std::size_t around) const {
    if (around != 0 && around != 2) return std::nullopt;
    Integrals outer = Integrals::Zero(), holes = Integrals::Zero();
    int turns = 0;
    for (const Round& round : rounds) {
      const int own = round.turns[1 - across_];
      Integrals values = along(round);
      if (around == 2 && own != 0) {
        // Two that run the same way leave their difference between them.
        outer += turns == own ? Integrals(-values) : values;
        turns = own;
        continue;
      }
      values *= values[5] < 0 ? -1 : 1;
      if (around == 0 && values[5] > outer[5]) std::swap(values, outer);
      holes += values;
    }
    if (outer[5] < 0) outer = -outer;
    const Integrals sum = outer - holes;
    if (!(sum[5] > 0) || !sum.allFinite()) return std::nullopt;
    return FaceIntegrals{sum[0], sum.segment<3>(1), sum[4]};
  }

  // Green's theorem: round a region to the left f du dv is the integral of F dv, where F is that of f over u.
  [[nodiscard]] Integrals along(const Round& round) const {
    Integrals sum = Integrals::Zero();
    const auto other = static_cast<Eigen::Index>(1 - across_);
    for (const Step& step : round.steps)
      if (step.along[other] != 0) sum += (across_ == 0 ? 1 : -1) * step.along[other] * line_to(step.at);
    return sum;
  }

  // From the base to this place, along the line of one parameter.
  [[nodiscard]] Integrals line_to(const Vec2& at) const {
    const auto d = static_cast<Eigen::Index>(across_);
    const std::vector<double>& breaks = breaks_[across_];
    const double first = breaks.front(), last = breaks.back(), period = last - first;
    const double from = base_, to = at[d];
    const bool wraps = periods_[across_] > 0;
    Integrals sum = Integrals::Zero();
    const auto turn_of = [&](double t) {
      return wraps ? static_cast<int>(std::floor((t - first) / period)) : 0;
    };
    for (int turn = turn_of(from); turn <= turn_of(to); ++turn)
      for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        // Beyond an open range the surface ends.
        const double a = std::max(breaks[k] + turn * period, from),
                     b = std::min(breaks[k + 1] + turn * period, to);
        if (a < b) add_span(sum, at, a, b);
      }
    return sum;
  }

  void add_span(Integrals& sum, Vec2 at, double a, double b) const {
    const auto d = static_cast<Eigen::Index>(across_);
    const nurbs::GaussRule& rule = nurbs::gauss_rule(order);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      at[d] = 0.5 * (a + b) + 0.5 * (b - a) * rule.nodes[i];
      sum += 0.5 * (b - a) * rule.weights[i] * values_at(at);
    }
  }

  [[nodiscard]] Integrals values_at(const Vec2& at) const {
    std::array<double, 2> place = {at.x(), at.y()};
    for (std::size_t k = 0; k < 2; ++k)
      if (periods_[k] > 0)
        place[k] -= periods_[k] * std::floor((place[k] - breaks_[k].front()) / periods_[k]);
    const nurbs::SurfaceJet jet = nurbs::evaluate_jet(surface_, place[0], place[1]);
    const Vec3 normal = jet.du.cross(jet.dv);
    Integrals values;
    values << normal.norm(), normal, (jet.position - origin_).dot(normal) / 3, 1;
    return values;
  }

  const Surface& surface_;
  Vec3 origin_;
  std::array<double, 2> periods_ = {0, 0};
  std::array<std::vector<double>, 2> breaks_;
  std::size_t across_ = 0;  // the parameter that changes along the lines: 0 is u
  double base_ = 0;         // where they begin
};

}  // namespace

std::optional<FaceIntegrals> integrals_of(const Face& face, const Vec3& origin) {
  if (!face.loops.empty()) {
    // What shares its edges has directed ones.
    const std::optional<Sphere> sphere =
        face.loops.front().edges.front().id >= 0 ? sphere_of(face.surface) : std::nullopt;
    std::optional<FaceIntegrals> integrals;
    if (sphere) integrals = integrals_on(*sphere, face, origin);
    return integrals ? integrals : Integrator(face, origin).over(face.loops);
  }
  const nurbs::Moments moments = nurbs::moments(face.surface, origin);
  return FaceIntegrals{moments.area, moments.area_vector, moments.volume};
}

PartMeasures measures_of(const Part& part) {
  constexpr double closes = 1e-3;  // of the area
  const Box3 box = box_of(part);
  if (box.isEmpty()) return {};
  double area = 0, volume = 0;
  Vec3 open = Vec3::Zero();
  bool is_known = true, are_all = true;
  for (const Face& face : part.faces) {
    const std::optional<FaceIntegrals> integrals = integrals_of(face, box.center());
    are_all = are_all && integrals;
    is_known = is_known && (integrals || face.area);
    area += integrals ? integrals->area : std::abs(face.area.value_or(0));
    if (!integrals) continue;
    open += (face.reversed ? -1 : 1) * integrals->area_vector;
    volume += (face.reversed ? -1 : 1) * integrals->volume;
  }
  PartMeasures measures;
  if (is_known) measures.area = area;
  if (are_all && part.kind == Part::Kind::solid && open.norm() <= closes * area)
    measures.volume = std::abs(volume);
  return measures;
}

namespace {

// Of a surface of four points in one plane; nothing of others.
std::optional<Eigen::Hyperplane<double, 3>> plane_of(const Surface& surface) {
  if (surface.degree_u != 1 || surface.degree_v != 1 || surface.points.size() != 4) return std::nullopt;
  const Vec3 normal = (surface.points[1] - surface.points[0]).cross(surface.points[2] - surface.points[0]);
  if (!(normal.norm() > 0)) return std::nullopt;
  const Eigen::Hyperplane<double, 3> plane(normal.normalized(), surface.points[0]);
  constexpr double flat = 1e-12;  // of the diagonal
  const double diagonal = (surface.points[3] - surface.points[0]).norm();
  if (plane.absDistance(surface.points[3]) > flat * diagonal) return std::nullopt;
  return plane;
}

// How far edges are from a face's surface.
class Offness {
 public:
  explicit Offness(const Face& face) : surface_(face.surface), plane_(plane_of(face.surface)) {}

  // The largest distance of five of the edge's points, or of its curve on the surface from the one in space.
  double of(const Edge& edge) {
    double most = 0;
    std::optional<SampledCurve> curve;
    if (!edge.flat.points.empty()) curve.emplace(edge.curve);
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
      most = std::max(most, curve ? curve->nearest(at_share(surface_, edge.flat, share)).distance
                                  : of(at_share(edge.curve, share)));
    return most;
  }

 private:
  double of(const Vec3& p) {
    if (plane_) return plane_->absDistance(p);
    if (!feet_) feet_.emplace(surface_);
    foot_ = feet_->of(p, foot_);
    return (feet_->jet(*foot_).position - p).norm();
  }

  const Surface& surface_;
  std::optional<Eigen::Hyperplane<double, 3>> plane_;
  std::optional<Feet> feet_;
  std::optional<Vec2> foot_;  // of the point before
};

double looseness_of(Offness& off, const Loop& loop) {
  double most = 0;
  std::vector<Vec3> ends;  // of each edge the start, the end
  for (const Edge& edge : loop.edges) {
    if (edge.curve.points.empty()) continue;
    most = std::max(most, off.of(edge));
    for (const double share : {0.0, 1.0}) ends.push_back(at_share(edge.curve, share));
  }
  for (std::size_t i = 1; i < ends.size(); i += 2)
    most = std::max(most, (ends[i] - ends[(i + 1) % ends.size()]).norm());
  return most;
}

}  // namespace

double looseness_of(const std::vector<Part>& parts) {
  double most = 0;
  for (const Part& part : parts)
    for (const Face& face : part.faces) {
      Offness off(face);
      for (const std::vector<Loop>* loops : {&face.loops, &face.border})
        for (const Loop& loop : *loops) most = std::max(most, looseness_of(off, loop));
    }
  return most;
}

}  // namespace selvage::cad
