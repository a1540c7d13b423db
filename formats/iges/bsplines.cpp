// 126 and 128: what is read with nearly every file, and nearly all of its bytes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/iges/types.h"
#include "nurbs/basis.h"
#include "nurbs/restrict.h"

namespace selvage::formats::iges {

namespace {

// The highest index and the degree of one direction.
struct Direction {
  std::int64_t last = 0, degree = 0;

  [[nodiscard]] std::size_t points() const { return static_cast<std::size_t>(last) + 1; }
  [[nodiscard]] std::size_t knots() const { return static_cast<std::size_t>(last + degree) + 2; }
};

std::int64_t read_last(Parameters& in) {
  const std::int64_t last = in.integer();
  if (in.ok() && (last < 1 || last > 1'000'000'000))
    in.fail(fmt::format("the highest index of control points cannot be {}", last));
  return last;
}

std::int64_t read_degree(Parameters& in, std::int64_t last) {
  const std::int64_t degree = in.integer();
  if (!in.ok()) return 0;
  if (degree < 1 || degree > last)
    in.fail(fmt::format("a degree of {} with {} control points", degree, last + 1));
  else if (degree > nurbs::max_degree)
    in.fail(fmt::format("a degree of {}: at most {} is read", degree, nurbs::max_degree));
  return degree;
}

// `values` from where `in` stands. fail_at(i, text) is what is wrong with number i of them.
bool read_values(Parameters& in, std::vector<double>& values, const auto& is_wrong) {
  const Parameters start = in;
  if (!in.reals(values.data(), values.size())) return false;
  return !is_wrong([&](std::size_t i, std::string text) {
    Parameters again = start;
    std::vector<double> before(i);
    again.reals(before.data(), i);
    again.real();
    in.fail(again.spot(), std::move(text));
    return true;
  });
}

// Not decreasing, with a domain.
bool read_knots(Parameters& in, const Direction& direction, std::vector<double>& knots,
                std::string_view which) {
  knots.resize(direction.knots());
  return read_values(in, knots, [&](const auto& fail) {
    const auto order = static_cast<std::size_t>(direction.degree) + 1;
    const std::size_t points = direction.points();
    for (std::size_t i = 1; i < knots.size(); ++i)
      if (knots[i] < knots[i - 1])
        return fail(i, fmt::format("{} {} is {} and thus below the one before it, {}", which, i + 1, knots[i],
                                   knots[i - 1]));
    if (!(knots[order - 1] < knots[points]))
      return fail(points,
                  fmt::format("the {}s span nothing: from {} to {}", which, knots[order - 1], knots[points]));
    return false;
  });
}

// An inner knot that stands more often than the degree tears the shape apart, or does nothing where both
// sides meet: one of the two points goes then, with the knots that are too many, and points that nothing is
// made of.
struct Tear {
  std::size_t first = 0,
              count = 0;  // knots that are too many, and the numbers of the points that go with them
};
std::vector<Tear> tears_of(const std::vector<double>& knots, int degree) {
  std::vector<Tear> tears;
  const auto most = static_cast<std::size_t>(degree);
  for (std::size_t i = most + 1; i + most + 1 < knots.size();) {
    std::size_t next = i;
    while (next < knots.size() && knots[next] == knots[i]) ++next;
    if (next + most < knots.size() && next - i > most) tears.push_back({i, next - i - most});
    i = next;
  }
  return tears;
}

// `gap(left, right)`: how far what belongs to two points is apart. `drop(i)`: without what belongs to point
// i.
template <class Gap, class Drop>
bool mend_tears(Reading& reading, const DirectoryEntry& entry, Parameters& in, std::vector<double>& knots,
                int degree, double size, const Gap& gap, const Drop& drop) {
  const std::vector<Tear> tears = tears_of(knots, degree);
  for (auto tear = tears.rbegin(); tear != tears.rend(); ++tear) {
    const double apart = gap(tear->first - 1, tear->first + tear->count - 1);
    if (apart > 1e-3 * size) {
      in.fail(fmt::format(
          "knot {} stands {} times or more, and the shape of degree {} falls apart there, by {:.3g}",
          knots[tear->first], degree + 1, degree, apart));
      return false;
    }
    if (apart > std::max(1e-6 * size, 2 * reading.file().global().resolution))
      reading.warning(entry, fmt::format("it is torn at the knot {}, by {:.3g}; its pieces are joined",
                                         knots[tear->first], apart));
    for (std::size_t k = tear->count; k-- > 0;) {
      drop(tear->first + k);
      knots.erase(knots.begin() + static_cast<std::ptrdiff_t>(tear->first));
    }
  }
  return true;
}

bool mend_tears(Reading& reading, const DirectoryEntry& entry, Parameters& in, nurbs::Curve& curve) {
  return mend_tears(
      reading, entry, in, curve.knots, curve.degree, cad::box_of(curve.points).sizes().norm(),
      [&](std::size_t a, std::size_t b) { return (curve.points[a] - curve.points[b]).norm(); },
      [&](std::size_t i) {
        const auto at = static_cast<std::ptrdiff_t>(i);
        curve.points.erase(curve.points.begin() + at);
        if (curve.is_rational()) curve.weights.erase(curve.weights.begin() + at);
      });
}

// The list without its columns (or rows) of this number.
template <class Value>
void drop_line(std::vector<Value>& list, std::size_t count_u, bool in_u, std::size_t number) {
  std::size_t k = 0;
  std::erase_if(list, [&](const Value&) {
    const std::size_t at = k++;
    return (in_u ? at % count_u : at / count_u) == number;
  });
}

bool mend_tears(Reading& reading, const DirectoryEntry& entry, Parameters& in, nurbs::Surface& s) {
  const double size = cad::box_of(s.points).sizes().norm();
  for (const bool in_u : {true, false}) {
    const auto gap = [&](std::size_t a, std::size_t b) {
      double largest = 0;
      const int across = in_u ? s.count_v : s.count_u;
      for (int k = 0; k < across; ++k) {
        const auto point = [&](std::size_t i) {
          return in_u ? s.point(static_cast<int>(i), k) : s.point(k, static_cast<int>(i));
        };
        largest = std::max(largest, (point(a) - point(b)).norm());
      }
      return largest;
    };
    const auto drop = [&](std::size_t i) {
      const auto count_u = static_cast<std::size_t>(s.count_u);
      drop_line(s.points, count_u, in_u, i);
      drop_line(s.weights, count_u, in_u, i);
      --(in_u ? s.count_u : s.count_v);
    };
    if (!mend_tears(reading, entry, in, in_u ? s.knots_u : s.knots_v, in_u ? s.degree_u : s.degree_v, size,
                    gap, drop))
      return false;
  }
  return true;
}

// Empty where all are 1.
bool read_weights(Parameters& in, std::size_t count, std::vector<double>& weights) {
  weights.resize(count);
  const bool good = read_values(in, weights, [&](const auto& fail) {
    const auto bad = std::ranges::find_if_not(weights, [](double weight) { return weight > 0; });
    return bad != weights.end() && fail(static_cast<std::size_t>(bad - weights.begin()),
                                        fmt::format("a weight of {}: weights have to be above 0", *bad));
  });
  if (std::ranges::all_of(weights, [](double weight) { return weight == 1; })) weights = {};
  return good;
}

struct Range {
  double from = 0, to = 0;
  bool operator==(const Range&) const = default;
};

// What of the domain the file says is the shape: all of it where the file says nothing, or more than there
// is.
Range used_range(Reading& reading, const DirectoryEntry& entry, const Range& said, const Range& domain,
                 std::string_view which) {
  const double slack = 1e-9 * (domain.to - domain.from);
  if (said == domain || said == Range{}) return domain;  // or defaulted
  if (!(said.from < said.to) || said.from < domain.from - slack || said.to > domain.to + slack) {
    reading.warning(
        entry, fmt::format("its range {} to {} of {} is not within the knots' {} to {}; all of it is taken",
                           said.from, said.to, which, domain.from, domain.to));
    return domain;
  }
  Range used{std::max(said.from, domain.from), std::min(said.to, domain.to)};
  if (used.from - domain.from <= slack) used.from = domain.from;
  if (domain.to - used.to <= slack) used.to = domain.to;
  return used;
}

std::optional<nurbs::Curve> read_curve(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  Direction along;
  along.last = read_last(in);
  along.degree = read_degree(in, along.last);
  for (int flag = 1; flag <= 4; ++flag)
    in.integer();  // planar, closed, polynomial, periodic: seen in the numbers
  if (!in.ok()) return std::nullopt;
  if (along.knots() + 4 * along.points() > in.room())
    return in.fail(fmt::format("{} control points: more than the entity's lines can hold", along.points()));
  nurbs::Curve curve;
  curve.degree = static_cast<int>(along.degree);
  if (!read_knots(in, along, curve.knots, "knot") || !read_weights(in, along.points(), curve.weights))
    return std::nullopt;
  curve.points.resize(along.points());
  if (!in.reals(curve.points.data()->data(), 3 * curve.points.size())) return std::nullopt;
  const double from = in.real(), to = in.real();
  for (int part = 0; part < 3; ++part) in.real();  // the plane's normal: seen in the points
  if (!in.ok() || !mend_tears(reading, entry, in, curve)) return std::nullopt;
  const Range domain{curve.first_parameter(), curve.last_parameter()};
  const Range used = used_range(reading, entry, {from, to}, domain, "the parameter");
  if (used == domain) return curve;
  return nurbs::restricted(curve, used.from, used.to);
}

std::optional<nurbs::Surface> read_surface(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  Direction u, v;
  u.last = read_last(in);
  v.last = read_last(in);
  u.degree = read_degree(in, u.last);
  v.degree = read_degree(in, v.last);
  for (int flag = 1; flag <= 5; ++flag) in.integer();  // closed, polynomial, periodic: seen in the numbers
  if (!in.ok()) return std::nullopt;
  if (u.knots() + v.knots() + 4 * u.points() * v.points() > in.room())
    return in.fail(
        fmt::format("{} x {} control points: more than the entity's lines can hold", u.points(), v.points()));
  nurbs::Surface surface;
  surface.degree_u = static_cast<int>(u.degree);
  surface.degree_v = static_cast<int>(v.degree);
  surface.count_u = static_cast<int>(u.points());
  surface.count_v = static_cast<int>(v.points());
  const std::size_t count = u.points() * v.points();
  if (!read_knots(in, u, surface.knots_u, "knot of u") || !read_knots(in, v, surface.knots_v, "knot of v") ||
      !read_weights(in, count, surface.weights))
    return std::nullopt;
  surface.points.resize(count);
  if (!in.reals(surface.points.data()->data(), 3 * count)) return std::nullopt;
  std::array<double, 4> ranges{};
  for (double& range : ranges) range = in.real();
  if (!in.ok() || !mend_tears(reading, entry, in, surface)) return std::nullopt;
  const Range domain_u{surface.first_u(), surface.last_u()}, domain_v{surface.first_v(), surface.last_v()};
  const Range used_u = used_range(reading, entry, {ranges[0], ranges[1]}, domain_u, "u");
  const Range used_v = used_range(reading, entry, {ranges[2], ranges[3]}, domain_v, "v");
  if (used_u == domain_u && used_v == domain_v) return surface;
  return nurbs::restricted(surface, used_u.from, used_u.to, used_v.from, used_v.to);
}

}  // namespace

std::span<const EntityType> bspline_types() {
  static constexpr std::array<EntityType, 2> types = {
      {{.number = 126, .curve = read_curve}, {.number = 128, .surface = read_surface}}};
  return types;
}

}  // namespace selvage::formats::iges
