#include "solid/check.h"

#include <algorithm>

#include "core/module.h"

namespace selvage::solid {

Result<SolidCheck> check_solids(std::span<const yarn::Body> bodies, const CheckOptions& options) {
  if (!options.overlaps) return call(cgal_module(), &CgalModule::check, bodies, options);
  // One step a yarn for its own check, and one for its share of the contacts.
  const std::size_t count = bodies.size();
  std::size_t done = 0;
  const auto step_to = [&](std::size_t step) {
    while (done < step) {
      ++done;
      if (options.progress) options.progress(done, 2 * count);
    }
  };
  CheckOptions each = options;
  each.progress = [&](std::size_t step, std::size_t /*total*/) { step_to(step); };
  Result<SolidCheck> result = call(cgal_module(), &CgalModule::check, bodies, each);
  if (!result) return result;
  contact::ContactOptions contact_options;
  contact_options.threads = options.threads;
  contact_options.reach = options.reach;
  contact_options.progress = [&](std::size_t place, std::size_t places) {
    step_to(count + count * place / places);
  };
  Result<contact::Contacts> contacts = contact::find_contacts(bodies, contact_options);
  step_to(2 * count);
  // What cannot be looked at is a defect of its yarn already.
  if (!contacts && std::any_of(result->yarns.begin(), result->yarns.end(),
                               [](const YarnCheck& yarn) { return !yarn.defects.empty(); }))
    return result;
  if (!contacts) return contacts.error();
  for (contact::Contact& c : contacts->list)
    (c.is_overlap() ? result->overlaps : result->near_contacts).push_back(std::move(c));
  result->min_gap = contacts->min_gap;
  return result;
}

}  // namespace selvage::solid
