#include "knit/knit_mend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "fabric/clearance.h"
#include "yarn/outline.h"

namespace selvage::fabric {

namespace {

constexpr int range_wales = 2;

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

// The derivative at an end of a course that goes on as copies of its outermost points.
Vec3 onward_derivative(const std::vector<Vec3>& points, const std::vector<double>& parameters, bool last,
                       nurbs::Parameterization how, const Onward& onward) {
  const std::size_t begin = last ? points.size() - 1 - onward.points : 0, end = begin + onward.points;
  const auto at = [&](std::size_t i) { return points.begin() + static_cast<std::ptrdiff_t>(i); };
  const nurbs::Curve curve = periodic_course({at(begin), at(end + 1)}, onward.period, how);
  const double scale =
      (curve.last_parameter() - curve.first_parameter()) / (parameters[end] - parameters[begin]);
  return scale * nurbs::evaluate_jet(curve, curve.first_parameter()).d1;
}

// From units of r and half thicknesses to lengths, and back.
std::vector<Vec3> scaled(std::vector<Vec3> points, const Vec3& by) {
  for (Vec3& point : points) point = point.cwiseProduct(by);
  return points;
}

// How far the yarn reaches in space that is scaled so that its section is as wide as thick: the support of
// the section, which the cloth's normal holds upright, with half of the gap.
class Reach {
 public:
  explicit Reach(const KnitYarn& yarn)
      : scale_(yarn.half.x(), yarn.half.x(), yarn.half.y()), gap_(yarn.gap), turns_(yarn.turns) {
    if (!std::holds_alternative<yarn::Circle>(yarn.section) &&
        !std::holds_alternative<yarn::Ellipse>(yarn.section))
      outline_ = outline_polygon(yarn.section, looks);
    half_ = yarn.half;
    const bool is_round = half_.x() == half_.y() && std::holds_alternative<yarn::Circle>(yarn.section);
    if (!is_round) gap_ += flat_share * half_.minCoeff();
    for (const Vec2& p : outline_) widest_ = std::max(widest_, p.norm());
    if (outline_.empty()) widest_ = half_.maxCoeff();
  }

  [[nodiscard]] double operator()(const Vec3& tangent, const Vec3& direction) const {
    const Vec3 along = tangent.cwiseProduct(scale_).normalized();
    const Vec3 normal = direction.cwiseQuotient(scale_);
    return support(along, normal) + 0.5 * gap_ * normal.norm();
  }

 private:
  static constexpr int looks = 16;  // in a piece of the outline
  // Surfaces of flat yarns are nearest beside the places where the centre lines are.
  static constexpr double flat_share = 0.03;  // of half the thickness, added to the gap

  [[nodiscard]] double support(const Vec3& along, const Vec3& normal) const {
    const Vec3 up = (Vec3::UnitZ() - along.z() * along).normalized();
    const Vec2 in_section(normal.dot(up.cross(along)), normal.dot(up));
    if (turns_) return widest_ * in_section.norm();
    // At least the ellipse of its size: the sharp tips of a bent yarn reach beyond the plane that parts the
    // two where their centre lines are nearest.
    double most = in_section.cwiseProduct(half_).norm();
    // The polygon's corners lie on the outline, whose sides bulge by less than this.
    constexpr double bulge = 1.002;
    for (const Vec2& p : outline_) most = std::max(most, bulge * p.dot(in_section));
    return most;
  }

