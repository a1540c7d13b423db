#include "mechanics/woven_problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "core/wrapped.h"
#include "nurbs/basis.h"

namespace selvage::mechanics {

using Eigen::VectorXd;
using std::numbers::pi;

namespace {

// Unknowns of a crossing: heights of the warp up to the next weft and of the weft up to the next warp, half
// width and half height of the warp here and half way to the next weft, of the weft likewise.
constexpr int block_size = 2 * spans_a_gap + 8;
constexpr int places_a_half_gap = 8, corner_places = 4;
constexpr double steepest = 2.2;  // slope of a centre line, 66 degrees
constexpr double least_half_height = 0.02;
constexpr double hold = 1e-5;  // of yarns that nothing holds

template <class T>
int color_of(std::map<T, int>& known, const T& key) {
  return known.try_emplace(key, static_cast<int>(known.size())).first->second;
}

// Numbers of yarns: the same for yarns of the same kind with the same distances to their neighbours.
std::vector<int> kinds_of(const std::vector<WovenYarn>& yarns, const std::vector<double>& gaps) {
  std::map<std::tuple<double, double, double, double, double, double, double>, int> known;
  std::vector<int> made;
  for (std::size_t k = 0; k < yarns.size(); ++k) {
    const WovenYarn& yarn = yarns[k];
    const double before = gaps[(k + gaps.size() - 1) % gaps.size()];
    made.push_back(color_of(known, {yarn.fibre_area, yarn.packing, yarn.max_packing, yarn.aspect,
                                    yarn.stiffness, before, gaps[k]}));
  }
  return made;
}

Partition classes_of(const WovenCloth& cloth, int max_classes) {
  const std::vector<int> warps = kinds_of(cloth.warps, cloth.warp_gaps),
                         wefts = kinds_of(cloth.wefts, cloth.weft_gaps);
  std::map<std::tuple<int, int, char>, int> known;
  std::vector<int> colors;
  for (std::size_t pick = 0; pick < wefts.size(); ++pick)
    for (std::size_t end = 0; end < warps.size(); ++end)
      colors.push_back(
          color_of(known, {warps[end], wefts[pick], cloth.warp_on_top[pick * warps.size() + end]}));
  return stable_partition(colors, cloth.picks(), cloth.ends(), max_classes);
}

void add_scaled(Form& sum, const Form& form, double by) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(form.count); ++k)
    if (form.weight[k] != 0.0) sum.add(form.index[k], by * form.weight[k]);
}

