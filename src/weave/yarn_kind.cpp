#include "weave/yarn_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/rounding.h"
#include "fabric/fibres.h"
#include "fabric/yarn_spec.h"
#include "yarn/outline.h"

namespace selvage::fabric {

namespace {

// Usual twist factors. Cotton twist multipliers (turns per inch over the square root of the cotton count,
// 956.7 times smaller) of carded ring-spun yarns: 4.2 for warp, 3.5 for weft, within the ranges 3.8 to 5.0
// and 3.0 to 3.8 of short and medium staple in W. Klein, The Rieter Manual of Spinning 1, Technology of
// Short-staple Spinning, table of twist coefficients. Worsted singles for weaving: metric twist factor (turns
// per metre over the square root of Nm) 89, times 31.6; an assumption, no published table was found. Filament
// yarns have producer's twist, 0 to 300; tows and rovings none.
constexpr YarnKind spun_warp{"spun yarn", 4000}, spun_weft{"spun yarn", 3400};
constexpr YarnKind worsted{"worsted yarn", 2800};
constexpr YarnKind filament_yarn{"filament yarn", 100};
constexpr YarnKind untwisted_tow{"tow", 0};
constexpr YarnKind monofilament{"monofilament", 0, true};

// Form in which a fibre usually is in a yarn. `natural`: staple, whatever the text says of filaments.
enum class FibreForm { natural, wool, staple, filament, tow, wire };
struct FormOfFibre {
  std::string_view fibre;  // name of the list in fibres.cpp
  FibreForm form;
};
constexpr std::array forms_of_fibres = {FormOfFibre{"cotton", FibreForm::natural},
                                        FormOfFibre{"flax", FibreForm::natural},
                                        FormOfFibre{"linen", FibreForm::natural},
                                        FormOfFibre{"jute", FibreForm::natural},
                                        FormOfFibre{"hemp", FibreForm::natural},
                                        FormOfFibre{"ramie", FibreForm::natural},
                                        FormOfFibre{"wool", FibreForm::wool},
                                        FormOfFibre{"viscose", FibreForm::staple},
                                        FormOfFibre{"acrylic", FibreForm::staple},
                                        FormOfFibre{"meta-aramid", FibreForm::staple},
                                        FormOfFibre{"silk", FibreForm::filament},
                                        FormOfFibre{"acetate", FibreForm::filament},
                                        FormOfFibre{"polyester", FibreForm::filament},
                                        FormOfFibre{"nylon", FibreForm::filament},
                                        FormOfFibre{"polyamide", FibreForm::filament},
                                        FormOfFibre{"polypropylene", FibreForm::filament},
                                        FormOfFibre{"polyethylene", FibreForm::filament},
                                        FormOfFibre{"elastane", FibreForm::filament},
                                        FormOfFibre{"dyneema", FibreForm::filament},
                                        FormOfFibre{"PLA", FibreForm::filament},
                                        FormOfFibre{"PTFE", FibreForm::filament},
                                        FormOfFibre{"PEEK", FibreForm::filament},
                                        FormOfFibre{"PPS", FibreForm::filament},
                                        FormOfFibre{"LCP", FibreForm::filament},
                                        FormOfFibre{"PBO", FibreForm::filament},
                                        FormOfFibre{"aramid", FibreForm::tow},
                                        FormOfFibre{"basalt", FibreForm::tow},
                                        FormOfFibre{"glass-E", FibreForm::tow},
                                        FormOfFibre{"glass-S", FibreForm::tow},
                                        FormOfFibre{"carbon-T300", FibreForm::tow},
                                        FormOfFibre{"carbon-T700", FibreForm::tow},
                                        FormOfFibre{"carbon-AS4", FibreForm::tow},
                                        FormOfFibre{"carbon-IM7", FibreForm::tow},
                                        FormOfFibre{"steel", FibreForm::wire},
                                        FormOfFibre{"copper", FibreForm::wire}};

// None: the thread has no material, or one of the text's own under another name.
std::optional<FibreForm> fibre_form_of(const Thread& thread) {
  const Material* const fibre = thread.material ? find_fibre(*thread.material) : nullptr;
  if (fibre == nullptr) return std::nullopt;
  const auto found =
      std::find_if(forms_of_fibres.begin(), forms_of_fibres.end(),
                   [&](const FormOfFibre& candidate) { return candidate.fibre == fibre->name; });
  return found == forms_of_fibres.end() ? std::nullopt : std::optional(found->form);
}

constexpr double assumed_density = 1.5;  // g/cm3
constexpr double assumed_packing = 0.6;

struct YarnSize {
  double tex = 0;
  double diameter = 0;  // mm, of the circle of the cross-section's area
};

Result<YarnSize> yarn_size_of(const Thread& thread, Unit units) {
  const double density = thread.fibre_density().value_or(assumed_density);
  const double packing = thread.size_packing().value_or(assumed_packing);
  Thread complete = thread;
  if (thread.linear_density) {
    complete.density = density;
    complete.packing = packing;
  }
  const Result<yarn::Section> section = section_of(complete, units, false);
  if (!section) return section.error();
  const yarn::SectionSize size = yarn::nominal_size(*section);
  if (const Status valid = yarn::check_section(*section, size); !valid) return valid.error();
  const double mm = millimetres_per(units);
  const double area = yarn::area(*section, size) * mm * mm;
  return YarnSize{thread.linear_density ? thread.linear_density->tex() : 1000.0 * density * packing * area,
                  2.0 * std::sqrt(area / std::numbers::pi)};
}

Status check_surface_angle(double turns, double diameter) {
  constexpr double max_angle = 45.0;                                  // degrees; its tangent is 1
  const double slope = std::numbers::pi * diameter * turns / 1000.0;  // mm/mm
  if (slope <= 1.0 + 1e-9) return {};
  const double angle = std::atan(slope) * 180.0 / std::numbers::pi;
  return error(
      Kind::geometry,
      fmt::format("twist {:.4g} turns/m lies at {:.1f} degrees at the surface of a yarn of {:.3g} mm; at "
                  "most {:.0f}: use a twist of at most {:.4g} turns/m",
                  turns, std::max(angle, max_angle + 0.1), diameter, max_angle,
                  rounded_down(1000.0 / (std::numbers::pi * diameter))));
}

}  // namespace

YarnKind yarn_kind_of(const Thread& thread, bool is_warp) {
  // Several plies have pores between them, whatever they are.
  const bool is_single = !thread.plies || thread.plies->count <= 1;
  const bool is_one_piece = thread.filaments == 1 || (!thread.filaments && thread.size_packing() == 1.0);
  if (is_single && is_one_piece) return monofilament;
  const YarnKind spun = is_warp ? spun_warp : spun_weft;
  const YarnKind by_filaments = thread.filaments ? filament_yarn : spun;
  const std::optional<FibreForm> form = fibre_form_of(thread);
  if (!form) return by_filaments;
  switch (*form) {
    case FibreForm::natural:
      return spun;
    case FibreForm::wool:
      return worsted;
    case FibreForm::staple:
      return by_filaments;
    case FibreForm::filament:
      return filament_yarn;
    case FibreForm::tow:
      return untwisted_tow;
    case FibreForm::wire:
      return is_single && !thread.filaments ? monofilament : filament_yarn;
  }
  return spun;
}

Result<std::optional<double>> twist_factor_of(const Thread& thread, Unit units, bool is_warp) {
  const YarnKind kind = yarn_kind_of(thread, is_warp);
  if (kind.is_solid) return std::optional<double>();
  const bool has_ply_twist = thread.plies && thread.plies->turns > 0.0;
  if (!has_ply_twist && !thread.twist) return std::optional<double>(kind.twist_factor);
  const Result<YarnSize> size = yarn_size_of(thread, units);
  if (!size) return size.error().placed(thread.place);
  // Without ply twist the plies are single yarns side by side.
  const double singles = !has_ply_twist && thread.plies ? std::max(1, thread.plies->count) : 1;
  const double turns = has_ply_twist ? thread.plies->turns : thread.twist->turns;
  if (const Status possible = check_surface_angle(turns, size->diameter / std::sqrt(singles)); !possible)
    return possible.error().placed(thread.place);
  return std::optional<double>(turns * std::sqrt(size->tex / singles));
}

}  // namespace selvage::fabric
