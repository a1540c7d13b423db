#include "fabric/yarn_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fabric {

namespace {

using std::numbers::pi;

Message at_thread(const Fabric& fabric, const Yarn& yarn, const Message& message) {
  return message.placed(yarn.place, fabric.file).of_yarn(yarn.name);
}

bool every_row_has_a_size(const Path& path) {
  return !path.sizes.empty() &&
         std::all_of(path.sizes.begin(), path.sizes.end(), [](const auto& s) { return s.has_value(); });
}

// The rows of a yarn's path; of a helix one without sizes.
const Path* path_of(const Yarn& yarn) {
  static const Path one_row = [] {
    Path path;
    path.points.resize(1);
    return path;
  }();
  return std::holds_alternative<Helix>(yarn.shape) ? &one_row : std::get_if<Path>(&yarn.shape);
}

// By which the section stands turned at a row, radians.
double angle_at(const Path& path, std::size_t row) {
  const bool has_size = row < path.sizes.size() && path.sizes[row];
  return has_size ? path.sizes[row]->angle.value_or(0.0) / 180.0 * pi : 0.0;
}

// How far the section reaches from the path toward a direction given in section axes.
double support(const yarn::Section& section, const yarn::SectionSize& size, const Vec2& toward) {
  double largest = 0.0;
  for (const Vec2& p : yarn::make_outline(section, size, 8, false).points)
    largest = std::max(largest, p.dot(toward));
  return largest;
}

}  // namespace

double yarn_diameter(double tex, double density, double packing) {
  return 2.0 * std::sqrt(tex / (1000.0 * pi * density * packing));
}

Result<yarn::Section> section_of(const Thread& thread, Unit units, bool rows_give_sizes) {
  yarn::Section section = thread.section.value_or(yarn::Circle{});
  double* diameter = nullptr;
  if (auto* circle = std::get_if<yarn::Circle>(&section)) diameter = &circle->diameter;
  if (auto* loop7 = std::get_if<yarn::Loop7>(&section)) diameter = &loop7->diameter;
  if (diameter == nullptr || *diameter > 0.0) return section;
  if (thread.diameter) {
    *diameter = *thread.diameter;
  } else if (thread.linear_density && thread.fibre_density() && thread.size_packing()) {
    *diameter = yarn_diameter(thread.linear_density->tex(), *thread.fibre_density(), *thread.size_packing()) /
                millimetres_per(units);
  } else if (!rows_give_sizes) {
    std::string missing;
    for (const auto& [word, is_there] : {std::pair{"`tex`", thread.linear_density.has_value()},
                                         std::pair{"`density`", thread.fibre_density().has_value()},
                                         std::pair{"`packing`", thread.size_packing().has_value()}})
      if (!is_there) missing += (missing.empty() ? "" : ", ") + std::string(word);
    return error(
        Kind::geometry,
        fmt::format("nothing gives the size of the section: add `diameter`, a `section` with a size, or {}",
                    missing));
  }
  return section;
}

Result<yarn::Section> centred_section_of(const Thread& thread, Unit units) {
  Result<yarn::Section> section = section_of(thread, units, false);
  if (!section) return section;
  if (auto* polygon = std::get_if<yarn::Polygon>(&*section)) {
    Eigen::AlignedBox2d box;
    for (const Vec2& corner : polygon->corners) box.extend(corner);
    for (Vec2& corner : polygon->corners) corner -= box.center();
  }
  return section;
}

std::vector<yarn::SectionSize> row_sizes(const Path& path, const yarn::Section& section) {
  const yarn::SectionSize own = yarn::nominal_size(section);
  std::vector<yarn::SectionSize> sizes(path.points.size(), own);
  for (std::size_t i = 0; i < path.sizes.size(); ++i)
    if (path.sizes[i]) sizes[i] = {path.sizes[i]->width, path.sizes[i]->height};
  return sizes;
}

