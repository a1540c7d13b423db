#include "knit/loop.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "knit/journey.h"

namespace selvage::fabric {

namespace {

// All points are of the left half, x from the loop's middle, y from the course's lower crossings (or, where
// the name says `top`, from those of the course whose loop is drawn through this one), z for a knit loop.
using Point = std::array<double, 3>;

constexpr double depth = 1.5;  // of legs, sinkers and heads before or behind the middle plane
constexpr double sinker_y = -3;
constexpr double head_over_top = 3;
constexpr Point foot = {-1, 0, 0};
constexpr Point leg = {-2, 3.5, depth};
constexpr Point shoulder_top = {-3, 0, 0};
// Where own stitch and stitch above differ: the leg before it crosses the middle plane, and after.
constexpr Point lower_leg = {-1.15, 1.4, 0.8};
constexpr Point upper_leg_top = {-2.4, -1.15, -0.9};
// On the arm of a sinker that starts in the middle plane.
constexpr Point arm = {-2.35, -2.15, -1.3};

// Yarns that lie on one needle are stacked through the thickness.
constexpr double layer = 2;
// What a tuck under the new loop does to that loop's arms and sinkers, and to the loop that it lies behind.
constexpr Point arm_behind_tucks = {-1.55, -1.65, -1.3};
constexpr double sinker_back = 1.55;
constexpr double leg_forward = 1.25, shoulder_forward = 1.25, head_forward = -0.7;
constexpr Point tuck_leg = {-1, 2.45, 1};
constexpr Point tuck_shoulder_top = {-3.15, 0.2, -1.15};
constexpr double tuck_head_over_top = 3.5, tuck_head = -5;
constexpr double float_y = -2, float_z = -2.5;
// A loop that joins others on its needle goes behind them, from its feet before the plane.
constexpr double joining_leg = 0.4;
// How far loops that cross stand out of their layer, before the others or behind.
constexpr double before_others = 1.9, behind_others = -0.5;

// A point of a user's own loop, from the left side of its wale.
Vec3 own_point(const LoopShape& shape, const Vec3& p) {
  return {p.x() * shape.wale, p.y() * shape.course, 2 * p.z()};
}

const std::vector<Vec3>& own_points(const KnitField& field, long long course, long long wale) {
  const auto sign = static_cast<char>(field.chart.at(course, wale));
  return std::find_if(field.own->begin(), field.own->end(),
                      [&](const OwnLoop& loop) { return loop.sign == sign; })
      ->points;
}

// A point of the published loop where the shape has it: x from the loop's middle.
Vec3 shaped(const LoopShape& shape, const Point& p, double top) {
  // Foot and shoulder of the published loop are at 1 and 3, the leg's middle at 2, a sinker's at 4.
  const double across = std::abs(p[0]);
  const double out = across < 1 ? -across : across < 3 ? across - 2 : 4 - across;
  const double x = std::copysign(across + (shape.bulge - 1) * out, p[0]);
  const double beyond = std::min(p[1], 0.0) + std::max(p[1] - top, 0.0);
  return {x * (shape.wale / wale_spacing),
          (p[1] + (shape.overlap - 1) * beyond) * (shape.course / course_spacing), p[2] * shape.depth};
}

// A pile's loop, in half thicknesses: its limbs beside its middle, where they end below its top and behind
// the cloth's back, there so much of the sinkers' way below the line at which loops hold each other.
constexpr double pile_limb_x = 1.35, pile_top = 1.6, pile_foot = 0.2, pile_foot_y = 0.9;

// What one needle does in one course.
struct Needle {
  Stitch stitch = Stitch::knit;
  double side = 1;    // of its loops: 1 where they are knit, -1 where they are purl
  double middle = 0;  // z of the middle plane of its bed's loops; in half thicknesses
  int behind = 0;     // tucks on the needle behind which the yarn has to pass
};

// What becomes of the yarn that one course gives to a needle.
struct Hold {
  double right = 0;  // wales to the right, where it is when it is knitted off
  int lift = 0;      // 1: before the loops that it crosses on its way, seen from its own face, -1: behind
  int joins = 0;     // others of its needle lie before it so many layers
  double top = course_spacing;  // y of the lower crossings of the row that knits it off
  bool turns = false;           // the stitch that knits it off is of the other kind
  int tucks = 0;                // laid on the needle above the held loop until then
};

// Held for longer than a course, so that its legs take two points.
bool is_long(const Hold& hold) {
  return hold.top > 1.1 * course_spacing;
}

bool is_inside(const KnitField& field, long long course) {
  return course >= field.first_course && course <= field.last_course;
}

}  // namespace

RowExtent extent_of(const KnitField& field, long long course) {
  const Journeys* journeys = field.chart.journeys();
  if (journeys == nullptr) return {field.first_wale, field.last_wale};
  const WaleSpan& span = journeys->span(course);
  return {span.first, span.last};
}

long long held_course(const KnitField& field, long long course, long long wale, int bed) {
  long long held = course - 1;
  while (is_inside(field, held) && !is_loop(field.chart.at(held, wale, bed))) --held;
  return held;
}

namespace {

// The first later course that knits on this needle; last_course + 1: none.
long long next_loop_course(const KnitField& field, long long course, long long wale, int bed) {
  long long next = course + 1;
  while (is_inside(field, next) && !is_loop(field.chart.at(next, wale, bed))) ++next;
  return next;
}

int count_tucks(const KnitField& field, long long first, long long end, long long wale, int bed) {
  int count = 0;
  for (long long course = first; course < end; ++course)
    count += is_tuck(field.chart.at(course, wale, bed)) ? 1 : 0;
  return count;
}

double side_of(Stitch stitch) {
  return stitch == Stitch::purl ? -1.0 : 1.0;
}

// The same of a chart that is the whole cloth.
Needle needle_of_journeys(const KnitField& field, const Journeys& journeys, long long course,
                          long long wale) {
  Needle needle;
  needle.stitch = field.chart.at(course, wale);
  const auto side_at = [&](long long row, long long w) {
    const Stitch stitch = field.chart.at(row, w);
    return is_tuck(stitch) && field.chart.is_opposite() ? bed_of(stitch) : side_of(stitch);
  };
  if (is_loop(needle.stitch)) {
    needle.side = side_of(needle.stitch);
    const Held& held = journeys.held(course, wale);
    if (held.count > 1 && side_at(held.row, held.wale) == needle.side) needle.behind = held.count - 1;
  } else if (is_tuck(needle.stitch)) {
    const Journey& journey = journeys.at(course, wale);
    needle.behind = std::max(journey.index - 1, 0);
    needle.side = field.chart.is_opposite() ? bed_of(needle.stitch)
                                            : side_of(journeys.joined(field.chart, course, wale));
  } else if (!field.chart.is_opposite()) {  // a float lies behind the loop that its needle holds
    long long held = course - 1;
    while (held >= 0 && !is_loop(field.chart.at(held, wale))) --held;
    if (held >= 0) needle.side = side_of(field.chart.at(held, wale));
  }
  needle.middle = needle.side * (needle.stitch == Stitch::miss ? 0.0 : field.shape.bed);
  return needle;
}

Needle needle_at(const KnitField& field, long long course, long long wale) {
  if (const Journeys* journeys = field.chart.journeys())
    return needle_of_journeys(field, *journeys, course, wale);
  Needle needle;
  needle.stitch = field.chart.at(course, wale);
  const int bed = bed_of(needle.stitch);
  if (field.chart.is_opposite() && bed == 0) return needle;
  const long long held = held_course(field, course, wale, bed);
  const bool holds = is_inside(field, held);
  if (is_loop(needle.stitch)) {
    needle.side = side_of(needle.stitch);
  } else if (field.chart.is_opposite()) {
    needle.side = bed;
  } else {  // on the bed of the loop that it joins, or else of the one that joins it
    const long long like = holds ? held : next_loop_course(field, course, wale, bed);
    needle.side = is_inside(field, like) ? side_of(field.chart.at(like, wale)) : 1.0;
  }
  // A loop of the other kind comes from the other side, where the tucks are not in its way.
  const bool comes_from_behind = !holds || side_of(field.chart.at(held, wale)) == needle.side;
  if (comes_from_behind)
    needle.behind = count_tucks(field, std::max(held + 1, field.first_course), course, wale, bed);
  needle.middle = needle.side * field.shape.bed;
  return needle;
}

Hold hold_of_journey(const KnitField& field, const Journey& journey, long long course, long long wale,
                     double side) {
  Hold hold;
  hold.right = journey.right;
  hold.lift = side > 0 ? journey.lift : -journey.lift;
  if (journey.off < 0) return hold;
  hold.top = course_spacing * (field.chart.height(journey.off) - field.chart.height(course));
  hold.turns = side_of(field.chart.at(journey.off, wale + journey.right)) != side;
  hold.tucks = journey.count - 1 - journey.index;
  if (is_loop(field.chart.at(course, wale))) hold.joins = journey.index;
  return hold;
}

Hold hold_of(const KnitField& field, long long course, long long wale, double side) {
  if (const Journeys* journeys = field.chart.journeys())
    return hold_of_journey(field, journeys->at(course, wale), course, wale, side);
  Hold hold;
  const int bed = bed_of(field.chart.at(course, wale));
  if (field.chart.is_opposite() && bed == 0) return hold;
  const long long next = next_loop_course(field, course, wale, bed);
  long long off = next;  // the row that knits it off
  // Above the last row a course of its like follows: with several feeds, the chart.
  while (field.chart.feeds() > 1 && !is_loop(field.chart.at(off, wale, bed))) ++off;
  hold.top = course_spacing * (field.chart.height(off) - field.chart.height(course));
  hold.turns = is_inside(field, next) && side_of(field.chart.at(next, wale, bed)) != side;
  hold.tucks = count_tucks(field, course + 1, next, wale, bed);
  return hold;
}

// How much further back a sinker or a float lies that passes behind tucks.
double room_for(int tucks) {
  return tucks > 0 ? sinker_back + layer * (tucks - 1) : 0.0;
}

struct Sinker {
  double z = 0;
  bool crosses = false;  // from one side or bed to the other
};

// Between a wale and the one on its left.
Sinker sinker_of(const KnitField& field, long long course, long long wale) {
  const RowExtent extent = extent_of(field, course);
  const Needle left = needle_at(field, course, std::max(wale - 1, extent.first));
  const Needle right = needle_at(field, course, std::min(wale, extent.last));
  const bool floats_between = field.chart.is_opposite() && (left.middle == 0 || right.middle == 0);
  if (left.side != right.side || floats_between) return {0, true};
  const double back = depth + room_for(std::max(left.behind, right.behind));
  return {right.middle - right.side * (back * field.shape.depth), false};
}

// How much before the middle of all yarns of a course one of them lies.
double offset_of(const KnitField& field, int end) {
  if (field.ends == 1) return 0;
  return end == 0 ? 1 : -1;
}

bool is_pile(const KnitField& field, int end) {
  return end == 1 && field.pile > 0;
}

// A sinker's middle, above the side of its wale.
Vec3 sinker_at(const KnitField& field, const Sinker& sinker, int end) {
  return {0, shaped(field.shape, {0, sinker_y, 0}, course_spacing).y(),
          is_pile(field, end) ? -field.pile : sinker.z + offset_of(field, end)};
}

// The limb of a pile's loop, from its sinker to the cloth: x from the sinker.
std::array<Vec3, 2> pile_limb(const KnitField& field) {
  const double y = shaped(field.shape, {0, sinker_y, 0}, course_spacing).y();
  return {{{pile_limb_x, y, -(field.pile - pile_top)},
           {pile_limb_x, pile_foot_y * y, -(plated_back(field.shape) + pile_foot)}}};
}

// The points of one half of a stitch, from its sinker to before its head.
class Half {
 public:
  Half(const Needle& needle, const Hold& hold, bool starts_in_the_middle) {
    if (is_tuck(needle.stitch)) add_tuck(needle, hold);
    if (is_loop(needle.stitch)) add_loop(needle, hold, starts_in_the_middle);
  }
  [[nodiscard]] const Point* begin() const { return points_.data(); }
  [[nodiscard]] const Point* end() const { return points_.data() + count_; }

