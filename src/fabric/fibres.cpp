#include "fabric/fibres.h"

#include <algorithm>
#include <vector>

namespace selvage::fabric {

namespace {

// Densities of textile fibres: W. E. Morton, J. W. S. Hearle, Physical Properties of Textile Fibres, 4th ed.,
// table 5.1 (dry, or at 65 % r.h. where it says so). Share of the section that is fibre: 0.6 of staple yarns,
// since they take 1.1 cm3/g in F. T. Peirce, The geometry of cloth structure, J. Text. Inst. 28 (1937), T45;
// 0.75 of filaments, J. W. S. Hearle, P. Grosberg, S. Backer, Structural Mechanics of Fibers, Yarns, and
// Fabrics 1 (1969), ch. 2. Their moduli depend on how they were made: a material block says them.
constexpr std::string_view textile = "Morton and Hearle, Physical Properties of Textile Fibres, table 5.1";
// Elastic constants and expansion of fibres for composites.
constexpr std::string_view exercise =
    "P. D. Soden, M. J. Hinton, A. S. Kaddour, Composites Science and Technology 58 (1998) 1011-1022, table "
    "1";
constexpr double staple = 0.6, filament = 0.75, wire = 1.0;

Fibre fibre(std::string_view name, double density, double packing, std::string_view source) {
  Fibre made;
  made.material.name = name;
  made.material.density = density;
  made.material.packing = packing;
  made.source = source;
  return made;
}

template <class Elastic>
Fibre fibre(std::string_view name, double density, double packing, std::string_view source,
            const Elastic& elastic, const Expansion& expansion) {
  Fibre made = fibre(name, density, packing, source);
  made.material.elastic = elastic;
  made.material.expansion = expansion;
  return made;
}

std::vector<Fibre> make_fibres() {
  return {
      fibre("cotton", 1.52, staple, textile),
      fibre("flax", 1.54, staple, textile),
      fibre("linen", 1.54, staple, textile),
      fibre("jute", 1.50, staple, textile),
      fibre("wool", 1.31, staple, textile),
      fibre("silk", 1.34, filament, textile),
      fibre("viscose", 1.52, staple, textile),
      fibre("acetate", 1.32, filament, textile),
      fibre("acrylic", 1.19, staple, textile),
      fibre("polyester", 1.39, filament, textile),
      fibre("nylon", 1.14, filament, textile),
      fibre("polyamide", 1.14, filament, textile),
      fibre("polypropylene", 0.91, filament, textile),
      fibre("polyethylene", 0.95, filament, textile),
      fibre("elastane", 1.20, filament, "manufacturers' sheets, 1.15 to 1.25 g/cm3"),
      fibre("dyneema", 0.97, filament, "the manufacturer's sheet, 0.97 to 0.98 g/cm3"),
      fibre("aramid", 1.44, filament,
            "M. Cheng, W. Chen, T. Weerasooriya, J. Engng Mater. Technol. 127 (2005) 197-203 (Kevlar KM2); "
            "expansion: DuPont, Kevlar technical guide",
            TransverseElastic{84'620, 1'340, 0.6, 24'400, 0.24}, Expansion{-4.9e-6, 66e-6}),
      fibre("glass-E", 2.55, filament, exercise, IsotropicElastic{74'000, 0.2}, Expansion{4.9e-6, 4.9e-6}),
      fibre("carbon-T300", 1.76, filament, exercise,
            TransverseElastic{230'000, 15'000, 0.2, 15'000, 1.0 / 14}, Expansion{-0.7e-6, 12e-6}),
      fibre("carbon-AS4", 1.79, filament, exercise, TransverseElastic{225'000, 15'000, 0.2, 15'000, 1.0 / 14},
            Expansion{-0.5e-6, 15e-6}),
      fibre("steel", 7.85, wire, "EN 1993-1-1, 3.2.6", IsotropicElastic{210'000, 0.3},
            Expansion{12e-6, 12e-6}),
      fibre("copper", 8.96, wire, "CRC Handbook of Chemistry and Physics; E, nu: annealed",
            IsotropicElastic{117'000, 0.34}, Expansion{16.5e-6, 16.5e-6}),
  };
}

}  // namespace

std::span<const Fibre> all_fibres() {
  static const std::vector<Fibre> list = make_fibres();
  return list;
}

const Material* find_fibre(std::string_view name) {
  const std::span<const Fibre> list = all_fibres();
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Fibre& fibre) { return fibre.material.name == name; });
  return found == list.end() ? nullptr : &found->material;
}

}  // namespace selvage::fabric
