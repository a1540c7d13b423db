// Where a function of one number passes zero, or a condition begins to fail.
#pragma once

namespace selvage::nurbs {

// `is_low` holds up to some place between the two: they come nearer to it by so many halvings.
template <class IsLow>
void halve_between(double& low, double& high, int halvings, const IsLow& is_low) {
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_low(middle) ? low : high) = middle;
  }
}

// Regula falsi with the Illinois rule: two places, and the function's values there, of different signs.
struct FalsePosition {
  double from, at_from, to, at_to;
  int stayed = 0;  // the last time: 1 `from`, -1 `to`

  [[nodiscard]] double crossing() const { return (from * at_to - to * at_from) / (at_to - at_from); }

  // Takes a place between them instead of the one whose value has its sign. Of one that stays for the second
  // time, half the value counts.
  void take(double place, double value) {
    const int stays = (value > 0.0) == (at_to > 0.0) ? 1 : -1;
    (stays > 0 ? to : from) = place;
    (stays > 0 ? at_to : at_from) = value;
    if (stays == stayed) (stays > 0 ? at_from : at_to) *= 0.5;
    stayed = stays;
  }
};

}  // namespace selvage::nurbs