double smooth_step(double t) {
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

WovenProblem::WovenProblem(const WovenCloth& scaled, int max_classes)
    : cloth_(scaled), classes_(classes_of(scaled, max_classes)) {
  num_unknowns_ = static_cast<Eigen::Index>(classes_.count()) * block_size;
  const Partition groups = classes_.is_exact ? classes_
                                             : refined(refined(classes_, cloth_.picks(), cloth_.ends()),
                                                       cloth_.picks(), cloth_.ends());
  // Of all crossings, times the number of classes: what a class weighs does not depend on how many there are.
  const double crossings = static_cast<double>(classes_.class_of.size()) / classes_.count();
  for (int group = 0; group < groups.count(); ++group) {
    const auto k = static_cast<std::size_t>(group);
    add_terms({groups.representatives[k] / cloth_.ends(), groups.representatives[k] % cloth_.ends()},
              groups.sizes[k] / crossings);
  }
}

int WovenProblem::block(int pick, int end) const {
  const int row = wrapped(pick, cloth_.picks()), column = wrapped(end, cloth_.ends());
  return classes_.class_of[static_cast<std::size_t>(row) * cloth_.warps.size() +
                           static_cast<std::size_t>(column)] *
         block_size;
}

int WovenProblem::height(WovenSystem system, int pick, int end, int knot) const {
  const int at = wrapped(knot, spans_a_gap), by = (knot - at) / spans_a_gap;
  const Crossing there = along(system, {pick, end}, by);
  return block(there.pick, there.end) + (system == WovenSystem::warp ? 0 : spans_a_gap) + at;
}

int WovenProblem::width_at(WovenSystem system, int pick, int end, int half) const {
  const int at = wrapped(half, 2), by = (half - at) / 2;
  const Crossing there = along(system, {pick, end}, by);
  return block(there.pick, there.end) + 2 * spans_a_gap + (system == WovenSystem::warp ? 0 : 4) + 2 * at;
}

double WovenProblem::gap(WovenSystem system, Crossing at, int from) const {
  const std::vector<double>& gaps = system == WovenSystem::warp ? cloth_.weft_gaps : cloth_.warp_gaps;
  const int k = (system == WovenSystem::warp ? at.pick : at.end) + from;
  return gaps[static_cast<std::size_t>(wrapped(k, static_cast<int>(gaps.size())))];
}

const WovenYarn& WovenProblem::yarn(WovenSystem system, Crossing at) const {
  return system == WovenSystem::warp
             ? cloth_.warps[static_cast<std::size_t>(wrapped(at.end, cloth_.ends()))]
             : cloth_.wefts[static_cast<std::size_t>(wrapped(at.pick, cloth_.picks()))];
}

bool WovenProblem::warp_on_top(Crossing at) const {
  return cloth_.warp_on_top[static_cast<std::size_t>(wrapped(at.pick, cloth_.picks())) * cloth_.warps.size() +
                            static_cast<std::size_t>(wrapped(at.end, cloth_.ends()))] != 0;
}

WovenProblem::Point WovenProblem::point(WovenSystem system, Crossing at, double gaps) const {
  Point made;
  // Spans from two before this one to two beyond it.
  const double place = gaps * spans_a_gap;
  const int span = static_cast<int>(std::floor(place));
  const auto knot = [&](int k) {  // distance from the crossing
    const int in = wrapped(k, spans_a_gap), whole = (k - in) / spans_a_gap;
    double sum = gap(system, at, whole) * in / spans_a_gap;
    for (int g = 0; g < whole; ++g) sum += gap(system, at, g);
    for (int g = whole; g < 0; ++g) sum -= gap(system, at, g);
    return sum;
  };
  std::vector<double> knots;
  for (int k = span - 3; k <= span + 4; ++k) knots.push_back(knot(k));
  const double t = knots[3] + (place - span) * (knots[4] - knots[3]);
  std::array<nurbs::BasisRow, 3> rows;
  nurbs::basis_derivatives(knots, 3, 3, t, rows);
  // Function k of the four has its middle at knot span - 1 + k.
  for (int k = 0; k < 4; ++k) {
    const int unknown = height(system, at.pick, at.end, span - 1 + k);
    const auto i = static_cast<std::size_t>(k);
    made.z.add(unknown, rows[0][i]);
    made.slope.add(unknown, rows[1][i]);
    made.curvature.add(unknown, rows[2][i]);
  }
  const double halves = 2.0 * gaps;
  const int half = static_cast<int>(std::floor(halves));
  const double step = smooth_step(halves - half);
  const int from = width_at(system, at.pick, at.end, half), to = width_at(system, at.pick, at.end, half + 1);
  made.half_width.add(from, 1.0 - step);
  made.half_width.add(to, step);
  made.half_height.add(from + 1, 1.0 - step);
  made.half_height.add(to + 1, step);
  return made;
}

void WovenProblem::add_terms(Crossing at, double share) {
  for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft}) {
    add_yarn(system, at, share);
    add_beside(system, at);
  }
  add_contacts(at);
}

