#include "knit/warpknit_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage::fabric {

void YarnPoints::begin(long long course, const Overlap& overlap) {
  const Vec3 foot = foot_in(overlap);
  put_moved(course, overlap, {foot.x(), -m_.course_pitch, foot.z()}, moves_.of_beginning(bar_number_, 0));
  put_moved(course, overlap, {foot.x(), -0.5 * (m_.course_pitch - foot.y()), foot.z()},
            moves_.of_beginning(bar_number_, 1));
}

void YarnPoints::overlap(long long course, const Overlap& overlap, int hold) {
  placed_ = 0;
  const std::size_t first = points_.size();
  put_moved(course, overlap, foot_in(overlap), next_number(course));
  if (bar_.own != nullptr && !overlap.is_laid_in()) {
    for (std::size_t i = 1; i + 1 < bar_.own->points.size(); ++i)
      put_moved(course, overlap, own_point(bar_.own->points[i]), next_number(course));
  } else if (!overlap.is_laid_in()) {
    bar_.is_fall_plate ? low_arch(course, overlap) : loop(course, overlap, hold);
  }
  put_moved(course, overlap, foot_out(overlap), next_number(course));
  stitches_.push_back({first, points_.size() - 1});
}

void YarnPoints::underlap(long long course, const Overlap& before, const Overlap& after) {
  const Vec3 start = point(course, before, foot_out(before), Vec3::Zero()),
             end = point(course + 1, after, foot_in(after), Vec3::Zero());
  const double length = (end - start).norm(), reach = 1.5 * std::max(m_.across, m_.along);
  if (length < 3.0 * reach) return;
  const Vec3 step = (end - start) * (reach / length);
  for (const Vec3& place : {Vec3(start + step), Vec3(end - step)}) {
    moved_by_.push_back(next_number(course));
    points_.emplace_back(place + moves_[moved_by_.back()]);
  }
}

void YarnPoints::finish(long long course, const Overlap& overlap) {
  const Vec3 foot = foot_in(overlap);
  placed_ = 0;
  put_moved(course, overlap, foot, next_number(course));
  put_moved(course, overlap, {foot.x(), 0.5 * (m_.course_pitch + foot.y()), foot.z()},
            moves_.of_end(bar_number_, 0));
  put_moved(course, overlap, {foot.x(), m_.course_pitch, foot.z()}, moves_.of_end(bar_number_, 1));
}

std::vector<Vec3> YarnPoints::of_guide(std::size_t guide) const {
  std::vector<Vec3> points = points_;
  for (Vec3& point : points) point.x() = std::fma(static_cast<double>(guide), m_.wale_pitch, point.x());
  return points;
}

// The place (x, y) from the middle of a needle and the line of a course; x is mirrored where the overlap
// begins left of the needle.
Vec3 YarnPoints::point(long long course, const Overlap& overlap, const Vec3& local, const Vec3& move) const {
  const double middle = overlap.is_laid_in() ? overlap.from : overlap.needle() - 0.5;
  const double side = overlap.from < overlap.to ? -1.0 : 1.0;
  return {std::fma(middle, m_.wale_pitch, side * local.x() + move.x()),
          std::fma(static_cast<double>(course), m_.course_pitch, local.y() + move.y()), local.z() + move.z()};
}

void YarnPoints::put_moved(long long course, const Overlap& overlap, const Vec3& local, std::size_t number) {
  points_.push_back(point(course, overlap, local, moves_[number]));
  moved_by_.push_back(number);
}

void YarnPoints::put(long long course, const Overlap& overlap, double x, double y, double z) {
  put_moved(course, overlap, {x, y, z}, next_number(course));
}

Vec3 YarnPoints::own_point(const Vec3& p) const {
  return {p.x() * m_.wale_pitch, p.y() * m_.course_pitch, p.z() * m_.thickest};
}

