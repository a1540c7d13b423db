#include "nurbs/measure.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numeric>
#include <optional>
#include <type_traits>

#include "core/index.h"
#include "nurbs/basis.h"

namespace selvage::nurbs {

namespace {

class AdaptiveIntegral {
 public:
  AdaptiveIntegral(const std::function<double(double)>& f, double rounding) : f_(f), rounding_(rounding) {}

  double over(double t0, double t1) {
    const double whole = by_gauss(t0, t1);
    // The span of a long curve is a small part of its parameters, whose rounding is then no small part of it.
    agreement_ = std::max(agreement_, 2 * DBL_EPSILON * std::max(std::abs(t0), std::abs(t1)) / (t1 - t0));
    rounding_ = std::max(rounding_, agreement_ * whole);
    return halved(t0, t1, whole, most_halvings);
  }

 private:
  static constexpr int most_halvings = 52, few_pieces = 256, most_pieces = 4096;

  [[nodiscard]] double by_gauss(double t0, double t1) const {
    const GaussRule& rule = gauss_rule(8);
    const double half = 0.5 * (t1 - t0), middle = 0.5 * (t1 + t0);
    double sum = 0.0;
    for (std::size_t g = 0; g < rule.nodes.size(); ++g)
      sum += rule.weights[g] * f_(middle + half * rule.nodes[g]);
    return half * sum;
  }

  double halved(double t0, double t1, double whole, int halvings) {
    const double middle = 0.5 * (t0 + t1);
    const double left = by_gauss(t0, middle), right = by_gauss(middle, t1), both = left + right;
    // A piece is measured by its own value while there are few. Where a curve all but stands still, under a
    // weight of 1e9, no piece ever is as exact as that, nor need be.
    const double enough = std::max(agreement_ * both, ++pieces_ > few_pieces ? rounding_ : 0.0);
    // So put that what is no number ends it, too.
    if (halvings == 0 || !(middle > t0 && middle < t1) || pieces_ > most_pieces ||
        !(std::abs(both - whole) > enough))
      return both;
    return halved(t0, middle, left, halvings - 1) + halved(middle, t1, right, halvings - 1);
  }

  const std::function<double(double)>& f_;
  double rounding_, agreement_ = 1e-13;
  int pieces_ = 0;
};

// What the rounding of coordinates leaves open of the length about this parameter: no piece can be as exact
// as 32 units in the last place of the span's points, or 1e-13 of their polygon.
double length_rounding(const Curve& curve, double t) {
  const int count = static_cast<int>(curve.points.size());
  const auto last = static_cast<std::size_t>(find_span(curve.knots, curve.degree, count, t));
  double largest = 0, polygon = 0;
  for (std::size_t i = last - static_cast<std::size_t>(curve.degree); i <= last; ++i) {
    largest = std::max(largest, curve.points[i].cwiseAbs().maxCoeff());
    if (i < last) polygon += (curve.points[i + 1] - curve.points[i]).norm();
  }
  return std::max(1e-13 * polygon, 32 * DBL_EPSILON * largest);
}

// Of a cubic within one of its spans: the slope is a parabola, known from three places.
class SpeedOfCubic {
 public:
  SpeedOfCubic(const Curve& curve, double from, double to)
      : middle_(0.5 * (from + to)), quarter_(0.25 * (to - from)) {
    const auto slope = [&](double t) { return evaluate_jet(curve, t).d1; };
    const Vec3 before = slope(middle_ - quarter_), after = slope(middle_ + quarter_);
    slope_ = slope(middle_);
    change_ = 0.5 * (after - before);
    bend_ = 0.5 * (after + before) - slope_;
  }
  double operator()(double t) const {
    const double x = (t - middle_) / quarter_;
    return (slope_ + x * (change_ + x * bend_)).norm();
  }

