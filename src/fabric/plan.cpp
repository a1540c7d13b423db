#include "fabric/plan.h"

#include "fabric/yarn_spec.h"

namespace selvage::fabric {

Result<YarnPlan> start_plan(const Fabric& fabric, const Thread& thread, std::string name, Role role,
                            TextPlace place) {
  YarnPlan plan;
  plan.name = std::move(name);
  plan.role = role;
  plan.place = place;
  plan.thread_name = thread.name;
  plan.thread = thread;
  Result<yarn::Section> section = centred_section_of(thread, fabric.units);
  if (!section) return section.error();
  plan.spec.section = *section;
  plan.spec.sizes = {{0.0, yarn::nominal_size(*section), 0.0}};
  plan.spec.twist = section_twist(thread, fabric.units);
  return plan;
}

Status interpolate(YarnPlan& plan, yarn::PathForm form, const Vec3& tangent_start, const Vec3& tangent_end) {
  yarn::PathRows rows;
  rows.form = form;
  rows.points = plan.points;
  rows.tangent_start = tangent_start;
  rows.tangent_end = tangent_end;
  Result<yarn::CentreLine> line = yarn::make_centre_line(rows);
  if (!line) {
    Message message = line.error();
    message.place = plan.place;  // rows of a construction have no line of their own
    return message;
  }
  plan.line = std::move(*line);
  return {};
}

}  // namespace selvage::fabric
