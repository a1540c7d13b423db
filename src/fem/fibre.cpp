#include "fem/fibre.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "fem/quality.h"
#include "nurbs/divided.h"

namespace selvage::fem {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// The parameter of the centre line nearest to a point, by Newton's method from a good guess; around the end
// of a ring.
double nearest_parameter(const yarn::Body& body, const Vec3& point, double guess) {
  const double first = body.axis.first_parameter(), last = body.axis.last_parameter(), range = last - first;
  double t = guess;
  for (int step = 0; step < 12; ++step) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(body.axis, t);
    const Vec3 miss = jet.position - point;
    const double speed = jet.d1.squaredNorm();
    double slope = speed + miss.dot(jet.d2);
    if (!(slope > 0.1 * speed)) slope = speed;  // beyond the centre of curvature: Gauss-Newton
    if (!(slope > 0)) break;
    const double change = std::clamp(-miss.dot(jet.d1) / slope, -range / 8, range / 8);
    const double before = t;
    t += change;
    if (body.closed_along) {
      if (t > last) t -= range;
      if (t < first) t += range;
    } else {
      t = std::clamp(t, first, last);
    }
    if (std::abs(t - before) <= 1e-9 * range) break;
  }
  return t;
}

// Which elements of a region stand round each node.
class Neighbours {
 public:
  Neighbours(const Mesh& mesh, const Region& region) : first_(mesh.nodes.size() + 1, 0) {
    const auto corners = static_cast<std::size_t>(mesh.corners_per_element());
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      for (std::size_t k = 0; k < corners; ++k) ++first_[mesh.elements[e][k] + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    elements_.resize(first_.back());
    std::vector<std::size_t> fill(first_.begin(), first_.end() - 1);
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      for (std::size_t k = 0; k < corners; ++k) elements_[fill[mesh.elements[e][k]]++] = e;
  }
  [[nodiscard]] std::span<const std::size_t> of(std::size_t node) const {
    return std::span(elements_).subspan(first_[node], first_[node + 1] - first_[node]);
  }

 private:
  std::vector<std::size_t> first_, elements_;
};

// The area of the sections along a yarn, between places where it was computed.
class Areas {
 public:
  explicit Areas(const yarn::Body& body) {
    constexpr int parts = 8;  // of a span
    places_ = nurbs::divided(body.surface.knots_v, body.surface.degree_v, parts);
    areas_.resize(places_.size(), unknown);
    body_ = &body;
  }
  double at(double v) {
    const auto above = std::upper_bound(places_.begin() + 1, places_.end() - 1, v);
    const auto i = static_cast<std::size_t>(above - places_.begin());
    const double share = std::clamp((v - places_[i - 1]) / (places_[i] - places_[i - 1]), 0.0, 1.0);
    return (1 - share) * known(i - 1) + share * known(i);
  }

 private:
  double known(std::size_t i) {
    if (std::isnan(areas_[i])) areas_[i] = section_area(*body_, places_[i]);
    return areas_[i];
  }
  const yarn::Body* body_ = nullptr;
  std::vector<double> places_, areas_;
};

struct Axes {
  Vec3 along, across;
};

// At the parameter of the centre line nearest to a point.
Axes axes_at(const yarn::Body& body, double t, const Vec3& point) {
  const nurbs::CurveJet jet = nurbs::evaluate_jet(body.axis, t);
  const Vec3 along = fibre_direction(body, jet.d1.normalized(), point - jet.position);
  const Vec3 seam = nurbs::evaluate(body.surface, body.surface.first_u(), t) - jet.position;
  const Vec3 level = seam - along * along.dot(seam);
  return {along, level.norm() > 1e-9 * seam.norm() ? Vec3(level.normalized()) : Vec3(along.unitOrthogonal())};
}

}  // namespace

