#include "fabric/warpknit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fabric/lapping.h"
#include "fabric/yarn_spec.h"
#include "yarn/outline.h"

namespace selvage::fabric {

namespace {

// A loop is held while its needle waits for the next one; a machine breaks the yarn sooner.
constexpr int longest_hold = 8;
// Courses by which yarns are continued on each side of a fabric with a unit cell.
constexpr int continued_courses = 2;
// Most data points of a course: a loop of eleven, an underlap of two.
constexpr std::uint64_t points_of_a_course = 13;

// How much further the foot before a loop reaches down than the one after it, in yarns lying across.
constexpr double low_foot = 0.4;

struct Bar {
  Lapping lapping;
  const Thread* thread = nullptr;
  bool is_fall_plate = false;
  TextPlace place;
  bool has_feet = false;                 // wraps needles in some course
  int bars_behind = 0;                   // of all bars
  int feet_before = 0, feet_behind = 0;  // bars with feet before and behind this one
};

bool wraps(const Lapping& lapping) {
  return std::any_of(lapping.begin(), lapping.end(), [](const Overlap& o) { return !o.is_laid_in(); });
}

// The dimensions of the loops, file units. They grow with the pitches, so that the smallest pitches are those
// at which neighbours touch: x in units of a foot's width, y in units of a yarn lying across, z in layers of
// one yarn.
struct Measures {
  double wale_pitch = 0, course_pitch = 0;
  double across = 0, along = 0, layer = 0;
  int bars_with_feet = 0;
  int fall_plates = 0;
  double deepest_foot = 0;  // below and above a course's line

  [[nodiscard]] double foot_x(const Bar& bar) const { return (0.5 + bar.feet_behind) * across; }
  [[nodiscard]] double leg_x() const { return (0.5 + bars_with_feet) * across; }
  // Underlaps reach a course's line from below, at -reach_y, and leave it at foot_y.
  [[nodiscard]] double reach_y(const Bar& bar) const {
    // A fall-plate bar's below all feet that its arch takes in; a loop's out of the way of its own underlap.
    return bar.is_fall_plate ? deepest_foot + along : foot_y(bar) + low_foot * along;
  }
  [[nodiscard]] double foot_y(const Bar& bar) const { return (0.5 + bar.feet_before) * along; }
  [[nodiscard]] double head_y() const { return deepest_foot + (2.0 + fall_plates) * along; }
  [[nodiscard]] double arch_y(const Bar& bar) const { return deepest_foot + (1.2 + bar.feet_before) * along; }
  [[nodiscard]] double underlap_z(const Bar& bar) const {
    return -(1.0 + (fall_plates > 0 ? 1.0 : 0.0) + bar.bars_behind) * layer;
  }
  [[nodiscard]] double arch_z() const { return -layer; }
  [[nodiscard]] double head_z(const Bar& bar) const { return bar.feet_behind * layer; }
  [[nodiscard]] double leg_z(const Bar& bar) const { return (bars_with_feet + bar.feet_behind) * layer; }
};

double thickness_of(const yarn::Section& section) {
  const yarn::SectionSize size = yarn::nominal_size(section);
  return std::max(size.width, size.height);
}

class WarpknitConstruction final : public Construction {
 public:
  WarpknitConstruction(const Fabric& fabric, const Warpknit& warpknit, std::vector<Bar> bars,
                       const Measures& measures)
      : fabric_(fabric), warpknit_(warpknit), bars_(std::move(bars)), measures_(measures) {
    if (fabric.cell) {
      first_course_ = -continued_courses;
      last_course_ += continued_courses;
    }
    last_course_ += warpknit.courses;
  }

  [[nodiscard]] std::size_t count() const override {
    return bars_.size() * static_cast<std::size_t>(warpknit_.wales);
  }
  [[nodiscard]] std::string name(std::size_t index) const override {
    return fmt::format("bar{}_{}", bar_of(index) + 1, guide_of(index) + 1);
  }
  [[nodiscard]] const Thread& thread(std::size_t index) const override {
    return *bars_[bar_of(index)].thread;
  }
  [[nodiscard]] std::uint64_t data_points() const override {
    const std::uint64_t a_yarn = longest();
    const auto yarns = static_cast<std::uint64_t>(count());
    constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
    return yarns > most / a_yarn ? most : yarns * a_yarn;
  }
  [[nodiscard]] std::uint64_t longest() const override {
    return points_of_a_course * static_cast<std::uint64_t>(last_course_ - first_course_) + 6;
  }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;

