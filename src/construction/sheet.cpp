#include "construction/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include "core/overloaded.h"
#include "core/parallel.h"
#include "core/plane.h"
#include "fabric/yarn_spec.h"
#include "knit/lapping.h"
#include "knit/warpknit_points.h"
#include "nurbs/basis.h"
#include "nurbs/measure.h"
#include "nurbs/patch.h"
#include "nurbs/restrict.h"
#include "nurbs/roots.h"
#include "yarn/ends.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;

// Where the curve first reaches a plane across an axis, going up (`way` 1) or down (-1); none where it does
// not.
std::optional<double> first_crossing(const nurbs::Curve& curve, int axis, double plane, double way) {
  const auto reaches = [&](const Vec3& point) { return way * (point[axis] - plane) >= 0; };
  const auto beyond = [&](double t) { return reaches(nurbs::evaluate(curve, t)); };
  constexpr int looks = 16, halvings = 60;
  const auto degree = static_cast<std::size_t>(curve.degree);
  for (std::size_t span = degree; span < curve.points.size(); ++span) {
    const double from = curve.knots[span], to = curve.knots[span + 1];
    const auto points = std::span(curve.points).subspan(span - degree, degree + 1);
    if (!(to > from) || std::ranges::none_of(points, reaches)) continue;
    double low = from;
    for (int i = 1; i <= looks; ++i) {
      double high = i == looks ? to : from + (to - from) * i / looks;
      if (beyond(high)) {
        nurbs::halve_between(low, high, halvings, [&](double t) { return !beyond(t); });
        return high;
      }
      low = high;
    }
  }
  return std::nullopt;
}

// A yarn from a plane to the one a repeat on; file units.
struct Stretch {
  double begin = 0, end = 0;  // parameters
  double length = 0, forward = 0, volume = 0;
  Vec3 start = Vec3::Zero();
  Vec2 way = Vec2::Zero();  // in the plane of the cloth, from its start to its end
  Box3 box;
  double inner = 0, outer = 0;  // distances from the z axis
  double turn = 0;              // about it, radians
};

// Distances from the z axis, and the turn about it.
void look_round(const YarnBuilder::Shaped& yarn, Stretch& piece) {
  constexpr int across = 64, along = 512;
  const nurbs::Surface& surface = yarn.body->surface;
  std::vector<double> us, vs;
  for (int i = 0; i < across; ++i)
    us.push_back(std::lerp(surface.first_u(), surface.last_u(), 1.0 * i / across));
  for (int i = 0; i <= along; ++i) vs.push_back(std::lerp(piece.begin, piece.end, 1.0 * i / along));
  piece.inner = std::numeric_limits<double>::infinity();
  for (const Vec3& point : nurbs::evaluate_grid(surface, us, vs)) {
    const double distance = (point + yarn.at).head<2>().norm();
    piece.inner = std::min(piece.inner, distance);
    piece.outer = std::max(piece.outer, distance);
  }
  const auto place = [&](double v) {
    return Vec2((nurbs::evaluate(yarn.body->axis, v) + yarn.at).head<2>());
  };
  for (std::size_t i = 1; i < vs.size(); ++i) {
    const Vec2 from = place(vs[i - 1]), to = place(vs[i]);
    piece.turn += std::atan2(cross(from, to), from.dot(to));
  }
}

