#include "contact/relax.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "contact/displacement_system.h"
#include "contact/near_skins.h"
#include "contact/strand.h"
#include "nurbs/measure.h"
#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::contact {

namespace {

// The size of a yarn's sections, before it becomes a strand.
struct Extents {
  double least = std::numeric_limits<double>::infinity(), most = 0;
};

Extents extents_of(const nurbs::Surface& s) {
  Extents extents;
  for (int j = 0; j < s.count_v; ++j) {
    // Widths of the control polygon in its principal directions.
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i + 1 < s.count_u; ++i) centre += s.point(i, j) / (s.count_u - 1);
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (int i = 0; i + 1 < s.count_u; ++i)
      spread += (s.point(i, j) - centre) * (s.point(i, j) - centre).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    for (int axis = 1; axis < 3; ++axis) {
      double reach = 0.0;
      for (int i = 0; i + 1 < s.count_u; ++i)
        reach = std::max(reach, std::abs((s.point(i, j) - centre).dot(axes.eigenvectors().col(axis))));
      extents.least = std::min(extents.least, 2.0 * reach);
      extents.most = std::max(extents.most, 2.0 * reach);
    }
  }
  return extents;
}

double section_area(const nurbs::Surface& s, double v) {
  std::vector<double> us;
  const std::vector<double> breaks = nurbs::breakpoints(s.knots_u, s.degree_u);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int i = 0; i < 4; ++i) us.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * i / 4.0);
  const std::vector<Vec3> points = nurbs::evaluate_grid(s, us, {v});
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
    area += 0.5 * (points[i] - points[0]).cross(points[(i + 1) % points.size()] - points[0]);
  return area.norm();
}

class Relaxer {
 public:
  Relaxer(std::vector<yarn::Body> bodies, const RelaxOptions& options)
      : options_(options),
        originals_(std::move(bodies)),
        modes_(options.stiff_section ? translation_modes : all_modes) {
    for (const yarn::Body& body : originals_) {
      const Extents extents = extents_of(body.surface);
      strands_.emplace_back(body, 0.6 * std::sqrt(extents.least * extents.most));
      thickness_ = std::min(thickness_, strands_.back().thickness());
    }
  }

  Result<Relaxation> run() {
    NearSkins skins(strands_);
    DisplacementSystem system(strands_, Stiffness{}, modes_);
    for (const FixedPoint& point : options_.fixed)
      system.hold(point.yarn, strands_[point.yarn].arc_of(point.parameter));
    Relaxation out;
    double aim = 0.0;  // beyond the wanted gap
    for (int step = 0;; ++step) {
      const std::vector<Facing> facings = find(skins, step);
      double missing = -std::numeric_limits<double>::infinity();
      for (const Facing& f : facings) missing = std::max(missing, wanted(f) - f.gap);
      out.iterations = step;
      if (options_.progress && !options_.progress(step, missing)) {
        out.reason = "interrupted";
        break;
      }
      if (missing <= 0.0) {
        out.solved = true;
        break;
      }
      if (step == options_.max_iterations) {
        out.reason = fmt::format("{} iterations were not enough", step);
        break;
      }
      aim = std::min(0.2, 0.05 + 0.01 * step);
      system.update(options_.threads);
      const std::vector<Demand> demands = demands_of(facings, aim);
      const Eigen::VectorXd x = system.solve(demands, options_.threads);
      double largest = 0.0;
      for (std::size_t y = 0; y < strands_.size(); ++y)
        largest = std::max(largest,
                           strands_[y].largest_move(x.segment(system.offset(y), system.length(y)), modes_) /
                               strands_[y].thickness());
      const double factor = largest > 0.1 ? 0.1 / largest : 1.0;
      for (std::size_t y = 0; y < strands_.size(); ++y)
        strands_[y].move(x.segment(system.offset(y), system.length(y)), modes_, factor);
    }
    return finish(std::move(out));
  }

 private:
  [[nodiscard]] double wanted(const Facing& f) const {
    if (options_.gap) return *options_.gap;
    return 0.01 * std::min(strands_[f.a].thickness(), strands_[f.b].thickness());
  }

  std::vector<Facing> find(NearSkins& skins, int /*step*/) {
    const double reach = 0.1 * thickness_ + std::max(0.0, options_.gap.value_or(0.01 * thickness_));
    std::vector<Facing> facings = skins.find(reach, options_.threads);
    // The places where two surfaces are nearest lie between samples.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> by_pair;
    const std::size_t sampled = facings.size();
    std::vector<Facing> extra;
    for (std::size_t k = 0; k < sampled; ++k)
      if (facings[k].gap < 2.0 * wanted(facings[k])) {
        const Facing better = settled(strands_, facings[k]);
        if (better.gap < facings[k].gap) extra.push_back(better);
      }
    facings.insert(facings.end(), extra.begin(), extra.end());
    return facings;
  }

  Demand::Side side(std::uint32_t y, const Vec2& site, const Vec3& point, const Vec3& direction) const {
    Demand::Side side;
    side.strand = y;
    const Stencil stencil = strands_[y].stencil(strands_[y].arc_of(site.y()));
    side.first = stencil.first;
    displacement_form(strands_[y].frame_at(site.y()), stencil, point, direction, modes_, side.form);
    return side;
  }

  std::vector<Demand> demands_of(const std::vector<Facing>& facings, double aim) const {
    std::vector<Demand> demands;
    demands.reserve(facings.size());
    for (const Facing& f : facings) {
      Demand demand;
      demand.plus = side(f.b, f.site_b, f.on_b, f.normal);
      demand.minus = side(f.a, f.site_a, f.on_a, f.normal);
      demand.has_minus = true;
      const double goal = wanted(f);
      demand.missing = goal + aim * std::abs(goal) - f.gap;
      demands.push_back(demand);
    }
    return demands;
  }

  Result<Relaxation> finish(Relaxation out) {
    for (std::size_t y = 0; y < strands_.size(); ++y) {
      yarn::Body body = originals_[y];
      const yarn::Body before = originals_[y];
      body.surface = strands_[y].body().surface;
      body.axis = yarn::section_centres(body.surface);
      body.tight_bends.clear();
      body.messages.clear();
      if (Status done = yarn::finish(body, body.start.style); !done) return done.error();
      YarnChange change;
      const nurbs::Curve old = yarn::section_centres(before.surface);
      const double old_length = nurbs::arc_length(old);
      change.length = nurbs::arc_length(body.axis) / old_length - 1.0;
      change.volume = body.volume / before.volume - 1.0;
      const double first = before.surface.first_v(), last = before.surface.last_v();
      const int samples = std::max(20, strands_[y].nodes() * 2);
      for (int i = 0; i <= samples; ++i) {
        const double v = first + (last - first) * i / samples;
        change.move = std::max(change.move, (nurbs::evaluate(old, v) - nurbs::evaluate(body.axis, v)).norm());
        const double area = section_area(body.surface, v) / section_area(before.surface, v) - 1.0;
        if (std::abs(area) > std::abs(change.area)) change.area = area;
      }
      out.changes.push_back(change);
      out.bodies.push_back(std::move(body));
    }
    return out;
  }

  RelaxOptions options_;
  std::vector<yarn::Body> originals_;
  std::vector<Strand> strands_;
  int modes_;
  double thickness_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Result<Relaxation> relax(std::vector<yarn::Body> bodies, const RelaxOptions& options) {
  return Relaxer(std::move(bodies), options).run();
}

}  // namespace selvage::contact
