// Warp knits as topology: what the lapping notation says, read here on its own, against the built centre
// lines. For every loop: it sits at its needle and course, it passes through the loops of its needle's last
// course from back to front (signed crossings with a surface spanned across the lower loop), its legs cross
// at the foot exactly where the lap is closed, underlaps lie behind the loops that they cross, laid-in yarns
// and the arches of fall-plate bars pass through no loop.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "nurbs/measure.h"
#include "nurbs/spline.h"
#include "property/zoo.h"
#include "yarn/outline.h"

namespace selvage {
namespace {

using fabric::Warpknit;
using fabric::YarnPlan;

struct Stroke {
  int from = 0, to = 0;
  [[nodiscard]] bool wraps() const { return from != to; }
};
struct TextBar {
  std::vector<Stroke> strokes;
  bool is_fall_plate = false;
  [[nodiscard]] const Stroke& at(int course) const {
    return strokes[static_cast<std::size_t>(course) % strokes.size()];
  }
};

TextBar bar_of(std::string notation, bool is_fall_plate) {
  for (char& c : notation)
    if (c == '/' || c == '-') c = ' ';
  std::istringstream in(notation);
  TextBar bar;
  bar.is_fall_plate = is_fall_plate;
  for (Stroke s; in >> s.from >> s.to;) bar.strokes.push_back(s);
  return bar;
}

// The bars as the text has them; the classics as textbooks list them, closed and open.
std::vector<TextBar> bars_of(const Warpknit& knit) {
  std::vector<TextBar> bars;
  for (const fabric::WarpknitBar& bar : knit.bars) bars.push_back(bar_of(bar.lapping, bar.fall_plate));
  if (knit.classic.empty()) return bars;
  static const std::map<std::string, std::array<std::vector<std::string>, 2>> classics = {
      {"tricot", {{{"1-0/1-2"}, {"0-1/2-1"}}}},
      {"cord", {{{"1-0/2-3"}, {"0-1/3-2"}}}},
      {"satin", {{{"1-0/3-4"}, {"0-1/4-3"}}}},
      {"velvet", {{{"1-0/4-5"}, {"0-1/5-4"}}}},
      {"locknit", {{{"2-3/1-0", "1-0/1-2"}, {"3-2/0-1", "0-1/2-1"}}}},
      {"queens-cord", {{{"1-0/0-1", "3-4/1-0"}, {"1-0/0-1", "4-3/0-1"}}}},
      {"atlas", {{{"1-0/1-2/2-3/2-1"}, {"0-1/1-2/3-2/2-1"}}}}};
  const bool is_open = knit.stitch == Warpknit::Stitch::open;
  for (const std::string& notation : classics.at(knit.classic)[is_open ? 1 : 0])
    bars.push_back(bar_of(notation, false));
  return bars;
}

// A loop (or the arch of a fall-plate bar) as found on a curve: sample numbers.
struct Loop {
  std::size_t yarn = 0;
  int needle = 0, course = 0;  // needle n lies between the spaces n-1 and n; course from 0
  bool is_arch = false;
  std::size_t before = 0, top = 0, after = 0;  // lowest places before and after the top, and the top
  std::size_t low_in = 0, low_out = 0;         // the part that a surface is spanned across
};

struct Strand {
  int bar = 0, guide = 0;  // from 0
  std::vector<Vec3> points;
};

double cross2(const Vec3& a, const Vec3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Do the segments ab and cd cross seen along z? How much higher ab lies there.
std::optional<double> height_at_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 r = b - a, s = d - c;
  const double turn = cross2(r, s);
  if (turn == 0.0) return std::nullopt;
  const double t = cross2(c - a, s) / turn, u = cross2(c - a, r) / turn;
  if (t < 0.0 || t >= 1.0 || u < 0.0 || u >= 1.0) return std::nullopt;
  return a.z() + t * r.z() - c.z() - u * s.z();
}

// +1: the segment goes through the triangle towards its normal's side; -1: against; 0: past it.
int crossing(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto volume = [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    return (q - p).cross(r - p).dot(s - p);
  };
  const double start = volume(a, b, c, from), stop = volume(a, b, c, to);
  if ((start > 0.0) == (stop > 0.0)) return 0;
  const bool ab = volume(from, to, a, b) > 0.0, bc = volume(from, to, b, c) > 0.0,
             ca = volume(from, to, c, a) > 0.0;
  if (ab != bc || bc != ca) return 0;
  return stop > 0.0 ? 1 : -1;
}

// Everything that a fabric of built yarns is judged by.
class Judge {
 public:
  Judge(const Warpknit& knit, const std::vector<YarnPlan>& plans) : knit_(knit), bars_(bars_of(knit)) {
    for (const YarnPlan& plan : plans) {
      Strand strand;
      if (std::sscanf(plan.name.c_str(), "bar%d_%d", &strand.bar, &strand.guide) != 2) continue;
      --strand.bar;
      --strand.guide;
      constexpr int a_span = 6;
      const std::vector<double>& knots = plan.line.curve.knots;
      for (std::size_t k = 0; k + 1 < knots.size(); ++k)
        for (int i = 0; knots[k] < knots[k + 1] && i < a_span; ++i)
          strand.points.push_back(
              nurbs::evaluate(plan.line.curve, knots[k] + (knots[k + 1] - knots[k]) * i / a_span));
      thickness_ = std::max(thickness_, yarn::nominal_size(plan.spec.section).width);
      strands_.push_back(std::move(strand));
    }
  }

