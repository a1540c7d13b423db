#include "formats/tg3/lay.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/bounds.h"

namespace selvage::formats::tg3 {

namespace {

constexpr std::size_t most_control_points = 5'000'000;  // of a unit, and of all copies of a yarn together
constexpr double most_copies = 100'000, most_steps = 1e9;
constexpr double most_looked_at = 3e8;  // points of all copies, those that turn out to be outside as well
constexpr std::size_t most_planes = 64;
constexpr double barely = 1e-6;  // of a size: what reaches no farther into the domain is outside

// The corners of what the half spaces share: where three of their planes meet inside all others.
std::vector<Vec3> corners_of(const std::vector<HalfSpace>& sides) {
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size(); ++j)
      for (std::size_t k = j + 1; k < sides.size(); ++k) {
        Eigen::Matrix3d normals;
        normals << sides[i].normal.transpose(), sides[j].normal.transpose(), sides[k].normal.transpose();
        if (std::abs(normals.determinant()) < 1e-9) continue;
        const Vec3 corner = normals.inverse() * Vec3(sides[i].distance, sides[j].distance, sides[k].distance);
        const bool is_inside = std::ranges::all_of(sides, [&](const HalfSpace& side) {
          return side.normal.dot(corner) >= side.distance - 1e-9 * (1 + corner.norm());
        });
        if (is_inside) corners.push_back(corner);
      }
  return corners;
}

// Numbers of repeats along each, in the order of TextileYarn::repeats.
using Steps = std::vector<int>;

class Layer {
 public:
  Layer(const TextileYarn& yarn, const YarnUnit& unit, const Fields& fields)
      : yarn_(yarn),
        unit_(unit),
        fields_(fields),
        repeats_(3, static_cast<Eigen::Index>(yarn.repeats.size())) {
    for (std::size_t k = 0; k < yarn.repeats.size(); ++k)
      repeats_.col(static_cast<Eigen::Index>(k)) = yarn.repeats[k];
    box_ = bounds_of(unit.grid.points);
  }

  // Lines of units: where the first one stands, and how many there are. Nothing: an error was told.
  std::optional<std::vector<std::pair<Vec3, int>>> lines(const Domain& domain) {
    const std::vector<Vec3> corners = corners_of(domain.sides);
    Box3 reach;  // of the shifts at which the unit's box meets the domain's
    const Box3 room = bounds_of(corners);
    reach.extend(room.min() - box_.max());
    reach.extend(room.max() - box_.min());
    if (repeats_.cols() == 0) return std::vector{std::pair(Vec3(Vec3::Zero()), 1)};
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(repeats_, Eigen::ComputeThinU | Eigen::ComputeThinV);
    if (repeats_.cols() > 3 || svd.singularValues().minCoeff() < 1e-9 * svd.singularValues().maxCoeff()) {
      fields_.error(error(Kind::geometry,
                          "the repeats of this yarn lie in one line or plane: each has to lead where the "
                          "others do not"),
                    yarn_.place);
      return std::nullopt;
    }
    inverse_ = svd.solve(Eigen::Matrix3d::Identity());
    std::vector<std::array<double, 2>> ranges;
    double copies = 1;
    for (Eigen::Index k = 0; k < repeats_.cols(); ++k) {
      double low = 0, high = 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double a = inverse_(k, axis) * reach.min()[axis], b = inverse_(k, axis) * reach.max()[axis];
        low += std::min(a, b);
        high += std::max(a, b);
      }
      if (!(low > -most_steps && high < most_steps)) {
        fields_.error(
            error(Kind::limit, "the domain is too far from this yarn: more than 1e9 of its repeats"),
            yarn_.place);
        return std::nullopt;
      }
      ranges.push_back({std::ceil(low - 1e-9), std::floor(high + 1e-9)});
      copies *= std::max(0.0, ranges.back()[1] - ranges.back()[0] + 1);
    }
    if (!(copies <= most_copies &&
          copies * static_cast<double>(unit_.grid.points.size()) <= most_looked_at)) {
      fields_.error(
          error(Kind::limit,
                fmt::format("the domain holds {:.3g} copies of this yarn of {} control points; make "
                            "it smaller",
                            copies, unit_.grid.points.size())),
          yarn_.place);
      return std::nullopt;
    }
    return joined(standing(ranges, domain));
  }

 private:
  [[nodiscard]] Vec3 shift_of(const Steps& steps) const {
    Vec3 shift = Vec3::Zero();
    for (std::size_t k = 0; k < steps.size(); ++k) shift += steps[k] * yarn_.repeats[k];
    return shift;
  }

