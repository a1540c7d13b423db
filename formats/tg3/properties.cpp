#include "formats/tg3/properties.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::formats::tg3 {

namespace {

bool is_same(const fabric::Thread& a, const fabric::Thread& b) {
  return a.linear_density == b.linear_density && a.density == b.density && a.filaments == b.filaments &&
         a.material == b.material;
}

bool is_same(const fabric::Material& a, const fabric::Material& b) {
  return a.elastic == b.elastic && a.expansion == b.expansion;
}

// The name of one that is the same, else of this one, which is added.
template <class Thing>
std::string shared(std::vector<Thing>& all, Thing one, std::string_view stem) {
  std::size_t of_stem = 0;
  for (const Thing& known : all) {
    if (is_same(known, one)) return known.name;
    if (known.name.starts_with(stem)) ++of_stem;
  }
  one.name = of_stem == 0 ? std::string(stem) : fmt::format("{}_{}", stem, of_stem + 1);
  all.push_back(std::move(one));
  return all.back().name;
}

}  // namespace

// A value, and its unit beside it; without a unit the first.
std::optional<double> Properties::measured(const Element& element, std::string_view name,
                                           const std::vector<Unit>& units) {
  const std::string value = fmt::format("{}Value", name);
  if (element.attribute(value) == nullptr) return std::nullopt;
  const double number = fields_.number(element, value);
  const std::string_view unit = fields_.text(element, fmt::format("{}Units", name));
  if (unit.empty()) return number * units.front().factor;
  for (const Unit& known : units)
    if (known.name == unit) return number * known.factor;
  std::string list;
  for (const Unit& known : units) list += fmt::format("{}{}", list.empty() ? "" : ", ", known.name);
  fields_.error(element, fmt::format("the unit {} of {} is not known: {}", in_quotes(unit), name, list));
  return std::nullopt;
}

std::optional<double> Properties::stress(const Element& element, std::string_view name) {
  return measured(element, name, {{"MPa", 1}, {"N/mm^2", 1}, {"GPa", 1e3}, {"kPa", 1e-3}, {"Pa", 1e-6}});
}

void Properties::read_fibres(const Element& element, fabric::Thread& thread) {
  // tex, g/cm3, mm2, mm.
  const std::optional<double> linear = measured(
      element, "YarnLinearDensity", {{"kg/m", 1e6}, {"g/m", 1e3}, {"kg/km", 1e3}, {"g/km", 1}, {"tex", 1}});
  thread.density =
      measured(element, "FibreDensity", {{"kg/m^3", 1e-3}, {"g/cm^3", 1}, {"g/m^3", 1e-6}, {"kg/mm^3", 1e6}});
  std::optional<double> area =
      measured(element, "FibreArea", {{"m^2", 1e6}, {"cm^2", 1e2}, {"mm^2", 1}, {"um^2", 1e-6}});
  const std::optional<double> diameter =
      measured(element, "FibreDiameter", {{"m", 1e3}, {"cm", 10}, {"mm", 1}, {"um", 1e-3}});
  constexpr int most_filaments = 10'000'000;
  if (element.attribute("FibresPerYarn") != nullptr)
    thread.filaments = fields_.whole(element, "FibresPerYarn", 1, most_filaments);
  if (!area && diameter && thread.filaments)
    area = *thread.filaments * std::numbers::pi / 4 * *diameter * *diameter;
  // g/km of mm2 of g/cm3.
  const std::optional<double> tex = linear                   ? linear
                                    : area && thread.density ? std::optional(1e3 * *area * *thread.density)
                                                             : std::nullopt;
  if (tex && *tex > 0)
    thread.linear_density = fabric::LinearDensity{*tex, fabric::LinearDensity::Measure::tex};
  if (thread.density && !(*thread.density > 0)) thread.density.reset();
  if ((diameter || area) && !tex)
    fields_.warning(
        element,
        "the fibres' diameter or area is left out: with the density of the fibre (and their number) "
        "it would say the yarn's linear density");
}

void Properties::read_elastic(const Element& element, fabric::Material& material) {
  const std::optional<double> e1 = stress(element, "YoungsModulus"), e2 = stress(element, "YoungsModulusY"),
                              e3 = stress(element, "YoungsModulusZ"), g12 = stress(element, "ShearModulusXY"),
                              g13 = stress(element, "ShearModulusXZ"),
                              g23 = stress(element, "ShearModulusYZ");
  const double nu12 = fields_.number(element, "PoissonsRatio", 0.0),
               nu13 = fields_.number(element, "PoissonsRatioY", 0.0),
               nu23 = fields_.number(element, "PoissonsRatioZ", 0.0);
  if (e1 && e2 && g12 && *e1 > 0 && *e2 > 0 && *g12 > 0) {
    material.elastic =
        fabric::TransverseElastic{.e1 = *e1, .e2 = *e2, .nu12 = nu12, .g12 = *g12, .nu23 = nu23};
    const auto differ = [](double a, double b) {
      return std::abs(a - b) > 1e-9 * std::max(std::abs(a), std::abs(b));
    };
    const double of_plane = *e2 / (2 * (1 + nu23));
    if (!warned_of_orthotropy_ && (differ(*e2, e3.value_or(*e2)) || differ(*g12, g13.value_or(*g12)) ||
                                   differ(of_plane, g23.value_or(of_plane)) || differ(nu12, nu13))) {
      warned_of_orthotropy_ = true;
      fields_.warning(
          element,
          fmt::format("yarns are alike in all directions across them here: the third Young's modulus, "
                      "PoissonsRatioY and the shear moduli XZ and YZ are left out (G23 becomes {:.6g} "
                      "MPa)",
                      of_plane));
    }
  }
  const std::vector<Unit> per_kelvin = {{"/K", 1}, {"1/K", 1}, {"/C", 1}};
  const std::optional<double> along = measured(element, "AlphaX", per_kelvin),
                              across = measured(element, "AlphaY", per_kelvin);
  if (along && across) material.expansion = fabric::Expansion{*along, *across};
}

std::string Properties::thread_of(const Element& yarn, const Element& textile) {
  fabric::Thread thread;
  const bool has_own = std::ranges::any_of(
      yarn.attributes, [](const Attribute& attribute) { return attribute.name.ends_with("Value"); });
  const Element& element = has_own ? yarn : textile;
  thread.place = element.place;
  read_fibres(element, thread);
  fabric::Material material;
  material.place = element.place;
  read_elastic(element, material);
  if (!std::holds_alternative<std::monostate>(material.elastic) || material.expansion)
    thread.material = shared(fabric_.materials, std::move(material), "fibres");
  if (is_same(thread, fabric::Thread())) return {};
  return shared(fabric_.threads, std::move(thread), "yarn");
}

std::string Properties::matrix_of(const Element& textile) {
  const std::optional<double> modulus = stress(textile, "MatrixYoungsModulus");
  if (!modulus || !(*modulus > 0)) return {};
  fabric::Material matrix;
  matrix.name = "matrix";
  matrix.place = textile.place;
  matrix.elastic = fabric::IsotropicElastic{*modulus, fields_.number(textile, "MatrixPoissonsRatio", 0.0)};
  if (textile.attribute("MatrixAlpha") != nullptr) {
    const double alpha = fields_.number(textile, "MatrixAlpha");
    matrix.expansion = fabric::Expansion{alpha, alpha};
  }
  fabric_.materials.push_back(matrix);
  return matrix.name;
}

}  // namespace selvage::formats::tg3