  // What is not as the text says; empty: all is well.
  std::vector<std::string> faults() {
    const auto wanted = bars_.size() * static_cast<std::size_t>(knit_.wales);
    if (strands_.size() != wanted) fault("{} yarns instead of {}", strands_.size(), wanted);
    for (std::size_t i = 0; i < strands_.size(); ++i) find_loops(i);
    if (!faults_.empty()) return faults_;
    for (const Loop& loop : loops_) judge_lap(loop);
    for (const Loop& lower : loops_) lower.is_arch ? judge_arch(lower) : judge_passing(lower);
    judge_backs();
    return faults_;
  }
  [[nodiscard]] std::size_t passings() const { return passings_; }
  [[nodiscard]] std::size_t backs() const { return backs_; }

 private:
  template <class... Args>
  void fault(fmt::format_string<Args...> format, Args&&... args) {
    faults_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }
  std::string name(std::size_t yarn) const {
    return fmt::format("bar{}_{}", strands_[yarn].bar + 1, strands_[yarn].guide + 1);
  }

  // The highest places of a curve are its loops' heads, in the order of the courses that wrap a needle.
  void find_loops(std::size_t yarn) {
    const Strand& strand = strands_[yarn];
    const std::vector<Vec3>& p = strand.points;
    const TextBar& bar = bars_[static_cast<std::size_t>(strand.bar)];
    std::vector<std::size_t> tops, lows = {0};
    // Ups and downs of less than this are no loops: a long underlap may sag.
    const double sag = 0.1 * knit_.course_pitch;
    bool rises = true;
    for (std::size_t i = 1, extreme = 0; i < p.size(); ++i) {
      if ((p[i].y() > p[extreme].y()) == rises) extreme = i;
      if (std::abs(p[i].y() - p[extreme].y()) < sag) continue;
      (rises ? tops : lows).push_back(extreme);
      rises = !rises;
      extreme = i;
    }
    std::size_t found = 0;
    for (int course = 0; course < knit_.courses; ++course) {
      const Stroke& stroke = bar.at(course);
      if (!stroke.wraps()) continue;
      if (found >= tops.size() || found + 1 >= lows.size())
        return fault("{} has fewer loops than overlaps", name(yarn));
      Loop loop;
      loop.yarn = yarn;
      loop.course = course;
      loop.needle = std::max(stroke.from, stroke.to) + strand.guide;
      loop.is_arch = bar.is_fall_plate;
      loop.before = lows[found];
      loop.top = tops[found];
      loop.after = lows[found + 1];
      ++found;
      const Vec3& top = p[loop.top];
      const double foot = course * knit_.course_pitch;
      if (std::abs(top.x() - (loop.needle - 0.5) * knit_.wale_pitch) > 0.1 * knit_.wale_pitch ||
          top.y() < foot || top.y() < foot + (loop.is_arch ? 0.0 : knit_.course_pitch))
        fault("{} has no loop on needle {} in course {}", name(yarn), loop.needle, course + 1);
      const double cut = p[loop.after].y() + 0.2 * knit_.course_pitch;
      for (loop.low_in = loop.top;
           p[loop.low_in].y() > (loop.is_arch ? foot - 0.1 * knit_.course_pitch : cut);)
        --loop.low_in;
      for (loop.low_out = loop.top; loop.low_out < loop.after && (loop.is_arch || p[loop.low_out].y() > cut);)
        ++loop.low_out;
      loops_.push_back(loop);
    }
    if (found != tops.size()) fault("{} has {} loops, not {}", name(yarn), tops.size(), found);
  }

