#include "formats/msh/msh.h"

namespace selvage::formats::msh {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "msh", .title = "Gmsh mesh 4.1", .extensions = {".msh"}};
  return self;
}

}  // namespace selvage::formats::msh
