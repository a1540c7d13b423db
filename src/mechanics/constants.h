// Constants of woven equilibria. All are ratios: of energies to the tension of a finished cloth, of areas and
// lengths to those of fibres.
#pragma once

namespace selvage::mechanics {

// Fitted to mill cloths with stated take-up (scripts/fit-cloth), the pressure to the thickness of 13 cloths
// of glass, aramid and carbon (samples/trade); nothing here is of one cloth or weave.
struct WovenConstants {
  double bending = 0.37;       // stiffness over tension * (mean fibre area of the cloth's yarns)
  double loom_tension = 1.71;  // of the weft over that of the warp, on the loom
  double flattening = 0.32;    // at a twist factor of 4,000, over tension * fibre area
  double packing = 0.737;      // of staple yarns at rest in a dense cloth
  double compaction = 0.85;    // van Wyk's stiffness over tension per fibre area
  double pressure = 0.0006;    // of finishing and of a thickness gauge, over tension per fibre area
  bool operator==(const WovenConstants&) const = default;
};

// Of the literature.
inline constexpr double densest_packing = 0.9068996821171089;  // pi / (2 sqrt(3)): hexagons of round fibres
inline constexpr double reference_twist_factor = 4000;         // turns/m sqrt(tex), carded cotton warp

// Tension of both systems where little is left of that of the finisher.
inline constexpr double relaxed_tension = 0.05;

// Resistance to flattening of a yarn of this twist factor, over that of the reference: in proportion, with a
// rest for yarns without twist, which friction and sizing hold together (Afrashteh, Merati, Jeddi, Indian J.
// Fibre & Textile Research 38 (2013) 126: height over width 0.35 without twist, 0.86 at 4,600; 0.27 and 0.84
// by this).
inline constexpr double cohesion = 0.0018;
constexpr double stiffness_by_twist(double twist_factor) {
  return cohesion + (1.0 - cohesion) * twist_factor / reference_twist_factor;
}

}  // namespace selvage::mechanics