  // The end of the underlap that follows a loop: the next loop's foot, the end of the yarn.
  std::size_t underlap_end(std::size_t yarn, std::size_t from) const {
    const std::vector<Vec3>& p = strands_[yarn].points;
    std::size_t end = from;
    while (end + 1 < p.size() && p[end + 1].z() < p[from].z() + 0.5 * thickness_) ++end;
    return end;
  }

  // Closed: the underlap goes against the overlap. Then it crosses behind the other leg on its way to another
  // needle; back to the same needle it ends within the loop, under the other leg instead of its own.
  void judge_lap(const Loop& loop) {
    const Strand& strand = strands_[loop.yarn];
    const TextBar& bar = bars_[static_cast<std::size_t>(strand.bar)];
    const Stroke &stroke = bar.at(loop.course), &next = bar.at(loop.course + 1);
    const bool is_closed = (next.from - stroke.to) * (stroke.to - stroke.from) < 0;
    const std::vector<Vec3>& p = strand.points;
    std::size_t end = underlap_end(loop.yarn, loop.after);
    while (p[end].y() > (loop.course + 1) * knit_.course_pitch) --end;
    bool crosses = false;
    if (next.wraps() && std::max(stroke.from, stroke.to) == std::max(next.from, next.to)) {
      const double middle = (loop.needle - 0.5) * knit_.wale_pitch;
      crosses = (p[end].x() > middle) != (p[loop.after].x() > middle);
    } else {
      for (std::size_t i = loop.before; i + 1 < loop.top; ++i)
        for (std::size_t k = loop.top + 1; k < end; ++k)
          if (height_at_crossing(p[i], p[i + 1], p[k], p[k + 1])) crosses = !crosses;
    }
    if (crosses != is_closed)
      fault("{} course {}: the lap is {}, its legs {}", name(loop.yarn), loop.course + 1,
            is_closed ? "closed" : "open", crosses ? "cross" : "do not cross");
    const double side = p[loop.low_in].x() - p[loop.low_out].x();
    if ((side > 0.0) != (stroke.from > stroke.to))
      fault("{} course {}: the overlap goes the wrong way", name(loop.yarn), loop.course + 1);
  }

  // Signed crossings of samples first..last of a strand with a fan across the loop, back to front counted +1.
  int crossings(const Loop& lower, const std::vector<Vec3>& p, std::size_t first, std::size_t last) const {
    const std::vector<Vec3>& ring = strands_[lower.yarn].points;
    Vec3 low = ring[lower.low_in], high = low, middle = Vec3::Zero();
    for (std::size_t i = lower.low_in; i <= lower.low_out; ++i) {
      low = low.cwiseMin(ring[i]);
      high = high.cwiseMax(ring[i]);
      middle += ring[i] / static_cast<double>(lower.low_out - lower.low_in + 1);
    }
    const bool turns_left = ring[lower.low_in].x() > ring[lower.low_out].x();  // seen from the face
    int sum = 0;
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 from = p[k].cwiseMin(p[k + 1]), to = p[k].cwiseMax(p[k + 1]);
      if ((from.array() > high.array()).any() || (to.array() < low.array()).any()) continue;
      for (std::size_t i = lower.low_in; i <= lower.low_out; ++i) {
        const Vec3 &a = ring[i], &b = i < lower.low_out ? ring[i + 1] : ring[lower.low_in];
        sum += turns_left ? crossing(p[k], p[k + 1], middle, a, b) : crossing(p[k], p[k + 1], middle, b, a);
      }
    }
    return sum;
  }

  // The course after this one in which the needles knit; they hold their loops until then.
  int next_knitted(int course) const {
    for (int next = course + 1; next < course + 20; ++next)
      for (const TextBar& bar : bars_)
        if (!bar.is_fall_plate && bar.at(next).wraps()) return next;
    return -1;
  }

