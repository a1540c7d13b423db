#include "braid/planar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "braid/fit.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

constexpr double most_planar_yarns = 1e6;

// A part of a braider's endless way, in steps.
struct Way {
  Braider braider;
  double from = 0, to = 0;
};

class PlanarBraid : public Construction {
 public:
  PlanarBraid(const Fabric& fabric, const Braid& braid, const Thread& thread, const Thread* axial,
              const BraidShape& shape, int points)
      : fabric_(fabric), braid_(braid), thread_(thread), axial_(axial), shape_(shape), points_(points) {
    const double half = 0.5 * shape.column * shape.carriers;
    Box3 cloth(Vec3(0.0, -half, 0.0), Vec3(braid.length, half, 0.0));
    if (fabric.cell) {
      cloth.extend(fabric.cell->shape().bounds());
      // Two steps of each braider's way, so that what its ends do to it is over before the cell.
      const Vec3 beyond(2.0 * shape.step, 2.0 * shape.column, 0.0);
      cloth = Box3(cloth.min() - beyond, cloth.max() + beyond);
    }
    from_ = cloth.min().x() / shape.step - 0.5;
    to_ = cloth.max().x() / shape.step - 0.5;
    low_ = column_of(cloth.min().y());
    high_ = column_of(cloth.max().y());
  }

  // About how many yarns there are, before they are listed.
  [[nodiscard]] double extent() const { return (high_ - low_) + (to_ - from_); }

  [[nodiscard]] bool has_braiders() const { return !ways_.empty(); }

  void list_yarns() {
    for (const int direction : {1, -1}) {
      const double first = direction > 0 ? low_ - to_ : low_ + from_,
                   last = direction > 0 ? high_ - from_ : high_ + to_;
      for (auto start = 2 * static_cast<std::int64_t>(std::ceil(0.5 * first));
           static_cast<double>(start) <= last; start += 2)
        add_way({start, direction});
    }
    if (axial_ == nullptr) return;
    const auto n = static_cast<double>(shape_.carriers);
    for (auto block = static_cast<std::int64_t>(std::floor(low_ / n));
         static_cast<double>(block) * n <= high_; ++block)
      for (const std::int64_t run : axial_runs()) {
        const double column = run_of(shape_, run).middle() + static_cast<double>(block) * n;
        if (column > low_ && column < high_) axial_columns_.push_back(column);
      }
  }

  [[nodiscard]] std::size_t count() const override { return ways_.size() + axial_columns_.size(); }
  [[nodiscard]] Vec2 unit() const override { return Vec2::Zero(); }
  [[nodiscard]] std::string system(std::size_t index) const override {
    return index < ways_.size() ? "braider" : "axial";
  }
  [[nodiscard]] std::string name(std::size_t index) const override {
    return index < ways_.size() ? fmt::format("braider_{}", index + 1)
                                : fmt::format("axial_{}", index - ways_.size() + 1);
  }
  [[nodiscard]] const Thread& thread(std::size_t index) const override {
    return index < ways_.size() ? thread_ : *axial_;
  }
  [[nodiscard]] std::uint64_t data_points() const override {
    std::uint64_t all = 2 * axial_columns_.size();
    for (const Way& way : ways_) all += points_of(way);
    return all;
  }
  [[nodiscard]] std::uint64_t longest() const override {
    std::uint64_t most = 2;
    for (const Way& way : ways_) most = std::max(most, points_of(way));
    return most;
  }

  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override {
    const bool is_braider = index < ways_.size();
    Result<YarnPlan> plan = start_plan(fabric_, thread(index), name(index),
                                       is_braider ? Role::braider : Role::axial, braid_.place);
    if (!plan) return plan;
    plan->spec.guide = yarn::FrameGuide::with_up(Vec3::UnitZ());
    if (is_braider) {
      place_braider(*plan, ways_[index]);
      return plan;
    }
    for (const double t : {from_, to_})
      plan->points.emplace_back((t + 0.5) * shape_.step,
                                shape_.level_place(axial_columns_[index - ways_.size()]), 0.0);
    if (Status made = interpolate(*plan, yarn::PathForm::chord, Vec3::UnitX(), Vec3::UnitX()); !made)
      return made.error();
    return plan;
  }

