#include "fabric/fibres.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/words.h"

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
constexpr std::string_view makers = "manufacturers' sheets";
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
      fibre("meta-aramid", 1.38, staple, "DuPont, Technical guide for Nomex brand fiber: 1.37 to 1.38 g/cm3"),
      fibre("hemp", 1.48, staple, makers),
      fibre("ramie", 1.55, staple, textile),
      fibre("PLA", 1.25, filament, "NatureWorks, fibre sheets: 1.24 to 1.25 g/cm3"),
      fibre("PTFE", 2.2, filament, "manufacturers' sheets, 2.1 to 2.3 g/cm3"),
      fibre("PEEK", 1.30, filament, "Victrex, material properties guide: 1.30 g/cm3"),
      fibre("PPS", 1.35, filament, "manufacturers' sheets, 1.34 to 1.37 g/cm3"),
      fibre("LCP", 1.41, filament, "Kuraray, Vectran HT: 1.41 g/cm3"),
      fibre("PBO", 1.54, filament, "Toyobo, Zylon AS: 1.54 g/cm3"),
      fibre("basalt", 2.67, filament, "manufacturers' sheets, 2.6 to 2.7 g/cm3"),
      fibre("glass-S", 2.45, filament,
            "Owens Corning, Glass fiber properties: S-glass (density, E, expansion); nu: Kaddour and Hinton "
            "2012, S2",
            IsotropicElastic{88'000, 0.2}, Expansion{3.4e-6, 3.4e-6}),
      fibre(
          "carbon-IM7", 1.78, filament,
          "A. S. Kaddour, M. J. Hinton, Journal of Composite Materials 46 (2012) 2295-2312; density: Hexcel, "
          "HexTow IM7",
          TransverseElastic{276'000, 19'000, 0.2, 27'000, 19.0 / 14 - 1}, Expansion{-0.4e-6, 5.6e-6}),
      fibre("carbon-T700", 1.80, filament,
            "Toray, T700S data sheet (density, E1, expansion along); across: those of T300, which no sheet "
            "gives",
            TransverseElastic{230'000, 15'000, 0.2, 15'000, 1.0 / 14}, Expansion{-0.38e-6, 12e-6}),
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

namespace {

// Generic fibres by their codes (ISO 2076, ISO 1043-1), other names and brands.
constexpr std::array aliases = {FibreAlias{"co", "cotton"},
                                FibreAlias{"flachs", "flax"},
                                FibreAlias{"li", "linen"},
                                FibreAlias{"merino", "wool"},
                                FibreAlias{"lambswool", "wool"},
                                FibreAlias{"cashmere", "wool"},
                                FibreAlias{"mohair", "wool"},
                                FibreAlias{"alpaca", "wool"},
                                FibreAlias{"wo", "wool"},
                                FibreAlias{"rayon", "viscose"},
                                FibreAlias{"modal", "viscose"},
                                FibreAlias{"lyocell", "viscose"},
                                FibreAlias{"tencel", "viscose"},
                                FibreAlias{"bamboo", "viscose"},
                                FibreAlias{"cv", "viscose"},
                                FibreAlias{"cupro", "viscose"},
                                FibreAlias{"pan", "acrylic"},
                                FibreAlias{"pet", "polyester"},
                                FibreAlias{"pes", "polyester"},
                                FibreAlias{"pbt", "polyester"},
                                FibreAlias{"dacron", "polyester"},
                                FibreAlias{"trevira", "polyester"},
                                FibreAlias{"terylene", "polyester"},
                                FibreAlias{"pa", "polyamide"},
                                FibreAlias{"pa6", "polyamide"},
                                FibreAlias{"pa66", "polyamide"},
                                FibreAlias{"polyamide6", "polyamide"},
                                FibreAlias{"polyamide66", "polyamide"},
                                FibreAlias{"nylon6", "nylon"},
                                FibreAlias{"nylon66", "nylon"},
                                FibreAlias{"perlon", "nylon"},
                                FibreAlias{"cordura", "nylon"},
                                FibreAlias{"pp", "polypropylene"},
                                FibreAlias{"pe", "polyethylene"},
                                FibreAlias{"hdpe", "polyethylene"},
                                FibreAlias{"spandex", "elastane"},
                                FibreAlias{"lycra", "elastane"},
                                FibreAlias{"el", "elastane"},
                                FibreAlias{"uhmwpe", "dyneema"},
                                FibreAlias{"hmpe", "dyneema"},
                                FibreAlias{"hppe", "dyneema"},
                                FibreAlias{"spectra", "dyneema"},
                                FibreAlias{"kevlar", "aramid"},
                                FibreAlias{"kevlar29", "aramid"},
                                FibreAlias{"kevlar49", "aramid"},
                                FibreAlias{"kevlarkm2", "aramid"},
                                FibreAlias{"twaron", "aramid"},
                                FibreAlias{"paraaramid", "aramid"},
                                FibreAlias{"nomex", "meta-aramid"},
                                FibreAlias{"maramid", "meta-aramid"},
                                FibreAlias{"vectran", "LCP"},
                                FibreAlias{"zylon", "PBO"},
                                FibreAlias{"teflon", "PTFE"},
                                FibreAlias{"polylactide", "PLA"},
                                FibreAlias{"glass", "glass-E"},
                                FibreAlias{"eglass", "glass-E"},
                                FibreAlias{"glassfibre", "glass-E"},
                                FibreAlias{"glassfiber", "glass-E"},
                                FibreAlias{"fibreglass", "glass-E"},
                                FibreAlias{"fiberglass", "glass-E"},
                                FibreAlias{"gf", "glass-E"},
                                FibreAlias{"sglass", "glass-S"},
                                FibreAlias{"s2glass", "glass-S"},
                                FibreAlias{"glasss2", "glass-S"},
                                FibreAlias{"s2", "glass-S"},
                                FibreAlias{"carbon", "carbon-T300"},
                                FibreAlias{"carbonfibre", "carbon-T300"},
                                FibreAlias{"carbonfiber", "carbon-T300"},
                                FibreAlias{"cf", "carbon-T300"},
                                FibreAlias{"t300", "carbon-T300"},
                                FibreAlias{"t700", "carbon-T700"},
                                FibreAlias{"t700s", "carbon-T700"},
                                FibreAlias{"as4", "carbon-AS4"},
                                FibreAlias{"im7", "carbon-IM7"}};

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (std::string_view(" -_.,/").find(c) == std::string_view::npos) plain += lower(c);
  return plain;
}

}  // namespace

std::span<const FibreAlias> fibre_aliases() {
  return aliases;
}

const Material* find_fibre(std::string_view name) {
  std::string plain = plain_name(name);
  const auto alias = std::find_if(aliases.begin(), aliases.end(),
                                  [&](const FibreAlias& known) { return known.alias == plain; });
  if (alias != aliases.end()) plain = plain_name(alias->name);
  const std::span<const Fibre> list = all_fibres();
  const auto found = std::find_if(
      list.begin(), list.end(), [&](const Fibre& fibre) { return plain_name(fibre.material.name) == plain; });
  return found == list.end() ? nullptr : &found->material;
}

}  // namespace selvage::fabric