  void judge_passing(const Loop& lower) {
    const int next = next_knitted(lower.course);
    std::vector<bool> has_loops(strands_.size(), false);
    for (const Loop& upper : loops_) {
      has_loops[upper.yarn] = true;
      // Loops of several bars on one needle in one course stand in each other; the text says no more of them.
      if (upper.needle == lower.needle && upper.course == lower.course && upper.is_arch == lower.is_arch)
        continue;
      const bool passes = !upper.is_arch && upper.needle == lower.needle && upper.course == next;
      const std::vector<Vec3>& p = strands_[upper.yarn].points;
      const bool follows = upper.yarn == lower.yarn && upper.before <= lower.low_out;  // its own leg before
      const std::size_t first = follows ? std::max(upper.before, lower.low_out + 1) : upper.before;
      const bool precedes = upper.yarn == lower.yarn && upper.after >= lower.low_in;
      const std::size_t last = precedes && upper.course < lower.course ? lower.low_in - 1 : upper.after;
      const int up = crossings(lower, p, first, upper.top), down = crossings(lower, p, upper.top, last);
      if (up != (passes ? 1 : 0) || down != (passes ? -1 : 0))
        fault("{} course {} goes through the loop of {} course {} {:+} and {:+} times", name(upper.yarn),
              upper.course + 1, name(lower.yarn), lower.course + 1, up, down);
      passings_ += passes ? 1 : 0;
    }
    for (std::size_t yarn = 0; yarn < strands_.size(); ++yarn) {
      if (has_loops[yarn]) continue;
      const std::vector<Vec3>& p = strands_[yarn].points;
      if (const int through = crossings(lower, p, 0, p.size() - 1); through != 0)
        fault("laid-in {} goes through the loop of {} course {}", name(yarn), name(lower.yarn),
              lower.course + 1);
    }
  }

  // The arch of a fall-plate bar is caught by a loop of its needle and course: the legs pass before it, the
  // underlap that leaves the loop behind it.
  void judge_arch(const Loop& arch) {
    const std::vector<Vec3>& q = strands_[arch.yarn].points;
    for (const Loop& loop : loops_) {
      if (loop.is_arch || loop.needle != arch.needle || loop.course != arch.course) continue;
      const std::vector<Vec3>& p = strands_[loop.yarn].points;
      int before = 0, behind = 0;
      for (std::size_t k = arch.low_in; k < arch.low_out; ++k) {
        for (std::size_t i = loop.before; i < loop.after; ++i)
          if (const auto height = height_at_crossing(p[i], p[i + 1], q[k], q[k + 1]))
            before += *height > 0.5 * thickness_ ? 1 : 0;
        for (std::size_t i = loop.after; i < underlap_end(loop.yarn, loop.after); ++i)
          if (const auto height = height_at_crossing(p[i], p[i + 1], q[k], q[k + 1]); height && *height < 0.0)
            ++behind;
      }
      if (before != 2 || behind == 0)
        fault("{} course {} does not catch the arch of {}: {} times before it, {} times behind",
              name(loop.yarn), loop.course + 1, name(arch.yarn), before, behind);
    }
  }

  // Underlaps, and laid-in yarns wholly, lie behind all loops that they cross; those of bars further to the
  // front behind those of the bars after them.
  void judge_backs() {
    struct Back {
      std::size_t yarn, first, last;
    };
    std::vector<Back> backs;
    std::vector<bool> has_loops(strands_.size(), false);
    for (const Loop& loop : loops_) {
      has_loops[loop.yarn] = true;
      backs.push_back({loop.yarn, loop.after, underlap_end(loop.yarn, loop.after)});
    }
    for (std::size_t yarn = 0; yarn < strands_.size(); ++yarn)
      if (!has_loops[yarn]) backs.push_back({yarn, 0, strands_[yarn].points.size() - 1});
    for (const Back& back : backs) {
      for (const Loop& loop : loops_)
        behind(back.yarn, back.first, back.last, loop.yarn, loop.low_in, loop.low_out, "the loop");
      for (const Back& other : backs)
        if (strands_[back.yarn].bar < strands_[other.yarn].bar)
          behind(back.yarn, back.first, back.last, other.yarn, other.first, other.last, "the underlap");
    }
  }