 private:
  [[nodiscard]] std::size_t bar_of(std::size_t index) const {
    return index / static_cast<std::size_t>(warpknit_.wales);
  }
  [[nodiscard]] std::size_t guide_of(std::size_t index) const {
    return index % static_cast<std::size_t>(warpknit_.wales);
  }
  // Courses until the needles get their next loops; 0: longer than a loop is held.
  [[nodiscard]] int hold_after(long long course) const;

  const Fabric& fabric_;
  const Warpknit& warpknit_;
  std::vector<Bar> bars_;  // at least one, front bar first
  Measures measures_;
  long long first_course_ = 0, last_course_ = 0;  // from 0; the last one is the first that is not knitted
};

// The data points of one yarn, course by course: those of the bar's first guide, moved.
class YarnPoints {
 public:
  YarnPoints(const Bar& bar, const Measures& measures) : bar_(bar), m_(measures) {}

  // From below the first course straight to its foot.
  void begin(long long course, const Overlap& overlap) {
    const double x = foot_x(overlap), z = m_.underlap_z(bar_), foot = m_.reach_y(bar_);
    put(course, overlap, x, -m_.course_pitch, z);
    put(course, overlap, x, -0.5 * (m_.course_pitch + foot), z);
  }

  // From the foot that an underlap has reached, or past the needle, to the foot from which the next begins.
  void overlap(long long course, const Overlap& overlap, int hold) {
    const double x = foot_x(overlap), foot = m_.foot_y(bar_), back = m_.underlap_z(bar_);
    points_.push_back(foot_of(course, overlap));
    if (!overlap.is_laid_in()) bar_.is_fall_plate ? low_arch(course, overlap) : loop(course, overlap, hold);
    put(course, overlap, -x, foot, back);
  }

  // Two points within a long underlap: near its ends it is a straight line already.
  void underlap(long long course, const Overlap& after) {
    const Vec3 start = points_.back(), end = foot_of(course + 1, after);
    const double length = (end - start).norm(), reach = 1.5 * std::max(m_.across, m_.along);
    if (length < 3.0 * reach) return;
    const Vec3 step = (end - start) * (reach / length);
    points_.emplace_back(start + step);
    points_.emplace_back(end - step);
  }

  // The foot of the course after the last, and straight up from it.
  void finish(long long course, const Overlap& overlap) {
    const double x = foot_x(overlap), z = m_.underlap_z(bar_), foot = m_.reach_y(bar_);
    points_.push_back(foot_of(course, overlap));
    put(course, overlap, x, 0.5 * (m_.course_pitch - foot), z);
    put(course, overlap, x, m_.course_pitch, z);
  }

  std::vector<Vec3> of_guide(std::size_t guide) && {
    for (Vec3& point : points_) point.x() = std::fma(static_cast<double>(guide), m_.wale_pitch, point.x());
    return std::move(points_);
  }

 private:
  // The point (x, y) from the middle of a needle and the line of a course; x is mirrored where the overlap
  // begins left of the needle.
  [[nodiscard]] Vec3 point(long long course, const Overlap& overlap, double x, double y, double z) const {
    const double middle = overlap.is_laid_in() ? overlap.from : overlap.needle() - 0.5;
    const double side = overlap.from < overlap.to ? -1.0 : 1.0;
    return {std::fma(middle, m_.wale_pitch, side * x),
            std::fma(static_cast<double>(course), m_.course_pitch, y), z};
  }
  void put(long long course, const Overlap& overlap, double x, double y, double z) {
    points_.push_back(point(course, overlap, x, y, z));
  }
  [[nodiscard]] Vec3 foot_of(long long course, const Overlap& overlap) const {
    return point(course, overlap, foot_x(overlap), -m_.reach_y(bar_), m_.underlap_z(bar_));
  }
  [[nodiscard]] double foot_x(const Overlap& overlap) const {
    return overlap.is_laid_in() ? 0.0 : m_.foot_x(bar_);
  }

  // The same points up one side of the needle, over `top`, and down the other side.
  void arch(long long course, const Overlap& overlap, const std::vector<Vec3>& flank, const Vec3& top) {
    for (const Vec3& p : flank) put(course, overlap, p.x(), p.y(), p.z());
    put(course, overlap, top.x(), top.y(), top.z());
    for (auto p = flank.rbegin(); p != flank.rend(); ++p) put(course, overlap, -p->x(), p->y(), p->z());
  }

