#include "fabric/grid_net.h"

namespace selvage::fabric {

yarn::GridNet net_of(const Grid& grid, bool yarn_closed) {
  yarn::GridNet net;
  net.sections = grid.sections;
  net.per_section = grid.per_section;
  net.points = grid.points;
  net.weights = grid.weights;
  net.degree_along = grid.degree_along;
  net.degree_round = grid.degree_round;
  net.knots_along = grid.knots_along;
  net.knots_round = grid.knots_round;
  net.open_round = grid.open_round;
  net.closed_along = grid.closed_along || yarn_closed;
  net.corners = grid.corners;
  return net;
}

}  // namespace selvage::fabric
