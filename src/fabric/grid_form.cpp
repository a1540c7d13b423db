#include "fabric/grid_form.h"

#include <algorithm>

#include "yarn/grid.h"

namespace selvage::fabric {

namespace {

std::vector<double> counted_from_zero(int count, int degree) {
  std::vector<double> knots;
  for (int i = 0; i < count + degree + 1; ++i) knots.push_back(std::clamp(i - degree, 0, count - degree));
  return knots;
}

}  // namespace

Grid grid_of(const yarn::Body& body) {
  const nurbs::Surface& surface = body.surface;
  Grid grid;
  grid.sections = surface.count_v;
  grid.per_section = surface.count_u;
  grid.open_round = true;
  grid.closed_along = body.closed_along;
  grid.points = surface.points;
  grid.weights = surface.weights;
  if (surface.degree_u != std::min(2, surface.count_u - 1)) grid.degree_round = surface.degree_u;
  const int most = body.closed_along ? surface.count_v : surface.count_v - 1;
  if (surface.degree_v != std::min(3, most)) grid.degree_along = surface.degree_v;
  std::vector<double> round = counted_from_zero(surface.count_u, surface.degree_u);
  const double spans = round.back();
  for (double& knot : round) knot /= spans;
  if (surface.knots_u != round) grid.knots_round = surface.knots_u;
  // A ring without knots would be the periodic form, whose first section is not repeated.
  if (body.closed_along || surface.knots_v != counted_from_zero(surface.count_v, surface.degree_v))
    grid.knots_along = surface.knots_v;
  if (!body.closed_along && body.quarters != yarn::quarters_of(surface)) grid.corners = body.quarters;
  return grid;
}

}  // namespace selvage::fabric
