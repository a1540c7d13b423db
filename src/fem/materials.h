// What the yarns are made of, for a solver: every yarn has a material with elastic constants in the end.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "fem/mesh.h"
#include "fem/physics.h"
#include "yarn/body.h"

namespace selvage::fem {

// The stand-in for a yarn without elastic constants: isotropic, E = 10 000 MPa, nu = 0.3, 1.5 g/cm3. It lets
// a deck run; it is nobody's fibre, and a warning says so.
fabric::Material generic_material();

// Nine elastic constants (Voigt's engineering constants, axes 1 along the yarn, 2 and 3 across it), expansion
// and density, in the units of Mesh. nu12: contraction along 2 under tension along 1. A transversely
// isotropic material has g23 = e2 / (2 (1 + nu23)).
struct Orthotropic {
  bool isotropic = false;         // elasticity and expansion: the axes mean nothing
  double e1 = 0, e2 = 0, e3 = 0;  // MPa
  double nu12 = 0, nu13 = 0, nu23 = 0;
  double g12 = 0, g13 = 0, g23 = 0;
  std::optional<std::array<double, 3>> expansion;  // 1/K
  std::optional<double> density;                   // tonne/mm3
};
// The same constants about an axis. Precondition: the material has elastic constants.
fabric::TransverseElastic as_transverse(const fabric::Material& material);

// All zero of a material without elastic constants.
Orthotropic orthotropic(const fabric::Material& material);

// A warning where materials have strengths, for a format that has no place for them; else none.
std::vector<Message> strengths_left_out(const std::vector<fabric::Material>& materials,
                                        std::string_view format);

// Names that every solver takes: letters, digits and underscores after a letter, at most 30, each only once
// (case does not count).
// `laws`: whose names follow.
std::vector<std::string> solver_names(const std::vector<fabric::Material>& materials,
                                      const std::vector<CohesiveLaw>& laws = {});

struct MaterialChoice {
  std::vector<fabric::Material> materials;  // those in use, in order of first use
  std::vector<std::string> of_body;         // the name of each body's
};

// Materials of the bodies by Body::material. Warnings: a yarn without material, a material without elastic
// constants.
MaterialChoice choose_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                Diagnostics& diagnostics);

// Those of a unit cell's yarns, and of its matrix where `with_matrix` says so. Elastic: as above. Errors
// (geometry): a matrix is wanted, but the cell names none, or no such material is in the file; (unsupported)
// a yarn without a material, or one without the property that the physics asks for: nothing stands in for it.
Result<MaterialChoice> choose_cell_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                             bool with_matrix, Physics physics, Diagnostics& diagnostics);

}  // namespace selvage::fem
