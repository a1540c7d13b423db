// Constants of woven equilibria. All are ratios: of energies to the tension of a finished cloth, of areas and
// lengths to those of fibres.
#pragma once

namespace selvage::mechanics {

// Fitted to mill cloths with stated take-up (scripts/fit-cloth); nothing here is of one cloth or weave.
struct WovenConstants {
  double bending = 0.344;      // stiffness over tension * (mean fibre area of the cloth's yarns)
  double loom_tension = 1.92;  // of the weft over that of the warp, on the loom
  double flattening = 0.373;   // at a twist factor of 4,000, over tension * fibre area
  double packing = 0.7545;     // of staple yarns at rest in a dense cloth
  double compaction = 1.0;     // van Wyk's stiffness over tension per fibre area
};

// Of the literature.
inline constexpr double densest_packing = 0.9068996821171089;  // pi / (2 sqrt(3)): hexagons of round fibres
inline constexpr double reference_twist_factor = 4000;         // turns/m sqrt(tex), carded cotton warp

}  // namespace selvage::mechanics
