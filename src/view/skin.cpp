#include "view/skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "nurbs/divided.h"
#include "nurbs/samples.h"

namespace selvage::view {

namespace {

constexpr std::size_t fewest_round = 8;
constexpr double most_facets = 2147483648.0;

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double square = ab.squaredNorm();
  const double t = square > 0.0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

// One parameter of the surface, u or v.
class Direction {
 public:
  // Round the section: judged at up to 24 sections, spread over the yarn.
  Direction(const nurbs::Surface& surface, double chord) : surface_(surface), is_u_(true), chord_(chord) {
    const std::vector<double> breaks = nurbs::breakpoints(surface.knots_v, surface.degree_v);
    const std::size_t count = std::min<std::size_t>(24, breaks.size());
    for (std::size_t k = 0; k < count; ++k) held_.push_back(breaks[k * (breaks.size() - 1) / (count - 1)]);
  }
  // Along the yarn: judged at the grid's own columns. `stops`: knots that are taken in any case.
  Direction(const nurbs::Surface& surface, const std::vector<double>& columns, double chord,
            std::span<const double> stops)
      : surface_(surface), is_u_(false), chord_(chord), held_(columns), stops_(stops) {}

  // Parameters between which the lines are straight within the chord; every edge of the surface twice.
  [[nodiscard]] std::vector<double> parameters(std::size_t fewest) const {
    const std::vector<double> fine = fine_parameters();
    const nurbs::Samples lines = lines_at(fine);
    const std::size_t last = fine.size() - 1, longest = std::max<std::size_t>(1, last / fewest);
    std::vector<std::size_t> next_stop(fine.size(), last);
    for (std::size_t k = last; k-- > 0;)
      next_stop[k] =
          k + 1 < last && !is_edge(fine[k + 1]) && !is_stop(fine[k + 1]) ? next_stop[k + 1] : k + 1;
    std::vector<double> chosen{fine.front()};
    for (std::size_t i = 0; i < last;) {
      if (i > 0 && is_edge(fine[i])) chosen.push_back(fine[i]);
      i = farthest(lines, i, std::min(i + longest, next_stop[i]));
      chosen.push_back(fine[i]);
    }
    return chosen;
  }

 private:
  [[nodiscard]] const std::vector<double>& knots() const {
    return is_u_ ? surface_.knots_u : surface_.knots_v;
  }
  [[nodiscard]] int degree() const { return is_u_ ? surface_.degree_u : surface_.degree_v; }

  // Where the surface is continuous, and no more: a knot of full multiplicity.
  [[nodiscard]] bool is_edge(double t) const {
    const auto [first, last] = std::equal_range(knots().begin(), knots().end(), t);
    return last - first >= degree();
  }
  [[nodiscard]] bool is_stop(double t) const { return std::binary_search(stops_.begin(), stops_.end(), t); }

  [[nodiscard]] nurbs::Samples lines_at(const std::vector<double>& parameters) const {
    return is_u_ ? nurbs::Samples(surface_, parameters, held_) : nurbs::Samples(surface_, held_, parameters);
  }

  // Neither does a line leave its chord, nor a quadrilateral between two of the grid's columns its plane, by
  // more than the chord. (The middle of a quadrilateral cut into triangles is off its bilinear surface by a
  // quarter of its mixed difference.)
  [[nodiscard]] bool is_straight(const nurbs::Samples& lines, std::size_t from, std::size_t to) const {
    for (std::size_t i = 0; i + 1 < lines.us.size() && !is_u_; ++i) {
      const Vec3 here = lines.at(i, to) - lines.at(i, from);
      if ((lines.at(i + 1, to) - lines.at(i + 1, from) - here).norm() > 4.0 * chord_) return false;
    }
    const auto at = [&](std::size_t k, std::size_t line) -> const Vec3& {
      return is_u_ ? lines.at(k, line) : lines.at(line, k);
    };
    for (std::size_t k = from + 1; k < to; ++k)
      for (std::size_t line = 0; line < held_.size(); ++line)
        if (distance_to_segment(at(k, line), at(from, line), at(to, line)) > chord_) return false;
    return true;
  }

  // Four steps a knot span, more where a span bends by more than the chord.
  [[nodiscard]] std::vector<double> fine_parameters() const {
    const nurbs::Samples lines = lines_at(nurbs::divided(knots(), degree(), 2));
    return nurbs::divided(nurbs::breakpoints(knots(), degree()), [&](std::size_t k) {
      const double bend = lines.largest<3>(
          !is_u_, 2 * k, [](const std::array<Vec3, 3>& p) { return distance_to_segment(p[1], p[0], p[2]); });
      return nurbs::whole_parts(2.0 * std::sqrt(bend / chord_), 4, 256);
    });
  }

  // The farthest sample from `start`, up to `limit`, to which the lines are straight.
  [[nodiscard]] std::size_t farthest(const nurbs::Samples& lines, std::size_t start,
                                     std::size_t limit) const {
    std::size_t good = start + 1;
    std::size_t step = 1;
    for (; good + step <= limit && is_straight(lines, start, good + step); step *= 2) good += step;
    for (; step > 0; step /= 2)
      if (good + step <= limit && is_straight(lines, start, good + step)) good += step;
    return good;
  }

