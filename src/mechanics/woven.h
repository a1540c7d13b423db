// Woven cloth in equilibrium: centre lines and sections of least energy without overlap. Sources: J. W. S.
// Hearle, W. J. Shanahan, An energy method for calculations in fabric mechanics, J. Text. Inst. 69 (1978) 81
// and 92; F. T. Peirce, The geometry of cloth structure, J. Text. Inst. 28 (1937) T45; C. M. van Wyk, J.
// Text. Inst. 37 (1946) T285.
#pragma once

#include <memory>

#include "core/diagnostics.h"
#include "mechanics/woven_problem.h"

namespace selvage::mechanics {

class WovenEquilibrium {
 public:
  WovenEquilibrium(std::shared_ptr<const WovenProblem> problem, Minimum minimum, double scale,
                   double tolerance)
      : problem_(std::move(problem)), minimum_(std::move(minimum)), scale_(scale), tolerance_(tolerance) {}

  // The control value of a centre line, in the cloth's unit; `knot` is spans_a_gap times the number of the
  // crossing at crossings. Cubic B-splines; the knots divide each gap evenly.
  [[nodiscard]] double control_height(WovenSystem system, int yarn, int knot) const;
  struct Size {
    double width = 0, height = 0;
  };
  // Full sizes of the section (an ellipse), in the cloth's unit, anywhere along a yarn: 0 at crossing 0, 1 at
  // the next.
  [[nodiscard]] Size size(WovenSystem system, int yarn, double crossings) const;

  // Mean of a system's yarns, (L - p) / p.
  [[nodiscard]] double crimp(WovenSystem system) const { return problem_->crimp(system, minimum_.x); }
  // Between plates this far apart (in the cloth's unit), or as far as they can be brought together, to 0.2 %;
  // itself where it is thinner.
  [[nodiscard]] WovenEquilibrium pressed(double thickness) const;
  // Between plates that press with this pressure (see pressure()); itself where its own press with more.
  // Error (geometry): no yarns bear it.
  [[nodiscard]] Result<WovenEquilibrium> pressed_with(double pressure) const;
  // Of the plates, over the tension of a finished cloth by the mean fibre area.
  [[nodiscard]] double pressure() const { return problem_->pressure(minimum_); }

  // Distance of the plates that touch it, in the cloth's unit.
  [[nodiscard]] double thickness() const { return scale_ * problem_->thickness(minimum_.x); }
  [[nodiscard]] WovenEnergy energy() const { return problem_->energy(minimum_.x); }
  [[nodiscard]] double residual() const { return minimum_.residual; }
  // Largest overlap that any inequality sees, in the cloth's unit.
  [[nodiscard]] double overlap() const { return scale_ * problem_->worst(minimum_.x); }
  [[nodiscard]] int steps() const { return minimum_.steps; }
  [[nodiscard]] int num_classes() const { return problem_->classes().count(); }

 private:
  // From here.
  [[nodiscard]] Result<WovenEquilibrium> next(const WovenCloth& cloth, double flattened) const;
  std::shared_ptr<const WovenProblem> problem_;
  Minimum minimum_;
  double scale_, tolerance_;
};

struct WovenOptions {
  double tolerance = 1e-9;
  int max_classes = 256;  // of the crossings of a repeat
};

// Errors: no equilibrium without overlap was found (geometry), with the residual; the crossings of the repeat
// are of more classes than options.max_classes (limit). Of a cloth with a thickness that it cannot have: the
// thinnest one.
Result<WovenEquilibrium> find_equilibrium(const WovenCloth& cloth, const WovenOptions& options = {});

}  // namespace selvage::mechanics
