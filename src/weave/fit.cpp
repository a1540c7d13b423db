#include "weave/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

namespace selvage::fabric {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Of a thickness: yarns of a jammed cloth may lose this much of theirs.
constexpr double most_thinner = 0.03;
// Crossings of a draft's repeat that are looked at one by one; of a longer one all conceivable ones are.
constexpr long long most_looked_at = 1'000'000;

}  // namespace

void PlanePath::add(double length, double turn) {
  if (length <= 0.0) return;
  Piece piece = end_;
  piece.curvature = turn / length;
  pieces_.push_back(piece);
  const Point last = at(piece.from + length);
  end_ = {piece.from + length, last.position, piece.heading + turn, 0.0};
}

void PlanePath::add_bridge(const Pass& from, const Pass& to) {
  const double rise = to.z - from.z, sign = rise < 0.0 ? -1.0 : 1.0;
  const Obstacle &first = rise > 0.0 ? from.above : from.below, &last = rise > 0.0 ? to.below : to.above;
  const std::optional<Bridge> bridge = rise == 0.0 ? std::nullopt
                                                   : find_bridge(to.s - from.s - first.flat - last.flat,
                                                                 std::abs(rise), first.radius + last.radius);
  if (!bridge) return add(to.s - from.s, 0.0);
  add(first.flat, 0.0);
  add(first.radius * bridge->angle, sign * bridge->angle);
  add(bridge->straight, 0.0);
  add(last.radius * bridge->angle, -sign * bridge->angle);
  add(last.flat, 0.0);
}

PlanePath PlanePath::bent(const Pass& before, const Pass& here, const Pass& after) {
  PlanePath path;
  path.end_.start = Vec2(2.0 * before.s - here.s, before.z);
  path.add(here.s - before.s, 0.0);
  path.add_bridge(before, here);
  const double middle = path.end_.from;
  path.end_ = {middle, Vec2(here.s, here.z), 0.0, 0.0};  // rounding does not add up
  path.add_bridge(here, after);
  path.add(after.s - here.s, 0.0);
  for (Piece& piece : path.pieces_) piece.from -= middle;
  return path;
}

PlanePath PlanePath::sine(const Pass& before, const Pass& here, const Pass& after, int points) {
  PlanePath path;
  path.middle_ = here.s;
  path.step_ = (after.s - here.s) / points;
  const int reach = points + points / 2;  // level beyond the passes before and after
  for (int i = -reach; i <= reach; ++i) {
    const double phase = std::numbers::pi * std::min(std::abs(i), points) / points;
    const double half = 0.5 * (here.z - (i < 0 ? before.z : after.z));
    path.heights_.push_back(here.z - half + half * std::cos(phase));
  }
  // The slopes of the cubic with continuous curvature, level at both ends: a tridiagonal system.
  const std::size_t count = path.heights_.size();
  std::vector<double> above(count, 0.0);
  path.slopes_.assign(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double pivot = 4.0 - above[i - 1];
    const double right = 3.0 * (path.heights_[i + 1] - path.heights_[i - 1]) / path.step_;
    above[i] = 1.0 / pivot;
    path.slopes_[i] = (right - path.slopes_[i - 1]) / pivot;
  }
  for (std::size_t i = count - 2; i > 0; --i) path.slopes_[i] -= above[i] * path.slopes_[i + 1];
  return path;
}

