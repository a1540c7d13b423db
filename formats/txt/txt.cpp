#include "formats/txt/txt.h"

namespace selvage::formats::txt {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "txt", .title = "Fabric TXT, the input language", .extensions = {".txt"}};
  return self;
}

}  // namespace selvage::formats::txt
