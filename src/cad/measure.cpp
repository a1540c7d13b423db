#include "cad/measure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "cad/distance.h"
#include "cad/seam.h"
#include "nurbs/basis.h"
#include "nurbs/chain.h"
#include "nurbs/measure.h"

namespace selvage::cad {

namespace {

using nurbs::Curve;
using nurbs::Surface;

// Area, area vector, volume, and the area in the parameters.
using Values = Eigen::Matrix<double, 6, 1>;

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
  FaceTracer(const Surface& surface, const std::array<double, 2>& periods)
      : surface_(surface), periods_(periods) {}

  std::optional<Trace> trace(const Edge& edge) {
    return edge.flat.points.empty() ? follow(edge.curve) : flat(edge.flat);
  }

 private:
  static std::vector<double> nodes_of(const Curve& curve, std::vector<double>& weights) {
    const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
    const nurbs::GaussRule& rule = nurbs::gauss_rule(order);
    std::vector<double> nodes;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double half = 0.5 * (breaks[k + 1] - breaks[k]);
        nodes.push_back(0.5 * (breaks[k] + breaks[k + 1]) + half * rule.nodes[i]);
        weights.push_back(half * rule.weights[i]);
      }
    return nodes;
  }

  static Trace flat(const Curve& curve) {
    Trace trace;
    std::vector<double> weights;
    const std::vector<double> nodes = nodes_of(curve, weights);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, nodes[i]);
      trace.steps.push_back({jet.position.head<2>(), weights[i] * jet.d1.head<2>()});
    }
    trace.first = nurbs::evaluate(curve, curve.first_parameter()).head<2>();
    trace.last = nurbs::evaluate(curve, curve.last_parameter()).head<2>();
    return trace;
  }

  // From the middle to both ends: at an end it may meet a pole, which has every parameter.
  std::optional<Trace> follow(const Curve& curve) {
    Trace trace;
    std::vector<double> weights;
    const std::vector<double> nodes = nodes_of(curve, weights);
    trace.steps.resize(nodes.size());
    const std::size_t middle = nodes.size() / 2;
    std::optional<Vec2> foot;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (k == nodes.size() - middle) foot = trace.steps[middle].at;
      const std::size_t i = k < nodes.size() - middle ? middle + k : nodes.size() - 1 - k;
      const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, nodes[i]);
      foot = foot_of(jet.position, foot);
      const std::optional<Vec2> along = direction(*foot, jet.d1);
      if (!along) return std::nullopt;
      trace.steps[i] = {*foot, weights[i] * *along};
    }
    trace.first = end_of(nurbs::evaluate(curve, curve.first_parameter()), trace.steps.front().at);
    trace.last = end_of(nurbs::evaluate(curve, curve.last_parameter()), trace.steps.back().at);
    return trace;
  }

  [[nodiscard]] nurbs::SurfaceJet jet_at(const Vec2& at) const {
    return nurbs::evaluate_jet(surface_, inside(at.x(), 0), inside(at.y(), 1));
  }
  [[nodiscard]] double inside(double value, std::size_t d) const {
    const double first = d == 0 ? surface_.first_u() : surface_.first_v();
    return periods_[d] > 0 ? value - periods_[d] * std::floor((value - first) / periods_[d]) : value;
  }

  // What of a step in space is one in the parameters; nothing at a pole.
  [[nodiscard]] std::optional<Vec2> direction(const Vec2& at, const Vec3& step) const {
    const nurbs::SurfaceJet jet = jet_at(at);
    const double uu = jet.du.squaredNorm(), uv = jet.du.dot(jet.dv), vv = jet.dv.squaredNorm();
    const double det = uu * vv - uv * uv;
    if (!(det > 1e-24 * uu * vv)) return std::nullopt;
    const double a = step.dot(jet.du), b = step.dot(jet.dv);
    return Vec2((vv * a - uv * b) / det, (uu * b - uv * a) / det);
  }

  // By Newton's method from the foot before; where that goes astray, looked for.
  Vec2 foot_of(const Vec3& p, const std::optional<Vec2>& before) {
    if (before) {
      Vec2 at = *before;
      for (int round = 0; round < 8; ++round) {
        const std::optional<Vec2> step = direction(at, p - jet_at(at).position);
        if (!step) break;
        at = within(at + *step);
        if (step->cwiseAbs().maxCoeff() < 1e-13 * extent()) return at;
      }
    }
    if (!set_) set_.emplace(std::vector<const Surface*>{&surface_});
    const SurfaceSet::Foot foot = set_->near(p);
    Vec2 at(foot.u, foot.v);
    return before ? moved_near(at, *before) : at;
  }

  [[nodiscard]] double extent() const {
    return std::max(surface_.last_u() - surface_.first_u(), surface_.last_v() - surface_.first_v());
  }
  [[nodiscard]] Vec2 within(Vec2 at) const {
    if (periods_[0] == 0) at.x() = std::clamp(at.x(), surface_.first_u(), surface_.last_u());
    if (periods_[1] == 0) at.y() = std::clamp(at.y(), surface_.first_v(), surface_.last_v());
    return at;
  }

  // At a pole what is open is as it is beside it.
  Vec2 end_of(const Vec3& p, const Vec2& beside) {
    const Vec2 at = foot_of(p, beside);
    const nurbs::SurfaceJet jet = jet_at(at), near = jet_at(beside);
    return {jet.du.norm() < 1e-6 * near.du.norm() ? beside.x() : at.x(),
            jet.dv.norm() < 1e-6 * near.dv.norm() ? beside.y() : at.y()};
  }

 public:
  [[nodiscard]] Vec2 moved_near(Vec2 at, const Vec2& other) const {
    for (std::size_t d = 0; d < 2; ++d) {
      const auto k = static_cast<Eigen::Index>(d);
      if (periods_[d] > 0) at[k] -= periods_[d] * std::round((at[k] - other[k]) / periods_[d]);
    }
    return at;
  }

 private:
  const Surface& surface_;
  std::array<double, 2> periods_;
  std::optional<SurfaceSet> set_;
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
    for (const bool in_u : {true, false})
      if (closes(surface_, in_u))
        periods_[in_u ? 0 : 1] =
            in_u ? surface_.last_u() - surface_.first_u() : surface_.last_v() - surface_.first_v();
    breaks_ = {nurbs::breakpoints(surface_.knots_u, surface_.degree_u),
               nurbs::breakpoints(surface_.knots_v, surface_.degree_v)};
  }

  std::optional<FaceIntegrals> over(const std::vector<Loop>& loops) {
    std::vector<Round> rounds;
    FaceTracer tracer(surface_, periods_);
    for (const Loop& loop : loops) {
      std::optional<Round> round = round_of(loop, tracer);
      if (!round) return std::nullopt;
      if (!round->steps.empty()) rounds.push_back(std::move(*round));
    }
    std::array<std::size_t, 2> around = {0, 0};
    for (const Round& round : rounds)
      for (std::size_t d = 0; d < 2; ++d) around[d] += round.turns[d] != 0 ? 1 : 0;
    if (rounds.empty() || (around[0] > 0 && around[1] > 0)) return std::nullopt;
    // Lines across what goes round; else those that cross fewer spans.
    across_ = around[0] > 0 ? 1 : around[1] > 0 ? 0 : (breaks_[0].size() <= breaks_[1].size() ? 0 : 1);
    base_ = rounds.front().steps.front().at[static_cast<Eigen::Index>(across_)];
    for (const Round& round : rounds)
      for (const Step& step : round.steps)
        base_ = std::min(base_, step.at[static_cast<Eigen::Index>(across_)]);
    return combined(rounds, around[1 - across_]);
  }

 private:
  std::optional<Round> round_of(const Loop& loop, FaceTracer& tracer) {
    Round round;
    std::optional<Vec2> first, last;
    for (const Edge& edge : loop.edges) {
      if (edge.flat.points.empty() && edge.curve.points.empty()) continue;  // a pole
      std::optional<Trace> trace = tracer.trace(edge);
      if (!trace) return std::nullopt;
      const Vec2 shift = last ? Vec2(tracer.moved_near(trace->first, *last) - trace->first) : Vec2::Zero();
      for (Step& step : trace->steps) step.at += shift;
      if (last) add_straight(round, *last, trace->first + shift);
      if (!first) first = trace->first;
      last = trace->last + shift;
      round.steps.insert(round.steps.end(), trace->steps.begin(), trace->steps.end());
    }
    if (!first) return round;
    const Vec2 end = tracer.moved_near(*first, *last);
    for (std::size_t d = 0; d < 2; ++d)
      if (periods_[d] > 0) {
        const auto k = static_cast<Eigen::Index>(d);
        round.turns[d] = static_cast<int>(std::lround((end[k] - (*first)[k]) / periods_[d]));
        if (std::abs(round.turns[d]) > 1) return std::nullopt;
      }
    add_straight(round, *last, end);
    return round;
  }

  static void add_straight(Round& round, const Vec2& from, const Vec2& to) {
    if (from == to) return;
    const nurbs::GaussRule& rule = nurbs::gauss_rule(order);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
      round.steps.push_back(
          {from + 0.5 * (1 + rule.nodes[i]) * (to - from), 0.5 * rule.weights[i] * (to - from)});
  }

  // `around`: how many of them go round. The largest one, or the two that go round, hold the others.
  std::optional<FaceIntegrals> combined(const std::vector<Round>& rounds, std::size_t around) const {
    if (around != 0 && around != 2) return std::nullopt;
    Values outer = Values::Zero(), holes = Values::Zero();
    int turns = 0;
    for (const Round& round : rounds) {
      const int own = round.turns[1 - across_];
      Values values = along(round);
      if (around == 2 && own != 0) {
        // Two that run the same way leave their difference between them.
        outer += turns == own ? Values(-values) : values;
        turns = own;
        continue;
      }
      values *= values[5] < 0 ? -1 : 1;
      if (around == 0 && values[5] > outer[5]) std::swap(values, outer);
      holes += values;
    }
    if (outer[5] < 0) outer = -outer;
    const Values sum = outer - holes;
    if (!(sum[5] > 0) || !sum.allFinite()) return std::nullopt;
    return FaceIntegrals{sum[0], sum.segment<3>(1), sum[4]};
  }

  // Green's theorem: round a region to the left f du dv is the integral of F dv, where F is that of f over u.
  [[nodiscard]] Values along(const Round& round) const {
    Values sum = Values::Zero();
    const auto other = static_cast<Eigen::Index>(1 - across_);
    for (const Step& step : round.steps)
      if (step.along[other] != 0) sum += (across_ == 0 ? 1 : -1) * step.along[other] * line_to(step.at);
    return sum;
  }

  // From the base to this place, along the line of one parameter.
  [[nodiscard]] Values line_to(const Vec2& at) const {
    const auto d = static_cast<Eigen::Index>(across_);
    const std::vector<double>& breaks = breaks_[across_];
    const double first = breaks.front(), last = breaks.back(), period = last - first;
    const double from = base_, to = at[d];
    const bool wraps = periods_[across_] > 0;
    Values sum = Values::Zero();
    const auto turn_of = [&](double t) {
      return wraps ? static_cast<int>(std::floor((t - first) / period)) : 0;
    };
    for (int turn = turn_of(from); turn <= turn_of(to); ++turn)
      for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        double a = breaks[k] + turn * period, b = breaks[k + 1] + turn * period;
        // Beyond an open range the surface ends.
        if (!wraps && k == 0) a = std::min(a, from);
        if (!wraps && k + 2 == breaks.size()) b = std::max(b, to);
        a = std::max(a, from);
        b = std::min(b, to);
        if (a < b) add_span(sum, at, a, b);
      }
    return sum;
  }

  void add_span(Values& sum, Vec2 at, double a, double b) const {
    const auto d = static_cast<Eigen::Index>(across_);
    const nurbs::GaussRule& rule = nurbs::gauss_rule(order);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      at[d] = 0.5 * (a + b) + 0.5 * (b - a) * rule.nodes[i];
      sum += 0.5 * (b - a) * rule.weights[i] * values_at(at);
    }
  }

  [[nodiscard]] Values values_at(const Vec2& at) const {
    std::array<double, 2> place = {at.x(), at.y()};
    for (std::size_t k = 0; k < 2; ++k)
      if (periods_[k] > 0)
        place[k] -= periods_[k] * std::floor((place[k] - breaks_[k].front()) / periods_[k]);
    const nurbs::SurfaceJet jet = nurbs::evaluate_jet(surface_, place[0], place[1]);
    const Vec3 normal = jet.du.cross(jet.dv);
    Values values;
    values << normal.norm(), normal, (jet.position - origin_).dot(normal) / 3, 1;
    return values;
  }

  const Surface& surface_;
  Vec3 origin_;
  std::array<double, 2> periods_ = {0, 0};  // 0: not closed
  std::array<std::vector<double>, 2> breaks_;
  std::size_t across_ = 0;  // the parameter that changes along the lines: 0 is u
  double base_ = 0;         // where they begin
};

}  // namespace

std::optional<FaceIntegrals> integrals_of(const Face& face, const Vec3& origin) {
  if (!face.loops.empty()) return Integrator(face, origin).over(face.loops);
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

}  // namespace selvage::cad