PlanePath::Point PlanePath::at(double t) const {
  if (!heights_.empty()) {
    const double place = t / step_ + 0.5 * static_cast<double>(heights_.size() - 1);
    const double last = static_cast<double>(heights_.size() - 2);
    const auto i = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, last));
    const double x = std::clamp(place - static_cast<double>(i), 0.0, 1.0), y = 1.0 - x;
    const double rise = heights_[i + 1] - heights_[i];
    const double from = step_ * slopes_[i] - rise, to = rise - step_ * slopes_[i + 1];
    return {{middle_ + t, y * heights_[i] + x * heights_[i + 1] + x * y * (y * from + x * to)},
            {1.0, (rise + (y - x) * (y * from + x * to) + x * y * (to - from)) / step_}};
  }
  auto piece = std::upper_bound(pieces_.begin(), pieces_.end(), t,
                                [](double value, const Piece& p) { return value < p.from; });
  if (piece != pieces_.begin()) --piece;
  const double length = t - piece->from, turn = length * piece->curvature;
  // The chord of an arc halves its turn; its length is stable for no turn, too.
  const double chord = std::abs(turn) < 1e-9 ? length : length * std::sin(0.5 * turn) / (0.5 * turn);
  const double along = piece->heading + 0.5 * turn, heading = piece->heading + turn;
  return {piece->start + chord * Vec2(std::cos(along), std::sin(along)),
          Vec2(std::cos(heading), std::sin(heading))};
}

SweptYarn swept_in_plane(const PlanePath& path, bool is_weft, double across, const yarn::Section& section,
                         double share) {
  constexpr int looks = 2, fine_looks = 16;
  const auto outline = [&](int count) {
    std::vector<Vec2> points = outline_polygon(section, count);
    for (Vec2& p : points) p *= share;
    return points;
  };
  return {[path, is_weft, across](double t) {
            const PlanePath::Point point = path.at(t);
            const Vec2 tangent = point.derivative.normalized();
            SweptStation station;
            if (is_weft) {
              station.position = {across, point.position.x(), point.position.y()};
              station.derivative = {0.0, point.derivative.x(), point.derivative.y()};
              station.across = -Vec3::UnitX();
              station.up = {0.0, -tangent.y(), tangent.x()};
            } else {
              station.position = {point.position.x(), across, point.position.y()};
              station.derivative = {point.derivative.x(), 0.0, point.derivative.y()};
              station.across = Vec3::UnitY();
              station.up = {-tangent.y(), 0.0, tangent.x()};
            }
            return station;
          },
          outline(looks), outline(fine_looks)};
}

namespace {

// One crossing with its neighbours: who crosses, and who is on top.
struct Crossing {
  std::array<const WovenThread*, 3> warps{}, wefts{};  // before, here and after, in the other's direction
  // Is the warp on top: at the weft before, here, at the weft after; at the warp before and after.
  std::array<bool, 3> along_warp{}, along_weft{};
};

// By threads, not by the places where they are listed.
using CrossingKey = std::array<const void*, 11>;
CrossingKey key_of(const Crossing& c) {
  static constexpr char yes = 1;
  CrossingKey key{};
  for (std::size_t i = 0; i < 3; ++i) {
    key[i] = c.warps[i]->thread;
    key[3 + i] = c.wefts[i]->thread;
    key[6 + i] = c.along_warp[i] ? &yes : nullptr;
  }
  key[9] = c.along_weft[0] ? &yes : nullptr;
  key[10] = c.along_weft[2] ? &yes : nullptr;
  return key;
}

class DifferentCrossings {
 public:
  explicit DifferentCrossings(const WovenPair& pair) : pair_(pair) {
    const auto repeat = [](int draft, const System& system) {
      const auto threads = static_cast<long long>(system.threads.size());
      return std::min(std::lcm(static_cast<long long>(draft), threads), 1LL << 31);
    };
    const long long wefts = repeat(pair.drawdown->picks, *pair.weft),
                    warps = repeat(pair.drawdown->ends, *pair.warp);
    if (wefts > most_looked_at / warps) {
      add_all_conceivable();
      return;
    }
    for (long long weft = 0; weft < wefts; ++weft)
      for (long long warp = 0; warp < warps; ++warp) add_with_ends(at(warp, weft));
  }
  [[nodiscard]] const std::vector<Crossing>& list() const { return list_; }