// Of the part from one plane to the other, in the direction of the yarn.
std::optional<Stretch> piece_of(const yarn::Body& body, int axis, double from, double to) {
  const double way = nurbs::evaluate(body.axis, body.axis.last_parameter())[axis] >=
                             nurbs::evaluate(body.axis, body.axis.first_parameter())[axis]
                         ? 1
                         : -1;
  const std::optional<double> begin = first_crossing(body.axis, axis, way > 0 ? from : to, way);
  const std::optional<double> end = first_crossing(body.axis, axis, way > 0 ? to : from, way);
  if (!begin || !end || !(*begin < *end)) return std::nullopt;
  Stretch piece;
  piece.forward = to - from;
  piece.begin = *begin;
  piece.end = *end;
  piece.length = nurbs::arc_length(body.axis, *begin, *end);
  piece.start = nurbs::evaluate(body.axis, *begin);
  const Vec3 stop = nurbs::evaluate(body.axis, *end);
  yarn::Body part;
  part.surface = nurbs::restricted(body.surface, body.surface.first_u(), body.surface.last_u(), *begin, *end);
  // A plane seals each end; the one through the start sees nothing of it.
  const double sealed = yarn::area_vector(yarn::end_curve(part, true)).dot(stop - piece.start) / 3.0;
  piece.volume = std::abs(nurbs::volume_flux(part.surface, piece.start) + sealed);
  piece.way = (stop - piece.start).head<2>();
  nurbs::extend(piece.box, part.surface, 1e-9 * yarn::bounds(part).diagonal().norm());
  return piece;
}

// The share of a period that these lanes (middle, width) hide.
double hidden_share(const std::vector<std::pair<double, double>>& lanes, double period) {
  std::vector<std::pair<double, double>> parts;  // from, to, within the period
  for (const auto& [middle, width] : lanes) {
    if (width >= period) return 1;
    const double from = middle - 0.5 * width - period * std::floor((middle - 0.5 * width) / period);
    parts.emplace_back(from, std::min(from + width, period));
    if (from + width > period) parts.emplace_back(0.0, from + width - period);
  }
  std::ranges::sort(parts);
  double hidden = 0, reached = 0;
  for (const auto& [from, to] : parts) {
    hidden += std::max(0.0, to - std::max(from, reached));
    reached = std::max(reached, to);
  }
  return hidden / period;
}

// One repeat of a construction as a cloth of its own, with a cell so that it goes on beyond it.
struct Sample {
  Fabric fabric;
  int axis_of_braid = -1;                        // 0: a strip, 2: a tube; -1: none, or a planar one
  bool is_oblique = false;                       // yarns run at angles to x and y
  Vec3 low = Vec3::Zero(), size = Vec3::Zero();  // file units; of a braid one number
};

std::string kind_of(const Item& item) {
  return std::visit(Overloaded{[](const Weave&) { return "weave"; }, [](const Knit&) { return "knit"; },
                               [](const Warpknit&) { return "warpknit"; },
                               [](const Braid&) { return "braid"; }, [](const auto&) { return ""; }},
                    item);
}

// Wales from a guide's first needle space to the farthest that it goes to, in any bar.
int widest_way(const Construction& warpknit) {
  double most = 0;
  std::string system;
  for (std::size_t i = 0; i < warpknit.count(); ++i) {
    if (warpknit.system(i) == system || warpknit.system(i) == "weft") continue;
    system = warpknit.system(i);
    if (const Result<YarnPlan> plan = warpknit.plan(i))
      for (const Vec3& point : plan->points) most = std::max(most, std::abs(point.x()));
  }
  return static_cast<int>(std::ceil(most / warpknit.unit().x())) + 1;
}