 private:
  double middle_, quarter_;
  Vec3 slope_, change_, bend_;
};

// The basis functions' values and first derivatives at the Gauss nodes of every span.
struct Node {
  Node(int first_point, double its_weight) : first(first_point), weight(its_weight) {}
  int first;  // index of the first control point that counts here
  double weight;
  BasisRow value, slope;  // as many as the degree wants
};

// One of the two directions of a surface, with the ends of its spans.
struct Direction {
  const std::vector<double>& knots;
  int degree, count;
  std::vector<double> breaks = breakpoints(knots, degree);

  [[nodiscard]] std::size_t spans() const { return breaks.size() - 1; }
};
Direction round_of(const Surface& surface) {
  return {.knots = surface.knots_u, .degree = surface.degree_u, .count = surface.count_u};
}
Direction along_of(const Surface& surface) {
  return {.knots = surface.knots_v, .degree = surface.degree_v, .count = surface.count_v};
}

// Nodes of the spans from `first` to before `last`, each of them in `parts` equal parts.
std::vector<Node> gauss_nodes(const Direction& direction, int order, int parts, std::size_t first,
                              std::size_t last) {
  const GaussRule& rule = gauss_rule(order);
  std::vector<Node> nodes;
  nodes.reserve((last - first) * rule.nodes.size() * static_cast<std::size_t>(parts));
  for (std::size_t k = first; k < last; ++k)
    for (int part = 0; part < parts; ++part) {
      const double length = (direction.breaks[k + 1] - direction.breaks[k]) / parts;
      const double half = 0.5 * length, middle = direction.breaks[k] + (part + 0.5) * length;
      const int span = find_span(direction.knots, direction.degree, direction.count, middle);
      for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
        const double t = middle + half * rule.nodes[g];
        Node& node = nodes.emplace_back(span - direction.degree, half * rule.weights[g]);
        basis_slopes(direction.knots, direction.degree, span, t, node.value, node.slope);
      }
    }
  return nodes;
}
std::vector<Node> gauss_nodes(const Direction& direction, int order, int parts) {
  return gauss_nodes(direction, order, parts, 0, direction.spans());
}

// Gauss nodes that integrate the product of two functions of a basis and the slope of a third.
int flux_order(int degree) {
  return std::min(8, (3 * degree + 1) / 2);
}

// Of a rational surface no polynomial rule is exact: four parts to a span bring the error down to rounding
// where weights differ by no more than those of conics, twice as many for each four times that they differ
// more.
int parts_of(const Surface& surface) {
  if (!surface.is_rational()) return 1;
  constexpr int most = 16;  // a file chooses the weights, and the nodes of a span are their square
  const auto [least, largest] = std::minmax_element(surface.weights.begin(), surface.weights.end());
  int parts = 4;
  for (double ratio = *largest / *least; ratio > 2 && parts < most; ratio /= 4) parts *= 2;
  return parts;
}

// work(degree), as a number that the compiler knows where it is that of most splines.
template <class Work>
void with_degree(int degree, const Work& work) {
  if (degree == 3)
    work(std::integral_constant<int, 3>());
  else if (degree == 2)
    work(std::integral_constant<int, 2>());
  else
    work(degree);
}

// Numbers at two places: one register of any processor, with the operators of a number.
using Pair [[gnu::vector_size(16)]] = double;
double sum_of(Pair pair) {
  return pair[0] + pair[1];
}

// Vectors at two places.
struct TwoVectors {
  Pair x{}, y{}, z{};

