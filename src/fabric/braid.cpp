#include "fabric/braid.h"

namespace selvage::fabric {

Result<std::unique_ptr<Construction>> make_braid(const Fabric&, const Braid& braid, Diagnostics&) {
  Message message = error(Kind::unsupported, "`braid` is not supported yet");
  message.place = braid.place;
  return message;
}

}  // namespace selvage::fabric
