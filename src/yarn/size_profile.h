// Section size and angle along a path: monotone piecewise cubics (Fritsch and Carlson 1980; derivatives by
// the weighted harmonic mean of Fritsch and Butland 1984), so that no size overshoots its neighbours.
#pragma once

#include <array>
#include <vector>

namespace selvage::yarn {

class SizeProfile {
 public:
  using Values = std::array<double, 3>;  // width, height, angle
  struct Jet {
    Values value, slope;
  };
  // Parameters increase strictly; before the first and after the last the value stands still. closed: the
  // profile returns to its first row after a period of 1.
  SizeProfile(std::vector<double> parameters, std::vector<Values> rows, bool closed);

  [[nodiscard]] Jet at(double t) const;
  [[nodiscard]] const std::vector<double>& parameters() const { return parameters_; }

 private:
  std::vector<double> parameters_;
  std::vector<Values> rows_, slopes_;
};

}  // namespace selvage::yarn
