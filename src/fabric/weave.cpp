#include "fabric/weave.h"

namespace selvage::fabric {

Result<std::unique_ptr<Construction>> make_weave(const Fabric&, const Weave& weave, Diagnostics&) {
  Message message = error(Kind::unsupported, "`weave` is not supported yet");
  message.place = weave.place;
  return message;
}

}  // namespace selvage::fabric