// Why there is none, else.
Result<Sample> sample_of(const Fabric& fabric, const Item& item, const Construction& cloth) {
  const Repeat repeat = cloth.repeat();
  const Vec2 unit = cloth.unit();
  Sample sample;
  Fabric& made = sample.fabric;
  made.file = fabric.file;
  made.units = fabric.units;
  made.units_given = fabric.units_given;
  made.tolerance = fabric.tolerance;
  made.threads = fabric.threads;
  made.materials = fabric.materials;
  made.outlines = fabric.outlines;
  made.items = {item};
  Vec3 beyond = Vec3::Zero();  // how far the cloth goes on beyond the sample
  if (auto* const braid = std::get_if<Braid>(&made.items.front()); braid != nullptr && !braid->planar) {
    const int axis = braid->flat ? 0 : 2;
    if (!repeat[static_cast<std::size_t>(axis)])
      return error(Kind::unsupported, "the braid does not repeat along its axis");
    sample.axis_of_braid = axis;
    sample.size[axis] = *repeat[static_cast<std::size_t>(axis)];
    braid->length = sample.size[axis];
  } else {
    if (!repeat[0] || !repeat[1])
      return error(Kind::unsupported, fmt::format("the {} does not repeat", kind_of(item)));
    // Where any translation will do, one pitch.
    for (int axis : {0, 1}) {
      const double along = *repeat[static_cast<std::size_t>(axis)];
      sample.size[axis] = along > 0 ? along : unit[axis];
    }
    const auto counted = [&](int axis) {
      return static_cast<int>(std::lround(sample.size[axis] / unit[axis]));
    };
    if (const auto* const planar = std::get_if<Braid>(&made.items.front())) {
      sample.is_oblique = true;
      // Beside the crossings, and as far beyond as a yarn gets that begins in the repeat.
      sample.low = Vec3(0.137 * sample.size.x(), 0.0731 * sample.size.y(), 0.0);
      const double slope = std::tan(planar->angle * pi / 180);
      beyond = Vec3(sample.size.y() / slope, sample.size.x() * slope, 0.0);
    } else if (auto* const weave = std::get_if<Weave>(&made.items.front())) {
      // Binders lie in gaps that the cloth of the text has.
      const bool is_bound = !weave->binders.empty();
      weave->warp.count = std::max(counted(1), is_bound ? weave->warp.count : 0);
      weave->weft.count = std::max(counted(0), is_bound ? weave->weft.count : 0);
    } else if (auto* const knit = std::get_if<Knit>(&made.items.front())) {
      knit->wales = counted(0);
      knit->courses = counted(1);
    } else if (auto* const warpknit = std::get_if<Warpknit>(&made.items.front())) {
      // Loops may reach as far up as they are held.
      const int courses = counted(1), before = (longest_hold + 1) / courses + 1;
      warpknit->courses = (1 + 2 * before) * courses;
      sample.low.y() = before * sample.size.y();
      const int beside = widest_way(cloth);
      warpknit->wales = (1 + 2 * beside) * counted(0);
      sample.low.x() = beside * sample.size.x();
    }
  }
  Cell cell;
  cell.low = sample.low - beyond;
  cell.high = sample.low + sample.size + beyond;
  cell.periodic = {true, true, false};
  made.cell = cell;
  return sample;
}

double tex_of(double mass, double length) {  // g, mm
  return length > 0 ? 1e6 * mass / length : 0;
}
double cotton_count(double tex) {
  return LinearDensity{1, LinearDensity::Measure::ne}.tex() / tex;
}
constexpr double inch = 25.4;

// Seen from above.
bool runs_in_lanes(const Weave& weave) {
  return weave.draft.form != Draft::Form::leno && !weave.draft.has_pile() && !weave.pile;
}

// Sums over the yarns of a repeat.
class Measuring {
 public:
  Measuring(const Fabric& fabric, const Sample& sample, const Vec2& unit)
      : fabric_(fabric), sample_(sample), unit_(unit), mm_(millimetres_per(fabric.units)) {}

  struct Measured {
    yarn::BodyLabel label;
    int axis = 0;  // along which it goes forward
    Stretch piece;
  };
  // From several threads.
  [[nodiscard]] Measured measured(YarnBuilder::Shaped yarn);
  void add(const Measured& yarn, const Construction& construction, std::size_t index);
  [[nodiscard]] Sheet sheet(const Item& item) const;

 private:
  struct Sum {
    double forward = 0, length = 0, volume = 0, fibres = 0, mass = 0;  // mm, mm3, g
    bool has_mass = true, has_fibres = true;
    int yarns = 0;
  };
  using Sums = std::vector<std::pair<std::string, Sum>>;  // in the order of their first yarns