  // Leg, head and leg of a loop whose head is drawn through by the loop `hold` courses above.
  void loop(long long course, const Overlap& overlap, int hold) {
    const double foot = m_.foot_x(bar_), wide = m_.leg_x(), rise = m_.head_y();
    const double face = m_.leg_z(bar_), head = m_.head_z(bar_), next = hold * m_.course_pitch;
    std::vector<Vec3> flank;
    // Out of the way of the underlaps of the bars behind before these come past.
    if (bar_.bars_behind > 0) flank.emplace_back(foot, m_.foot_y(bar_) + 0.4 * m_.along, -0.1 * m_.layer);
    flank.emplace_back(foot, rise - 0.25 * m_.along, face);  // through the loop below: in front of its head
    flank.emplace_back(wide, next, 0.5 * (face + head));     // beside the feet of the next loop
    flank.emplace_back(0.75 * wide, next + 0.7 * rise, head);
    arch(course, overlap, flank, {0.0, next + rise, head});
  }

  // Up before the underlaps of the bars behind that come, round their feet, and behind them down again.
  void low_arch(long long course, const Overlap& overlap) {
    const double foot = m_.foot_x(bar_), flank = m_.deepest_foot, z = m_.arch_z();
    put(course, overlap, foot, -flank, z);
    put(course, overlap, foot, flank, z);
    put(course, overlap, 0.0, m_.arch_y(bar_), z);
    put(course, overlap, -foot, flank, 1.3 * z);
  }

