#include "fabric/knit.h"

namespace selvage::fabric {

Result<std::unique_ptr<Construction>> make_knit(const Fabric&, const Knit& knit, Diagnostics&) {
  Message message = error(Kind::unsupported, "`knit` is not supported yet");
  message.place = knit.place;
  return message;
}

}  // namespace selvage::fabric