  void behind(std::size_t yarn, std::size_t first, std::size_t last, std::size_t other,
              std::size_t other_first, std::size_t other_last, std::string_view what) {
    const std::vector<Vec3>&p = strands_[yarn].points, &q = strands_[other].points;
    const auto box = [](const std::vector<Vec3>& points, std::size_t from, std::size_t to) {
      Vec3 low = points[from], high = low;
      for (std::size_t i = from; i <= to; ++i) {
        low = low.cwiseMin(points[i]);
        high = high.cwiseMax(points[i]);
      }
      return std::pair(low, high);
    };
    const auto [low, high] = box(q, other_first, other_last);
    for (std::size_t i = first; i < last; ++i) {
      if (std::max(p[i].x(), p[i + 1].x()) < low.x() || std::min(p[i].x(), p[i + 1].x()) > high.x() ||
          std::max(p[i].y(), p[i + 1].y()) < low.y() || std::min(p[i].y(), p[i + 1].y()) > high.y())
        continue;
      for (std::size_t k = other_first; k < other_last; ++k) {
        if (yarn == other && (i > k ? i - k : k - i) < 3) continue;
        const std::optional<double> height = height_at_crossing(p[i], p[i + 1], q[k], q[k + 1]);
        if (!height) continue;
        ++backs_;
        if (*height > -0.5 * thickness_)
          fault("the underlap of {} lies before {} of {} at ({:.3f}, {:.3f})", name(yarn), what, name(other),
                p[i].x(), p[i].y());
      }
    }
  }

  const Warpknit& knit_;
  std::vector<TextBar> bars_;
  std::vector<Strand> strands_;
  std::vector<Loop> loops_;
  std::vector<std::string> faults_;
  double thickness_ = 0;
  std::size_t passings_ = 0, backs_ = 0;
};

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(lines.size(), 8); ++i) text += lines[i] + "\n";
  return text;
}

TEST(WarpknitTopology, EveryLoopOfTheZooIsThereAndPassesThroughTheOneBelow) {
  const auto zoo = zoo::with<Warpknit>();
  ASSERT_GE(zoo.size(), 10U);
  for (const zoo::ZooFabric* sample : zoo) {
    zoo::ZooFabric cloth = *sample;
    cloth.fabric.cell.reset();  // its courses are counted: it does not go on beyond a cell
    const zoo::ZooFabric* fabric = &cloth;
    const Warpknit& knit = zoo::item_of<Warpknit>(*fabric);
    Judge judge(knit, zoo::plans_of(*fabric));
    const std::vector<std::string> faults = judge.faults();
    EXPECT_TRUE(faults.empty()) << fabric->name << ":\n" << joined(faults);
    EXPECT_GT(judge.passings(), 0U) << fabric->name;
    EXPECT_GT(judge.backs(), 0U) << fabric->name;
  }
}

std::string text_of(const std::string& bars, double course_pitch = 1.0) {
  return "fabric 1\nthread t\n  diameter 0.1\nend\nwarpknit\n" + bars +
         fmt::format("  wales 3 pitch 1.2\n  courses 5 pitch {}\nend\n", course_pitch);
}

struct Built {
  fabric::Fabric fabric;
  std::vector<YarnPlan> plans;
  explicit Built(const std::string& text) : fabric(zoo::fabric_of(text)), plans(zoo::plans_of(fabric)) {}
  [[nodiscard]] const Warpknit& knit() const { return std::get<Warpknit>(fabric.items.front()); }
};

// Any lapping, not only the known ones.
TEST(WarpknitTopology, LappingsOfEveryKind) {
  for (const std::string bars :
       {"  bar t 1-0\n", "  bar t 0-1\n", "  bar t 0-1/1-0\n", "  bar t 1-0/2-1/3-2/1-2\n",
        "  bar t 5-6/2-1/3-4\n", "  bar t 1-0/1-1\n  bar t 2-1/1-2\n",
        "  bar t 1-0/1-2\n  bar t 1-2/1-0\n  bar t 1-0/0-1\n",
        "  bar t 0-1/3-2\n  bar t 0-0/4-4\n  bar t 1-0/3-4\n",
        "  bar t 2-1/0-1 fall-plate\n  bar t 0-1/2-1\n", "  bar t 1-0/1-2/1-1/2-2\n"}) {
    const Built built(text_of(bars));
    Judge judge(built.knit(), built.plans);
    EXPECT_EQ(joined(judge.faults()), "") << bars;
  }
}

