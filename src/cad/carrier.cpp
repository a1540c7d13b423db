#include "cad/carrier.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "cad/bernstein.h"
#include "cad/model.h"
#include "nurbs/basis.h"
#include "nurbs/sweep.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

// Lengths as shares of `size`, from `middle`, so that the equation's terms are of one magnitude.
struct Frame {
  Vec3 middle = Vec3::Zero();
  double size = 1;
  [[nodiscard]] Vec3 inside(const Vec3& p) const { return (p - middle) / size; }
};

// Of a term of the equation, at a point.
struct Term {
  double value;
  Vec3 gradient;
};

// 1, x, y, z, the six products of two, and of a cyclide |p|^2 times x, y, z and |p|^2.
std::vector<Term> terms_at(const Vec3& p, bool is_cyclide) {
  std::vector<Term> terms = {{1, Vec3::Zero()}};
  for (int i = 0; i < 3; ++i) terms.push_back({p[i], Vec3::Unit(i)});
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) terms.push_back({p[i] * p[j], p[j] * Vec3::Unit(i) + p[i] * Vec3::Unit(j)});
  if (!is_cyclide) return terms;
  const double square = p.squaredNorm();
  for (int i = 0; i < 3; ++i) terms.push_back({square * p[i], 2 * p[i] * p + square * Vec3::Unit(i)});
  terms.push_back({square * square, 4 * square * p});
  return terms;
}

class Carrier : public Implicit {
 public:
  Carrier(Frame frame, bool is_cyclide, const std::vector<Vec3>& points)
      : frame_(std::move(frame)), is_cyclide_(is_cyclide) {
    const auto columns = static_cast<Eigen::Index>(terms_at(Vec3::Zero(), is_cyclide).size());
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), columns);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::vector<Term> terms = terms_at(frame_.inside(points[k]), is_cyclide);
      for (Eigen::Index i = 0; i < columns; ++i)
        rows(static_cast<Eigen::Index>(k), i) = terms[static_cast<std::size_t>(i)].value;
    }
    const Eigen::BDCSVD<Eigen::MatrixXd> parts(rows, Eigen::ComputeThinV);
    coefficients_ = parts.matrixV().col(columns - 1);
    rest_ = parts.singularValues()[columns - 1] / std::sqrt(static_cast<double>(points.size()));
  }
  [[nodiscard]] int degree() const override { return is_cyclide_ ? 4 : 2; }
  [[nodiscard]] double value(const Vec3& p) const override {
    double sum = 0;
    Eigen::Index i = 0;
    for (const Term& term : terms_at(frame_.inside(p), is_cyclide_)) sum += coefficients_[i++] * term.value;
    return sum;
  }
  [[nodiscard]] Vec3 gradient(const Vec3& p) const override {
    Vec3 sum = Vec3::Zero();
    Eigen::Index i = 0;
    for (const Term& term : terms_at(frame_.inside(p), is_cyclide_))
      sum += coefficients_[i++] * term.gradient;
    return sum / frame_.size;
  }
  // What it leaves of the points, root mean square.
  [[nodiscard]] double rest() const { return rest_; }
  // Within the frame no second derivative of the equation is larger, in units of the frame's size.
  [[nodiscard]] double largest_curvature() const {
    return (is_cyclide_ ? 40.0 : 4.0) * coefficients_.cwiseAbs().maxCoeff();
  }
  [[nodiscard]] double size() const { return frame_.size; }

 private:
  Frame frame_;
  bool is_cyclide_;
  Eigen::VectorXd coefficients_;
  double rest_ = 0;
};

std::vector<double> sites_of(const std::vector<double>& breaks, int each) {
  std::vector<double> sites;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int i = 0; i < each; ++i) sites.push_back(std::lerp(breaks[k], breaks[k + 1], (i + 0.5) / each));
  return sites;
}

std::vector<double> breaks_within(const std::vector<double>& knots, int degree, double low, double high) {
  std::vector<double> out = {low};
  for (const double knot : nurbs::breakpoints(knots, degree))
    if (knot > low && knot < high) out.push_back(knot);
  out.push_back(high);
  return out;
}

// A surface's part, and the places between its knots.
struct Piecewise {
  const Surface& surface;
  std::vector<double> us, vs;

