// What is compared of a CAD model, and which thing of one model is which of the other.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// A model whose first `yarns` parts are yarns: their first face is the body, then come the ends.
struct Subject {
  Model model;
  std::size_t yarns = 0;
};

// A yarn, another part, or a curve (as a surface of no width).
struct Thing {
  enum class Kind { yarn, part, curve };
  Kind kind = Kind::part;
  std::string name;
  std::optional<Color> color;
  std::vector<const nurbs::Surface*> surfaces;
  std::vector<const Face*> faces;  // of a curve none
  Box3 box;                        // of the control points, of trimmed faces of points on them (place_of)
  double spread = 0;               // root of the mean square distance of the control points from their mean
};
std::string_view name_of(Thing::Kind kind);  // "yarn", "part", "curve"

struct Things {
  std::vector<Thing> list;
  std::deque<nurbs::Surface> curves;
};
// Without curves that run along the edge of a face of either model, to 1e-7 of its size: outlines that are
// drawn twice. The model outlives them.
Things things_of(const Subject& subject, const Subject& other);

struct Pairing {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // in the order of a
  std::vector<std::size_t> only_a, only_b;
};
// By name (where one name stands for several things, by their places), then what stands at the same place,
// then what has the same shape elsewhere, then what is the next of its kind within a quarter of its size.
// `near`: boxes whose corners are this close are at the same place. Near-linear but for the last two, which
// look only at what is left over.
Pairing pair_things(const std::vector<Thing>& a, const std::vector<Thing>& b, double near);

}  // namespace selvage::cad