 private:
  void add(const Crossing& crossing) {
    if (known_.insert(key_of(crossing)).second) list_.push_back(crossing);
  }
  // At the cloth's edges yarns stay level; that makes a difference to sines, whose cubic swings a little
  // there.
  void add_with_ends(const Crossing& crossing) {
    add(crossing);
    if (pair_.warp_bend && pair_.weft_bend) return;
    const std::array<std::optional<std::size_t>, 3> ends = {std::nullopt, 0, 2};
    for (const std::optional<std::size_t> warp_end : ends)
      for (const std::optional<std::size_t> weft_end : ends) {
        Crossing c = crossing;
        if (warp_end) c.along_warp[*warp_end] = c.along_warp[1];
        if (weft_end) c.along_weft[*weft_end] = c.along_weft[1];
        add(c);
      }
  }
  [[nodiscard]] Crossing at(long long warp, long long weft) const {
    Crossing c;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      c.warps[k] = &pair_.warp->thread(warp + i - 1);
      c.wefts[k] = &pair_.weft->thread(weft + i - 1);
      c.along_warp[k] = pair_.drawdown->warp_on_top(weft + i - 1, warp);
      c.along_weft[k] = pair_.drawdown->warp_on_top(weft, warp + i - 1);
    }
    return c;
  }
  void add_all_conceivable() {
    for (const WovenThread& warp : pair_.warp->threads)
      for (const WovenThread& weft : pair_.weft->threads)
        for (unsigned bits = 0; bits < 32; ++bits) {
          Crossing c;
          c.warps = {&warp, &warp, &warp};
          c.wefts = {&weft, &weft, &weft};
          const bool here = (bits & 1U) != 0;
          c.along_warp = {(bits & 2U) != 0, here, (bits & 4U) != 0};
          c.along_weft = {(bits & 8U) != 0, here, (bits & 16U) != 0};
          add(c);
        }
  }

  const WovenPair& pair_;
  std::set<CrossingKey> known_;
  std::vector<Crossing> list_;
};

// A yarn through three crossings. `crossed`: the threads there; on_top: its own place.
PlanePath path_of(const std::optional<Bend>& bend, const WovenThread& own,
                  const std::array<const WovenThread*, 3>& crossed, const std::array<bool, 3>& on_top,
                  double height, double pitch, double clearance) {
  std::array<Pass, 3> passes;
  for (std::size_t i = 0; i < 3; ++i) {
    passes[i].s = (static_cast<double>(i) - 1.0) * pitch;
    passes[i].z = on_top[i] ? height : -height;
    passes[i].below = passes[i].above =
        obstacle_of(bend.value_or(Bend::round), crossed[i]->size, own.size.height, clearance);
  }
  return bend ? PlanePath::bent(passes[0], passes[1], passes[2])
              : PlanePath::sine(passes[0], passes[1], passes[2], points_a_wave);
}

bool is_round(const System& system) {
  return std::all_of(system.threads.begin(), system.threads.end(), [](const WovenThread& woven) {
    return std::holds_alternative<yarn::Circle>(woven.section);
  });
}

double gap_of(const WovenPair& pair, const Crossing& crossing, const Heights& heights, double thinner) {
  constexpr int stations = 160;  // the gap is flat at its least: what they miss is below 1e-4 of the section
  const WovenThread &warp = *crossing.warps[1], &weft = *crossing.wefts[1];
  std::array<bool, 3> weft_on_top{};
  for (std::size_t i = 0; i < 3; ++i) weft_on_top[i] = !crossing.along_weft[i];
  const double warp_pitch = pair.warp->room, weft_pitch = pair.weft->room;
  const PlanePath warp_path = path_of(pair.warp_bend, warp, crossing.wefts, crossing.along_warp,
                                      heights.warp(warp.size.height), weft_pitch, heights.clearance),
                  weft_path = path_of(pair.weft_bend, weft, crossing.warps, weft_on_top,
                                      heights.weft(weft.size.height), warp_pitch, heights.clearance);
  const SweptYarn a = swept_in_plane(warp_path, false, 0.0, warp.section, 1.0 - thinner / warp.size.height),
                  b = swept_in_plane(weft_path, true, 0.0, weft.section, 1.0 - thinner / weft.size.height);
  return least_gap(a, -weft_pitch, weft_pitch, stations, b, 0.0, warp_pitch);
}

}  // namespace

