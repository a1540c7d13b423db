#include "formats/registry.h"
#include "formats/tg3/reader.h"

namespace selvage::formats::tg3 {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "tg3",
                                  .title = "TexGen 3 models: yarns by nodes and sections",
                                  .extensions = {".tg3"},
                                  .sniff = is_tg3,
                                  .read_fabric = read_fabric,
                                  .read_within = read_within};
  return self;
}

}  // namespace selvage::formats::tg3