Vec3 YarnPoints::foot_in(const Overlap& overlap) const {
  if (bar_.own != nullptr && !overlap.is_laid_in()) return own_point(bar_.own->points.front());
  return {foot_x(overlap), -m_.reach_y(bar_), m_.underlap_z(bar_)};
}

Vec3 YarnPoints::foot_out(const Overlap& overlap) const {
  if (bar_.own != nullptr && !overlap.is_laid_in()) return own_point(bar_.own->points.back());
  return {-foot_x(overlap), m_.foot_y(bar_), m_.underlap_z(bar_)};
}

// The same points up one side of the needle, over `top`, and down the other side.
void YarnPoints::arch(long long course, const Overlap& overlap, const std::vector<Vec3>& flank,
                      const Vec3& top) {
  for (const Vec3& p : flank) put(course, overlap, p.x(), p.y(), p.z());
  put(course, overlap, top.x(), top.y(), top.z());
  for (auto p = flank.rbegin(); p != flank.rend(); ++p) put(course, overlap, -p->x(), p->y(), p->z());
}

// Leg, head and leg of a loop whose head is drawn through by the loop `hold` courses above.
void YarnPoints::loop(long long course, const Overlap& overlap, int hold) {
  const double foot = m_.foot_x(bar_), wide = m_.leg_x(), rise = m_.head_y();
  const double face = m_.leg_z(bar_), head = m_.head_z(bar_), next = hold * m_.course_pitch;
  std::vector<Vec3> flank;
  // Straight up through the layers that are stitched.
  if (m_.substrate > 0.0)
    for (const double share : {0.65, 0.15})
      flank.emplace_back(foot, m_.foot_y(bar_), -share * (m_.layer + m_.substrate));
  // Out of the way of the underlaps of the bars behind before these come past.
  if (bar_.bars_behind > 0) flank.emplace_back(foot, m_.foot_y(bar_) + 0.4 * m_.along, -0.1 * m_.layer);
  flank.emplace_back(foot, rise - 0.25 * m_.along, face);  // through the loop below: in front of its head
  flank.emplace_back(wide, next, 0.5 * (face + head));     // beside the feet of the next loop
  flank.emplace_back(0.75 * wide, next + 0.7 * rise, head);
  arch(course, overlap, flank, {0.0, next + rise, head});
}

// Up before the underlaps of the bars behind that come, round their feet, and behind them down again.
void YarnPoints::low_arch(long long course, const Overlap& overlap) {
  const double foot = m_.foot_x(bar_), flank = m_.deepest_foot, z = m_.arch_z();
  put(course, overlap, foot, -flank, z);
  put(course, overlap, foot, flank, z);
  put(course, overlap, 0.0, m_.arch_y(bar_), z);
  put(course, overlap, -foot, flank, 1.3 * z);
}

int hold_after(const std::vector<Bar>& bars, long long course) {
  for (int hold = 1; hold <= longest_hold; ++hold)
    for (const Bar& bar : bars)
      if (!bar.is_fall_plate && !overlap_at(bar.lapping, course + hold).is_laid_in()) return hold;
  return 0;
}

Result<YarnPoints> points_of_bar(const std::vector<Bar>& bars, std::size_t bar, const Measures& measures,
                                 const LoopMoves& moves, long long first, long long last) {
  const Lapping& lapping = bars[bar].lapping;
  YarnPoints points(bars[bar], bar, measures, moves);
  points.begin(first, overlap_at(lapping, first));
  for (long long course = first; course < last; ++course) {
    const Overlap &overlap = overlap_at(lapping, course), &next = overlap_at(lapping, course + 1);
    const int hold = hold_after(bars, course);
    if (hold == 0)
      return error(Kind::geometry,
                   fmt::format("no bar knits in the {} courses after course {}: the loops would be held "
                               "for longer than any yarn bears",
                               longest_hold, course + 1));
    points.overlap(course, overlap, hold);
    points.underlap(course, overlap, next);
  }
  points.finish(last, overlap_at(lapping, last));
  return points;
}

}  // namespace selvage::fabric
