#include "fabric/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fabric/build_options.h"
#include "fabric/yarn_spec.h"

namespace selvage::fabric {

namespace {

bool is_odd(const Quantity& quantity, double value) {
  return !(value >= quantity.least && value <= quantity.most);
}

class LengthCheck {
 public:
  LengthCheck(const Fabric& fabric, Diagnostics& diagnostics) : fabric_(fabric), diagnostics_(diagnostics) {}

  // One message a thing: the next numbers are mostly wrong in the same way.
  bool is_good(const Quantity& quantity, double length, TextPlace place, const std::string& yarn) {
    const std::string odd = oddity(quantity, length * millimetres_per(fabric_.units));
    if (odd.empty()) return true;
    diagnostics_.add(error(Kind::geometry, odd + (fabric_.units_given ? "" : " (a file without `units`)"))
                         .placed(place, fabric_.file)
                         .of_yarn(yarn));
    return false;
  }
  bool is_good(const Vec3& point, TextPlace place, const std::string& yarn) {
    return std::all_of(point.begin(), point.end(),
                       [&](double x) { return is_good(place_quantity, x, place, yarn); });
  }
  bool has_good_size(const yarn::SectionSize& size, TextPlace place, const std::string& yarn) {
    return is_good(size_quantity, size.width, place, yarn) &&
           is_good(size_quantity, size.height, place, yarn);
  }

  void look_at(const Thread& thread, TextPlace place, const std::string& yarn) {
    const Result<yarn::Section> section = section_of(thread, fabric_.units, true);
    if (!section) return;  // told where it is used
    const yarn::SectionSize size = yarn::nominal_size(*section);
    if (size.width > 0.0 && size.height > 0.0) has_good_size(size, place, yarn);
  }

  void look_at(const Yarn& yarn) {
    if (std::holds_alternative<ReadBody>(yarn.shape)) return;
    look_at(yarn.own, yarn.place, yarn.name);
    if (const auto* const grid = std::get_if<Grid>(&yarn.shape)) {
      for (const Vec3& point : grid->points)
        if (!is_good(point, grid->place, yarn.name)) return;
    }
    if (const auto* const helix = std::get_if<Helix>(&yarn.shape))
      is_good(Vec3(helix->radius, 0.0, helix->pitch * helix->turns), helix->place, yarn.name);
    const auto* const path = std::get_if<Path>(&yarn.shape);
    if (path == nullptr) return;
    for (std::size_t i = 0; i < path->points.size(); ++i) {
      TextPlace place = path->place;
      place.line = i < path->lines.size() ? path->lines[i] : place.line + static_cast<int>(i) + 1;
      if (!is_good(path->points[i], place, yarn.name)) return;
      if (i >= path->sizes.size() || !path->sizes[i]) continue;
      if (!has_good_size({path->sizes[i]->width, path->sizes[i]->height}, place, yarn.name)) return;
    }
  }

 private:
  const Fabric& fabric_;
  Diagnostics& diagnostics_;
};

}  // namespace

std::string oddity(const Quantity& quantity, double value) {
  if (!is_odd(quantity, value)) return {};
  std::string text =
      fmt::format("{} of {:.4g} {} is far outside of what exists, {:g} to {:g} {}", quantity.what, value,
                  quantity.unit, quantity.least, quantity.most, quantity.unit);
  if (!quantity.slip_unit.empty() && !is_odd(quantity, quantity.slip * value))
    text += fmt::format(": if these are {}, write {:.6g}", quantity.slip_unit, quantity.slip * value);
  return text;
}

Status check_proportion(std::string_view what, double distance, double size, Unit units, TextPlace place) {
  if (!is_odd(ratio_quantity, distance / size)) return {};
  return error(Kind::geometry,
               fmt::format(
                   "{} of {:.4g} {} is out of all proportion to yarns of {:.4g} {}: it lies between {:g} and "
                   "{:g} times their size",
                   what, distance, name_of(units), size, name_of(units), ratio_quantity.least,
                   ratio_quantity.most))
      .placed(place);
}

void check_lengths(const Fabric& fabric, double tolerance, Diagnostics& diagnostics) {
  constexpr double finest = 1e-15, coarsest = 100;  // of the smallest section; finer than numbers are
  LengthCheck check(fabric, diagnostics);
  const int errors = diagnostics.error_count();
  for (const Thread& thread : fabric.threads) check.look_at(thread, thread.place, {});
  for (const Item& item : fabric.items)
    if (const auto* const yarn = std::get_if<Yarn>(&item)) check.look_at(*yarn);
  if (fabric.cell)
    for (const Vec3& corner : {fabric.cell->shape().bounds().min(), fabric.cell->shape().bounds().max()})
      if (!check.is_good(corner, fabric.cell->place, {})) break;
  if (diagnostics.error_count() > errors) return;
  const std::optional<double> smallest = smallest_section(fabric);
  if (!smallest || (tolerance >= finest * *smallest && tolerance <= coarsest * *smallest)) return;
  diagnostics.add(
      error(Kind::geometry,
            fmt::format(
                "a tolerance of {:.4g} {} does not go with sections of {:.4g} {}: it lies between {:.4g} "
                "and {:.4g}, and mostly is a thousandth of them",
                tolerance, name_of(fabric.units), *smallest, name_of(fabric.units), finest * *smallest,
                coarsest * *smallest))
          .placed({1, 1}, fabric.file));
}

}  // namespace selvage::fabric
