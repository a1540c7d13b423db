#include "view/page/shape.h"

#include <algorithm>
#include <cmath>

#include "core/little_endian.h"
#include "nurbs/spline.h"
#include "view/skin.h"
#include "yarn/line_samples.h"

namespace selvage::view::page {

namespace {

// A part is about as long as this many thicknesses: what is near the eye is then a small part of a long yarn.
constexpr double part_length = 100;
// Steps in a thickness, and the most that a part has room for.
constexpr double steps = 500, most_steps = 65000;

// Knots of v at which the yarn is cut, its two ends included.
std::vector<double> cuts_of(const yarn::Body& body, double thickness) {
  std::vector<double> cuts;
  const std::vector<double> knots = nurbs::breakpoints(body.surface.knots_v, body.surface.degree_v);
  Vec3 last = Vec3::Zero();
  double length = 0;
  for (const double v : knots) {
    const Vec3 here = nurbs::evaluate(body.axis, v);
    if (!cuts.empty()) length += (here - last).norm();
    last = here;
    if (!cuts.empty() && length < part_length * thickness && v != knots.back()) continue;
    cuts.push_back(v);
    length = 0;
  }
  return cuts;
}

std::span<const double> inner(const std::vector<double>& cuts) {
  return std::span(cuts).subspan(1, cuts.size() - 2);
}

// The rows of a skin between two cuts: a row that stands twice at a cut belongs to both sides, once each.
struct Rows {
  std::size_t first = 0, last = 0;  // included
  Rows(const std::vector<double>& places, double from, double to)
      : first(
            static_cast<std::size_t>(std::upper_bound(places.begin(), places.end(), from) - places.begin()) -
            1),
        last(static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), to) - places.begin())) {}
};

Box3 box_of(const Skin& skin, const Rows& rows) {
  Box3 box;
  for (std::size_t k = rows.first * skin.columns; k < (rows.last + 1) * skin.columns; ++k)
    box.extend(skin.points[k].cast<double>());
  return box;
}

void append_normal(std::string& to, const Vec3f& normal) {
  for (const float x : normal) append_little_endian(to, static_cast<std::int8_t>(std::lround(127.0F * x)));
}

Part tube_part(const Skin& skin, const Rows& rows, const Box3& box, double step, bool is_twisted) {
  Part part;
  part.rows = rows.last - rows.first + 1;
  part.has_start = skin.has_ends && rows.first == 0;
  part.has_end = skin.has_ends && rows.last + 1 == skin.rows;
  for (int k = 0; k < 3; ++k)
    part.origin[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(std::floor(box.min()[k] / step));
  std::string normals;
  const auto put = [&](const Vec3f& point, const Vec3f& normal) {
    for (int k = 0; k < 3; ++k)
      append_little_endian(part.bytes, static_cast<std::uint16_t>(std::lround(
                                           point[k] / step - part.origin[static_cast<std::size_t>(k)])));
    append_normal(normals, normal);
  };
  for (std::size_t k = rows.first * skin.columns; k < (rows.last + 1) * skin.columns; ++k)
    put(skin.points[k], skin.normals[k]);
  const auto put_end = [&](std::size_t row, std::size_t centre, const Vec3f& normal) {
    for (std::size_t k = row * skin.columns; k < (row + 1) * skin.columns; ++k) put(skin.points[k], normal);
    put(skin.points[centre], normal);
  };
  if (part.has_start) put_end(0, skin.points.size() - 2, skin.start_normal);
  if (part.has_end) put_end(skin.rows - 1, skin.points.size() - 1, skin.end_normal);
  part.bytes += normals;
  if (is_twisted)
    for (std::size_t row = rows.first; row <= rows.last; ++row)
      append_little_endian(part.bytes, static_cast<float>(skin.along[row]));
  return part;
}

// Two points of a line and what may be left out between them: all that the straight keeps near.
std::vector<std::size_t> simplified(std::span<const yarn::LineSample> line, double chord) {
  std::vector<std::size_t> kept{0};
  const auto is_straight = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from + 1; k < to; ++k) {
      const Vec3 &p = line[k].position, &a = line[from].position, &b = line[to].position;
      if ((p - a - nearest_share(p, a, b) * (b - a)).norm() > chord) return false;
    }
    return true;
  };
  constexpr std::size_t most = 256;  // for the work is quadratic in it
  for (std::size_t from = 0; from + 1 < line.size();) {
    std::size_t to = from + 1;
    while (to + 1 < line.size() && to - from < most && is_straight(from, to + 1)) ++to;
    kept.push_back(to);
    from = to;
  }
  return kept;
}

