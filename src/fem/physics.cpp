#include "fem/physics.h"

#include <array>

#include "fem/materials.h"

namespace selvage::fem {

const TransportLaw& transport_law(Physics physics) {
  using fabric::Material;
  static constexpr std::array<TransportLaw, 3> laws = {
      {{"conduction", "conductivity", "W/(m K)", "temperature", &Material::conductivity},
       {"diffusion", "diffusivity", "mm2/s", "concentration", &Material::diffusivity},
       {"permittivity", "permittivity", "relative", "electric potential", &Material::permittivity}}};
  return laws[static_cast<std::size_t>(physics) - 1];
}

bool has_constants(const fabric::Material& material, Physics physics) {
  if (physics == Physics::elastic) return !std::holds_alternative<std::monostate>(material.elastic);
  return (material.*transport_law(physics).member).has_value();
}

bool is_isotropic(const fabric::Material& material, Physics physics) {
  if (physics == Physics::elastic) return orthotropic(material).isotropic;
  const std::optional<fabric::Transport>& transport = material.*transport_law(physics).member;
  return transport && transport->along == transport->across;
}

}  // namespace selvage::fem
