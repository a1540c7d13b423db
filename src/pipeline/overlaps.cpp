#include "pipeline/overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text_report.h"
#include "pipeline/facts.h"

namespace selvage::pipeline {

Message overlap_message(const solid::Overlap& overlap, std::span<const yarn::Body> bodies, Unit units) {
  const std::string depth = fmt::format("{:.4g} {}", overlap.depth, name_of(units));
  const std::string a = in_quotes(bodies[overlap.a].name), b = in_quotes(bodies[overlap.b].name);
  Message message =
      error(Kind::geometry, overlap.a == overlap.b
                                ? fmt::format("yarn {} meets itself and overlaps, {} deep", a, depth)
                                : fmt::format("yarns {} and {} overlap, {} deep", a, b, depth));
  // Rounding is no coordinate: 1e-15 would read like a place.
  message.at = overlap.at.unaryExpr([&](double x) { return std::abs(x) < 1e-6 * overlap.depth ? 0.0 : x; });
  return message;
}

void report_check(Job& job, const solid::SolidCheck& check, std::span<const yarn::Body> bodies) {
  if (!job.wants_report()) return;
  const double mm = millimetres_per(job.file_units());
  InputReport& report = job.report;
  for (std::size_t i = 0; i < check.yarns.size() && i < report.yarns.size(); ++i) {
    report.yarns[i].closed = check.yarns[i].is_shut();
    report.yarns[i].self_overlap = check.yarns[i].self_intersecting || !bodies[i].tight_bends.empty();
  }
  report.overlaps.emplace();
  for (const solid::Overlap& overlap : check.overlaps)
    report.overlaps->push_back({bodies[overlap.a].name, bodies[overlap.b].name, overlap.depth * mm,
                                overlap.at * mm, overlap.direction, overlap.area * mm * mm, overlap.site_a,
                                overlap.site_b});
  if (job.options.reach > 0.0) {
    report.contacts.emplace();
    for (const solid::NearContact& contact : check.near_contacts)
      report.contacts->push_back({bodies[contact.a].name, bodies[contact.b].name, contact.gap * mm,
                                  contact.at * mm, contact.site_a, contact.site_b});
  }
  for (const solid::Overlap& overlap : check.overlaps)
    if (overlap.a == overlap.b && overlap.a < report.yarns.size())
      report.yarns[overlap.a].self_overlap = true;
  std::optional<double> thinnest;
  for (const yarn::Body& body : bodies)
    thinnest = std::min(thinnest.value_or(thinnest_section(body) * mm), thinnest_section(body) * mm);
  if (check.min_gap) report.min_gap = *check.min_gap * mm;
  report.creo_absolute_accuracy = creo_accuracy(thinnest, report.min_gap);
}

bool check_overlaps(Job& job, std::span<const yarn::Body> bodies,
                    const std::function<void(Message&)>& finish) {
  solid::CheckOptions options;
  options.threads = static_cast<int>(job.threads);
  options.progress = [&job](std::size_t done, std::size_t total) {
    job.progress("checking yarn", done, total);
  };
  Result<solid::SolidCheck> check = solid::check_solids(bodies, options);
  if (!check) {
    job.say(check.error());
    return false;
  }
  report_check(job, *check, bodies);
  for (const solid::YarnCheck& yarn : check->yarns) job.say_all(yarn.defects);
  for (const solid::Overlap& overlap : check->overlaps) {
    Message message = overlap_message(overlap, bodies, job.file_units());
    finish(message);
    job.say(std::move(message), overlap.depth);
  }
  return !job.has_failed();
}

}  // namespace selvage::pipeline