 private:
  void add(const Point& point, double up = 0, double forward = 0) {
    points_[count_++] = {point[0], point[1] + up, point[2] + forward};
  }
  void add_loop(const Needle& needle, const Hold& hold, bool starts_in_the_middle);
  void add_joining(const Hold& hold);
  void add_crossing(const Hold& hold);
  void add_tuck(const Needle& needle, const Hold& hold);

  std::array<Point, 6> points_{};
  std::size_t count_ = 0;
};

void Half::add_loop(const Needle& needle, const Hold& hold, bool starts_in_the_middle) {
  if (needle.behind > 0)
    add(arm_behind_tucks, 0, -layer * (needle.behind - 1));
  else if (starts_in_the_middle)
    add(arm);
  add(foot);
  if (hold.joins > 0) return add_joining(hold);
  const bool is_held = is_long(hold);
  // A held loop is drawn up: a straight leg from the foot to the shoulder, before the plane at both ends.
  const auto on_leg = [&](double y) {
    return Point{foot[0] + (shoulder_top[0] - foot[0]) * y / hold.top, y, depth};
  };
  if (hold.turns) {
    if (is_held) {
      add(on_leg(leg[1]));
      const double last = hold.top - course_spacing + lower_leg[1];
      add(on_leg(last), 0, lower_leg[2] - depth);
    } else {
      add(lower_leg);
    }
    add(upper_leg_top, hold.top);
    add(shoulder_top, hold.top, 0.5 * layer * hold.tucks);
  } else if (hold.lift != 0) {
    add_crossing(hold);
    add(shoulder_top, hold.top, shoulder_forward * hold.tucks);
  } else {
    add(is_held ? on_leg(leg[1]) : Point{leg[0], 0.5 * hold.top, leg[2]});
    if (is_held) add(on_leg(hold.top - leg[1]), 0, leg_forward * hold.tucks);
    add(shoulder_top, hold.top, shoulder_forward * hold.tucks);
  }
}

// From its feet behind the loops that lie on its needle before it.
void Half::add_joining(const Hold& hold) {
  const double back = -layer * (hold.joins - 1);
  add({leg[0], joining_leg * hold.top, 0.5 * leg[2] + 0.5 * back});
  if (hold.turns) {
    add(upper_leg_top, hold.top, back - layer);
    add(shoulder_top, hold.top, 0.5 * (back + layer * (hold.tucks - 1)));
  } else {
    add(tuck_shoulder_top, hold.top, back);
  }
}

// A leg before or behind the legs of other loops.
void Half::add_crossing(const Hold& hold) {
  const double out = hold.lift > 0 ? before_others : behind_others;
  for (const double share : {1.0 / 3, 2.0 / 3})
    add({foot[0] + (shoulder_top[0] - foot[0]) * share, share * hold.top, leg[2]}, 0, out);
}

void Half::add_tuck(const Needle& needle, const Hold& hold) {
  const double back = -layer * needle.behind;
  const double leg_back = hold.turns ? back - layer : back;
  const bool is_held = is_long(hold);
  add(tuck_leg, std::min(hold.top - course_spacing, 0.0), leg_back);
  if (is_held) add({tuck_shoulder_top[0], tuck_leg[1], tuck_leg[2]}, hold.top - course_spacing, leg_back);
  if (hold.turns) {
    add(upper_leg_top, hold.top, back - layer);
    add(shoulder_top, hold.top, 0.5 * (back + layer * (hold.tucks - 1)));
  } else {
    add(tuck_shoulder_top, hold.top, back);
  }
}

Point head_of(const Needle& needle, const Hold& hold) {
  switch (needle.stitch) {
    case Stitch::none:
      break;
    case Stitch::miss:
      return {0, float_y, float_z - room_for(needle.behind)};
    case Stitch::tuck:
    case Stitch::back_tuck:
      if (hold.turns) return {0, hold.top + head_over_top, depth + layer * hold.tucks};
      return {0, hold.top + tuck_head_over_top, tuck_head - layer * needle.behind};
    case Stitch::knit:
    case Stitch::purl:
      break;
  }
  if (hold.turns) return {0, hold.top + head_over_top, depth + layer * hold.tucks};
  if (hold.joins > 0) return {0, hold.top + tuck_head_over_top, tuck_head - layer * (hold.joins - 1)};
  return {0, hold.top + head_over_top, -depth + head_forward * hold.tucks};
}

}  // namespace

double plated_back(const LoopShape& shape) {
  return depth * shape.depth + 2;
}

double least_pile(const LoopShape& shape) {
  return plated_back(shape) + pile_foot + pile_top + 1;
}

void add_stitch_points(const KnitField& field, long long course, long long wale, std::vector<Vec3>& points,
                       int end) {
  if (field.own != nullptr) {
    const std::vector<Vec3>& own = own_points(field, course, wale);
    for (std::size_t i = 0; i + 1 < own.size(); ++i) points.push_back(own_point(field.shape, own[i]));
    return;
  }
  if (field.chart.journeys() != nullptr && field.chart.at(course, wale) == Stitch::none) return;
  const Needle needle = needle_at(field, course, wale);
  const Hold hold = hold_of(field, course, wale, needle.side);
  const Sinker left_sinker = sinker_of(field, course, wale);
  const Sinker right_sinker = sinker_of(field, course, wale + 1);
  const auto add = [&](const Point& p, double mirror) {
    const Vec3 at = shaped(field.shape, p, hold.top);
    const double lean = hold.right * field.shape.wale * std::clamp(p[1] / hold.top, 0.0, 1.0);
    points.emplace_back(field.shape.wale / 2 + mirror * at.x() + lean, at.y(),
                        needle.middle + needle.side * (at.z() + offset_of(field, end)));
  };
  points.push_back(sinker_at(field, left_sinker, end));
  const std::array<Vec3, 2> limb = pile_limb(field);
  if (is_pile(field, end)) points.insert(points.end(), limb.begin(), limb.end());
  for (const Point& point : Half(needle, hold, left_sinker.crosses)) add(point, 1);
  Point head = head_of(needle, hold);
  if (field.chart.is_opposite() && needle.stitch == Stitch::miss) head[2] = 0;
  add(head, 1);
  const Half right(needle, hold, right_sinker.crosses);
  for (const Point* point = right.end(); point != right.begin();) add(*--point, -1);
  if (is_pile(field, end))
    for (auto at = limb.rbegin(); at != limb.rend(); ++at)
      points.emplace_back(field.shape.wale - at->x(), at->y(), at->z());
}

Vec3 last_sinker_point(const KnitField& field, long long course, int end) {
  if (field.own != nullptr)
    return own_point(field.shape, own_points(field, course, field.last_wale).back() - Vec3::UnitX());
  return sinker_at(field, sinker_of(field, course, extent_of(field, course).last + 1), end);
}

}  // namespace selvage::fabric