Result<yarn::PathRows> path_rows_of(const Fabric& fabric, const Yarn& yarn, const Thread& thread) {
  const Path& path = std::get<Path>(yarn.shape);
  yarn::PathRows rows;
  rows.form = path.form;
  rows.points = path.points;
  rows.closed = yarn.closed;
  rows.tangent_start = yarn.tangent_start;
  rows.tangent_end = yarn.tangent_end;
  rows.knots = path.knots;
  rows.error = path.error;
  if (path.form != yarn::PathForm::polyline) return rows;
  Result<yarn::Section> section = section_of(thread, fabric.units, every_row_has_a_size(path));
  if (!section) return at_thread(fabric, yarn, section.error());
  const std::vector<yarn::SectionSize> sizes = row_sizes(path, *section);
  for (const yarn::SectionSize& size : sizes)
    if (Status s = yarn::check_section(*section, size); !s) return at_thread(fabric, yarn, s.error());
  // The section's axes are carried from segment to segment by the turn at each corner, as the
  // rotation-minimizing frame does.
  const std::vector<Vec3>& p = path.points;
  const std::size_t n = p.size();
  rows.half_sizes.assign(n, 0.0);
  const auto direction = [&](std::size_t i) -> Vec3 { return (p[(i + 1) % n] - p[i]).normalized(); };
  Vec3 tangent = direction(0);
  Vec3 up = yarn.up.value_or(std::abs(tangent.z()) > std::cos(6.0 / 180.0 * pi) ? Vec3(Vec3::UnitY())
                                                                                : Vec3(Vec3::UnitZ()));
  up = (up - up.dot(tangent) * tangent).normalized();
  for (std::size_t k = 1; k < n + (yarn.closed ? 1 : 0); ++k) {
    const std::size_t i = k % n;
    if (!yarn.closed && i + 1 == n) break;
    const Vec3 next = direction(i), inward = next - tangent;
    if (inward.norm() > 1e-12) {
      Vec3 toward = inward - inward.dot(tangent) * tangent;
      toward.normalize();
      const double angle = angle_at(path, i);
      const Vec3 across = up.cross(tangent);
      const Vec3 x = std::cos(angle) * across + std::sin(angle) * up,
                 y = -std::sin(angle) * across + std::cos(angle) * up;
      rows.half_sizes[i] = support(*section, sizes[i], Vec2(toward.dot(x), toward.dot(y)));
    }
    up = Eigen::Quaterniond::FromTwoVectors(tangent, next) * up;
    tangent = next;
  }
  return rows;
}

double fibre_twist(const Thread& thread, Unit units) {
  if (!thread.twist) return 0.0;
  const double turns_per_unit = thread.twist->turns * millimetres_per(units) / 1000.0;
  return thread.twist->hand == Hand::z ? turns_per_unit : -turns_per_unit;
}

double section_twist(const Thread& thread, Unit units) {
  return thread.twist && thread.twist->rotates ? 2.0 * pi * fibre_twist(thread, units) : 0.0;
}

Result<yarn::TubeSpec> tube_spec_of(const Fabric& fabric, const Yarn& yarn, const Thread& thread,
                                    const std::vector<double>& row_parameters) {
  const Path& path = std::get<Path>(yarn.shape);
  yarn::TubeSpec spec;
  Result<yarn::Section> section = section_of(thread, fabric.units, every_row_has_a_size(path));
  if (!section) return at_thread(fabric, yarn, section.error());
  spec.section = *section;
  const std::vector<yarn::SectionSize> sizes = row_sizes(path, spec.section);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    spec.sizes.push_back({row_parameters[i], sizes[i], angle_at(path, i)});
    if (path.sizes.empty()) break;  // one size for the whole yarn
  }
  if (path.form == yarn::PathForm::smooth)
    spec.sizes = yarn::sparse_sizes(spec.sizes, path.error, yarn.closed);
  spec.guide = yarn::FrameGuide::free_from(yarn.up);
  spec.twist = section_twist(thread, fabric.units);
  return spec;
}

namespace {

// What is odd about the share of fibre in sections of these sizes; empty: nothing.
std::string share_oddity(const Thread& thread, const yarn::Section& section,
                         const std::vector<yarn::SectionSize>& sizes, Unit units) {
  const double mm = millimetres_per(units);
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const yarn::SectionSize& size : sizes) {
    if (!yarn::check_section(section, size).ok()) return {};  // reported where the yarn is built
    const double share = thread.linear_density->tex() /
                         (1000.0 * *thread.fibre_density() * yarn::area(section, size) * mm * mm);
    low = std::min(low, share);
    high = std::max(high, share);
  }
  if (high > 1.0 + 1e-9) {
    const std::string fill =
        fmt::format("the fibres would fill {:.3g} times the section ({:.4g} tex of {:.4g} g/cm3)", high,
                    thread.linear_density->tex(), *thread.fibre_density());
    constexpr double of_radius = 4, usual = 0.3;
    if (std::holds_alternative<yarn::Circle>(section) && high / of_radius < 1 && high / of_radius > usual)
      return fill + ": is the diameter in truth a radius?";
    return fmt::format("{}: a section of {:.3g} times the area holds them", fill,
                       high / thread.size_packing().value_or(1.0));
  }
  const auto differs = [&](double share) {
    return std::abs(share - *thread.packing) > 0.05 * *thread.packing;
  };
  if (thread.packing && (differs(high) || differs(low)))
    return fmt::format(
        "its size makes {:.3g}{} of the section fibre, but `packing` says {:.3g} (packing sizes only a "
        "circle "
        "without a diameter)",
        low, high > low * 1.001 ? fmt::format(" to {:.3g}", high) : "", *thread.packing);
  return {};
}

}  // namespace