  [[nodiscard]] Pair dot(const TwoVectors& v) const { return x * v.x + y * v.y + z * v.z; }
  [[nodiscard]] TwoVectors cross(const TwoVectors& v) const {
    return {y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x};
  }
  [[nodiscard]] double length() const {
    const Pair square = dot(*this);
    return std::sqrt(square[0]) + std::sqrt(square[1]);
  }
  [[nodiscard]] Vec3 sum() const { return {sum_of(x), sum_of(y), sum_of(z)}; }
  TwoVectors& operator+=(const TwoVectors& v) {
    x += v.x;
    y += v.y;
    z += v.z;
    return *this;
  }
};
TwoVectors operator*(Pair shares, const TwoVectors& v) {
  return {shares * v.x, shares * v.y, shares * v.z};
}
TwoVectors operator*(double share, const TwoVectors& v) {
  return Pair{share, share} * v;
}

// What Lines are made of: control points, of a rational surface times their weights, or these alone (as x).
enum class Net { points, weighted_points, weights };

// A surface at two v at once: at each of them the net collapses to a line of control points over u and one of
// their derivatives by v, told from the origin.
template <Net net>
class Lines {
 public:
  Lines(const Surface& surface, const Vec3& origin)
      : surface_(surface), origin_(origin), points_(at(surface.count_u)), slopes_(points_.size()) {}

  // To a node and the one behind it, or the last of all alone.
  void move_to(const std::vector<Node>& nodes, std::size_t n) {
    const bool is_last = n + 1 == nodes.size();
    const Node &one = nodes[n], &other = nodes[is_last ? n : n + 1];
    shares_ = Pair{one.weight, is_last ? 0.0 : other.weight};
    for (std::size_t j = 0; j <= at(surface_.degree_v); ++j) {
      values_[j] = Pair{one.value[j], other.value[j]};
      changes_[j] = Pair{one.slope[j], other.slope[j]};
    }
    with_degree(surface_.degree_v, [&](auto degree) {
      const std::size_t columns = points_.size();
      for (std::size_t i = 0; i < columns; ++i) {
        TwoVectors point, slope;
        for (std::size_t j = 0; j <= at(int{degree}); ++j) {
          const Vec3 p = at_net(one.first, i, j), q = at_net(other.first, i, j);
          const TwoVectors both = {Pair{p.x(), q.x()}, Pair{p.y(), q.y()}, Pair{p.z(), q.z()}};
          point += values_[j] * both;
          slope += changes_[j] * both;
        }
        points_[i] = point;
        slopes_[i] = slope;
      }
    });
  }

  [[nodiscard]] const TwoVectors* points() const { return points_.data(); }
  [[nodiscard]] const TwoVectors* slopes() const { return slopes_.data(); }
  // What the nodes count.
  [[nodiscard]] Pair shares() const { return shares_; }

 private:
  [[nodiscard]] Vec3 at_net(int first, std::size_t i, std::size_t j) const {
    const std::size_t k = (at(first) + j) * points_.size() + i;
    if constexpr (net == Net::weights) return {surface_.weights[k], 0, 0};
    Vec3 p = surface_.points[k] - origin_;
    if constexpr (net == Net::weighted_points) p *= surface_.weights[k];
    return p;
  }