  const Bar& bar_;
  const Measures& m_;
  std::vector<Vec3> points_;
};

int WarpknitConstruction::hold_after(long long course) const {
  for (int hold = 1; hold <= longest_hold; ++hold)
    for (const Bar& bar : bars_)
      if (!bar.is_fall_plate && !overlap_at(bar.lapping, course + hold).is_laid_in()) return hold;
  return 0;
}

Result<YarnPlan> WarpknitConstruction::plan(std::size_t index) const {
  const Bar& bar = bars_[bar_of(index)];
  Result<YarnPlan> plan = start_plan(fabric_, *bar.thread, name(index), Role::wale, bar.place);
  if (!plan) return plan;
  YarnPoints points(bar, measures_);
  points.begin(first_course_, overlap_at(bar.lapping, first_course_));
  for (long long course = first_course_; course < last_course_; ++course) {
    const Overlap &overlap = overlap_at(bar.lapping, course), &next = overlap_at(bar.lapping, course + 1);
    const int hold = hold_after(course);
    if (hold == 0)
      return error(Kind::geometry,
                   fmt::format("no bar knits in the {} courses after course {}: the loops would be held "
                               "for longer than any yarn bears",
                               longest_hold, course + 1));
    points.overlap(course, overlap, hold);
    points.underlap(course, next);
  }
  points.finish(last_course_, overlap_at(bar.lapping, last_course_));
  plan->points = std::move(points).of_guide(guide_of(index));
  if (Status made = interpolate(*plan, yarn::PathForm::loop, Vec3::UnitY(), Vec3::UnitY()); !made)
    return made.error();
  // Legs of loops run along the cloth's normal in places, where it says nothing about their sections.
  plan->spec.guide =
      bar.has_feet ? yarn::FrameGuide::free_from(Vec3::UnitZ()) : yarn::FrameGuide::with_up(Vec3::UnitZ());
  return plan;
}

Message at(Message message, TextPlace place) {
  if (message.place.line == 0) message.place = place;
  return message;
}

Status check_overlaps(const WarpknitBar& bar, const Lapping& lapping) {
  for (std::size_t i = 0; i < lapping.size(); ++i) {
    const Overlap& o = lapping[i];
    if (std::abs(o.from - o.to) <= 1) continue;
    return at(error(Kind::unsupported,
                    fmt::format(
                        "overlap {} of this lapping, {}-{}, goes over {} needles at once; a guide wraps one "
                        "needle a course, between neighbouring spaces",
                        i + 1, o.from, o.to, std::abs(o.from - o.to))),
              bar.lapping_place);
  }
  return {};
}

Result<std::vector<Bar>> read_bars(const Fabric& fabric, const Warpknit& warpknit) {
  std::vector<WarpknitBar> texts = warpknit.bars;
  if (!warpknit.classic.empty())
    for (const std::string_view lapping :
         classic_lappings(warpknit.classic, warpknit.stitch.value_or(Warpknit::Stitch::closed)))
      texts.push_back({warpknit.thread, warpknit.place, std::string(lapping), {}, false});
  if (texts.empty()) return at(error(Kind::geometry, "this warp knit has no bars"), warpknit.place);
  std::vector<Bar> bars;
  for (const WarpknitBar& text : texts) {
    Bar bar;
    Result<Lapping> lapping = parse_lapping(text.lapping, text.lapping_place);
    if (!lapping) return at(lapping.error(), text.place);
    if (Status checked = check_overlaps(text, *lapping); !checked) return at(checked.error(), text.place);
    bar.lapping = std::move(*lapping);
    bar.thread = fabric.find_thread(text.thread);
    if (bar.thread == nullptr)
      return at(error(Kind::geometry, fmt::format("there is no thread '{}'", text.thread)), text.place);
    bar.is_fall_plate = text.fall_plate;
    bar.place = text.place;
    bar.has_feet = wraps(bar.lapping);
    bars.push_back(std::move(bar));
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    bars[i].bars_behind = static_cast<int>(bars.size() - 1 - i);
    for (std::size_t k = 0; k < bars.size(); ++k)
      if (bars[k].has_feet && k != i) ++(k < i ? bars[i].feet_before : bars[i].feet_behind);
  }
  return bars;
}

Result<Measures> measure(const Fabric& fabric, const Warpknit& warpknit, const std::vector<Bar>& bars) {
  Measures m;
  double thickest = 0.0;
  int most_feet_before = 0;
  bool knits = false;
  for (const Bar& bar : bars) {
    const Result<yarn::Section> section = section_of(*bar.thread, fabric.units, false);
    if (!section) return section.error();
    thickest = std::max(thickest, thickness_of(*section));
    m.bars_with_feet += bar.has_feet ? 1 : 0;
    m.fall_plates += bar.has_feet && bar.is_fall_plate ? 1 : 0;
    most_feet_before = std::max(most_feet_before, bar.feet_before);
    knits = knits || (bar.has_feet && !bar.is_fall_plate);
  }
  if (!knits)
    return error(Kind::geometry,
                 "no bar of this warp knit forms loops: at least one needs overlaps, such as 1-0/1-2, "
                 "that are not pushed down");
  // Side by side on one needle: two feet a bar, the two legs of the loop below, half a space to each side.
  const double across = 2.0 * m.bars_with_feet + 2.0;
  // One above the other within a course: feet from the lowest to the highest, arches, heads, the next feet.
  const double along = 2.0 * most_feet_before + 4.0 + low_foot + 2.0 * m.fall_plates;
  const auto too_small = [&](std::string_view what, double pitch, double yarns) {
    return error(Kind::geometry,
                 fmt::format("the {} pitch {} is too small for yarns of {:.4g}: the loops of {} bars "
                             "need at least {:.6g}",
                             what, pitch, thickest, m.bars_with_feet, yarns * thickest));
  };
  if (!(warpknit.wale_pitch >= across * thickest)) return too_small("wale", warpknit.wale_pitch, across);
  if (!(warpknit.course_pitch >= along * thickest)) return too_small("course", warpknit.course_pitch, along);
  m.wale_pitch = warpknit.wale_pitch;
  m.course_pitch = warpknit.course_pitch;
  m.across = warpknit.wale_pitch / across;
  m.along = warpknit.course_pitch / along;
  m.layer = 1.12 * thickest;  // the loop path misses its points by a few per cent of a yarn
  m.deepest_foot = (0.5 + most_feet_before) * m.along;
  return m;
}

}  // namespace

Result<std::unique_ptr<Construction>> make_warpknit(const Fabric& fabric, const Warpknit& warpknit,
                                                    Diagnostics&) {
  if (warpknit.wales < 1 || warpknit.courses < 1)
    return at(error(Kind::geometry, "a warp knit needs at least one wale and one course"), warpknit.place);
  Result<std::vector<Bar>> bars = read_bars(fabric, warpknit);
  if (!bars) return bars.error();
  const Result<Measures> measures = measure(fabric, warpknit, *bars);
  if (!measures) return at(measures.error(), warpknit.place);
  return std::unique_ptr<Construction>(
      std::make_unique<WarpknitConstruction>(fabric, warpknit, std::move(*bars), *measures));
}

}  // namespace selvage::fabric