  [[nodiscard]] bool reaches_into(const Domain& domain, const Vec3& shift) const {
    const double margin = barely * box_.sizes().maxCoeff();
    return std::ranges::all_of(domain.sides, [&](const HalfSpace& side) {
      const double needed = side.distance - side.normal.dot(shift) + margin;
      return std::ranges::any_of(unit_.grid.points,
                                 [&](const Vec3& point) { return side.normal.dot(point) > needed; });
    });
  }

  // All copies within the ranges that reach into the domain.
  [[nodiscard]] std::vector<Steps> standing(const std::vector<std::array<double, 2>>& ranges,
                                            const Domain& domain) const {
    std::vector<Steps> all = {{}};
    for (const auto& [low, high] : ranges) {
      std::vector<Steps> longer;
      for (const Steps& steps : all)
        for (int step = static_cast<int>(low); step <= static_cast<int>(high); ++step) {
          longer.push_back(steps);
          longer.back().push_back(step);
        }
      all = std::move(longer);
    }
    std::erase_if(all, [&](const Steps& steps) { return !reaches_into(domain, shift_of(steps)); });
    return all;
  }

  // The repeats that lead from the yarn's beginning to its end; empty: none do.
  [[nodiscard]] Steps own_steps() const {
    const Vec3 way = yarn_.nodes.back().position - yarn_.nodes.front().position;
    const Eigen::VectorXd share = inverse_ * way;
    Steps steps;
    for (const double one : share) steps.push_back(static_cast<int>(std::lround(one)));
    const bool leads = (shift_of(steps) - way).norm() <= barely * way.norm();
    return leads && unit_.goes_on ? steps : Steps();
  }

  [[nodiscard]] std::vector<std::pair<Vec3, int>> joined(const std::vector<Steps>& copies) const {
    const Steps own = own_steps();
    std::vector<std::pair<Vec3, int>> lines;
    if (std::ranges::all_of(own, [](int step) { return step == 0; })) {
      for (const Steps& steps : copies) lines.emplace_back(shift_of(steps), 1);
      return lines;
    }
    // The copy of each line of which the step along the yarn's longest own one is the smallest, and the first
    // and last of the units that stand from there.
    std::size_t longest = 0;
    for (std::size_t k = 1; k < own.size(); ++k)
      if (std::abs(own[k]) > std::abs(own[longest])) longest = k;
    std::map<Steps, std::array<int, 2>> reach;
    for (Steps steps : copies) {
      const int units = static_cast<int>(std::floor(static_cast<double>(steps[longest]) / own[longest]));
      for (std::size_t k = 0; k < own.size(); ++k) steps[k] -= units * own[k];
      const auto [found, is_new] = reach.try_emplace(steps, std::array{units, units});
      auto& [first, last] = found->second;
      first = std::min(first, units);
      last = std::max(last, units);
    }
    for (const auto& [steps, ends] : reach) {
      Steps first = steps;
      for (std::size_t k = 0; k < own.size(); ++k) first[k] += ends[0] * own[k];
      lines.emplace_back(shift_of(first), ends[1] - ends[0] + 1);
    }
    return lines;
  }

  const TextileYarn& yarn_;
  const YarnUnit& unit_;
  const Fields& fields_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> repeats_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> inverse_;
  Box3 box_;
};

}  // namespace

std::optional<Domain> read_domain(const Element& element, const Fields& fields) {
  const std::string_view type = fields.text(element, "type");
  if (type != "CDomainPlanes") {
    fields.warning(
        element,
        fmt::format("a domain of the type {} is left out: the yarns are not repeated, and there is no "
                    "cell; planes (CDomainPlanes) are read",
                    in_quotes(type)));
    return std::nullopt;
  }
  const int errors = fields.errors();
  Domain domain;
  domain.place = element.place;
  for (const Element& plane : element.children) {
    if (plane.name != "Plane") continue;
    const Vec3 normal = fields.vector(plane, "Normal");
    const double distance = fields.number(plane, "d");
    if (fields.errors() > errors) return std::nullopt;
    if (!(normal.norm() > 0))
      fields.error(plane, "the normal of this plane is zero: it has to point into the domain");
    else
      domain.sides.push_back({normal.normalized(), distance / normal.norm()});
  }
  if (domain.sides.size() > most_planes)
    fields.error(
        element,
        fmt::format("this domain has {} planes; up to {} are read", domain.sides.size(), most_planes),
        Kind::limit);
  if (fields.errors() > errors) return std::nullopt;
  if (const std::vector<Vec3> corners = corners_of(domain.sides);
      corners.size() < 4 || !(bounds_of(corners).sizes().minCoeff() > 0)) {
    fields.warning(
        element,
        "the planes of this domain enclose no volume: the yarns are not repeated, and there is no cell; "
        "the normals of two opposite planes have to point at each other");
    return std::nullopt;
  }
  if (!cell_of(domain))
    fields.warning(
        element,
        "this domain is no box along the axes: the yarns are repeated over it, but there is no cell");
  return domain;
}

