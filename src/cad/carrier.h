// The surface of low degree that faces lie on: cylinders, cones, spheres and tori, however their parameters
// run.
#pragma once

#include <optional>

#include "cad/distance.h"

namespace selvage::cad {

// A bound on how far two surfaces, over their ranges, are from each other's carrier, where one algebraic
// surface carries both: a quadric, or a cyclide (a torus is one). So far at most are the faces apart whose
// outlines coincide, where a point of one is on the other. None where no such surface is within `enough` of
// both.
//
// The carrier's equation is fitted to points of both, and what it leaves of them is bounded by the Bernstein
// coefficients of the equation over each piece, divided by those of its gradient: f <= e and |grad f| >= g
// within e / g of a point mean that the carrier is within e / g of it.
std::optional<double> carrier_distance(const nurbs::Surface& a, const Range& range_a, const nurbs::Surface& b,
                                       const Range& range_b, double enough);

}  // namespace selvage::cad
