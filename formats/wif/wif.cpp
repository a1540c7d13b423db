#include "formats/registry.h"

#include "formats/wif/ini.h"
#include "formats/wif/reader.h"

namespace selvage::formats::wif {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "wif",
                                  .title = "WIF 1.1, drafts of weaving programs",
                                  .extensions = {".wif"},
                                  .sniff = has_wif_section,
                                  .read_fabric = read_fabric};
  return self;
}

}  // namespace selvage::formats::wif