// Does any yarn of the draft change sides from one crossing to the next? {warps, wefts}
std::pair<bool, bool> changes_of(const Drawdown& drawdown) {
  bool warps = false, wefts = false;
  for (int pick = 0; pick < drawdown.picks; ++pick)
    for (int end = 0; end < drawdown.ends; ++end) {
      const bool here = drawdown.warp_on_top(pick, end);
      warps = warps || here != drawdown.warp_on_top(pick + 1, end);
      wefts = wefts || here != drawdown.warp_on_top(pick, end + 1);
    }
  return {warps, wefts};
}

double crossing_gap(const WovenPair& pair, const Heights& heights, double thinner) {
  // Arcs about round sections of round yarns: nowhere nearer than at the crossing.
  const std::optional<Bend> round = Bend::round;
  if (pair.warp_bend == round && pair.weft_bend == round && is_round(*pair.warp) && is_round(*pair.weft))
    return heights.clearance + thinner;
  double gap = infinity;
  const DifferentCrossings crossings(pair);
  for (const Crossing& crossing : crossings.list())
    gap = std::min(gap, gap_of(pair, crossing, heights, thinner));
  return gap;
}

std::optional<double> least_clearance(double wanted, double most,
                                      const std::function<std::optional<double>(double)>& gap_at) {
  constexpr int most_steps = 40;
  constexpr double near = 0.02;  // of the wanted gap: no nearer to the smallest clearance than needed
  double clearance = wanted, slope = 1.0, last_clearance = 0.0, last_gap = 0.0;
  for (int step = 0; step < most_steps && clearance <= most; ++step) {
    const std::optional<double> gap = gap_at(clearance);
    if (!gap) return std::nullopt;
    if (*gap >= wanted) return clearance;
    if (step > 0) slope = std::clamp((*gap - last_gap) / (clearance - last_clearance), 0.1, 1.0);
    last_clearance = clearance;
    last_gap = *gap;
    clearance += (wanted * (1.0 + near) - *gap) / slope;
  }
  return std::nullopt;
}

Result<WeaveFit> fit_weave(const WovenPair& pair, double wanted,
                           const std::function<Result<Heights>(double clearance)>& heights_at) {
  const Result<Heights> touching = heights_at(0.0);
  if (!touching) return touching.error();
  const double thin = std::min(pair.warp->thickest, pair.weft->thickest);
  // The best of what was looked at, for a cloth without room.
  WeaveFit best{*touching, -infinity, 0.0};
  const auto gap_at = [&](double clearance) -> std::optional<double> {
    const Result<Heights> heights = heights_at(clearance);
    if (!heights) return std::nullopt;
    const double gap = crossing_gap(pair, *heights, 0.0);
    if (gap > best.gap) best = {*heights, gap, 0.0};
    return gap;
  };
  if (least_clearance(wanted, 2.0 * thin, gap_at)) return best;
  // No room: as far as it goes.
  double low = 0.0, high = 2.0 * thin;
  for (int step = 0; step < 30 && high - low > 0.01 * wanted; ++step) {
    const double middle = 0.5 * (low + high);
    (heights_at(middle) ? low : high) = middle;
  }
  gap_at(0.0);
  gap_at(low);
  const double missing = 0.5 * wanted - best.gap;
  if (missing <= 0.0) return best;
  double thinnest = infinity;
  for (const System* system : {pair.warp, pair.weft})
    for (const WovenThread& woven : system->threads) thinnest = std::min(thinnest, woven.size.height);
  if (missing > most_thinner * thinnest) return best;
  best.thinner = missing;
  best.gap = crossing_gap(pair, best.heights, missing);
  return best;
}

}  // namespace selvage::fabric
