#include <fmt/format.h>

#include "core/number_text.h"
#include "fabric/fibres.h"
#include "formats/txt/colors.h"
#include "formats/txt/lessons.h"
#include "formats/txt/scope.h"

namespace selvage::formats::txt {

namespace {

Measures measures_of(std::string_view name, std::string_view bare, Measure measure) {
  Measures made{name, bare, {}};
  for (const NumberUnit& unit : number_units)
    if (unit.measure == measure || (measure == Measure::pitch && unit.measure == Measure::length))
      made.units.push_back(unit.word);
  return made;
}

std::vector<Known> all_known() {
  std::vector<Known> known;
  for (const fabric::Fibre& fibre : fabric::all_fibres()) {
    const fabric::Material& material = fibre.material;
    std::string text = "a fibre of the trade, for `material`:";
    if (material.density) text += fmt::format(" density {}", number_text(*material.density));
    if (material.packing) text += fmt::format(", packing {}", number_text(*material.packing));
    known.push_back({std::string(material.name), fmt::format("{} ({})", text, fibre.source)});
  }
  for (const fabric::FibreAlias& alias : fabric::fibre_aliases())
    known.push_back(
        {std::string(alias.alias), fmt::format("another name of the fibre {}, for `material`", alias.name)});
  for (const std::string_view name : color_names())
    known.push_back({std::string(name), "a colour, for `color`"});
  for (const std::string_view name : function_names())
    known.push_back({std::string(name), "a function of expressions; angles in radians"});
  return known;
}

}  // namespace

const Language& language() {
  static const Language self = {
      .name = "Fabric TXT",
      .lessons = all_lessons(),
      .values = all_values(),
      .templates = all_templates(),
      .measures = {measures_of("length", "the file's unit", Measure::length),
                   measures_of("pitch", "a distance in the file's unit; also so many on a length: 26/cm",
                               Measure::pitch),
                   measures_of("angle", "degrees", Measure::angle),
                   measures_of("density", "g/cm3", Measure::density),
                   measures_of("modulus", "MPa", Measure::modulus),
                   measures_of("twist", "turns a metre; also turns on a length: 20/in", Measure::twist),
                   measures_of("expansion", "1/K", Measure::expansion),
                   measures_of("conductivity", "W/(m K)", Measure::conductivity),
                   measures_of("diffusivity", "mm2/s", Measure::diffusivity)},
      .known = all_known(),
      .grammar = textmate_grammar};
  return self;
}

}  // namespace selvage::formats::txt