// The judge sees what it has to see.
TEST(WarpknitTopology, MutationsAreSeen) {
  const Built sound(text_of("  bar t 1-0/1-2\n  bar t 1-0/3-4\n"));
  for (std::size_t yarn = 0; yarn < sound.plans.size(); ++yarn) {
    std::vector<YarnPlan> mirrored = sound.plans;
    for (Vec3& point : mirrored[yarn].line.curve.points) point.z() = -point.z();
    EXPECT_FALSE(Judge(sound.knit(), mirrored).faults().empty()) << "mirrored: " << mirrored[yarn].name;
  }
  const Built open(text_of("  bar t 0-1/2-1\n  bar t 1-0/3-4\n"));
  EXPECT_FALSE(Judge(open.knit(), sound.plans).faults().empty()) << "closed laps taken for open ones";
  const Built shifted(text_of("  bar t 1-0/1-2\n  bar t 1-0/2-3\n"));
  EXPECT_FALSE(Judge(shifted.knit(), sound.plans).faults().empty()) << "underlaps of another length";
  std::vector<YarnPlan> swapped = sound.plans;
  std::swap(swapped[0].name, swapped[1].name);
  EXPECT_FALSE(Judge(sound.knit(), swapped).faults().empty()) << "two yarns under each other's name";
}

// How near the surfaces of round yarns come, by dense samples of their centre lines (6e-4 of a thickness is
// the most that these miss): of two yarns, or of two places of one that are farther apart along it than one
// and a half of its thickness, and a sample. In thicknesses of the thinner yarn.
double least_gap(const std::vector<YarnPlan>& plans) {
  struct Sample {
    Vec3 position;
    double along = 0, diameter = 0;
    std::size_t yarn = 0;
  };
  double thickest = 0.0;
  for (const YarnPlan& plan : plans)
    thickest = std::max(thickest, yarn::nominal_size(plan.spec.section).width);
  std::map<std::array<long, 3>, std::vector<Sample>> cells;
  const auto cell_of = [&](const Vec3& p) {
    std::array<long, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] = std::lround(std::floor(p[axis] / (1.2 * thickest)));
    return cell;
  };
  double gap = std::numeric_limits<double>::infinity();
  for (std::size_t yarn = 0; yarn < plans.size(); ++yarn) {
    const nurbs::Curve& curve = plans[yarn].line.curve;
    const double diameter = yarn::nominal_size(plans[yarn].spec.section).width;
    const auto count = static_cast<long>(nurbs::arc_length(curve) / (0.05 * diameter));
    Sample sample{nurbs::evaluate(curve, 0.0), 0.0, diameter, yarn};
    for (long i = 0; i <= count; ++i) {
      const Vec3 position = nurbs::evaluate(curve, static_cast<double>(i) / static_cast<double>(count));
      sample.along += (position - sample.position).norm();
      sample.position = position;
      const std::array<long, 3> cell = cell_of(position);
      for (long n = 0; n < 27; ++n) {
        const auto near = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
        if (near == cells.end()) continue;
        for (const Sample& other : near->second) {
          if (other.yarn == yarn && sample.along - other.along < 1.6 * diameter) continue;
          const double least = std::min(diameter, other.diameter);
          gap =
              std::min(gap, ((position - other.position).norm() - 0.5 * (diameter + other.diameter)) / least);
        }
      }
      cells[cell].push_back(sample);
    }
  }
  return gap;
}

std::vector<YarnPlan> plans_as_published(const fabric::Fabric& fabric) {
  fabric::BuildOptions options;
  options.as_published = true;
  Diagnostics diagnostics;
  const auto builder = fabric::YarnBuilder::create(fabric, options, diagnostics);
  std::vector<YarnPlan> plans;
  for (std::size_t i = 0; i < builder->count(); ++i) plans.push_back(*builder->plan(i));
  return plans;
}

TEST(WarpknitClearance, TheZooKeepsOneHundredthOfAThicknessFree) {
  std::size_t overlapping = 0;
  for (const zoo::ZooFabric* fabric : zoo::with<Warpknit>()) {
    EXPECT_GE(least_gap(zoo::plans_of(*fabric)), 0.01) << fabric->name;
    overlapping += least_gap(plans_as_published(fabric->fabric)) < 0.0 ? 1 : 0;
  }
  EXPECT_GE(overlapping, 3U);  // what is looked for is there without the moves
}

