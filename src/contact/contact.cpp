#include "contact/contact.h"

namespace selvage::contact {

Result<Contacts> find_contacts(std::span<const yarn::Body> /*bodies*/, const ContactOptions& /*options*/) {
  return error(Kind::unsupported, "contacts on B-spline surfaces are not found yet");
}

}  // namespace selvage::contact
