#include "formats/step/step.h"

namespace selvage::formats::step {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "step", .title = "STEP AP242 or AP214, manifold solids", .extensions = {".stp"}};
  return self;
}

}  // namespace selvage::formats::step
