#include "formats/iges/iges.h"

namespace selvage::formats::iges {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "iges", .title = "IGES 5.3, B-spline surfaces or solids", .extensions = {".igs"}};
  return self;
}

}  // namespace selvage::formats::iges
