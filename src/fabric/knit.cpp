#include "fabric/knit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fabric/knit_chart.h"
#include "fabric/knit_loop.h"
#include "fabric/yarn_spec.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

// With a unit cell the cloth goes on beyond it. The influence of a spline's end falls by 2 + sqrt(3) from
// data point to data point: four wales of eight points make the loops inside periodic to the last bits.
constexpr long long margin_wales = 4;

nurbs::Parameterization parameterization_of(Knit::Method method) {
  switch (method) {
    case Knit::Method::uniform:
      return nurbs::Parameterization::uniform;
    case Knit::Method::centripetal:
      return nurbs::Parameterization::centripetal;
    case Knit::Method::chord:
      break;
  }
  return nurbs::Parameterization::chord;
}

// The derivative at the start of a course that goes on as its own mirror image in the plane x = const. It
// lies along x, so that the end face lies in that plane; and loops that are mirror images of themselves have
// the same shape at the ends as in the middle of the cloth.
Vec3 mirrored_derivative(const std::vector<Vec3>& points, const std::vector<double>& parameters, bool last,
                         nurbs::Parameterization how) {
  const std::size_t count = std::min<std::size_t>(points.size() - 1, 28);  // 28: to 1e-16
  std::vector<Vec3> both(2 * count + 1);
  for (std::size_t i = 0; i <= count; ++i) {
    const Vec3& point = points[last ? points.size() - 1 - i : i];
    const double plane = last ? points.back().x() : points.front().x();
    const Vec3 image(2 * plane - point.x(), point.y(), point.z());
    both[count - i] = last ? point : image;
    both[count + i] = last ? image : point;
  }
  const std::vector<double> t = nurbs::parameters(both, how);
  const nurbs::Curve curve = nurbs::interpolate(both, t, nurbs::end_derivative(both, t, false),
                                                nurbs::end_derivative(both, t, true));
  const std::size_t end = parameters.size() - 1;
  const double step = last ? parameters[end] - parameters[end - 1] : parameters[1] - parameters[0];
  const double scale = (t[count + 1] - t[count]) / step;
  return {scale * nurbs::evaluate_jet(curve, t[count]).d1.x(), 0, 0};
}

class KnitConstruction final : public Construction {
 public:
  KnitConstruction(const Fabric& fabric, const Knit& knit, const Thread& thread, KnitField field, Vec2 half)
      : fabric_(fabric), knit_(knit), thread_(thread), field_(std::move(field)), half_(std::move(half)) {}

  [[nodiscard]] std::size_t count() const override {
    return static_cast<std::size_t>(field_.last_course - field_.first_course + 1);
  }
  [[nodiscard]] std::string name(std::size_t index) const override {
    return fmt::format("course_{}", course(index) + 1);
  }
  [[nodiscard]] const Thread& thread(std::size_t /*index*/) const override { return thread_; }
  [[nodiscard]] std::uint64_t data_points() const override {
    return count() * longest();  // below 2^64: counts are below 2^31
  }
  [[nodiscard]] std::uint64_t longest() const override {
    constexpr std::uint64_t points_a_loop = 8;
    return points_a_loop * wales() + 1;
  }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;

 private:
  [[nodiscard]] long long course(std::size_t index) const {
    return field_.first_course + static_cast<long long>(index);
  }
  [[nodiscard]] std::uint64_t wales() const {
    return static_cast<std::uint64_t>(field_.last_wale - field_.first_wale + 1);
  }

  const Fabric& fabric_;
  const Knit& knit_;
  const Thread& thread_;
  KnitField field_;
  Vec2 half_;  // of the section: r across, and r through the thickness
};

Result<YarnPlan> KnitConstruction::plan(std::size_t index) const {
  Result<YarnPlan> plan = start_plan(fabric_, thread_, name(index), Role::course, knit_.place);
  if (!plan) return plan;
  const double r = half_.x();
  const auto at_course = static_cast<double>(course(index));
  std::vector<Vec3>& points = plan->points;
  points.reserve(8 * wales() + 1);
  const auto place_from = [&](std::size_t first, long long wale) {
    for (std::size_t i = first; i < points.size(); ++i) {
      const Vec3 base = points[i];
      points[i] = {std::fma(static_cast<double>(wale), wale_spacing * r, base.x() * r),
                   std::fma(at_course, course_spacing * r, base.y() * r), base.z() * half_.y()};
    }
  };
  for (long long wale = field_.first_wale; wale <= field_.last_wale; ++wale) {
    const std::size_t first = points.size();
    add_stitch_points(field_, course(index), wale, points);
    place_from(first, wale);
  }
  points.push_back(last_sinker_point(field_, course(index)));
  place_from(points.size() - 1, field_.last_wale + 1);
  plan->spec.guide = yarn::FrameGuide::with_up(Vec3::UnitZ());
  const nurbs::Parameterization how = parameterization_of(knit_.method.value_or(Knit::Method::chord));
  yarn::CentreLine& line = plan->line;
  line.parameters = nurbs::parameters(points, how);
  line.curve =
      nurbs::interpolate(points, line.parameters, mirrored_derivative(points, line.parameters, false, how),
                         mirrored_derivative(points, line.parameters, true, how));
  return plan;
}

}  // namespace

Result<std::unique_ptr<Construction>> make_knit(const Fabric& fabric, const Knit& knit, Diagnostics&) {
  const auto failed = [](Message message, TextPlace place) {
    if (message.place.line == 0) message.place = place;
    return message;
  };
  Result<StitchChart> chart = StitchChart::of(knit);
  if (!chart) return failed(chart.error(), knit.place);
  const Thread* thread = fabric.find_thread(knit.thread);
  if (thread == nullptr)
    return failed(error(Kind::geometry, fmt::format("there is no thread '{}'", knit.thread)),
                  knit.thread_place);
  Result<yarn::Section> section = section_of(*thread, fabric.units, false);
  if (!section) return failed(section.error(), knit.thread_place);
  const yarn::SectionSize size = yarn::nominal_size(*section);
  const long long beside = fabric.cell ? margin_wales : 0;
  // The loops of courses below reach up into the cell as far as they are held, and one course further.
  const long long beyond = fabric.cell ? chart->longest_hold() + 2 : 0;
  return std::unique_ptr<Construction>(std::make_unique<KnitConstruction>(
      fabric, knit, *thread,
      KnitField{std::move(*chart), -beyond, knit.courses - 1 + beyond, -beside, knit.wales - 1 + beside},
      Vec2(size.width / 2, size.height / 2)));
}

}  // namespace selvage::fabric
