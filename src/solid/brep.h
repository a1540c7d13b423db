// Yarns as OpenCASCADE solids. Implemented in the module selvage_occt together with formats/step; this header
// shows no type of OpenCASCADE.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "formats/format.h"
#include "yarn/body.h"

namespace selvage::solid {

struct BrepCheck {
  bool valid = false;    // BRepCheck_Analyzer on the solid
  int free_edges = 0;    // edges with one face
  double volume = 0;     // BRepGProp, file units^3
  double tolerance = 0;  // the largest tolerance of its vertices and edges
  std::vector<Message> defects;
};

// Builds each yarn's solid as STEP would write it and lets OpenCASCADE judge it.
Result<std::vector<BrepCheck>> check_breps(std::span<const yarn::Body> bodies);

// What the module exports.
struct OcctModule {
  const char* version;
  Result<std::vector<BrepCheck>> (*check)(std::span<const yarn::Body> bodies);
  Result<std::unique_ptr<formats::BodyWriter>> (*open_step)(OutputFile& output,
                                                            const formats::SurfaceOptions& options);
};
Result<const OcctModule*> occt_module();

}  // namespace selvage::solid