  [[nodiscard]] bool is_braid() const { return sample_.axis_of_braid >= 0; }
  [[nodiscard]] bool is_tube() const { return sample_.axis_of_braid == 2; }
  [[nodiscard]] int axis_of(const yarn::Body& body) const;
  [[nodiscard]] Stretch stretch_of(const yarn::Body& body, int axis, double at) const;
  [[nodiscard]] Stretch piece_in_repeat(const YarnBuilder::Shaped& yarn, int axis);
  [[nodiscard]] bool is_in_repeat(const Stretch& piece, int axis) const;
  void add_to(Sums& sums, const std::string& name, const Stretch& piece, const yarn::BodyLabel& label,
              const Thread& thread) const;
  // Of the repeat, mm2; of a braid the length, mm.
  [[nodiscard]] double extent() const {
    return is_braid() ? mm_ * sample_.size[sample_.axis_of_braid]
                      : mm_ * mm_ * sample_.size.x() * sample_.size.y();
  }
  [[nodiscard]] double per_m() const { return is_braid() ? 1e3 / extent() : 1e6 / extent(); }
  [[nodiscard]] SystemSheet system_sheet(const Item& item, const std::string& name, const Sum& sum) const;
  [[nodiscard]] ThreadSheet thread_sheet(const std::string& name, const Sum& sum) const;
  void set_braid(const Braid& braid, Sheet& sheet) const;
  void set_planar_braid(Sheet& sheet) const;

  const Fabric& fabric_;
  const Sample& sample_;
  Vec2 unit_;
  double mm_;
  std::mutex mutex_;                                                  // of pieces_
  std::map<std::tuple<std::uint64_t, int, double>, Stretch> pieces_;  // by shape, axis, and where along it
  Sums systems_, threads_;
  std::array<std::vector<std::pair<double, double>>, 2> lanes_;  // of yarns along x, along y
  Box3 box_;
  double inner_ = std::numeric_limits<double>::infinity(), outer_ = 0;
  double turn_ = 0, width_ = 0;  // of braiders, summed: radians a mm (a planar one: to x), and mm
  int braiders_ = 0;
  double lanes_of_braiders_ = 0, lanes_of_axials_ = 0;  // of a planar braid, mm2
};

// The one that it goes forward along.
int Measuring::axis_of(const yarn::Body& body) const {
  if (is_braid()) return sample_.axis_of_braid;
  const Vec3 forward = nurbs::evaluate(body.axis, body.axis.last_parameter()) -
                       nurbs::evaluate(body.axis, body.axis.first_parameter());
  return std::abs(forward.x()) >= std::abs(forward.y()) ? 0 : 1;
}

// Of a body that stands `at` away from its place along the axis. What lies in the cloth by itself, such as a
// tuft, is taken whole.
Stretch Measuring::stretch_of(const yarn::Body& body, int axis, double at) const {
  // Beside a crossing or the middle of a loop, where places tie.
  const double beside = is_braid() ? 0.0 : 0.137 * unit_[axis];
  const double from = sample_.low[axis] + beside - at;
  const double begin = nurbs::evaluate(body.axis, body.axis.first_parameter())[axis],
               end = nurbs::evaluate(body.axis, body.axis.last_parameter())[axis];
  if (is_braid() || std::min(begin, end) <= from)
    if (const auto piece = piece_of(body, axis, from, from + sample_.size[axis])) return *piece;
  Stretch whole;
  whole.length = body.length;
  whole.volume = body.volume;
  whole.start = nurbs::evaluate(body.axis, body.axis.first_parameter());
  nurbs::extend(whole.box, body.surface, 1e-9 * yarn::bounds(body).diagonal().norm());
  return whole;
}

// Of one shape one is measured, wherever it lies across.
Stretch Measuring::piece_in_repeat(const YarnBuilder::Shaped& yarn, int axis) {
  const double at = yarn.at[axis];
  const std::uint64_t shape = yarn.body->shape;
  std::optional<Stretch> piece;
  if (shape > 0) {
    const std::lock_guard lock(mutex_);
    if (const auto known = pieces_.find({shape, axis, at}); known != pieces_.end()) piece = known->second;
  }
  if (!piece) {
    piece = stretch_of(*yarn.body, axis, at);
    const std::lock_guard lock(mutex_);
    if (shape > 0) pieces_.try_emplace({shape, axis, at}, *piece);
  }
  piece->start += yarn.at;
  piece->box.translate(yarn.at);
  if (is_tube()) look_round(yarn, *piece);
  return *piece;
}

