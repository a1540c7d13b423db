#include "formats/registry.h"

#include "formats/knitout/header.h"
#include "formats/knitout/reader.h"
#include "formats/knitout/writer.h"

namespace selvage::formats::knitout {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "knitout",
                                  .title = "knitout 2, programs of knitting machines",
                                  .extensions = {".knitout"},
                                  .sniff = is_knitout,
                                  .read_fabric = read_fabric,
                                  .write_fabric = write_fabric,
                                  .carries_surfaces = false};
  return self;
}

}  // namespace selvage::formats::knitout