  Piecewise(const Surface& of, const Range& range)
      : surface(of),
        us(breaks_within(of.knots_u, of.degree_u, range.u0, range.u1)),
        vs(breaks_within(of.knots_v, of.degree_v, range.v0, range.v1)) {}
  [[nodiscard]] std::size_t count() const { return (us.size() - 1) * (vs.size() - 1); }
};

// Bounds the distance of a surface's part from the carrier; none where it may be more than `enough`.
class Certifier {
 public:
  Certifier(const Carrier& carrier, double enough) : carrier_(carrier), enough_(enough) {}

  std::optional<double> certify(const Piecewise& of) {
    left_ = 200 + 2 * of.count();
    double worst = 0;
    for (std::size_t j = 0; j + 1 < of.vs.size(); ++j)
      for (std::size_t i = 0; i + 1 < of.us.size(); ++i) {
        const auto bound = look_at(of.surface, {of.us[i], of.us[i + 1], of.vs[j], of.vs[j + 1]});
        if (!bound) return std::nullopt;
        worst = std::max(worst, *bound);
      }
    return worst;
  }

 private:
  std::optional<double> look_at(const Surface& surface, const Range& range) {
    if (left_ == 0) return std::nullopt;
    --left_;
    const auto [value, slope] = implicit_bounds(surface, range, carrier_);
    if (!(value < 1)) return std::nullopt;
    // At the distance d the gradient may be less by d times the largest second derivative.
    const double d = value > 0 && slope > 0 ? 2 * value / slope : slope > 0 ? 0.0 : enough_ + 1;
    const double loss = d / (carrier_.size() * carrier_.size()) * carrier_.largest_curvature();
    if (d <= enough_ && loss <= 0.5 * slope) return d;
    // Next to the point of a cone the gradient vanishes: a small piece is near to the next one.
    const double middle_u = 0.5 * (range.u0 + range.u1), middle_v = 0.5 * (range.v0 + range.v1);
    const Vec3 middle = nurbs::evaluate(surface, middle_u, middle_v);
    const double along_u = (middle - nurbs::evaluate(surface, range.u0, middle_v)).norm(),
                 along_v = (middle - nurbs::evaluate(surface, middle_u, range.v0)).norm();
    if (along_u + along_v <= 0.25 * enough_) {
      const Box3 box = piece_bounds(surface, range);
      if (!box.isEmpty() && box.diagonal().norm() <= enough_) return box.diagonal().norm();
    }
    const double u = middle_u, v = middle_v;
    const bool in_u = along_u > along_v;
    const Range low = in_u ? Range{range.u0, u, range.v0, range.v1} : Range{range.u0, range.u1, range.v0, v};
    const Range high = in_u ? Range{u, range.u1, range.v0, range.v1} : Range{range.u0, range.u1, v, range.v1};
    const auto first = look_at(surface, low);
    if (!first) return std::nullopt;
    const auto second = look_at(surface, high);
    if (!second) return std::nullopt;
    return std::max(*first, *second);
  }

  const Carrier& carrier_;
  double enough_;
  std::size_t left_ = 0;
};

}  // namespace

std::optional<double> carrier_distance(const Surface& a, const Range& range_a, const Surface& b,
                                       const Range& range_b, double enough) {
  constexpr std::size_t most_pieces = 400;
  const Piecewise of_a(a, range_a), of_b(b, range_b);
  if (of_a.count() + of_b.count() > most_pieces) return std::nullopt;
  // Fitted to one of them alone: the other one's points could be on a second sheet of it.
  for (const Piecewise* of : {&of_a, &of_b}) {
    const int each_u = std::max(2, static_cast<int>(8 / (of->us.size() - 1))),
              each_v = std::max(2, static_cast<int>(8 / (of->vs.size() - 1)));
    const std::vector<Vec3> points =
        nurbs::evaluate_grid(of->surface, sites_of(of->us, each_u), sites_of(of->vs, each_v));
    const Box3 box = box_of(points);
    const double size = 0.5 * box.diagonal().norm();
    if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
    for (const bool is_cyclide : {false, true}) {
      const Carrier carrier({box.center(), size}, is_cyclide, points);
      if (!(carrier.rest() <= std::min(1e-6, enough / size))) continue;
      Certifier certifier(carrier, 0.5 * enough);
      const std::optional<double> first = certifier.certify(of_a);
      if (!first) continue;
      const std::optional<double> second = certifier.certify(of_b);
      if (second) return *first + *second;
    }
  }
  return std::nullopt;
}

}  // namespace selvage::cad