Measuring::Measured Measuring::measured(YarnBuilder::Shaped yarn) {
  const int axis = axis_of(*yarn.body);
  Stretch piece = piece_in_repeat(yarn, axis);
  // An oblique yarn is compared with the straight line.
  if (sample_.is_oblique) piece.forward = piece.way.norm();
  return {std::move(yarn.label), axis, piece};
}

// Of yarns that are whole repeats apart one is.
bool Measuring::is_in_repeat(const Stretch& piece, int axis) const {
  if (is_braid()) return true;
  const auto is_within = [&](int k) {
    constexpr double beside = 0.0731;  // of the places where yarns stand
    const double along = piece.start[k] - sample_.low[k] - beside * unit_[k];
    return along >= 0 && along < sample_.size[k];
  };
  return is_within(1 - axis) && (piece.forward > 0 || is_within(axis));
}

void Measuring::add_to(Sums& sums, const std::string& name, const Stretch& piece,
                       const yarn::BodyLabel& label, const Thread& thread) const {
  auto found = std::ranges::find(sums, name, &Sums::value_type::first);
  if (found == sums.end()) found = sums.insert(sums.end(), {name, Sum{}});
  Sum& sum = found->second;
  const double length = mm_ * piece.length, volume = mm_ * mm_ * mm_ * piece.volume;
  const double mass =
      thread.linear_density ? 1e-6 * thread.linear_density->tex() * length : 1e-3 * label.density * volume;
  std::optional<double> fibres;
  if (label.fibre_area > 0)
    fibres = label.fibre_area * mm_ * mm_ * length;
  else if (const std::optional<double> packing = thread.size_packing())
    fibres = *packing * volume;
  ++sum.yarns;
  sum.forward += mm_ * piece.forward;
  sum.length += length;
  sum.volume += volume;
  sum.mass += mass;
  sum.has_mass = sum.has_mass && mass > 0;
  sum.fibres += fibres.value_or(0);
  sum.has_fibres = sum.has_fibres && fibres;
}

void Measuring::add(const Measured& yarn, const Construction& construction, std::size_t index) {
  const auto& [label, axis, piece] = yarn;
  if (!is_in_repeat(piece, axis)) return;
  const Thread& thread = construction.thread(index);
  add_to(systems_, construction.system(index), piece, label, thread);
  add_to(threads_, thread.name, piece, label, thread);
  box_.extend(piece.box);
  if (!is_braid() && !sample_.is_oblique) {
    const double low = piece.box.min()[1 - axis], high = piece.box.max()[1 - axis];
    lanes_[static_cast<std::size_t>(axis)].emplace_back(0.5 * (low + high), high - low);
  }
  if (const auto section = centred_section_of(thread, fabric_.units); sample_.is_oblique && section)
    (label.role == Role::braider ? lanes_of_braiders_ : lanes_of_axials_) +=
        mm_ * mm_ * yarn::nominal_size(*section).width * piece.forward;
  if (sample_.is_oblique && label.role == Role::braider) {
    ++braiders_;
    turn_ += std::atan(std::abs(piece.way.y() / piece.way.x()));
  }
  if (!is_tube()) return;
  inner_ = std::min(inner_, piece.inner);
  outer_ = std::max(outer_, piece.outer);
  if (label.role != Role::braider) return;
  ++braiders_;
  turn_ += std::abs(piece.turn) / (mm_ * piece.forward);
  if (const Result<yarn::Section> section = centred_section_of(thread, fabric_.units))
    width_ += mm_ * yarn::nominal_size(*section).width;
}