// The gap from a crossing to the next one along a yarn.
void WovenProblem::add_yarn(WovenSystem system, Crossing at, double share) {
  const WovenYarn& own = yarn(system, at);
  const WovenConstants& constants = cloth_.constants;
  const double length = gap(system, at, 0), area = own.fibre_area;
  const nurbs::GaussRule& rule = nurbs::gauss_rule(2);
  for (int span = 0; span < spans_a_gap; ++span)
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double along = share * 0.5 * rule.weights[k] * length / spans_a_gap, weight = area * along;
      const Point here = point(system, at, (span + 0.5 + 0.5 * rule.nodes[k]) / spans_a_gap);
      paths_.push_back({{here.slope, here.curvature},
                        weight * constants.bending,
                        weight * tension(system),
                        along,
                        system});
      sections_.push_back({{here.half_width, here.half_height},
                           weight * constants.flattening * own.stiffness,
                           weight * constants.compaction,
                           std::log(own.aspect),
                           own.packing,
                           area});
    }
  for (int half = 0; half < 2; ++half) {
    // Fibres leave the axis where the section changes: by the mean of the squares of their slopes, a quarter
    // of that at the surface; the square of the slope of a smooth step is 6/5 in the mean.
    const int from = width_at(system, at.pick, at.end, half),
              to = width_at(system, at.pick, at.end, half + 1);
    for (int size = 0; size < 2; ++size) {
      SquareTerm change;
      change.form.add(from + size, -1.0);
      change.form.add(to + size, 1.0);
      change.factor = 0.5 * share * area * tension(system) * 0.25 * 1.2 / (0.5 * length);
      changes_.push_back(change);
    }
    packed_.push_back({{Form{}, Form{}}, area / (pi * own.max_packing)});
    packed_.back().forms[0].add(from, 1.0);
    packed_.back().forms[1].add(from + 1, 1.0);
    Linear high;
    high.forms[0].add(from + 1, 1.0);
    high.forms[0].constant = -least_half_height;
    linears_.push_back(high);
  }
  for (int knot = 0; knot < spans_a_gap; ++knot) {
    const Point here = point(system, at, static_cast<double>(knot) / spans_a_gap);
    holds_.push_back({here.z, 0.5 * hold * share * area * length / spans_a_gap});
    const Point middle = point(system, at, (knot + 0.5) / spans_a_gap);
    for (const double side : {-1.0, 1.0}) {
      for (const Point& place : {here, middle}) {
        folds_.push_back({{place.slope, place.curvature, place.half_height}, side});
        if (!cloth_.thickness) continue;
        Linear plate;
        plate.forms[0].constant = 0.5 * *cloth_.thickness;
        add_scaled(plate.forms[0], place.z, -side);
        add_scaled(plate.forms[0], place.half_height, -1.0);
        linears_.push_back(plate);
      }
      Linear steep;
      add_scaled(steep.forms[0], middle.slope, side);
      steep.forms[0].constant = steepest;
      linears_.push_back(steep);
    }
  }
}

// A yarn and the next one of its system, side by side. On one side of the cloth neither comes over the other,
// and where they change sides they pass at one height.
void WovenProblem::add_beside(WovenSystem system, Crossing at) {
  constexpr int places = 8, half = places / 2;  // a gap
  const WovenSystem other = system == WovenSystem::warp ? WovenSystem::weft : WovenSystem::warp;
  const Crossing next = along(other, at, 1);
  // How far the yarn is above the next one: by no side, or by one up or down.
  const auto above = [&](int crossing) {
    return (warp_on_top(along(system, at, crossing)) ? 1 : 0) -
           (warp_on_top(along(system, next, crossing)) ? 1 : 0);
  };
  const bool is_level_here = above(0) == 0, is_level_next = above(1) == 0,
             change_sides = above(0) * above(1) < 0;
  for (int place = 0; place < places; ++place) {
    const double gaps = static_cast<double>(place) / places;
    const Point a = point(system, at, gaps), b = point(system, next, gaps);
    const bool is_level =
        2 * place < places ? is_level_here : change_sides || (is_level_here && is_level_next);
    if (!is_level || place % half != 0) {
      besides_.push_back(
          {{a.z, a.slope, a.half_width, a.half_height, b.z, b.slope, b.half_width, b.half_height},
           gap(other, at, 0),
           cloth_.clearance});
    } else {
      Linear apart;
      apart.forms[0].constant = gap(other, at, 0) - cloth_.clearance;
      apart.forms[0].add(width_at(system, at.pick, at.end, place / half), -1.0);
      apart.forms[0].add(width_at(system, next.pick, next.end, place / half), -1.0);
      linears_.push_back(apart);
    }
  }
}

std::size_t WovenProblem::add_run(WovenSystem system, Crossing at, int direction, double sign) {
  Run run;
  run.sign = sign * direction;
  for (int k = 0; k <= places_a_half_gap; ++k)
    run.slopes.push_back(point(system, at, direction * 0.5 * k / places_a_half_gap).slope);
  runs_.push_back(std::move(run));
  return runs_.size() - 1;
}