std::optional<fabric::Cell> cell_of(const Domain& domain) {
  if (domain.sides.size() != 6) return std::nullopt;
  fabric::Cell cell;
  cell.place = domain.place;
  std::array<std::array<bool, 2>, 3> is_set{};
  for (const HalfSpace& side : domain.sides) {
    Eigen::Index axis = 0;
    if (side.normal.cwiseAbs().maxCoeff(&axis) < 1 - 1e-12) return std::nullopt;
    const bool is_high = side.normal[axis] < 0;
    (is_high ? cell.high : cell.low)[axis] = side.normal[axis] * side.distance;
    is_set[static_cast<std::size_t>(axis)][is_high ? 1 : 0] = true;
  }
  if (is_set != std::array<std::array<bool, 2>, 3>{{{true, true}, {true, true}, {true, true}}})
    return std::nullopt;
  return cell;
}

double lay(const TextileYarn& yarn, const std::optional<Domain>& domain, double tolerance,
           const Fields& fields, fabric::Fabric& fabric) {
  const auto refuse = [&](const Message& message) {
    fields.error(message, yarn.place);
    return 0.0;
  };
  Result<YarnPath> path = YarnPath::make(yarn.nodes, yarn.interpolation);
  if (!path) return refuse(path.error());
  if (const std::size_t replaced = path->num_replaced_ups(); replaced > 0)
    fields.warning(yarn.place,
                   fmt::format("the direction `Up` lies along the line at {} of the {} nodes of this "
                               "yarn: it is taken across the line there",
                               replaced, yarn.nodes.size()));
  YarnShape shape{.path = std::move(*path),
                  .sections = yarn.sections,
                  .pieces = yarn.pieces,
                  .blend = yarn.blend,
                  .adjustments = yarn.adjustments,
                  .tolerance = tolerance};
  const std::vector<double> bends = yarn.adjustments.bends_round();
  for (Section& section : shape.sections) {
    section.corners.insert(section.corners.end(), bends.begin(), bends.end());
    section.corners = corners_of(std::array<const Section*, 1>{&section});
  }
  if (!yarn.positions.empty()) shape.pieces = pieces_of_positions(shape.path, yarn.positions);
  if (shape.pieces.empty()) shape.pieces = constant_pieces(shape.path);
  const Result<YarnUnit> unit = surface_of(shape, most_control_points);
  if (!unit) return refuse(unit.error());
  std::vector<std::pair<Vec3, int>> lines = {{Vec3::Zero(), 1}};
  if (domain) {
    const auto found = Layer(yarn, *unit, fields).lines(*domain);
    if (!found) return 0.0;
    lines = *found;
  }
  std::size_t points = 0;
  for (const auto& [shift, units] : lines)
    points += unit->grid.points.size() * static_cast<std::size_t>(units);
  if (points > most_control_points)
    return refuse(
        error(Kind::limit, fmt::format("the copies of this yarn in the domain would need more than {} "
                                       "control points; make the domain smaller",
                                       most_control_points)));
  if (lines.empty())
    fields.warning(yarn.place, "no copy of this yarn reaches into the domain: it is left out");
  const Vec3 period = yarn.nodes.back().position - yarn.nodes.front().position;
  int number = 0;
  for (const auto& [shift, units] : lines) {
    fabric::Grid grid = chained(unit->grid, period, units);
    for (Vec3& point : grid.points) point += shift;
    grid.place = yarn.place;
    fabric::Yarn one;
    one.name = lines.size() == 1 ? yarn.name : fmt::format("{}_{}", yarn.name, ++number);
    one.place = yarn.place;
    one.thread = yarn.thread;
    one.thread_place = yarn.place;
    if (yarn.role != fabric::Role::other) one.role = yarn.role;
    one.shape = std::move(grid);
    fabric.items.emplace_back(std::move(one));
  }
  return unit->deviation;
}

}  // namespace selvage::formats::tg3
