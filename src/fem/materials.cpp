#include "fem/materials.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::fem {

fabric::Material generic_material() {
  fabric::Material material;
  material.name = "generic";
  material.density = 1.5;
  material.elastic = fabric::IsotropicElastic{.modulus = 10'000, .poisson = 0.3};
  return material;
}

MaterialChoice choose_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                Diagnostics& diagnostics) {
  MaterialChoice choice;
  const fabric::Material generic = generic_material();
  std::vector<std::string> without;  // yarns
  for (const yarn::Body& body : bodies) {
    const fabric::Material* found = body.material.empty() ? nullptr : fabric.find_material(body.material);
    fabric::Material material = found != nullptr ? *found : generic;
    // A name of the file's own is not taken for the stand-in.
    while (found == nullptr && fabric.find_material(material.name) != nullptr) material.name += "_";
    if (found == nullptr) without.push_back(body.name);
    choice.of_body.push_back(material.name);
    const bool known =
        std::any_of(choice.materials.begin(), choice.materials.end(),
                    [&](const fabric::Material& other) { return other.name == material.name; });
    if (known) continue;
    if (std::holds_alternative<std::monostate>(material.elastic)) {
      material.elastic = generic.elastic;
      Message message =
          warning(Kind::unsupported,
                  fmt::format("material '{}' has no elastic constants; the mesh carries E = 10000 MPa, "
                              "nu = 0.3 for it: give it an 'elastic' line",
                              material.name));
      message.file = fabric.file;
      message.place = material.place;
      diagnostics.add(std::move(message));
    }
    choice.materials.push_back(std::move(material));
  }
  if (!without.empty()) {
    Message message = warning(
        Kind::unsupported,
        fmt::format("{} {} no material; the mesh carries a generic one (E = 10000 MPa, nu = 0.3, 1.5 g/cm3): "
                    "name one in the yarn's thread",
                    without.size() == 1 ? fmt::format("yarn '{}'", without.front())
                                        : fmt::format("{} yarns", without.size()),
                    without.size() == 1 ? "has" : "have"));
    message.file = fabric.file;
    diagnostics.add(std::move(message));
  }
  return choice;
}

}  // namespace selvage::fem
