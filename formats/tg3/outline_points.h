// Which points of a yarn's sections its surface goes through, and the curves round through them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "formats/tg3/section.h"

namespace selvage::formats::tg3 {

inline constexpr double round_share = 1e-6;

// The same parameters for all sections of a yarn. Polygons are joined by straight lines. Other sections are
// joined by cubics between their corners (periodic where none has one), with so many points, evenly along the
// sections' outlines, that the curve keeps within `round_share` of the largest section's size.
class OutlinePoints {
 public:
  // `tolerance`: how far the curves may be from the sections, 0: as said above. Of polygons those corners are
  // left out, of all sections together, without which none is farther off.
  explicit OutlinePoints(const std::vector<Section>& sections, double tolerance = 0);

  // Of each point its parameter t of the sections, 0 <= t < 1.
  [[nodiscard]] std::vector<double> section_parameters() const;
  // Of each section, counter-clockwise, the first not repeated.
  [[nodiscard]] const std::vector<std::vector<Vec2>>& points() const { return points_; }
  // The control points (rows) round through a row of data for each point, first = last; columns are
  // independent.
  [[nodiscard]] Eigen::MatrixXd controls(const Eigen::MatrixXd& data) const;
  // How far the curves are from the sections, about.
  [[nodiscard]] double deviation() const { return deviation_; }
  [[nodiscard]] int degree() const { return is_straight_ ? 1 : 3; }
  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }

 private:
  struct Arc {
    Eigen::Index first = 0, spans = 0;  // its points: from the first on, the last one wrapped round
  };
  void take_kept(const std::vector<Section>& sections);
  void place(const std::vector<Section>& sections, int per_turn);
  void leave_out_corners(double tolerance);
  void make_knots();
  [[nodiscard]] double worst_error(const std::vector<Section>& sections) const;

  bool is_straight_ = false;
  double deviation_ = 0;
  std::vector<Arc> arcs_;              // none: periodic
  std::vector<double> parameters_;     // of the points, 0 .. 1, the last one the return to the first
  std::vector<double> ts_, halfways_;  // of the sections: at the points, and halfway behind each
  std::vector<double> knots_;
  std::vector<std::vector<Vec2>> points_;
};

}  // namespace selvage::formats::tg3
