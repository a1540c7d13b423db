#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "fem/fibre.h"
#include "fem/materials.h"

namespace selvage::fem {
namespace {

// The material of the matrix, fit for the formulas.
Result<fabric::Material> matrix_of(const Mesh& mesh) {
  for (const Region& region : mesh.regions) {
    if (region.kind != Region::Kind::matrix) continue;
    const fabric::Material* material = fabric::find_named(mesh.materials, region.material);
    if (material != nullptr && std::holds_alternative<fabric::IsotropicElastic>(material->elastic))
      return *material;
    return error(Kind::geometry,
                 fmt::format("the stiffness of yarns follows from that of their fibres only in "
                             "an isotropic matrix, which '{}' is not",
                             region.material));
  }
  return error(Kind::geometry,
               "the stiffness of yarns follows from that of their fibres only where there is a matrix");
}

constexpr int bins = 100;

struct AlongFibres {
  double tension = 0, compression = 0;
};
std::optional<AlongFibres> strength_along(const fabric::Material& fibre) {
  if (const auto* same = std::get_if<fabric::IsotropicStrength>(&fibre.strength))
    return AlongFibres{same->tension, same->compression};
  if (const auto* two = std::get_if<fabric::TransverseStrength>(&fibre.strength))
    return AlongFibres{two->tension, two->compression};
  return {};
}

// With a strength in shear.
const fabric::IsotropicStrength* strength_of_matrix(const fabric::Material& matrix) {
  const auto* same = std::get_if<fabric::IsotropicStrength>(&matrix.strength);
  return same != nullptr && same->shear ? same : nullptr;
}

std::optional<fabric::TransverseStrength> strength_of_yarn(const fabric::Material& fibre,
                                                           const fabric::Material& matrix, double fraction) {
  const std::optional<AlongFibres> along = strength_along(fibre);
  const fabric::IsotropicStrength* of_matrix = strength_of_matrix(matrix);
  if (!along || of_matrix == nullptr) return {};
  const fabric::TransverseElastic f = as_transverse(fibre), m = as_transverse(matrix);
  const auto share = [&](double soft, double stiff) {
    return 1 - (std::sqrt(fraction) - fraction) * (1 - soft / stiff);
  };
  const double across = share(m.e1, f.e2);
  fabric::TransverseStrength::Across result = {.tension = across * of_matrix->tension,
                                               .compression = across * of_matrix->compression,
                                               .s12 = share(m.g12, f.g12) * *of_matrix->shear};
  result.s23 = result.compression / 2;
  const double microbuckling = m.g12 / (1 - fraction * (1 - m.g12 / f.g12));
  return fabric::TransverseStrength{
      .tension = fraction * along->tension,
      .compression = std::min(
          {fraction * along->compression, 10 * result.s12 + 2.5 * of_matrix->tension, microbuckling}),
      .across = result};
}

// Fibres whose strengths come to nothing.
void warn_of_lost_strengths(const Mesh& mesh, const fabric::Material& matrix, Diagnostics& diagnostics) {
  if (strength_of_matrix(matrix) != nullptr) return;
  for (const fabric::Material& material : mesh.materials)
    if (material.name != matrix.name && strength_along(material))
      diagnostics.add(warning(
          Kind::geometry,
          fmt::format(
              "yarns of '{}' have no strength: it follows from that of their fibres only in a matrix "
              "with one in tension, compression and shear: give '{}' a line `strength isotropic T C S`",
              material.name, matrix.name)));
}

}  // namespace

fabric::Material chamis(const fabric::Material& fibre, const fabric::Material& matrix, double fraction) {
  const fabric::TransverseElastic f = as_transverse(fibre), m = as_transverse(matrix);
  const double root = std::sqrt(fraction), rest = 1 - fraction;
  const double g23 = f.e2 / (2 * (1 + f.nu23));
  auto in_series = [&](double of_matrix, double of_fibre) {
    return of_matrix / (1 - root * (1 - of_matrix / of_fibre));
  };
  fabric::TransverseElastic yarn;
  yarn.e1 = fraction * f.e1 + rest * m.e1;
  yarn.e2 = in_series(m.e1, f.e2);
  yarn.g12 = in_series(m.g12, f.g12);
  yarn.nu12 = fraction * f.nu12 + rest * m.nu12;
  yarn.nu23 = yarn.e2 / (2 * in_series(m.g12, g23)) - 1;
  fabric::Material result;
  result.name = fibre.name;
  result.place = fibre.place;
  result.elastic = yarn;
  if (const auto strength = strength_of_yarn(fibre, matrix, fraction)) result.strength = *strength;
  if (fibre.density && matrix.density) result.density = fraction * *fibre.density + rest * *matrix.density;
  if (fibre.expansion && matrix.expansion) {
    const double of_matrix = matrix.expansion->along;
    result.expansion = fabric::Expansion{
        .along = (fraction * fibre.expansion->along * f.e1 + rest * of_matrix * m.e1) / yarn.e1,
        .across = fibre.expansion->across * root +
                  (1 - root) * (1 + fraction * m.nu12 * f.e1 / yarn.e1) * of_matrix};
  }
  return result;
}

Status derive_yarn_stiffness(Mesh& mesh, Diagnostics& diagnostics) {
  const Result<fabric::Material> matrix = matrix_of(mesh);
  if (!matrix) return matrix.error();
  warn_of_lost_strengths(mesh, *matrix, diagnostics);
  std::vector<fabric::Material> made;
  std::map<std::pair<std::string, int>, std::uint32_t> numbers;  // material and hundredths
  std::vector<std::uint32_t> of_element(mesh.elements.size(), 0);
  auto number_of = [&](const fabric::Material& material, int hundredths) {
    const auto [place, is_new] =
        numbers.try_emplace({material.name, hundredths}, static_cast<std::uint32_t>(made.size()));
    if (!is_new) return place->second;
    if (hundredths == 0) {
      made.push_back(material);
    } else {
      made.push_back(chamis(material, *matrix, static_cast<double>(hundredths) / bins));
      made.back().name += fmt::format("_vf{:03d}", hundredths);
    }
    return place->second;
  };
  for (Region& region : mesh.regions) {
    const fabric::Material* material = fabric::find_named(mesh.materials, region.material);
    if (material == nullptr) return error(Kind::internal, "a region of the mesh has no material");
    std::size_t without = 0;
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      int hundredths = 0;
      if (region.kind == Region::Kind::yarn) {
        const double fraction = e < mesh.fibre_fraction.size() ? mesh.fibre_fraction[e] : 0;
        if (fraction > 0 && fraction < 1)  // not NaN
          hundredths = std::clamp(static_cast<int>(std::lround(fraction * bins)), 1, bins - 1);
        else
          ++without;
      }
      of_element[e] = number_of(*material, hundredths);
    }
    if (without > 0)
      diagnostics.add(warning(
          Kind::geometry,
          fmt::format(
              "{} elements of yarn '{}' have no fibre fraction between 0 and 1, and keep the constants "
              "of '{}': its thread needs `tex` and `density`, and a section that holds them",
              without, region.name, region.material)));
    if (region.first_element < region.last_element)
      region.material = made[of_element[region.first_element]].name;
  }
  mesh.materials = std::move(made);
  mesh.element_material = std::move(of_element);
  return {};
}

}  // namespace selvage::fem