std::vector<double> parameters_along(const Mesh& mesh, const Region& region, const yarn::Body& body,
                                     std::span<const double> known, double unit) {
  const auto corners = static_cast<std::size_t>(mesh.corners_per_element());
  const Neighbours neighbours(mesh, region);
  std::vector<double> result(region.last_element - region.first_element, unknown);
  std::vector<bool> seen(result.size(), false);
  std::vector<double> parameters(known.begin(), known.end());
  parameters.resize(mesh.nodes.size(), unknown);
  std::deque<std::size_t> queue;
  auto reach = [&](std::size_t node) {
    for (const std::size_t e : neighbours.of(node)) {
      if (seen[e - region.first_element]) continue;
      seen[e - region.first_element] = true;
      queue.push_back(e);
    }
  };
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!std::isnan(known[i])) reach(i);
  while (!queue.empty()) {
    const std::size_t e = queue.front();
    queue.pop_front();
    const auto& element = mesh.elements[e];
    double guess = unknown;
    for (std::size_t k = 0; k < corners; ++k)
      if (std::isnan(guess)) guess = parameters[element[k]];
    const double t = nearest_parameter(body, middle_of(mesh, e) / unit, guess);
    result[e - region.first_element] = t;
    for (std::size_t k = 0; k < corners; ++k) {
      if (!std::isnan(parameters[element[k]])) continue;
      parameters[element[k]] = t;
      reach(element[k]);
    }
  }
  return result;
}

void settle_parameters(const Mesh& mesh, const Region& region, const yarn::Body& body,
                       std::span<double> parameters, double unit) {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    parameters[i] = nearest_parameter(body, middle_of(mesh, region.first_element + i) / unit, parameters[i]);
}

Vec3 fibre_direction(const yarn::Body& body, const Vec3& tangent, const Vec3& off) {
  if (body.twist == 0) return tangent;
  return (tangent + 2 * std::numbers::pi * body.twist * tangent.cross(off)).normalized();
}

void add_fibres(Mesh& mesh, const Region& region, const yarn::Body& body, std::span<const double> parameters,
                double unit) {
  if (mesh.along.size() < mesh.elements.size()) {
    mesh.along.resize(mesh.elements.size(), Vec3::UnitX());
    mesh.across.resize(mesh.elements.size(), Vec3::UnitY());
  }
  mesh.fibre_fraction.resize(mesh.elements.size(), 0);
  Areas areas(body);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::size_t e = region.first_element + i;
    const Axes axes = axes_at(body, parameters[i], middle_of(mesh, e) / unit);
    mesh.along[e] = axes.along;
    mesh.across[e] = axes.across;
    mesh.fibre_fraction[e] = body.fibre_area > 0 ? body.fibre_area / areas.at(parameters[i]) : unknown;
  }
}

double section_area(const yarn::Body& body, double v) {
  // Half the integral of (S - c) x S_u: a cubic of u for the common quadratic outline, which two points of
  // Gauss integrate exactly in each span; four serve any degree up to 4.
  constexpr std::array<std::array<double, 2>, 4> gauss = {{{-0.8611363115940526, 0.3478548451374538},
                                                           {-0.3399810435848563, 0.6521451548625461},
                                                           {0.3399810435848563, 0.6521451548625461},
                                                           {0.8611363115940526, 0.3478548451374538}}};
  const nurbs::CurveJet centre = nurbs::evaluate_jet(body.axis, v);
  const std::vector<double> breaks = nurbs::breakpoints(body.surface.knots_u, body.surface.degree_u);
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double half = (breaks[i + 1] - breaks[i]) / 2, middle = (breaks[i + 1] + breaks[i]) / 2;
    for (const auto& [place, weight] : gauss) {
      const nurbs::SurfaceJet jet = nurbs::evaluate_jet(body.surface, middle + half * place, v);
      area += weight * half / 2 * (jet.position - centre.position).cross(jet.du);
    }
  }
  return std::abs(area.dot(centre.d1.normalized()));
}

double section_perimeter(const yarn::Body& body, double v) {
  constexpr int parts = 16;  // of a span
  const std::vector<double> us = nurbs::divided(body.surface.knots_u, body.surface.degree_u, parts);
  return nurbs::length_of(nurbs::evaluate_grid(body.surface, us, {v}));
}

}  // namespace selvage::fem
