#include "fem/orientation.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace selvage::fem {
namespace {

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

void set_orientation(Mesh& mesh, std::size_t element, const yarn::Body& body, double t) {
  const nurbs::CurveJet jet = nurbs::evaluate_jet(body.axis, t);
  const Vec3 along = jet.d1.normalized();
  const Vec3 seam = nurbs::evaluate(body.surface, body.surface.first_u(), t) - jet.position;
  const Vec3 level = seam - along * along.dot(seam);
  mesh.along[element] = along;
  mesh.across[element] =
      level.norm() > 1e-9 * seam.norm() ? Vec3(level.normalized()) : Vec3(along.unitOrthogonal());
}

}  // namespace

void add_orientations(Mesh& mesh, const SurfaceMesh& surface, const yarn::Body& body) {
  const std::size_t count = mesh.elements.size();
  mesh.along.assign(count, Vec3::UnitX());
  mesh.across.assign(count, Vec3::UnitY());
  // Parameters spread from the surface's vertices, which know theirs, inward from node to element to node:
  // the guess is never far off, and never on another turn of the yarn that happens to be near.
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> parameters(mesh.nodes.size(), unknown);
  for (std::size_t i = 0; i < surface.parameters.size(); ++i) parameters[i] = surface.parameters[i].y();
  std::vector<std::size_t> first_use(mesh.nodes.size() + 1, 0), uses(4 * count);
  for (const auto& element : mesh.elements)
    for (std::size_t k = 0; k < 4; ++k) ++first_use[element[k] + 1];
  for (std::size_t i = 1; i < first_use.size(); ++i) first_use[i] += first_use[i - 1];
  std::vector<std::size_t> fill(first_use.begin(), first_use.end() - 1);
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t k = 0; k < 4; ++k) uses[fill[mesh.elements[e][k]]++] = e;

  std::vector<bool> seen(count, false);
  std::deque<std::size_t> queue;
  auto reach = [&](std::size_t node) {
    for (std::size_t i = first_use[node]; i < first_use[node + 1]; ++i) {
      if (seen[uses[i]]) continue;
      seen[uses[i]] = true;
      queue.push_back(uses[i]);
    }
  };
  for (std::size_t i = 0; i < surface.parameters.size(); ++i) reach(i);
  while (!queue.empty()) {
    const std::size_t e = queue.front();
    queue.pop_front();
    const auto& element = mesh.elements[e];
    Vec3 middle = Vec3::Zero();
    double guess = unknown;
    for (std::size_t k = 0; k < 4; ++k) {
      middle += mesh.nodes[element[k]] / 4;
      if (std::isnan(guess)) guess = parameters[element[k]];
    }
    const double t = nearest_parameter(body, middle, guess);
    set_orientation(mesh, e, body, t);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!std::isnan(parameters[element[k]])) continue;
      parameters[element[k]] = t;
      reach(element[k]);
    }
  }
}

}  // namespace selvage::fem
