// Pictures of the surfaces of meshes. Implemented in the module selvage_embree; call it through render().
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "view/picture.h"

namespace selvage::view {

struct MeshSurface {
  std::vector<Vec3> points;                             // file units
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise, seen from outside
  std::vector<std::uint8_t>
      inner;  // of each triangle: 1 to 3: its edge opposite of this corner is none of an element
  std::vector<yarn::Color> colors;  // of each triangle, where there are no values
  std::vector<float> values;        // of points or triangles; may be empty, else colours go by color_scale.h
  bool values_are_of_points = true;
  double low = 0, high = 1;  // values of the scale's ends, low < high
};

// The surface by parallel rays, with the edges of its elements where these are larger than a few pixels.
// Light comes from the upper left; what faces the eye or the light has its colour, the rest is down to half
// as bright. `flat`: all has its very colour. Errors: geometry (no triangle, coordinates that are not
// finite), unsupported (a section), internal.
Result<Picture> render(const MeshSurface& surface, const PictureOptions& options);

}  // namespace selvage::view
