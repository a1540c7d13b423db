#include "structured/beam_section.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/plane.h"
#include "fem/fibre.h"
#include "nurbs/divided.h"
#include "surface_mesh/size_field.h"

namespace selvage::fem {
namespace {

// A section in its plane, mm.
struct FlatSection {
  Vec3 centre, across, up;       // of the plane; `across` toward the seam
  std::vector<Vec2> outline;     // about the centroid, counter-clockwise or not; the first is not repeated
  Vec2 centroid = Vec2::Zero();  // from the centre
  double area = 0;
  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();  // integrals of x x, x y, y y about the centroid
};

// Of the polygon; what it leaves out of the round section is made up by scaling to the exact area.
void integrate(FlatSection& flat, double exact_area) {
  double area = 0;
  Vec2 first = Vec2::Zero();
  const std::vector<Vec2>& p = flat.outline;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 &a = p[k], &b = p[(k + 1) % p.size()];
    area += cross(a, b) / 2;
    first += cross(a, b) / 6 * (a + b);
  }
  flat.centroid = first / area;
  const double growth = std::sqrt(exact_area / std::abs(area));
  for (Vec2& point : flat.outline) point = growth * (point - flat.centroid);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 &a = p[k], &b = p[(k + 1) % p.size()], sum = a + b;
    flat.moments += cross(a, b) / 24 * (a * a.transpose() + b * b.transpose() + sum * sum.transpose());
  }
  if (area < 0) flat.moments = -flat.moments;
  flat.area = exact_area;
}

FlatSection flat_section(const yarn::Body& body, double v, double scale) {
  constexpr int parts = 4, least = 128;
  const nurbs::CurveJet jet = nurbs::evaluate_jet(body.axis, v);
  const Vec3 along = jet.d1.normalized();
  const Vec3 seam = nurbs::evaluate(body.surface, body.surface.first_u(), v) - jet.position;
  const Vec3 level = seam - along * along.dot(seam);
  FlatSection flat;
  flat.centre = jet.position * scale;
  flat.across = level.norm() > 1e-9 * seam.norm() ? level.normalized() : along.unitOrthogonal();
  flat.up = along.cross(flat.across);
  std::vector<double> us = nurbs::divided(body.surface.knots_u, body.surface.degree_u, parts, least);
  us.pop_back();
  for (const Vec3& point : nurbs::evaluate_grid(body.surface, us, {v})) {
    const Vec3 from = scale * point - flat.centre;
    flat.outline.emplace_back(from.dot(flat.across), from.dot(flat.up));
  }
  integrate(flat, section_area(body, v) * scale * scale);
  return flat;
}

bool is_near(double value, double wanted) {
  return std::abs(value - wanted) <= 0.01 * wanted;
}

BeamSection::Shape shape_of(const BeamSection& s, bool has_four_corners) {
  const double round = s.area / 16, square = s.area / 12;
  if (is_near(s.area, std::numbers::pi / 4 * s.width * s.height) &&
      is_near(s.i11, round * s.height * s.height) && is_near(s.i22, round * s.width * s.width))
    return is_near(s.width, s.height) ? BeamSection::Shape::circle : BeamSection::Shape::ellipse;
  if (has_four_corners && is_near(s.area, s.width * s.height) &&
      is_near(s.i11, square * s.height * s.height) && is_near(s.i22, square * s.width * s.width))
    return BeamSection::Shape::rectangle;
  return BeamSection::Shape::general;
}

double extent(const std::vector<Vec2>& outline, const Vec2& way) {
  double low = 0, high = 0;
  for (const Vec2& point : outline) {
    low = std::min(low, point.dot(way));
    high = std::max(high, point.dot(way));
  }
  return high - low;
}

bool is_seen_from_centroid(const std::vector<Vec2>& outline) {
  double sum = 0;
  bool all = true;
  for (std::size_t k = 0; k < outline.size(); ++k)
    sum += cross(outline[k], outline[(k + 1) % outline.size()]);
  for (std::size_t k = 0; k < outline.size(); ++k)
    all = all && cross(outline[k], outline[(k + 1) % outline.size()]) * sum > 0;
  return all;
}