void WovenProblem::add_contacts(Crossing at) {
  const double side = warp_on_top(at) ? 1.0 : -1.0;
  constexpr int every = places_a_half_gap / corner_places;
  // Both yarns fall away from the crossing: the upper one down, the lower one up.
  const std::array<std::size_t, 2> warp_runs = {add_run(WovenSystem::warp, at, -1, -side),
                                                add_run(WovenSystem::warp, at, 1, -side)},
                                   weft_runs = {add_run(WovenSystem::weft, at, -1, side),
                                                add_run(WovenSystem::weft, at, 1, side)};
  std::array<std::vector<Point>, 2> warp_points, weft_points;
  for (std::size_t d = 0; d < 2; ++d)
    for (int k = 0; k <= places_a_half_gap; ++k) {
      const double gaps = (d == 0 ? -0.5 : 0.5) * k / places_a_half_gap;
      warp_points[d].push_back(point(WovenSystem::warp, at, gaps));
      weft_points[d].push_back(point(WovenSystem::weft, at, gaps));
    }
  const auto length = [&](WovenSystem system, std::size_t d) {
    return d == 0 ? -gap(system, at, -1) : gap(system, at, 0);
  };
  const auto add = [&](std::size_t warp_side, int warp_place, std::size_t weft_side, int weft_place) {
    const Point &a = warp_points[warp_side][static_cast<std::size_t>(warp_place)],
                &b = weft_points[weft_side][static_cast<std::size_t>(weft_place)];
    Contact contact;
    contact.forms = {a.z, a.slope, a.half_width, a.half_height, b.z, b.slope, b.half_width, b.half_height};
    contact.side = side;
    contact.along_warp = 0.5 * warp_place / places_a_half_gap * length(WovenSystem::warp, warp_side);
    contact.along_weft = 0.5 * weft_place / places_a_half_gap * length(WovenSystem::weft, weft_side);
    contact.clearance = cloth_.clearance;
    contact.warp_run = warp_runs[warp_side];
    contact.weft_run = weft_runs[weft_side];
    contact.warp_place = warp_place;
    contact.weft_place = weft_place;
    contacts_.push_back(contact);
  };
  add(0, 0, 0, 0);
  for (std::size_t d = 0; d < 2; ++d)
    for (int k = 1; k <= places_a_half_gap; ++k) {
      add(d, k, 0, 0);
      add(0, 0, d, k);
    }
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t e = 0; e < 2; ++e)
      for (int k = 1; k <= corner_places; ++k)
        for (int m = 1; m <= corner_places; ++m) add(d, every * k, e, every * m);
}

VectorXd WovenProblem::start(double warp_share) const {
  VectorXd x = VectorXd::Zero(num_unknowns_);
  for (const int representative : classes_.representatives) {
    const Crossing at{representative / cloth_.ends(), representative % cloth_.ends()};
    const auto half_height = [&](WovenSystem system, Crossing there) {
      const WovenYarn& own = yarn(system, there);
      return std::sqrt(own.fibre_area / (pi * own.packing * own.aspect));
    };
    for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft}) {
      const double share = system == WovenSystem::warp ? warp_share : warp_share - 1.0;
      const auto rise = [&](Crossing there) {
        const double both = half_height(WovenSystem::warp, there) + half_height(WovenSystem::weft, there);
        return (warp_on_top(there) ? share : -share) * both;
      };
      const double from = rise(at), to = rise(along(system, at, 1));
      for (int knot = 0; knot < spans_a_gap; ++knot)
        x[height(system, at.pick, at.end, knot)] =
            from + (to - from) * smooth_step(static_cast<double>(knot) / spans_a_gap);
      const double height_here = half_height(system, at);
      for (int half = 0; half < 2; ++half) {
        const int width = width_at(system, at.pick, at.end, half);
        x[width] = yarn(system, at).aspect * height_here;
        x[width + 1] = height_here;
      }
    }
  }
  return x;
}

VectorXd WovenProblem::equality() const {
  if (!cloth_.warp_share) return {};
  VectorXd made = VectorXd::Zero(num_unknowns_);
  for (std::size_t k = 0; k < classes_.representatives.size(); ++k) {
    const int representative = classes_.representatives[k];
    const Crossing at{representative / cloth_.ends(), representative % cloth_.ends()};
    const double share = classes_.sizes[k] / static_cast<double>(classes_.class_of.size());
    const double side = warp_on_top(at) ? share : -share;
    // Of the sum of both, side * (warp - weft), the warp has this share.
    const Form warp = point(WovenSystem::warp, at, 0.0).z, weft = point(WovenSystem::weft, at, 0.0).z;
    for (int i = 0; i < warp.count; ++i)
      made[warp.index[static_cast<std::size_t>(i)]] +=
          (1.0 - *cloth_.warp_share) * side * warp.weight[static_cast<std::size_t>(i)];
    for (int i = 0; i < weft.count; ++i)
      made[weft.index[static_cast<std::size_t>(i)]] +=
          *cloth_.warp_share * side * weft.weight[static_cast<std::size_t>(i)];
  }
  return made;
}

}  // namespace selvage::mechanics
