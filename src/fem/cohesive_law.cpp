#include "fem/cohesive_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "fem/materials.h"

namespace selvage::fem {
namespace {

using Pair = fabric::Interface::Pair;

constexpr double bonded_factor = 1e4;

double area_of(const Mesh& mesh, const Interface& interface) {
  double area = 0;
  for (const FacingSides& facing : interface.sides) {
    const auto& n = facing.first.nodes;
    area += (mesh.nodes[n[1]] - mesh.nodes[n[0]]).cross(mesh.nodes[n[2]] - mesh.nodes[n[0]]).norm() / 2;
  }
  return area;
}

// Of the thinnest yarn, mm.
double least_thickness(const Mesh& mesh) {
  std::vector<double> areas(mesh.regions.size(), 0.0);
  for (const Interface& interface : mesh.interfaces) {
    const double area = area_of(mesh, interface);
    areas[interface.first] += area;
    areas[interface.second] += area;
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < mesh.regions.size(); ++r)
    if (mesh.regions[r].kind == Region::Kind::yarn && areas[r] > 0)
      least = std::min(least, 4 * mesh.regions[r].exact_volume / areas[r]);
  return least;
}

std::optional<Pair> lower(const std::optional<Pair>& a, const std::optional<Pair>& b) {
  if (!a || !b) return a ? a : b;
  return Pair{std::min(a->normal, b->normal), std::min(a->shear, b->shear)};
}

Status check_energy(const CohesiveLaw& law, const fabric::Material& first, const fabric::Material& second) {
  const auto check = [&](std::string_view what, double Pair::*way) -> Status {
    const double strength = law.fracture->strength.*way, stiffness = law.stiffness.*way;
    const double least = strength * strength / (2 * stiffness);
    if (law.fracture->energy.*way > least) return {};
    const fabric::Material& place = first.interface && first.interface->energy ? first : second;
    return error(Kind::geometry,
                 fmt::format(
                     "the interface of '{}' and '{}' takes {:.3g} N/mm elastically up to its {} strength, "
                     "and its fracture energy is {:.3g}: it has to be larger, or the stiffness",
                     first.name, second.name, least, what, law.fracture->energy.*way))
        .placed(place.place);
  };
  if (Status normal = check("normal", &Pair::normal); !normal) return normal;
  return check("shear", &Pair::shear);
}

Result<CohesiveLaw> law_of(const fabric::Material& first, const fabric::Material& second, double thickness) {
  CohesiveLaw law;
  law.name = first.name + "_" + second.name;
  const fabric::Interface a = first.interface.value_or(fabric::Interface{}),
                          b = second.interface.value_or(fabric::Interface{});
  const double modulus = std::max(as_transverse(first).e2, as_transverse(second).e2);
  const double bonded = bonded_factor * modulus / thickness;
  law.stiffness = lower(a.stiffness, b.stiffness).value_or(Pair{bonded, bonded});
  const std::optional<Pair> strength = lower(a.strength, b.strength), energy = lower(a.energy, b.energy);
  if (!strength || !energy) return law;
  law.fracture = {*strength, *energy};
  if (Status right = check_energy(law, first, second); !right) return right.error();
  return law;
}

}  // namespace

Status choose_cohesive_laws(Mesh& mesh) {
  const double thickness = least_thickness(mesh);
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  mesh.laws.clear();
  for (Interface& interface : mesh.interfaces) {
    std::string first = mesh.regions[interface.first].material,
                second = mesh.regions[interface.second].material;
    const bool is_of_yarns = mesh.regions[interface.second].kind == Region::Kind::yarn;
    if (is_of_yarns && second < first) std::swap(first, second);
    const auto [at, is_new] = known.try_emplace({first, second}, mesh.laws.size());
    interface.law = at->second;
    if (!is_new) continue;
    Result<CohesiveLaw> law = law_of(*fabric::find_named(mesh.materials, first),
                                     *fabric::find_named(mesh.materials, second), thickness);
    if (!law) return law.error();
    mesh.laws.push_back(std::move(*law));
  }
  return {};
}

}  // namespace selvage::fem