std::optional<Message> fibre_share_warning(const Fabric& fabric, const Yarn& yarn, const Thread& thread) {
  const Path* const path = path_of(yarn);
  if (path == nullptr || !thread.linear_density || !thread.fibre_density()) return std::nullopt;
  const Result<yarn::Section> section = section_of(thread, fabric.units, every_row_has_a_size(*path));
  if (!section) return std::nullopt;  // reported where the yarn is built
  const std::string oddity = share_oddity(thread, *section, row_sizes(*path, *section), fabric.units);
  if (oddity.empty()) return std::nullopt;
  return at_thread(
      fabric, yarn,
      warning(Kind::geometry, fmt::format("{} '{}': {}", yarn.thread.empty() ? "yarn" : "thread",
                                          yarn.thread.empty() ? yarn.name : yarn.thread, oddity)));
}

std::optional<Message> fibre_share_warning(const Fabric& fabric, const Thread& thread, TextPlace place) {
  if (!thread.linear_density || !thread.fibre_density()) return std::nullopt;
  const Result<yarn::Section> section = section_of(thread, fabric.units, false);
  if (!section) return std::nullopt;
  const std::string oddity = share_oddity(thread, *section, {yarn::nominal_size(*section)}, fabric.units);
  if (oddity.empty()) return std::nullopt;
  return warning(Kind::geometry, fmt::format("thread '{}': {}", thread.name, oddity))
      .placed(place, fabric.file);
}

std::optional<Message> roundness_note(const Fabric& fabric, const Thread& thread, TextPlace place) {
  if (!thread.section || !std::holds_alternative<yarn::Loop7>(*thread.section)) return std::nullopt;
  return note(Kind::geometry, fmt::format("section loop7: its radius has the nominal mean, but varies by "
                                          "{:.3g} % of it round the yarn",
                                          100.0 * yarn::loop7_out_of_roundness()))
      .placed(place, fabric.file);
}

std::optional<Message> turning_warning(const Fabric& fabric, const Thread& thread, TextPlace place) {
  if (section_twist(thread, fabric.units) == 0.0) return std::nullopt;
  const Result<yarn::Section> section = section_of(thread, fabric.units, false);
  if (!section || std::holds_alternative<yarn::Circle>(*section) ||
      std::holds_alternative<yarn::Loop7>(*section))
    return std::nullopt;
  return warning(Kind::geometry,
                 fmt::format("the section of thread '{}' turns along its yarns, which have room as if it did "
                             "not: 'selvage "
                             "check' tells where they overlap, --relax moves them apart where they have room",
                             thread.name))
      .placed(place, fabric.file);
}

std::optional<double> smallest_size(const Fabric& fabric, const Yarn& yarn) {
  const Path* const path = path_of(yarn);
  if (path == nullptr) return std::nullopt;
  const Result<yarn::Section> section =
      section_of(resolved_thread(fabric, yarn), fabric.units, every_row_has_a_size(*path));
  if (!section) return std::nullopt;
  double smallest = std::numeric_limits<double>::infinity();
  for (const yarn::SectionSize& size : row_sizes(*path, *section)) {
    if (!(size.width > 0.0 && size.height > 0.0)) return std::nullopt;
    smallest = std::min({smallest, size.width, size.height});
    if (path->sizes.empty()) break;
  }
  return smallest;
}

std::optional<double> smallest_size(const Fabric& fabric, const Thread& thread) {
  const Result<yarn::Section> section = section_of(thread, fabric.units, false);
  if (!section) return std::nullopt;
  const yarn::SectionSize size = yarn::nominal_size(*section);
  if (!(size.width > 0.0 && size.height > 0.0)) return std::nullopt;
  return std::min(size.width, size.height);
}

}  // namespace selvage::fabric