Part ribbon_part(std::span<const yarn::LineSample> line, const Vec3& centre, double chord) {
  Part part;
  for (const std::size_t k : simplified(line, chord)) {
    const yarn::LineSample& sample = line[k];
    const std::array<Vec3, 3> vectors = {sample.position - centre, 0.5 * sample.width * sample.side,
                                         0.5 * sample.height * sample.up};
    for (const Vec3& vector : vectors)
      for (const double x : vector) append_little_endian(part.bytes, static_cast<float>(x));
    ++part.rows;
  }
  return part;
}

// The last sample of one part is the first of the next.
std::vector<std::span<const yarn::LineSample>> split(const std::vector<yarn::LineSample>& line,
                                                     const std::vector<double>& cuts) {
  std::vector<std::span<const yarn::LineSample>> parts;
  std::size_t first = 0;
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    std::size_t last = first;
    while (last + 1 < line.size() && line[last].parameter < cuts[k]) ++last;
    if (k + 1 == cuts.size()) last = line.size() - 1;
    parts.push_back(std::span(line).subspan(first, last - first + 1));
    first = last;
  }
  return parts;
}

// The largest side of the box of any two rows that follow each other.
double longest_step(const Skin& skin) {
  double longest = 0;
  for (std::size_t row = 0; row + 1 < skin.rows; ++row) {
    Eigen::AlignedBox3f box;
    for (std::size_t k = row * skin.columns; k < (row + 2) * skin.columns; ++k) box.extend(skin.points[k]);
    longest = std::max(longest, static_cast<double>(box.sizes().maxCoeff()));
  }
  return longest;
}

}  // namespace

std::size_t Level::bytes() const {
  std::size_t sum = 0;
  for (const Part& part : parts) sum += part.bytes.size();
  return sum;
}

Result<Shape> make_shape(const yarn::Body& body, std::size_t first_level) {
  Shape shape;
  shape.centre = yarn::bounds(body).center();
  shape.thickness = yarn::narrowest_section(body);
  shape.is_twisted = body.twist != 0.0;
  const std::vector<double> cuts = cuts_of(body, shape.thickness);
  const Camera space(shape.centre);
  for (std::size_t k = first_level; k < tube_chords.size(); ++k) {
    Level level{true, tube_chords[k] * shape.thickness, 0, {}, {}};
    const Result<Skin> skin = make_skin(body, space, level.chord, inner(cuts));
    if (!skin) return skin.error();
    level.columns = skin->columns;
    level.around = skin->around;
    std::vector<Rows> rows;
    double longest = longest_step(*skin);
    for (std::size_t part = 0; part + 1 < cuts.size(); ++part) {
      rows.emplace_back(skin->places, cuts[part], cuts[part + 1]);
      if (k == first_level) shape.boxes.push_back(box_of(*skin, rows.back()));
      longest = std::max(longest, box_of(*skin, rows.back()).sizes().maxCoeff());
    }
    // All levels have one step, so that they meet at the cuts; coarser skins are hardly larger.
    if (k == first_level) shape.step = std::max(shape.thickness / steps, 1.02 * longest / most_steps);
    for (const Rows& of : rows)
      level.parts.push_back(tube_part(*skin, of, box_of(*skin, of), shape.step, shape.is_twisted));
    shape.levels.push_back(std::move(level));
  }
  // What the samples themselves leave of the line's chord.
  const double sampled = ribbon_chords[0] * shape.thickness / 4;
  const std::vector<yarn::LineSample> line = yarn::line_samples(body, sampled);
  const auto parts = split(line, cuts);
  for (const auto& part : parts) {
    if (first_level < tube_chords.size()) break;
    Box3 box;
    for (const yarn::LineSample& sample : part) box.extend(sample.position - shape.centre);
    const double reach = 0.5 * yarn::widest_section(body);
    shape.boxes.emplace_back(box.min() - Vec3::Constant(reach), box.max() + Vec3::Constant(reach));
  }
  for (std::size_t k = std::max(first_level, tube_chords.size()) - tube_chords.size();
       k < ribbon_chords.size(); ++k) {
    Level level{false, ribbon_chords[k] * shape.thickness, 0, {}, {}};
    for (const auto& part : parts)
      level.parts.push_back(ribbon_part(part, shape.centre, level.chord - sampled));
    shape.levels.push_back(std::move(level));
  }
  return shape;
}

}  // namespace selvage::view::page