// Triangles of a fan of rings round the centroid: node 0 is there, node 1 + (r - 1) n + k on ray k at r of
// `rings` parts; those on the outline, where the stress function is zero, have no number.
class StressFunction {
 public:
  explicit StressFunction(const std::vector<Vec2>& outline) : outline_(outline) {
    const std::size_t n = outline.size();
    const auto count = static_cast<Eigen::Index>(1 + (rings - 1) * n);
    load_ = Eigen::VectorXd::Zero(count);
    for (std::size_t k = 0; k < n; ++k) {
      add({{{0, 0}, {1, k}, {1, k + 1}}});
      for (std::size_t r = 1; r < rings; ++r) {
        add({{{r, k}, {r + 1, k}, {r + 1, k + 1}}});
        add({{{r, k}, {r + 1, k + 1}, {r, k + 1}}});
      }
    }
    stiffness_.resize(count, count);
    stiffness_.setFromTriplets(entries_.begin(), entries_.end());
  }
  // Twice the integral of the function.
  [[nodiscard]] double torsion() const {
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(stiffness_);
    return solver.solve(load_).dot(load_);
  }

 private:
  static constexpr std::size_t rings = 20;
  using Corner = std::array<std::size_t, 2>;  // ring, ray
  [[nodiscard]] Vec2 place(const Corner& c) const {
    return static_cast<double>(c[0]) / rings * outline_[c[1] % outline_.size()];
  }
  [[nodiscard]] Eigen::Index number(const Corner& c) const {
    if (c[0] == rings) return -1;
    return c[0] == 0 ? 0
                     : static_cast<Eigen::Index>(1 + (c[0] - 1) * outline_.size() + c[1] % outline_.size());
  }
  // Minus the Laplacian of the function is 2.
  void add(const std::array<Corner, 3>& corners) {
    const std::array<Vec2, 3> p = {place(corners[0]), place(corners[1]), place(corners[2])};
    const double area = std::abs(cross(p[1] - p[0], p[2] - p[0])) / 2;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Index row = number(corners[i]);
      if (row < 0) continue;
      load_[row] += 2 * area / 3;
      for (std::size_t j = 0; j < 3; ++j) {
        const Vec2 a = p[(i + 1) % 3] - p[(i + 2) % 3], b = p[(j + 1) % 3] - p[(j + 2) % 3];
        if (const Eigen::Index column = number(corners[j]); column >= 0)
          entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), a.dot(b) / (4 * area));
      }
    }
  }

  const std::vector<Vec2>& outline_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> stiffness_;
  Eigen::VectorXd load_;
};

}  // namespace

std::string_view name_of(BeamSection::Shape shape) {
  constexpr std::array<std::string_view, 4> names = {"circle", "ellipse", "rectangle", "general"};
  return names[static_cast<std::size_t>(shape)];
}

bool are_alike(const BeamSection& a, const BeamSection& b, double share) {
  const auto is_like = [](double x, double y, double most) { return std::abs(x - y) <= most * y; };
  return a.shape == b.shape && is_like(a.area, b.area, share) && is_like(a.i11, b.i11, 2 * share) &&
         is_like(a.i22, b.i22, 2 * share);
}

PlacedSection beam_section(const yarn::Body& body, double v, double scale) {
  constexpr double round = 0.02;  // moments nearer than this have no axes to speak of
  const FlatSection flat = flat_section(body, v, scale);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal(flat.moments);
  Vec2 wide = principal.eigenvectors().col(1);
  if (principal.eigenvalues()[0] > (1 - round) * principal.eigenvalues()[1]) wide = Vec2::UnitX();
  if (wide.x() < 0) wide = -wide;
  const Vec2 high(-wide.y(), wide.x());
  PlacedSection placed;
  placed.centroid = flat.centre + flat.centroid.x() * flat.across + flat.centroid.y() * flat.up;
  placed.n1 = wide.x() * flat.across + wide.y() * flat.up;
  BeamSection& section = placed.section;
  section.area = flat.area;
  section.i11 = high.dot(flat.moments * high);
  section.i22 = wide.dot(flat.moments * wide);
  section.width = extent(flat.outline, wide);
  section.height = extent(flat.outline, high);
  section.shape = shape_of(section, crests_of(body.surface).size() == 4);
  return placed;
}

double torsion_constant(const yarn::Body& body, double v, double scale) {
  const FlatSection flat = flat_section(body, v, scale);
  if (is_seen_from_centroid(flat.outline)) return StressFunction(flat.outline).torsion();
  return std::pow(flat.area, 4) / (4 * std::numbers::pi * std::numbers::pi * flat.moments.trace());
}

}  // namespace selvage::fem