SystemSheet Measuring::system_sheet(const Item& item, const std::string& name, const Sum& sum) const {
  SystemSheet system;
  system.name = name;
  if (sum.forward > 0) {
    system.per_mm = is_braid() ? sum.yarns : sum.forward / extent();
    if (is_braid())
      system.take_up = 1 - sum.forward / sum.length;
    else if (std::holds_alternative<Knit>(item) || std::holds_alternative<Warpknit>(item))
      system.yarn_ratio = sum.length / sum.forward;
    else
      system.crimp = sum.length / sum.forward - 1;
  }
  system.length = 1e-3 * sum.length * per_m();
  if (sum.has_mass) system.mass = sum.mass * per_m();
  const double tex = sum.has_mass ? tex_of(sum.mass, sum.length) : 0;
  if (std::holds_alternative<Weave>(item) && tex > 0 && system.per_mm)
    system.cover_factor = inch * *system.per_mm / std::sqrt(cotton_count(tex));
  if (std::holds_alternative<Knit>(item)) {
    const double needles = mm_ * sample_.size.x() / (mm_ * unit_.x());
    system.loop_length = sum.length / (sum.forward > 0 ? sum.yarns * needles : sum.yarns);
    if (tex > 0) system.tightness = std::sqrt(tex) / (0.1 * *system.loop_length);
  }
  if (std::holds_alternative<Warpknit>(item) && name != "weft") {
    constexpr double courses_a_rack = 480;
    system.run_in = courses_a_rack * sum.length * unit_.y() / (sum.yarns * sample_.size.y());
  }
  return system;
}

ThreadSheet Measuring::thread_sheet(const std::string& name, const Sum& sum) const {
  ThreadSheet sheet;
  sheet.name = name;
  sheet.length = 1e-3 * sum.length * per_m();
  if (sum.has_mass) {
    sheet.tex = tex_of(sum.mass, sum.length);
    sheet.mass = sum.mass * per_m();
  }
  if (sum.has_fibres) sheet.fibre_fraction = sum.fibres / sum.volume;
  const Thread* const thread = fabric_.find_thread(name);
  if (thread == nullptr || !thread->twist || thread->twist->turns == 0 || !(sheet.tex > 0)) return sheet;
  const double turns = std::abs(thread->twist->turns);  // a metre
  sheet.twist_factor = turns * std::sqrt(sheet.tex);
  sheet.cotton_twist_factor = 1e-3 * inch * turns / std::sqrt(cotton_count(sheet.tex));
  return sheet;
}

void Measuring::set_planar_braid(Sheet& sheet) const {
  sheet.braid_angle = turn_ / braiders_ * 180 / pi;
  // Of the braiders half go each way.
  const auto open = [&](double lanes) { return std::max(0.0, 1 - lanes / extent()); };
  sheet.cover = 1 - std::pow(open(lanes_of_braiders_ / 2), 2) * open(lanes_of_axials_);
}

void Measuring::set_braid(const Braid& braid, Sheet& sheet) const {
  if (braid.planar) return set_planar_braid(sheet);
  sheet.repeat_y = 0;
  if (braid.flat) return;
  const double radius = mm_ * braid.radius, angle = std::atan(radius * turn_ / braiders_);
  const double filled = std::min(1.0, width_ / (4 * pi * radius * std::cos(angle)));
  sheet.thickness = mm_ * (outer_ - inner_);
  sheet.braid_angle = angle * 180 / pi;
  sheet.cover = filled * (2 - filled);
}