  const Surface& surface_;
  Vec3 origin_;
  Pair shares_{};
  std::array<Pair, max_degree + 1> values_, changes_;
  std::vector<TwoVectors> points_, slopes_;
};

// From those of the homogeneous surface (Piegl and Tiller 4.20).
void divide(TwoVectors& position, TwoVectors& along_u, TwoVectors& along_v,
            const Lines<Net::weights>& weights, const Node& u, int degree) {
  Pair w{}, w_u{}, w_v{};
  for (std::size_t i = 0; i <= at(degree); ++i) {
    const std::size_t k = at(u.first) + i;
    w += u.value[i] * weights.points()[k].x;
    w_u += u.slope[i] * weights.points()[k].x;
    w_v += u.value[i] * weights.slopes()[k].x;
  }
  position = (1.0 / w) * position;
  along_u = (1.0 / w) * (along_u += -w_u * position);
  along_v = (1.0 / w) * (along_v += -w_v * position);
}

// take(number of the node in nodes_u, position - origin, S_u x S_v times the weight) for nodes of one span of
// v, two at once. What takes no position gets none.
template <bool is_rational, class Take>
void at_nodes_of(const Surface& surface, const Vec3& origin, const std::vector<Node>& nodes_u,
                 const std::vector<Node>& nodes_v, const Take& take) {
  constexpr bool takes_position = std::is_invocable_v<Take, std::size_t, TwoVectors, TwoVectors>;
  Lines<is_rational ? Net::weighted_points : Net::points> lines(surface, origin);
  std::optional<Lines<Net::weights>> weights;
  if constexpr (is_rational) weights.emplace(surface, origin);
  with_degree(surface.degree_u, [&](auto degree) {
    for (std::size_t done = 0; done < nodes_v.size(); done += 2) {
      lines.move_to(nodes_v, done);
      if constexpr (is_rational) weights->move_to(nodes_v, done);
      for (std::size_t n = 0; n < nodes_u.size(); ++n) {
        const Node& u = nodes_u[n];
        TwoVectors position, along_u, along_v;
        const TwoVectors *const point = lines.points() + u.first, *const slope = lines.slopes() + u.first;
        for (std::size_t i = 0; i <= at(int{degree}); ++i) {
          if constexpr (takes_position || is_rational) position += u.value[i] * point[i];
          along_u += u.slope[i] * point[i];
          along_v += u.value[i] * slope[i];
        }
        if constexpr (is_rational) divide(position, along_u, along_v, *weights, u, surface.degree_u);
        const TwoVectors normal = u.weight * lines.shares() * along_u.cross(along_v);
        if constexpr (takes_position)
          take(n, position, normal);
        else
          take(n, normal);
      }
    }
  });
}
template <class Take>
void at_nodes(const Surface& surface, const Vec3& origin, const std::vector<Node>& nodes_u,
              const std::vector<Node>& nodes_v, const Take& take) {
  if (surface.is_rational())
    at_nodes_of<true>(surface, origin, nodes_u, nodes_v, take);
  else
    at_nodes_of<false>(surface, origin, nodes_u, nodes_v, take);
}

// Through a line P = sum N_i p_i over u, moving by Q = sum N_k q_k, the flux of P is the integral of
// P . (P' x Q): the sum of the volumes (p_i x p_j) . q_k, i < j, times the integrals of (N_i N_j' - N_j N_i')
// N_k.
class FluxRound {
 public:
  explicit FluxRound(const Direction& round)
      : degree_(round.degree), count_(round.count), integrals_(pair(count_, 1)) {
    for (const Node& node : gauss_nodes(round, flux_order(degree_), 1))
      for (int a = 0; a <= degree_; ++a)
        for (int b = a + 1; b <= degree_; ++b) {
          double* const of_pair = integrals_.data() + pair(node.first + a, b - a);
          const double turn = node.value[at(a)] * node.slope[at(b)] - node.value[at(b)] * node.slope[at(a)];
          // The first k that goes with i is i - degree.
          for (int c = 0; c <= degree_; ++c)
            of_pair[c - a + degree_] += node.weight * turn * node.value[at(c)];
        }
  }

  // The sum of the fluxes at two v, each times its share.
  [[nodiscard]] double operator()(const Lines<Net::points>& lines) const {
    Pair flux{};
    for (int i = 0; i + 1 < count_; ++i) {
      const int last = std::min(count_ - 1, i + degree_);
      for (int j = i + 1; j <= last; ++j) {
        const double* const of_pair = integrals_.data() + pair(i, j - i) + (degree_ - i);
        TwoVectors sum;
        for (int k = std::max(0, j - degree_); k <= last; ++k) sum += of_pair[k] * lines.slopes()[k];
        flux += lines.points()[i].cross(lines.points()[j]).dot(sum);
      }
    }
    return sum_of(flux * lines.shares());
  }

 private:
  [[nodiscard]] int width() const { return 2 * degree_ + 1; }
  // Where the integrals of i and j = i + step begin.
  [[nodiscard]] std::size_t pair(int i, int step) const {
    return (at(i) * at(degree_) + at(step - 1)) * at(width());
  }