TEST(WarpknitClearance, TheClassicsAtTheirSmallestPitchesAndAtTwiceThese) {
  for (const std::string name : {"tricot", "cord", "satin", "velvet", "locknit", "queens-cord", "atlas"})
    for (const std::string stitch : {"open", "closed"})
      for (const double scale : {1.0, 2.0}) {
        const bool two_bars = name == "locknit" || name == "queens-cord";
        const Built built(fmt::format(
            "fabric 1\nthread t\n  diameter 0.1\nend\nwarpknit {}\n  thread t\n  wales 6 pitch {}\n"
            "  courses 5 pitch {}\n  stitch {}\nend\n",
            name, scale * (two_bars ? 0.601 : 0.401), scale * (two_bars ? 0.641 : 0.441), stitch));
        EXPECT_GE(least_gap(built.plans), 0.01) << name << ' ' << stitch << ' ' << scale;
        Judge judge(built.knit(), built.plans);
        EXPECT_EQ(joined(judge.faults()), "") << name << ' ' << stitch << ' ' << scale;
      }
}

// Any lapping that is accepted: what moves keeps its interlacing, too.
TEST(WarpknitClearance, SeededLappings) {
  std::mt19937 random(20261121);
  const auto below = [&](unsigned count) { return static_cast<int>(random() % count); };
  for (int round = 0; round < 12; ++round) {
    const int bars = 1 + below(3), length = 1 + below(4);
    std::string text;
    for (int bar = 0; bar < bars; ++bar) {
      const bool wraps = bar == 0 || below(3) > 0;
      text += fmt::format("  bar t ");
      for (int course = 0; course < length; ++course) {
        const int at = below(4), rises = below(2);
        text += fmt::format("{}{}-{}", course > 0 ? "/" : "", at + (wraps ? 1 - rises : 0),
                            at + (wraps ? rises : 0));
      }
      text += "\n";
    }
    const Built built(text_of(text));
    EXPECT_GE(least_gap(built.plans), 0.01) << text;
    Judge judge(built.knit(), built.plans);
    EXPECT_EQ(joined(judge.faults()), "") << text;
  }
}

// A laid-in yarn that is lifted to the face goes through the loops, or lies before them.
TEST(WarpknitTopology, ALiftedLaidInYarnIsSeen) {
  const Built sound(text_of("  bar t 1-0/0-1\n  bar t 0-0/2-2\n"));
  EXPECT_EQ(joined(Judge(sound.knit(), sound.plans).faults()), "");
  std::vector<YarnPlan> lifted = sound.plans;
  for (Vec3& point : lifted[3].line.curve.points) point.z() += 0.2;
  EXPECT_FALSE(Judge(sound.knit(), lifted).faults().empty());
}

// Guides of a bar are the same yarn, moved: to the last bit of base + i * pitch.
TEST(WarpknitPeriodicity, GuidesAreMovedCopies) {
  for (const zoo::ZooFabric* fabric : zoo::with<Warpknit>()) {
    const Warpknit& knit = zoo::item_of<Warpknit>(*fabric);
    const std::vector<YarnPlan> plans = zoo::plans_of(*fabric);
    const auto wales = static_cast<std::size_t>(knit.wales);
    for (std::size_t i = 0; i < plans.size(); ++i) {
      if (plans[i].role == yarn::Role::weft) continue;
      const YarnPlan& first = plans[i / wales * wales];
      ASSERT_EQ(plans[i].points.size(), first.points.size());
      for (std::size_t k = 0; k < first.points.size(); ++k) {
        const Vec3 moved(first.points[k].x() + static_cast<double>(i % wales) * knit.wale_pitch,
                         first.points[k].y(), first.points[k].z());
        ASSERT_EQ(plans[i].points[k], moved) << fabric->name << ' ' << plans[i].name << " point " << k;
      }
    }
  }
}

// The loop path method nearly meets its points: that is reported, and small against the yarn.
TEST(WarpknitPath, MissIsReportedAndSmall) {
  for (const zoo::ZooFabric* fabric : zoo::with<Warpknit>())
    for (const YarnPlan& plan : zoo::plans_of(*fabric)) {
      if (plan.role == yarn::Role::weft) continue;  // straight
      EXPECT_GT(plan.line.largest_miss, 0.0) << fabric->name;
      EXPECT_LT(plan.line.largest_miss, yarn::nominal_size(plan.spec.section).width) << fabric->name;
      // Two control points for every inner data point: six would give ten.
      EXPECT_EQ(plan.line.curve.points.size(), 2 * plan.points.size() - 2) << fabric->name;
    }
}

}  // namespace
}  // namespace selvage
