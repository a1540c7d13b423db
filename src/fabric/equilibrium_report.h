// Results of an equilibrium, for reports.
#pragma once

#include <string_view>
#include <vector>

namespace selvage::fabric {

struct EquilibriumReport {
  // Means over the yarns of a system; mm.
  struct System {
    std::string_view name;
    double width = 0, height = 0;                  // of the cross-section at crossings
    double width_between = 0, height_between = 0;  // half way between them
    double axis_height = 0;  // of centre lines at crossings, over the middle of the cloth
    double packing = 0;      // fibre area over yarn area
    double crimp = 0;        // (L - p) / p
    [[nodiscard]] double take_up() const { return crimp / (1.0 + crimp); }
  };
  std::string_view state;
  std::vector<System> systems;
  // Per crossing, over (tension of a finished cloth) * (mean fibre area)^(3/2); then its fractions.
  double energy = 0;
  double bending = 0, tension = 0, flattening = 0, compaction = 0;
  int steps = 0;        // of Newton's method, all starts
  double residual = 0;  // of the gradient, over its scale
  int num_classes = 0;  // congruence classes of crossings
};

}  // namespace selvage::fabric