  int degree_, count_;
  std::vector<double> integrals_;
};

// The integrals of moments(), strip by strip: a span of v, all round. Rule 0 is exact for all but the area,
// for which rule 1 has two nodes more, and rules 2, 3, .. are rule 1 on halves, quarters, .. of the spans.
class MomentIntegrals {
 public:
  MomentIntegrals(const Surface& surface, const Vec3& origin)
      : surface_(surface), origin_(origin), round_(round_of(surface)), along_(along_of(surface)) {}

  Moments whole(double area_error) {
    Moments sum;
    std::vector<Areas> strips;
    for (std::size_t strip = 0; strip < along_.spans(); ++strip) strips.push_back(all_of(strip, sum));
    for (const Areas& areas : strips) sum.area += total(areas);
    const double enough = std::max(area_error, 1e-10 * sum.area) / static_cast<double>(along_.spans());
    for (std::size_t strip = 0; strip < strips.size(); ++strip)
      sum.area += refined(strip, strips[strip], enough) - total(strips[strip]);
    return sum;
  }

 private:
  using Areas = std::vector<double>;  // of the spans round a strip
  static constexpr std::size_t last_rule = 6;
  static constexpr int most_parts = 128;  // of a span: a weight may let the area grow without end

  static double total(const Areas& areas) { return std::accumulate(areas.begin(), areas.end(), 0.0); }
  // Span by span, so that errors of opposite sign do not hide each other.
  static double difference(const Areas& a, const Areas& b) {
    return std::transform_reduce(a.begin(), a.end(), b.begin(), 0.0, std::plus<>(),
                                 [](double x, double y) { return std::abs(x - y); });
  }

  // S (S . (S_u x S_v)) has degree 4 p - 1 in each direction, which eight nodes integrate up to degree 4.
  [[nodiscard]] int order(int degree, std::size_t rule) const {
    return (surface_.is_rational() ? 8 : std::min(8, 2 * degree)) + (rule == 0 ? 0 : 2);
  }
  [[nodiscard]] int parts(std::size_t rule) const {
    const int whole = std::max(parts_of(surface_), (std::max(round_.degree, along_.degree) + 3) / 4);
    return whole << (rule > 1 ? rule - 1 : 0);
  }

  // take(span of u, position - origin, S_u x S_v times the weight) at the nodes of a strip, two at once,
  // without the position where it takes none.
  template <class Take>
  void at_strip(std::size_t strip, std::size_t rule, const Take& take) {
    std::vector<Node>& nodes_u = nodes_u_[rule];
    if (nodes_u.empty()) nodes_u = gauss_nodes(round_, order(round_.degree, rule), parts(rule));
    const std::vector<Node> nodes_v =
        gauss_nodes(along_, order(along_.degree, rule), parts(rule), strip, strip + 1);
    const std::size_t of_span = nodes_u.size() / round_.spans();
    at_nodes(
        surface_, origin_, nodes_u, nodes_v,
        [&](std::size_t node,
            const auto&... vectors) requires std::is_invocable_v<Take, std::size_t, decltype(vectors)...> {
          take(node / of_span, vectors...);
        });
  }

  // Adds all but the area to the sum.
  Areas all_of(std::size_t strip, Moments& sum) {
    Areas areas(round_.spans());
    TwoVectors area_vector, first;
    Pair volume{};
    at_strip(strip, 0, [&](std::size_t span, const TwoVectors& position, const TwoVectors& normal) {
      const Pair flux = position.dot(normal);
      areas[span] += normal.length();
      area_vector += normal;
      volume += flux;
      first += flux * position;
    });
    sum.area_vector += area_vector.sum();
    sum.volume += sum_of(volume) / 3.0;
    sum.first += first.sum() / 4.0;
    return areas;
  }
  Areas areas_of(std::size_t strip, std::size_t rule) {
    Areas areas(round_.spans());
    at_strip(strip, rule,
             [&](std::size_t span, const TwoVectors& normal) { areas[span] += normal.length(); });
    return areas;
  }