Sheet Measuring::sheet(const Item& item) const {
  Sheet sheet;
  sheet.kind = kind_of(item);
  sheet.thickness = mm_ * box_.sizes().z();
  sheet.repeat_x = is_braid() ? extent() : mm_ * sample_.size.x();
  sheet.repeat_y = mm_ * sample_.size.y();
  double area = extent();  // mm2
  if (const auto* const braid = std::get_if<Braid>(&item)) {
    set_braid(*braid, sheet);
    if (!braid->planar) area *= braid->flat ? mm_ * box_.sizes().y() : 2 * pi * mm_ * braid->radius;
  }
  bool has_mass = true, has_fibres = true;
  double volume = 0, fibres = 0, mass = 0;
  for (const auto& [name, sum] : systems_) {
    volume += sum.volume;
    fibres += sum.fibres;
    mass += sum.mass;
    has_mass = has_mass && sum.has_mass;
    has_fibres = has_fibres && sum.has_fibres;
    sheet.systems.push_back(system_sheet(item, name, sum));
  }
  for (const auto& [name, sum] : threads_) sheet.threads.push_back(thread_sheet(name, sum));
  sheet.yarn_fraction = volume / (area * sheet.thickness);
  if (has_fibres) sheet.fibre_fraction = fibres / (area * sheet.thickness);
  if (has_mass) {
    sheet.mass = 1e6 * mass / area;
    if (is_braid()) sheet.linear_mass = 1e3 * mass / extent();
  }
  if (const auto* const weave = std::get_if<Weave>(&item); weave != nullptr && runs_in_lanes(*weave)) {
    std::array<double, 2> hidden{};
    for (const int axis : {0, 1})
      hidden[static_cast<std::size_t>(axis)] =
          hidden_share(lanes_[static_cast<std::size_t>(axis)], sample_.size[1 - axis]);
    sheet.cover = hidden[0] + hidden[1] - hidden[0] * hidden[1];
  }
  if (std::holds_alternative<Knit>(item) || std::holds_alternative<Warpknit>(item)) {
    sheet.wales_per_mm = 1 / (mm_ * unit_.x());
    sheet.courses_per_mm = 1 / (mm_ * unit_.y());
  }
  return sheet;
}

TextPlace place_of(const Item& item) {
  return std::visit([](const auto& statement) { return statement.place; }, item);
}

// A sample may cost as much as the cloth itself several times, or this many data points.
bool is_worth(const Construction& sample, const Construction& cloth) {
  constexpr std::uint64_t always = 200'000, times = 3;
  return sample.data_points() <= std::max(always, product_of(times, cloth.data_points()));
}

Result<Sheet> sheet_of(const Fabric& fabric, const Item& item, const Construction& cloth,
                       BuildOptions options, int threads) {
  Result<Sample> sample = sample_of(fabric, item, cloth);
  if (!sample) return sample.error();
  options.detail = Detail::yarn;
  options.ends = yarn::EndStyle::none;
  Diagnostics told;  // of the cloth already
  const std::optional<YarnBuilder> builder = YarnBuilder::create(sample->fabric, options, told);
  if (!builder) return error(Kind::geometry, "its repeat cannot be built by itself");
  if (!is_worth(*builder->origin(0).construction, cloth))
    return error(Kind::limit, "its repeat is far larger than the cloth of the text");
  Measuring measuring(sample->fabric, *sample, cloth.unit());
  std::vector<std::optional<Result<Measuring::Measured>>> yarns(builder->count());
  for_each_index(yarns.size(), threads, [&](std::size_t i) {
    Result<YarnBuilder::Shaped> yarn = builder->shape(i);
    yarns[i] = yarn ? Result(measuring.measured(std::move(*yarn))) : yarn.error();
  });
  for (std::size_t i = 0; i < yarns.size(); ++i) {
    if (!*yarns[i]) return yarns[i]->error();
    const YarnBuilder::Origin origin = builder->origin(i);
    measuring.add(**yarns[i], *origin.construction, origin.index);
  }
  Sheet sheet = measuring.sheet(item);
  sheet.place = place_of(item);
  sheet.file = fabric.file;
  sheet.equilibrium = cloth.equilibrium();
  sheet.pile = cloth.pile();
  if (sheet.pile && sheet.pile->ends_per_mm)
    for (const SystemSheet& system : sheet.systems)
      if (system.name == "pile") sheet.pile_ratio = system.length / (1e3 * *sheet.pile->ends_per_mm);
  return sheet;
}

}  // namespace

SheetResult sheets_of(const YarnBuilder& builder, const BuildOptions& options, int threads) {
  SheetResult result;
  for (const auto& [fabric, item, construction] : builder.cloths()) {
    Result<Sheet> sheet = sheet_of(*fabric, *item, *construction, options, threads);
    if (sheet)
      result.sheets.push_back(std::move(*sheet));
    else
      result.missing.push_back(note(Kind::unsupported, fmt::format("no data sheet of this {}: {}",
                                                                   kind_of(*item), sheet.error().text))
                                   .placed(place_of(*item), fabric->file));
  }
  return result;
}

}  // namespace selvage::fabric
