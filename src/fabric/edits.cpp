#include "fabric/edits.h"

namespace selvage::fabric {

Status apply_edits(const Fabric& fabric, std::string_view yarn, yarn::CentreLine&) {
  for (const Edit& edit : fabric.edits) {
    if (edit.yarn != yarn) continue;
    Message message = error(Kind::unsupported, "`edit` is not supported yet");
    message.place = edit.place;
    return message;
  }
  return {};
}

}  // namespace selvage::fabric
