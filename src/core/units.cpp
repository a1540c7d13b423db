#include "core/units.h"

namespace selvage {

namespace {

struct Size {
  std::string_view name;
  std::int64_t tenths_of_um;
};
constexpr std::array<Size, all_units.size()> sizes = {
    {{"m", 10'000'000}, {"cm", 100'000}, {"mm", 10'000}, {"um", 10}, {"inch", 254'000}}};

}  // namespace

std::string_view name_of(Unit unit) {
  return sizes[static_cast<std::size_t>(unit)].name;
}

std::int64_t exact_size(Unit unit) {
  return sizes[static_cast<std::size_t>(unit)].tenths_of_um;
}

double millimetres_per(Unit unit) {
  return static_cast<double>(exact_size(unit)) / static_cast<double>(exact_size(Unit::mm));
}

}  // namespace selvage