  // The error of Gauss's rule with n nodes goes down like q^-2n, so that of two nodes more is at most the
  // power 1 + 2 / n of it, relative. Of finer rules the error is put at what it was before.
  double refined(std::size_t strip, Areas areas, double enough) {
    const double most_nodes = order(std::max(round_.degree, along_.degree), 0);
    for (std::size_t rule = 1; rule <= last_rule && parts(rule) <= most_parts; ++rule) {
      Areas finer = areas_of(strip, rule);
      const double change = difference(areas, finer), area = total(finer);
      areas = std::move(finer);
      const double error =
          rule == 1 && change > 0 ? area * std::pow(change / area, 1 + 2 / most_nodes) : change;
      if (!(error > enough)) break;
    }
    return total(areas);
  }

  const Surface& surface_;
  Vec3 origin_;
  Direction round_, along_;
  std::array<std::vector<Node>, last_rule + 1> nodes_u_;
};

}  // namespace

double adaptive_integral(const std::function<double(double)>& f, double t0, double t1, double rounding) {
  return AdaptiveIntegral(f, rounding).over(t0, t1);
}

double arc_length(const Curve& curve, double t0, double t1) {
  // Knot by knot from the one after t0: a short piece of a long curve costs no more than its own spans.
  auto knot = std::upper_bound(curve.knots.begin(), curve.knots.end(), t0);
  const bool is_cubic = curve.degree <= 3 && !curve.is_rational();
  double sum = 0.0, from = t0;
  while (from < t1) {
    while (knot != curve.knots.end() && *knot <= from) ++knot;
    const double to = knot == curve.knots.end() ? t1 : std::min(*knot, t1);
    const auto integral = [&](const auto& speed) {
      return adaptive_integral([&](double t) { return speed(t); }, from, to,
                               length_rounding(curve, 0.5 * (from + to)));
    };
    sum += is_cubic ? integral(SpeedOfCubic(curve, from, to))
                    : integral([&](double t) { return evaluate_jet(curve, t).d1.norm(); });
    from = to;
  }
  return sum;
}

double arc_length(const Curve& curve) {
  return arc_length(curve, curve.first_parameter(), curve.last_parameter());
}

double volume_flux(const Surface& surface, const Vec3& origin) {
  const Direction round = round_of(surface), along = along_of(surface);
  double sum = 0.0;
  if (surface.is_rational()) {
    const std::vector<Node> nodes_u = gauss_nodes(round, 8, parts_of(surface));
    for (std::size_t span = 0; span < along.spans(); ++span)
      at_nodes(surface, origin, nodes_u, gauss_nodes(along, 8, parts_of(surface), span, span + 1),
               [&](std::size_t /*node*/, const TwoVectors& position, const TwoVectors& normal) {
                 sum += sum_of(position.dot(normal));
               });
    return sum / 3.0;
  }
  // S . (S_u x S_v) has degree 3 p - 1 in each direction: of a cubic's span five nodes are exact.
  const FluxRound flux(round);
  Lines<Net::points> lines(surface, origin);
  for (std::size_t span = 0; span < along.spans(); span += 2) {
    const std::vector<Node> nodes =
        gauss_nodes(along, flux_order(along.degree), 1, span, std::min(span + 2, along.spans()));
    for (std::size_t n = 0; n < nodes.size(); n += 2) {
      lines.move_to(nodes, n);
      sum += flux(lines);
    }
  }
  return sum / 3.0;
}

Moments& Moments::operator+=(const Moments& other) {
  area += other.area;
  area_vector += other.area_vector;
  volume += other.volume;
  first += other.first;
  return *this;
}

Moments moments(const Surface& surface, const Vec3& origin, double area_error) {
  return MomentIntegrals(surface, origin).whole(area_error);
}

}  // namespace selvage::nurbs
