#include "fabric/warpknit.h"

namespace selvage::fabric {

Result<std::unique_ptr<Construction>> make_warpknit(const Fabric&, const Warpknit& warpknit, Diagnostics&) {
  Message message = error(Kind::unsupported, "`warpknit` is not supported yet");
  message.place = warpknit.place;
  return message;
}

}  // namespace selvage::fabric