  // Who is on top depends on the column alone, as in a tube; along y the pattern and the axial yarns repeat.
  [[nodiscard]] Repeat repeat() const override {
    const std::int64_t period = std::max<std::int64_t>(std::int64_t{shape_.over} + shape_.under, 1);
    const std::int64_t columns = period % 2 == 0 ? period : 2 * period, runs = 2 * columns / period;
    const std::vector<std::int64_t> axials = axial_runs();
    const std::set<std::int64_t> taken(axials.begin(), axials.end());
    const std::int64_t blocks =
        std::max<std::int64_t>(shape_.carriers / columns, 1);  // whole, as was checked
    const std::int64_t shift = smallest_repeat(blocks, runs, [&](long long block, long long run) {
      return taken.contains(block % blocks * runs + run);
    });
    return {2.0 * shape_.step, static_cast<double>(shift * columns) * shape_.column, std::nullopt};
  }

 private:
  [[nodiscard]] double column_of(double y) const { return y / shape_.column + 0.5 * (shape_.carriers - 1); }
  [[nodiscard]] std::uint64_t points_of(const Way& way) const {
    return static_cast<std::uint64_t>((way.to - way.from) * points_) + 3;
  }
  // Of the first N columns, those runs that have an axial yarn.
  [[nodiscard]] std::vector<std::int64_t> axial_runs() const {
    std::vector<std::int64_t> runs;
    for (std::int64_t i = 0; i < braid_.axial_count; ++i)
      runs.push_back(i * run_count(shape_) / braid_.axial_count);
    return runs;
  }

  // What the cloth leaves of a braider's way: at least a step, or it is left out.
  void add_way(const Braider& braider) {
    const auto start = static_cast<double>(braider.start);
    const double enters = braider.direction > 0 ? low_ - start : start - high_,
                 leaves = braider.direction > 0 ? high_ - start : start - low_;
    const Way way{braider, std::max(enters, from_), std::min(leaves, to_)};
    if (way.to - way.from >= 1.0) ways_.push_back(way);
  }

  void place_braider(YarnPlan& plan, const Way& way) const {
    const double length = way.to - way.from, room = 0.25 / points_;
    std::vector<double> parameters;
    Vec3 last = Vec3::Zero(), first = Vec3::Zero();
    const auto add = [&](double t) {
      const BraidPoint point = braid_point(shape_, way.braider, t);
      plan.points.push_back(point.position);
      parameters.push_back((t - way.from) / length);
      last = point.derivative * length;
    };
    add(way.from);
    first = last;
    // Crossings and the middles between them are among the points.
    for (auto k = static_cast<std::int64_t>(std::ceil((way.from + room) * points_));
         static_cast<double>(k) / points_ < way.to - room; ++k)
      add(static_cast<double>(k) / points_);
    add(way.to);
    parameters.back() = 1.0;
    plan.line.curve = nurbs::interpolate(plan.points, parameters, first, last);
    plan.line.parameters = std::move(parameters);
  }

  const Fabric& fabric_;
  const Braid& braid_;
  const Thread& thread_;
  const Thread* axial_;
  BraidShape shape_;
  int points_;                 // data points a step
  double from_ = 0, to_ = 0;   // steps along x, as braid_point counts them
  double low_ = 0, high_ = 0;  // columns across
  std::vector<Way> ways_;
  std::vector<double> axial_columns_;
};

}  // namespace

Result<std::unique_ptr<Construction>> make_planar_braid(const Fabric& fabric, const Braid& braid,
                                                        const Thread& thread, const Thread* axial,
                                                        const BraidShape& shape, int points) {
  auto made = std::make_unique<PlanarBraid>(fabric, braid, thread, axial, shape, points);
  if (!(made->extent() < most_planar_yarns))
    return error(Kind::limit,
                 fmt::format("this braid, with its cell, has about {:.2g} yarns, more than {:.0g}",
                             made->extent(), most_planar_yarns))
        .placed(braid.place);
  made->list_yarns();
  if (!made->has_braiders())
    return error(
               Kind::geometry,
               fmt::format("this braid is shorter than the way from one crossing to the next: its length has "
                           "to be at least {:.4g} {}",
                           1.001 * shape.step, name_of(fabric.units)))
        .placed(braid.place);
  return std::unique_ptr<Construction>(std::move(made));
}

}  // namespace selvage::fabric