  const nurbs::Surface& surface_;
  bool is_u_;
  double chord_;  // file units
  std::vector<double> held_;
  std::span<const double> stops_;  // increasing
};

// Where a parameter stands for its normal: of two at one place the first belongs to the part before it.
std::vector<double> normal_sites(const std::vector<double>& parameters) {
  constexpr double inward = 1e-6;  // of the interval
  std::vector<double> sites = parameters;
  for (std::size_t k = 0; k + 1 < sites.size(); ++k) {
    if (parameters[k] != parameters[k + 1]) continue;
    if (k > 0) sites[k] -= inward * (parameters[k] - parameters[k - 1]);
    if (k + 2 < sites.size()) sites[k + 1] += inward * (parameters[k + 2] - parameters[k + 1]);
  }
  return sites;
}

Vec3f as_float(const Vec3& v) {
  return v.cast<float>();
}

// Turns of the fibres at each row: the twist times the length of the centre line up to it.
std::vector<double> fibre_turns(const yarn::Body& body, const std::vector<double>& vs) {
  constexpr int steps = 8;
  std::vector<double> turns(vs.size(), 0.0);
  if (body.twist == 0.0 || body.section_turns) return turns;
  for (std::size_t k = 1; k < vs.size(); ++k) {
    double length = 0.0;
    Vec3 last = nurbs::evaluate(body.axis, vs[k - 1]);
    for (int step = 1; step <= steps; ++step) {
      const Vec3 next = nurbs::evaluate(body.axis, vs[k - 1] + (vs[k] - vs[k - 1]) * step / steps);
      length += (next - last).norm();
      last = next;
    }
    turns[k] = turns[k - 1] + body.twist * length;
  }
  return turns;
}

// Directions from the camera matrix act on points; a normal is a difference of two of them, not scaled.
Vec3 normal_at(const yarn::Body& body, const Camera& camera, double u, double v) {
  const nurbs::SurfaceJet jet = nurbs::evaluate_jet(body.surface, u, v);
  const Vec3 normal = jet.du.cross(jet.dv);
  const double length = normal.norm();
  const Vec3 out = camera.direction(normal) * (body.inward ? -1.0 : 1.0);
  return length > 0.0 ? Vec3(out / length) : Vec3::Zero();
}

void fill_grid(Skin& skin, const yarn::Body& body, const Camera& camera, const std::vector<double>& us,
               const std::vector<double>& vs) {
  const std::vector<double> normal_us = normal_sites(us), normal_vs = normal_sites(vs);
  const std::vector<Vec3> grid = nurbs::evaluate_grid(body.surface, us, vs);
  skin.points.reserve(grid.size() + 2);
  skin.normals.reserve(grid.size());
  for (std::size_t row = 0; row < skin.rows; ++row)
    for (std::size_t column = 0; column < skin.columns; ++column) {
      // The seam, and where a ring closes, has the numbers of its first side.
      const std::size_t from_row = body.closed_along && row + 1 == skin.rows ? 0 : row;
      const std::size_t from_column = column + 1 == skin.columns ? 0 : column;
      skin.points.push_back(as_float(camera.to_picture(grid[from_row * skin.columns + from_column])));
      skin.normals.push_back(as_float(normal_at(body, camera, normal_us[column], normal_vs[row])));
    }
}

void close_ends(Skin& skin, const yarn::Body& body) {
  skin.has_ends = !body.closed_along;
  if (!skin.has_ends) return;
  for (const bool last : {false, true}) {
    const std::size_t row = last ? skin.rows - 1 : 0;
    Vec3f centre = Vec3f::Zero(), normal = Vec3f::Zero();
    const auto at = [&](std::size_t column) { return skin.points[row * skin.columns + column]; };
    for (std::size_t k = 0; k + 1 < skin.columns; ++k) centre += at(k);
    centre /= static_cast<float>(skin.columns - 1);
    for (std::size_t k = 0; k + 1 < skin.columns; ++k) normal += (at(k) - centre).cross(at(k + 1) - centre);
    // Columns run counter-clockwise about the path: this is the direction of the path.
    (last ? skin.end_normal : skin.start_normal) = last ? normal.normalized() : Vec3f(-normal.normalized());
    skin.points.push_back(centre);
  }
}

}  // namespace

Result<Skin> make_skin(const yarn::Body& body, const Camera& camera, double chord,
                       std::span<const double> stops) {
  const double pixel = 1.0 / camera.pixels_per_unit();
  const auto fault = [&](Kind kind, std::string_view what) {
    Message message = error(kind, fmt::format("yarn '{}' {}", body.name, what));
    message.yarn = body.name;
    message.place = body.place;
    return message;
  };
  for (const Vec3& p : body.surface.points)
    if (!p.allFinite()) return fault(Kind::geometry, "has coordinates that are not finite");
  std::vector<double> us = Direction(body.surface, chord * pixel).parameters(fewest_round);
  const std::vector<double> vs = Direction(body.surface, us, chord * pixel, stops).parameters(1);
  if (static_cast<double>(us.size()) * static_cast<double>(vs.size()) > most_facets)
    return fault(Kind::limit, "needs more than 2^31 facets in this picture; make the picture smaller");
  if (body.inward) std::reverse(us.begin(), us.end());
  Skin skin;
  skin.columns = us.size();
  skin.rows = vs.size();
  skin.places = vs;
  fill_grid(skin, body, camera, us, vs);
  for (double u : us) skin.around.push_back((u - us.front()) / (us.back() - us.front()));
  skin.along = fibre_turns(body, vs);
  close_ends(skin, body);
  skin.size = std::sqrt(4.0 / std::numbers::pi * std::abs(body.end_area)) * camera.pixels_per_unit();
  skin.uncertainty = 3.0 * chord + body.tube_error * camera.pixels_per_unit();
  return skin;
}

}  // namespace selvage::view