  Vec3 scale_;
  double gap_;
  bool turns_;
  std::vector<Vec2> outline_;
  Vec2 half_;
  double widest_ = 0;
};

}  // namespace

nurbs::Parameterization method_of(const Knit& knit) {
  const bool is_relaxed = knit.shape == Knit::Shape::relaxed;
  return knit.method.value_or(is_relaxed ? nurbs::Parameterization::uniform : nurbs::Parameterization::chord);
}

yarn::CentreLine course_line(const std::vector<Vec3>& points, nurbs::Parameterization how,
                             const Onward& onward) {
  yarn::CentreLine line;
  line.parameters = nurbs::parameters(points, how);
  const auto derivative = [&](bool last) {
    return onward.points > 0 ? onward_derivative(points, line.parameters, last, how, onward)
                             : mirrored_derivative(points, line.parameters, last, how);
  };
  line.curve = nurbs::interpolate(points, line.parameters, derivative(false), derivative(true));
  return line;
}

nurbs::Curve periodic_course(const std::vector<Vec3>& points, const Vec3& period,
                             nurbs::Parameterization how) {
  const std::vector<double> t = nurbs::parameters(points, how);
  nurbs::Curve curve;
  curve.degree = 3;
  curve.knots = nurbs::clamped_knots(t);
  // What the line goes forward is a straight line of its own, whose control points lie at the means of knots.
  const auto forward = [&](double parameter) { return parameter * period.transpose(); };
  Eigen::MatrixXd data(static_cast<Eigen::Index>(points.size()) - 1, 3);
  for (Eigen::Index i = 0; i < data.rows(); ++i)
    data.row(i) = points[static_cast<std::size_t>(i)].transpose() - forward(t[static_cast<std::size_t>(i)]);
  const Eigen::MatrixXd control = nurbs::interpolate_periodic(t, data);
  for (Eigen::Index i = 0; i < control.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double mean = (curve.knots[k + 1] + curve.knots[k + 2] + curve.knots[k + 3]) / 3.0;
    curve.points.emplace_back((control.row(i) + forward(mean)).transpose());
  }
  return curve;
}

LoopTies::LoopTies(long long first, long long last, long long repeat, int border, int range, bool as_one)
    : first_(first), count_(last - first + 1), reduced_(count_), repeat_(repeat), border_(border) {
  is_periodic_ = as_one && repeat == 1;
  if (is_periodic_) border_ = range = 0;
  const long long inner = count_ - 2LL * border_, least = repeat + range;
  tied_ = inner >= least;
  if (tied_) reduced_ = 2LL * border_ + least + (inner - least) % repeat;
}

long long LoopTies::of_offset(long long offset, long long count) const {
  if (!tied_ || offset < border_) return offset;
  if (offset >= count - border_) return reduced_ - (count - offset);
  return border_ + (offset - border_) % repeat_;
}

namespace {

// Wales are solved as one only in a cloth wide enough to have an inside: a narrow one stays symmetric.
std::vector<LoopTies> ties_of(const KnitField& field, bool as_one, bool also_narrow = false) {
  const int hold = field.chart.longest_hold();
  const long long wales = field.last_wale - field.first_wale + 1;
  const bool is_wide = wales > 2 * border_wales + range_wales;
  return {LoopTies(field.first_course, field.last_course, field.chart.repeat_of_courses(),
                   border_courses(field.chart), hold + 2, as_one),
          LoopTies(field.first_wale, field.last_wale, field.chart.repeat_of_wales(), border_wales,
                   range_wales, as_one && (is_wide || also_narrow))};
}

// The class that each one is the mirror image of, if every course is its own image; else nothing.
std::vector<int> images_of(const MendProblem& problem) {
  constexpr double same = 1e-9;
  std::vector<int> images(problem.freedom.size(), -1);
  for (const MendLine& line : problem.lines) {
    const double both = line.points.front().x() + line.points.back().x();
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const std::size_t j = line.points.size() - 1 - i;
      const Vec3 image(both - line.points[j].x(), line.points[j].y(), line.points[j].z());
      int& known = images[static_cast<std::size_t>(line.classes[i])];
      if ((image - line.points[i]).norm() > same || (known >= 0 && known != line.classes[j])) return {};
      known = line.classes[j];
    }
  }
  return images;
}

}  // namespace

long long KnitMoves::loops_solved(const KnitField& field) {
  const std::vector<LoopTies> ties = ties_of(field, false);
  return ties[0].reduced_count() * ties[1].reduced_count() * field.ends;
}

KnitMoves::KnitMoves(const KnitField& field, const KnitYarn& yarn)
    : ties_(ties_of(field, true, yarn.relaxes)) {
  solve(field, yarn);
  if (yarn.relaxes) {  // loops with room are symmetric
    const Mending turned = mending_;
    solve(field, yarn, MendProblem().max_steps, Start::mirrored);
    const bool is_worse = !mending_.is_relaxed || mending_.bent > turned.bent;
    if (is_worse && turned.is_solved() && (turned.is_relaxed || !mending_.is_solved())) mending_ = turned;
  }
  const bool was_periodic = ties_[0].is_periodic() || ties_[1].is_periodic();
  if (mending_.is_solved() || !was_periodic) return;
  // At its edges and from loop to loop the cloth may give way where a single loop cannot.
  ties_ = ties_of(field, false);
  KnitYarn rigid = yarn;
  rigid.relaxes = false;
  solve(field, rigid);
}

bool KnitMoves::come_apart(const KnitField& field, const KnitYarn& yarn) {
  constexpr long long wide = 2 * border_wales + range_wales + 1;
  constexpr int few_steps = 40;
  KnitField endless = field;
  if (field.chart.journeys() == nullptr) {
    endless.last_course =
        endless.first_course + field.chart.repeat_of_courses() + border_courses(field.chart);
    endless.last_wale = endless.first_wale + std::max(wide, field.chart.repeat_of_wales()) - 1;
  }
  KnitMoves moves;
  moves.ties_ = ties_of(endless, true);
  KnitYarn rigid = yarn;
  rigid.relaxes = false;
  moves.solve(endless, rigid, few_steps);
  return moves.mending_.is_solved();
}

