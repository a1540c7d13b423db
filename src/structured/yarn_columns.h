// Which yarn is where: straight lines through a cell along z, and what each of them meets of the yarns.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::fem {

// Where a line along z passes a yarn's surface.
struct Crossing {
  double z = 0;
  double v = 0;  // parameter along the yarn
};

// The crossings of the lines through (xs[i], ys[j]), file units, with a yarn's surface: entry j * xs.size() +
// i, sorted by z; always an even number. The surface is taken as triangles whose edges are at most `edge`
// long, closed with flat fans at its ends.
std::vector<std::vector<Crossing>> cross_yarn(const yarn::Body& body, std::span<const double> xs,
                                              std::span<const double> ys, double edge);

}  // namespace selvage::fem
