#include "formats/inp/inp.h"

namespace selvage::formats::inp {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "inp", .title = "Abaqus and CalculiX input deck", .extensions = {".inp"}};
  return self;
}

}  // namespace selvage::formats::inp