void KnitMoves::solve(const KnitField& field, const KnitYarn& yarn, int max_steps, Start start) {
  KnitField reduced = field;
  reduced.last_course = field.first_course + ties_[0].reduced_count() - 1;
  reduced.last_wale = field.first_wale + ties_[1].reduced_count() - 1;
  const long long courses = ties_[0].reduced_count(), wales = ties_[1].reduced_count();
  ends_ = field.ends;
  const auto loop = [&](long long line, long long w) {
    return static_cast<std::size_t>(line * (wales + 1) + w);
  };
  constexpr auto none = static_cast<std::size_t>(-1);
  first_class_.assign(static_cast<std::size_t>(courses * ends_ * (wales + 1)), none);
  const Vec3 scale(1, 1, yarn.half.y() / yarn.half.x());
  const Reach reach(yarn);
  double radius = 1;  // the farthest that the yarn reaches, about
  for (const Vec3& direction : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitZ())})
    radius = std::max(radius, reach(Vec3::UnitY(), direction));
  MendProblem problem;
  problem.measure = scale;
  problem.max_steps = max_steps;
  problem.relaxes = yarn.relaxes;
  if (ties_[0].is_periodic()) problem.repeat = {0, field.shape.course * field.chart.height(1), 0};
  const bool goes_on = ties_[1].is_periodic();
  for (long long l = 0; l < courses * ends_; ++l) {
    const long long c = l / ends_;
    const int end = static_cast<int>(l % ends_);
    MendLine line;
    if (goes_on) line.period = {field.shape.wale, 0, 0};
    const long long course = field.first_course + c;
    const RowExtent extent = extent_of(reduced, course);
    if (extent.first > extent.last) continue;
    for (long long w = extent.first - field.first_wale; w <= wales; ++w) {
      if (w > extent.last - field.first_wale) w = wales;
      const std::size_t first = line.points.size();
      const long long wale = w < wales ? field.first_wale + w : extent.last + 1;
      if (w < wales)
        add_stitch_points(reduced, course, wale, line.points, end);
      else
        line.points.push_back(last_sinker_point(reduced, course, end));
      const std::size_t own = loop(l, w);
      const std::size_t like =
          loop(ties_[0].of_reduced(c) * ends_ + end, w < wales ? ties_[1].of_reduced(w) : end_wale());
      if (like == own) {
        first_class_[own] = problem.freedom.size();
        problem.freedom.resize(problem.freedom.size() + line.points.size() - first, Vec3::Ones());
        // The ends lie in mirror planes.
        if (first == 0 || w == wales) problem.freedom[first_class_[own]].x() = 0;
      }
      for (std::size_t i = first; i < line.points.size(); ++i) {
        line.classes.push_back(static_cast<int>(first_class_[like] + i - first));
        line.points[i] += Vec3(field.shape.wale * static_cast<double>(wale),
                               field.shape.course * field.chart.height(course), 0);
      }
    }
    line.curve = [scale, period = line.period, how = yarn.how, goes_on](const std::vector<Vec3>& points) {
      const std::vector<Vec3> true_points = scaled(points, scale);
      nurbs::Curve curve =
          goes_on ? periodic_course(true_points, period, how) : course_line(true_points, how).curve;
      curve.points = scaled(std::move(curve.points), scale.cwiseInverse());
      return curve;
    };
    const double least = yarn.relaxes ? least_relaxed_share : least_share;
    line.shares = [scale, how = yarn.how, goes_on, least](const std::vector<Vec3>& points) {
      const std::vector<double> t = nurbs::parameters(scaled(points, scale), how);
      return goes_on ? periodic_shares(t, least) : interpolation_shares(t, least);
    };
    line.keeps_length = yarn.keeps_length;
    line.radius = radius;
    line.reach = reach;
    problem.lines.push_back(std::move(line));
  }
  if (goes_on && start == Start::turned) {
    // Symmetric loops between their like have no room: they turn about the wale, one leg to the face.
    constexpr double turn = 0.5;
    problem.start.assign(problem.freedom.size(), Vec3::Zero());
    for (const MendLine& line : problem.lines)
      for (std::size_t i = 0; i < line.points.size(); ++i)
        problem.start[static_cast<std::size_t>(line.classes[i])].z() =
            turn * std::sin(2.0 * std::numbers::pi / field.shape.wale * line.points[i].x());
  } else {
    problem.images = images_of(problem);
  }
  mending_ = mend(problem);
}

long long KnitMoves::end_wale() const {
  return ties_[1].is_periodic() ? 0 : ties_[1].reduced_count();
}

std::size_t KnitMoves::loop_index(long long course, long long wale, int end) const {
  const bool is_end = wale > ties_[1].last();
  return static_cast<std::size_t>((ties_[0].of(course) * ends_ + end) * (ties_[1].reduced_count() + 1) +
                                  (is_end ? end_wale() : ties_[1].of(wale)));
}

void KnitMoves::apply(long long course, long long wale, std::vector<Vec3>& points, std::size_t first,
                      int end) const {
  if (mending_.moves.empty()) return;
  const std::size_t start = first_class_[loop_index(course, wale, end)];
  for (std::size_t i = first; i < points.size(); ++i) points[i] += mending_.moves[start + i - first];
}

}  // namespace selvage::fabric
