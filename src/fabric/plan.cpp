#include "fabric/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fabric/yarn_spec.h"

namespace selvage::fabric {

void tell_from_origin(YarnPlan& plan) {
  for (Vec3& p : plan.points) p += plan.at;
  for (Vec3& p : plan.line.curve.points) p += plan.at;
  plan.at = Vec3::Zero();
}

std::uint64_t sum_of(std::uint64_t a, std::uint64_t b) {
  constexpr auto most = std::numeric_limits<std::uint64_t>::max();
  return a > most - b ? most : a + b;
}

std::uint64_t product_of(std::uint64_t a, std::uint64_t b) {
  constexpr auto most = std::numeric_limits<std::uint64_t>::max();
  return b != 0 && a > most / b ? most : a * b;
}

Work& Work::operator+=(const Work& more) {
  yarns = sum_of(yarns, more.yarns);
  points = sum_of(points, more.points);
  longest = std::max(longest, more.longest);
  return *this;
}

Work in_parts(const Work& work, std::uint64_t parts) {
  return {product_of(work.yarns, parts), product_of(work.points, parts), work.longest};
}

Status check_work(const Work& work, const WorkLimits& limits) {
  // What a data point of a jersey costs at the default tolerance: some 52 control points, 3 kB of IGES.
  constexpr double gigabytes_a_point = 3e-6;
  const std::uint64_t points = std::max(work.points, product_of(work.yarns, least_points_of_a_yarn));
  if (points > limits.points)
    return error(
        Kind::limit,
        fmt::format("this would be {} yarn{} through {:.3g} data points, about {:.2g} GB of IGES; "
                    "one fabric may have {:.3g} data points: build it in parts, and yarns of plies "
                    "or filaments plain with `--detail yarn`",
                    work.yarns, work.yarns == 1 ? "" : "s", static_cast<double>(points),
                    gigabytes_a_point * static_cast<double>(points), static_cast<double>(limits.points)));
  if (work.longest > limits.longest)
    return error(Kind::limit,
                 fmt::format("one of its yarns would have {:.3g} data points, more than the {} that one yarn "
                             "may have: build it in parts",
                             static_cast<double>(work.longest), limits.longest));
  return {};
}

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

Status hold_up(YarnPlan& plan, const std::vector<Vec3>& ups) {
  plan.spec.guide = yarn::FrameGuide::free_from(ups.front());
  const yarn::SectionSize size = plan.spec.sizes.front().size;
  if (std::holds_alternative<yarn::Circle>(plan.spec.section)) return {};
  const Result<yarn::FrameField> frames = yarn::FrameField::make(plan.line.curve, plan.spec.guide, false);
  if (!frames) return frames.error();
  plan.spec.sizes.clear();
  double angle = 0.0;
  for (std::size_t i = 0; i < ups.size(); ++i) {
    const yarn::Frame frame = frames->at(plan.line.parameters[i]);
    const double turned = std::atan2(-ups[i].dot(frame.across), ups[i].dot(frame.up));
    angle = turned + 2.0 * std::numbers::pi * std::round((angle - turned) / (2.0 * std::numbers::pi));
    plan.spec.sizes.push_back({plan.line.parameters[i], size, angle});
  }
  return {};
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
