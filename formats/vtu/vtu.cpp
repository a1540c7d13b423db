#include "formats/vtu/vtu.h"

namespace selvage::formats::vtu {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "vtu", .title = "VTK unstructured grid", .extensions = {".vtu"}};
  return self;
}

}  // namespace selvage::formats::vtu
