#include "fem/materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "fem/names.h"

namespace selvage::fem {

fabric::Material generic_material() {
  fabric::Material material;
  material.name = "generic";
  material.density = 1.5;
  material.elastic = fabric::IsotropicElastic{.modulus = 10'000, .poisson = 0.3};
  return material;
}

fabric::TransverseElastic as_transverse(const fabric::Material& material) {
  if (const auto* two = std::get_if<fabric::TransverseElastic>(&material.elastic)) return *two;
  const auto& same = std::get<fabric::IsotropicElastic>(material.elastic);
  return {.e1 = same.modulus,
          .e2 = same.modulus,
          .nu12 = same.poisson,
          .g12 = same.modulus / (2 * (1 + same.poisson)),
          .nu23 = same.poisson};
}

Orthotropic orthotropic(const fabric::Material& material) {
  Orthotropic result;
  if (!std::holds_alternative<std::monostate>(material.elastic)) {
    const fabric::TransverseElastic two = as_transverse(material);
    const double g23 = two.e2 / (2 * (1 + two.nu23));
    const bool isotropic = std::holds_alternative<fabric::IsotropicElastic>(material.elastic);
    result = {isotropic, two.e1, two.e2, two.e2, two.nu12, two.nu12, two.nu23, two.g12, two.g12, g23, {}, {}};
  }
  if (material.expansion) {
    const auto [along, across] = *material.expansion;
    result.expansion = {along, across, across};
    result.isotropic = result.isotropic && along == across;
  }
  if (material.density) result.density = *material.density * 1e-9;
  return result;
}

namespace {

// Constants a thousand times too small: moduli are in MPa. Below these no solid of the trade is: what is
// softer than plastics is rubber, whose volume hardly changes.
std::optional<Message> gigapascals(const fabric::Material& material) {
  constexpr double softest_plastic = 100, softest_fibre = 1000, rubber = 0.45;
  const char* what = nullptr;
  double modulus = 0;
  if (const auto* same = std::get_if<fabric::IsotropicElastic>(&material.elastic);
      same != nullptr && same->modulus < softest_plastic && same->poisson < rubber) {
    what = "E";
    modulus = same->modulus;
  } else if (const auto* two = std::get_if<fabric::TransverseElastic>(&material.elastic);
             two != nullptr && two->e1 < softest_fibre && two->nu12 < rubber) {
    what = "E1";
    modulus = two->e1;
  }
  if (what == nullptr) return std::nullopt;
  return warning(
      Kind::unsupported,
      fmt::format("material '{0}' has {1} = {2:g} MPa: moduli are in MPa; if {2:g} GPa is meant, write {3:g}",
                  material.name, what, modulus, 1000 * modulus));
}

// Adds a material to those in use, with elastic constants, unless it is there.
void use(const fabric::Fabric& fabric, fabric::Material material, MaterialChoice& choice,
         Diagnostics& diagnostics) {
  if (fabric::find_named(choice.materials, material.name) != nullptr) return;
  if (std::holds_alternative<std::monostate>(material.elastic)) {
    material.elastic = generic_material().elastic;
    diagnostics.add(
        warning(Kind::unsupported,
                fmt::format("material '{}' has no elastic constants; the mesh carries E = 10000 MPa, "
                            "nu = 0.3 for it: give it an 'elastic' line",
                            material.name))
            .placed(material.place, fabric.file));
  }
  if (std::optional<Message> soft = gigapascals(material))
    diagnostics.add(std::move(*soft).placed(material.place, fabric.file));
  choice.materials.push_back(std::move(material));
}

}  // namespace

std::vector<Message> strengths_left_out(const std::vector<fabric::Material>& materials,
                                        std::string_view format) {
  const auto has_some = [](const fabric::Material& material) {
    return !std::holds_alternative<std::monostate>(material.strength);
  };
  if (std::none_of(materials.begin(), materials.end(), has_some)) return {};
  return {
      warning(Kind::unsupported,
              fmt::format("{} has no place for the strengths of materials, and is written without; of a unit "
                          "cell's .inp deck `scripts/homogenize` finds what breaks first",
                          format))};
}

std::vector<std::string> solver_names(const std::vector<fabric::Material>& materials,
                                      const std::vector<CohesiveLaw>& laws) {
  std::vector<std::string> own;
  own.reserve(materials.size() + laws.size());
  for (const fabric::Material& material : materials) own.push_back(material.name);
  for (const CohesiveLaw& law : laws) own.push_back(law.name);
  return unique_names(own, {.longest = 30, .begin = "M_"});
}

MaterialChoice choose_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                Diagnostics& diagnostics) {
  MaterialChoice choice;
  const fabric::Material generic = generic_material();
  std::vector<std::string> without;  // yarns
  for (const yarn::Body& body : bodies) {
    const fabric::Material* found =
        body.material.empty() ? nullptr : fabric.find_material_anywhere(body.material);
    fabric::Material material = found != nullptr ? *found : generic;
    // A name of the file's own is not taken for the stand-in.
    while (found == nullptr && fabric.find_material_anywhere(material.name) != nullptr) material.name += "_";
    if (found == nullptr) without.push_back(body.name);
    choice.of_body.push_back(material.name);
    use(fabric, std::move(material), choice, diagnostics);
  }
  if (!without.empty())
    diagnostics.add(
        warning(Kind::unsupported,
                fmt::format(
                    "{} {} no material; the mesh carries a generic one (E = 10000 MPa, nu = 0.3, 1.5 g/cm3): "
                    "name one in the yarn's thread",
                    without.size() == 1 ? fmt::format("yarn '{}'", without.front())
                                        : fmt::format("{} yarns", without.size()),
                    without.size() == 1 ? "has" : "have"))
            .placed({}, fabric.file));
  return choice;
}

namespace {

// The material of the cell's matrix.
Result<fabric::Material> matrix_material(const fabric::Fabric& fabric) {
  auto failed = [&](std::string text, TextPlace place) {
    return error(Kind::geometry, std::move(text)).placed(place, fabric.file);
  };
  if (!fabric.cell) return failed("a matrix fills a `cell`, and the file says none", {});
  const fabric::Cell& cell = *fabric.cell;
  if (cell.matrix.empty())
    return failed("the cell names no matrix: add `matrix NAME`, with a material of that name", cell.place);
  const fabric::Material* found = fabric.find_material(cell.matrix);
  if (found == nullptr)
    return failed(fmt::format("the cell's matrix '{}' is no material of the file", cell.matrix), cell.place);
  return *found;
}

// Of bodies by their materials, each of which conducts.
Result<MaterialChoice> conducting_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                            const TransportLaw& law) {
  MaterialChoice choice;
  for (const yarn::Body& body : bodies) {
    const fabric::Material* found =
        body.material.empty() ? nullptr : fabric.find_material_anywhere(body.material);
    if (found == nullptr)
      return error(
                 Kind::unsupported,
                 fmt::format("--physics {} asks for the {} of every yarn, and this one has no material: name "
                             "one in its thread",
                             law.word, law.property))
          .of_yarn(body.name)
          .placed({}, fabric.file);
    choice.of_body.push_back(found->name);
    if (fabric::find_named(choice.materials, found->name) == nullptr) choice.materials.push_back(*found);
  }
  return choice;
}

}  // namespace

Result<MaterialChoice> choose_cell_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                             bool with_matrix, Physics physics, Diagnostics& diagnostics) {
  const bool is_elastic = physics == Physics::elastic;
  Result<MaterialChoice> choice = is_elastic ? choose_materials(fabric, bodies, diagnostics)
                                             : conducting_materials(fabric, bodies, transport_law(physics));
  if (!choice) return choice;
  if (with_matrix) {
    Result<fabric::Material> matrix = matrix_material(fabric);
    if (!matrix) return matrix.error();
    if (is_elastic)
      use(fabric, std::move(*matrix), *choice, diagnostics);
    else if (fabric::find_named(choice->materials, matrix->name) == nullptr)
      choice->materials.push_back(std::move(*matrix));
  }
  for (const fabric::Material& material : choice->materials)
    if (!has_constants(material, physics))
      return error(Kind::unsupported,
                   fmt::format(
                       "material '{}' has no {}, which --physics {} asks for: give its `material` block a "
                       "line `{} ...`",
                       material.name, transport_law(physics).property, transport_law(physics).word,
                       transport_law(physics).property))
          .placed(material.place, fabric.file);
  return choice;
}

}  // namespace selvage::fem
