// What a unit cell's deck solves: its stiffness, or the flux that follows a gradient. Conduction of heat,
// diffusion and the electric displacement of a dielectric have one equation, div(K grad u) = 0, and so one
// kind of deck.
#pragma once

#include <optional>
#include <string_view>

#include "fabric/model.h"

namespace selvage::fem {

enum class Physics { elastic, conduction, diffusion, permittivity };

struct TransportLaw {
  std::string_view word;       // of --physics: "conduction"
  std::string_view property;   // of a material, its word in Fabric TXT: "conductivity"
  std::string_view unit;       // of the property
  std::string_view potential;  // whose gradient drives the flux
  std::optional<fabric::Transport> fabric::Material::*member;
};

// Precondition: not elastic.
const TransportLaw& transport_law(Physics physics);

// Has the material what the physics asks for?
bool has_constants(const fabric::Material& material, Physics physics);

// The same in all directions, so that axes mean nothing? (Elastic: elasticity and expansion.) False where it
// has no constants.
bool is_isotropic(const fabric::Material& material, Physics physics);

}  // namespace selvage::fem
