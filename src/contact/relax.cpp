#include "contact/relax.h"

namespace selvage::contact {

Result<Relaxation> relax(std::vector<yarn::Body> /*bodies*/, const RelaxOptions& /*options*/) {
  return error(Kind::unsupported, "yarns are not moved apart yet");
}

}  // namespace selvage::contact
