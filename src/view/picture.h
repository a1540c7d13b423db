// Pictures of yarns, ray-traced without a display. Implemented in the module selvage_embree (the only user of
// Embree and libpng); call it through render() and png(), which open the module.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "view/camera.h"
#include "yarn/body.h"

namespace selvage::view {

inline constexpr int largest_side = 16384;  // pixels

// A plane across x (0), y (1) or z (2), file units.
struct Section {
  int axis = 2;
  double place = 0;
};

struct PictureOptions {
  int width = 1200, height = 900;  // pixels, 1 .. largest_side
  Eye eye;
  std::optional<Section> section;
  yarn::Color background{255, 255, 255};
  bool flat = false;  // without ambient occlusion and shadows, for speed
  int threads = 1;    // the picture is the same, to the bit, with any number
  std::function<void(std::size_t done, std::size_t total)> progress;  // may be empty
};

// 8 bits a channel, red, green, blue; rows from the top, without padding.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  double pixels_per_unit = 0;  // how large a file unit is across the line of sight
};

// What the picture shows:
// - yarns in their colours (those of nobody's choice in that of their role, role_color.h), by parallel light
//   rays (orthographic), lit from the upper left of the picture;
// - with a section only what is on the far side of its plane (seen along the plane: on the side of smaller
//   coordinates); what the plane cuts is filled with the yarn's colour, flat, with a dark rim;
// - cut ends lighter than the yarn's side;
// - a twisted yarn's fibres as fine stripes with the twist's hand and pitch, where they are wide enough to
// see;
// - magenta where the yarn that is seen holds a part of another yarn inside itself, along the line of sight;
//   orange where it holds a part of itself (neighbouring loops, a fold). A surface that lies inside another
//   yarn cannot be seen itself, so the place is marked on the skin before it. Overlaps that are shallower
//   than the picture's own accuracy (0.6 pixel, and the yarns' tube_error) are not marked.
// Errors: geometry (no yarn, coordinates that are not finite, a section that cuts nothing), limit (more than
// 2^31 facets), internal.
Result<Picture> render(std::span<const yarn::Body> bodies, const PictureOptions& options);

// The picture as a PNG file. Error (internal): libpng refuses.
Result<std::string> png(const Picture& picture);

struct MeshSurface;  // view/mesh_picture.h

// What the module exports.
struct EmbreeModule {
  const char* version;  // of Embree
  Result<Picture> (*render)(std::span<const yarn::Body> bodies, const PictureOptions& options);
  Result<Picture> (*render_mesh)(const MeshSurface& surface, const PictureOptions& options);
  Result<std::string> (*png)(const Picture& picture);
};
Result<const EmbreeModule*> embree_module();

}  // namespace selvage::view
