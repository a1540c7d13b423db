#include "pipeline/overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text_report.h"
#include "pipeline/facts.h"

namespace selvage::pipeline {

Message overlap_message(const contact::Contact& overlap, std::span<const yarn::Body> bodies, Unit units) {
  const std::string depth = fmt::format("{:.4g} {}", overlap.depth(), name_of(units));
  const std::string a = in_quotes(bodies[overlap.a].name), b = in_quotes(bodies[overlap.b].name);
  // Rounding is no coordinate: 1e-15 would read like a place.
  const auto clean = [&](double x) { return std::abs(x) < 1e-6 * overlap.depth() ? 0.0 : x; };
  return error(Kind::geometry,
               overlap.a == overlap.b ? fmt::format("yarn {} meets itself and overlaps, {} deep", a, depth)
                                      : fmt::format("yarns {} and {} overlap, {} deep", a, b, depth),
               {.at = overlap.at.unaryExpr(clean)});
}

void report_check(Job& job, const solid::SolidCheck& check, std::span<const yarn::Body> bodies) {
  if (!job.wants_report()) return;
  const double mm = millimetres_per(job.file_units());
  Json& yarns = job.report["yarns"];
  std::optional<double> thinnest, min_gap = check.min_gap;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i < yarns.size()) {
      yarns[i]["closed"] = check.yarns[i].is_shut();
      yarns[i]["self_overlap"] = check.yarns[i].self_intersecting || !bodies[i].tight_bends.empty();
    }
    const double thickness = yarn::narrowest_section(bodies[i]) * mm;
    thinnest = std::min(thinnest.value_or(thickness), thickness);
  }
  for (const contact::Contact& overlap : check.overlaps)
    if (overlap.a == overlap.b && overlap.a < yarns.size()) yarns[overlap.a]["self_overlap"] = true;
  const auto site = [](const std::optional<Vec2>& uv) { return uv ? point_json(*uv) : Json(); };
  const auto contact_json = [&](const contact::Contact& contact) {
    const double area = contact.area * mm * mm;
    return Json{{"a", bodies[contact.a].name},
                {"b", bodies[contact.b].name},
                {contact.is_overlap() ? "depth" : "gap", std::abs(contact.gap) * mm},
                {"at", point_json(contact.at * mm)},
                {"direction", if_true(contact.is_overlap(), point_json(contact.direction))},
                {"area", if_true(area > 0, area)},
                {"site_a", site(contact.site_a)},
                {"site_b", site(contact.site_b)}};
  };
  job.report["overlaps"] = list_json(check.overlaps, contact_json);
  if (job.options.reach > 0.0) job.report["contacts"] = list_json(check.near_contacts, contact_json);
  if (min_gap) *min_gap *= mm;
  job.report["min_gap"] = if_known(min_gap);
  job.report["creo_absolute_accuracy"] = if_known(creo_accuracy(thinnest, min_gap));
}

std::optional<solid::SolidCheck> check_of(Job& job, std::span<const yarn::Body> bodies) {
  solid::CheckOptions options;
  options.threads = static_cast<int>(job.threads);
  options.reach = job.options.reach;
  options.progress = job.progress_of("checking yarn");
  Result<solid::SolidCheck> check = solid::check_solids(bodies, options);
  if (check) return std::move(*check);
  return job.fail(check.error());
}

bool check_overlaps(Job& job, std::span<const yarn::Body> bodies,
                    const std::function<void(Message&)>& finish) {
  const std::optional<solid::SolidCheck> check = check_of(job, bodies);
  if (!check) return false;
  report_check(job, *check, bodies);
  for (const solid::YarnCheck& yarn : check->yarns) job.say_all(yarn.defects);
  for (const contact::Contact& overlap : check->overlaps) {
    Message message = overlap_message(overlap, bodies, job.file_units());
    finish(message);
    job.say(std::move(message), overlap.depth());
  }
  return !job.has_failed();
}

}  // namespace selvage::pipeline
