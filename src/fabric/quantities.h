// What exists. A number far outside of it is a slip of units, which geometry would only show as endless work
// or as nonsense; the bounds are wide enough for everything that is made, from nanofibres to ropes.
#pragma once

#include <string>
#include <string_view>

#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

struct Quantity {
  std::string_view what, unit;
  double least = 0, most = 0;
  std::string_view slip_unit = {};  // another one that such numbers are often given in, ...
  double slip = 1;                  // ... and what a value in it is multiplied by
  Measure measure = Measure::plain;
};

inline constexpr Quantity density_quantity = {"a density", "g/cm3", 0.001,           25,
                                              "kg/m3",     1e-3,    Measure::density};
inline constexpr Quantity linear_density_quantity = {"a linear density", "g/km (tex)", 1e-6, 1e9};
inline constexpr Quantity packing_quantity = {"a packing", "of the section", 0.01, 1};
inline constexpr Quantity twist_quantity = {"a twist", "turns per metre", 0, 1e6, {}, 1, Measure::twist};
inline constexpr Quantity modulus_quantity = {"a modulus", "MPa", 1e-9, 1e7, "Pa", 1e-6, Measure::modulus};
inline constexpr Quantity strength_quantity = {"a strength", "MPa", 1e-6, 1e6, "Pa", 1e-6, Measure::modulus};
inline constexpr Quantity expansion_quantity = {"an expansion",    "1/K", -0.01, 0.01, "1e-6/K", 1e-6,
                                                Measure::expansion};
inline constexpr Quantity conductivity_quantity = {
    "a thermal conductivity", "W/(m K)", 1e-4, 1e5, "mW/(m K)", 1e-3, Measure::conductivity};
inline constexpr Quantity diffusivity_quantity = {"a diffusivity",     "mm2/s", 1e-13, 1e6, "m2/s", 1e6,
                                                  Measure::diffusivity};
inline constexpr Quantity permittivity_quantity = {
    "a relative permittivity", "times that of a vacuum", 1, 1e6, "F/m", 1 / 8.8541878188e-12};
inline constexpr Quantity interface_stiffness_quantity = {
    "an interface's stiffness", "MPa/mm", 1e-6, 1e12, "N/m3", 1e-9};
inline constexpr Quantity interface_strength_quantity = {
    "an interface's strength", "MPa", 1e-6, 1e5, "Pa", 1e-6, Measure::modulus};
inline constexpr Quantity interface_energy_quantity = {
    "an interface's fracture energy", "N/mm (kJ/m2)", 1e-9, 1e4, "J/m2", 1e-3};
inline constexpr Quantity size_quantity = {"a section's size", "mm", 1e-4, 1e5};
inline constexpr Quantity place_quantity = {"a coordinate", "mm", -1e9, 1e9};
inline constexpr Quantity ratio_quantity = {"a ratio", "times the yarn's size", 0.01, 1e5};

// What is wrong with a value, in words that name the unit and the bounds; empty: nothing.
std::string oddity(const Quantity& quantity, double value);

// A distance between yarns of this size, both in file units, at its place in the text. Error (geometry): out
// of all proportion to them.
Status check_proportion(std::string_view what, double distance, double size, Unit units, TextPlace place);

// Lengths of the whole text: sizes of sections, coordinates, the cell, and a tolerance (file units) that
// belongs to the smallest section. Errors (geometry) at their threads, yarns and rows, and at the cell.
void check_lengths(const Fabric& fabric, double tolerance, Diagnostics& diagnostics);

}  // namespace selvage::fabric
