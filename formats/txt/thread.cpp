// The blocks `thread` and `material`.
#include <fmt/format.h>

#include <cmath>

#include "core/number_text.h"
#include "core/plane.h"
#include "core/words.h"
#include "fabric/fibres.h"
#include "formats/txt/blocks.h"
#include "formats/txt/colors.h"
#include "formats/txt/count.h"

namespace selvage::formats::txt {

namespace {

using fabric::LinearDensity;
using fabric::Material;
using fabric::Thread;

// --- thread
// ---------------------------------------------------------------------------------------------------------

LinearDensity::Measure system_of(std::string_view word) {
  for (const auto& measure : density_words)
    if (same_word(measure.text, word)) return measure.value;
  return LinearDensity::Measure::denier;  // Td
}

// More than one number: what a trade writes.
void read_count_notation(Parser& p, Thread& thread, std::string_view word) {
  const auto text = p.rest_of(fmt::format("the linear density ({})", word));
  if (!text) return;
  const Spot spot = p.last();
  const Result<YarnCount> count = read_yarn_count(with_plain_blanks(*text), system_of(word), p.scope());
  if (!count) return p.error(spot, count.error().text);
  p.check(fabric::linear_density_quantity, count->whole.tex());
  if (!p.finish()) return;
  thread.linear_density = count->whole;
  p.counted = {count->plies, count->filaments, spot};
  if (count->filaments == 1) thread.filaments = thread.filaments.value_or(1);
  if (!count->understood.empty()) p.report.note(spot, fmt::format("understood as {}", count->understood));
}

void read_linear_density(Parser& p, Thread& thread, std::string_view word) {
  if (is_count_notation(p.peek_rest(), p.scope())) return read_count_notation(p, thread, word);
  const auto value = p.positive(fmt::format("the linear density ({})", word));
  if (!value) return;
  const LinearDensity density = {*value, system_of(word)};
  p.check(fabric::linear_density_quantity, density.tex());
  if (p.finish()) thread.linear_density = density;
}

template <class Owner>
void read_packing(Parser& p, Owner& owner, std::string_view) {
  std::optional<double> value;
  if (const std::string_view word = p.peek_word(); word.ends_with('%')) {
    value = read_number(word.substr(0, word.size() - 1));
    if (!value || !(*value > 0.0 && *value <= 100.0))
      return p.error(p.here(), "the packing is a share of the section, as in 0.65 or 65%");
    p.take_word();
    *value /= 100.0;
  } else {
    value = p.positive("the packing");
  }
  if (value && *value > 1.0)
    p.error(p.last(), fmt::format("the packing is a share of the section: it cannot be larger than 1{}",
                                  *value <= 100.0 ? fmt::format("; write '{}'", *value / 100.0) : ""));
  else if (value)
    p.check(fabric::packing_quantity, *value);
  if (p.finish()) owner.packing = *value;
}

std::optional<yarn::Section> read_polygon(Parser& p) {
  const Spot spot = p.last();
  p.finish();
  PointRows corners{"corner", "a corner"};
  if (!read_points(p, "polygon", "", spot, corners)) return std::nullopt;
  const std::vector<Vec2>& points = corners.points;
  if (points.size() < 3)
    p.error(p.last(), fmt::format("a polygon has at least 3 corners; this one has {}", points.size()));
  else if (points.front() == points.back())
    p.error(corners.last,
            "the polygon's last corner repeats its first: leave it out, the polygon is closed anyway");
  else if (twice_area(points) == 0.0)
    p.error(spot, "the polygon's area is 0");
  else
    return yarn::Polygon{points};
  return std::nullopt;
}

// What stands behind the word of a shape, by its members.
template <class Shape>
std::optional<yarn::Section> read_shape_of(Parser& p) {
  Shape shape;
  const auto read = [&](double& value, std::string_view what, Measure measure = Measure::length) {
    const std::optional<double> given = p.positive(what, measure);
    value = given.value_or(0.0);
    return given.has_value();
  };
  bool good = true;
  if constexpr (requires { shape.corners; }) {
    return read_polygon(p);
  } else if constexpr (requires { shape.diameter; }) {
    good = !p.more() || read(shape.diameter, "the section's diameter");
  } else {
    good = read(shape.width, "the section's width") && read(shape.height, "the section's height");
    if constexpr (requires { shape.exponent; })
      good = good && read(shape.exponent, "the section's exponent", Measure::plain);
  }
  return good && p.finish() ? std::optional<yarn::Section>(shape) : std::nullopt;
}

template <std::size_t... Kind>
std::optional<yarn::Section> read_kind(Parser& p, std::size_t kind, std::index_sequence<Kind...>) {
  constexpr std::array readers{&read_shape_of<std::variant_alternative_t<Kind, yarn::Section>>...};
  return readers[kind](p);
}

void read_section(Parser& p, Thread& thread, std::string_view) {
  const auto kind = p.choice("section", section_words);
  if (!kind) return p.skip_statement();
  constexpr std::make_index_sequence<std::variant_size_v<yarn::Section>> all;
  if (std::optional<yarn::Section> section = read_kind(p, *kind, all)) thread.section = std::move(section);
}

// TURNS and their direction, in either order; turns may say `t/m` behind them.
std::pair<std::optional<double>, std::optional<fabric::Hand>> read_turns(Parser& p, std::string_view what) {
  std::optional<fabric::Hand> hand;
  const auto is_hand = [](std::string_view word) { return same_word(word, "Z") || same_word(word, "S"); };
  const auto is_number = [](std::string_view word) { return read_number(word).has_value(); };
  if (is_hand(p.peek_word())) {
    hand = p.choice("twist direction", hand_words);
  } else if (const std::string_view word = p.peek_word(); word.size() > 1) {  // Z600, 600Z
    const std::string_view first = word.substr(0, 1), last = word.substr(word.size() - 1);
    if (is_hand(first) && is_number(word.substr(1))) {
      hand = same_word(first, "Z") ? fabric::Hand::z : fabric::Hand::s;
      p.take_bytes(1);
    } else if (is_hand(last) && is_number(word.substr(0, word.size() - 1))) {
      const double turns = *read_number(word.substr(0, word.size() - 1));
      p.take_word();
      p.check(fabric::twist_quantity, turns);
      return {turns, same_word(last, "Z") ? fabric::Hand::z : fabric::Hand::s};
    }
  }
  const auto turns = p.not_negative(fmt::format("the {} (its direction is the letter Z or S)", what),
                                    fabric::twist_quantity);
  for (const std::string_view unit : {"t/m", "turns/m", "tr/m", "/m"})
    if (same_word(p.peek_word(), unit)) p.take_word();
  if (!hand) hand = p.choice("twist direction", hand_words);
  return {turns, hand};
}

void read_twist(Parser& p, Thread& thread, std::string_view) {
  const auto [turns, hand] = read_turns(p, "twist");
  const bool rotates = p.more() && p.expect("rotate");
  if (p.finish()) thread.twist = {*turns, *hand, rotates};
}

void read_plies(Parser& p, Thread& thread, std::string_view) {
  const auto count = p.count("the number of plies");
  const auto [turns, hand] = read_turns(p, "ply twist");
  if (p.finish()) thread.plies = {*count, *turns, *hand};
}

// E glass, PA 6.6: names of fibres may have blanks.
void read_thread_material(Parser& p, Thread& thread, std::string_view) {
  const std::string rest = with_plain_blanks(p.peek_rest());
  if (rest.find(' ') != std::string::npos && rest.find_first_of("\"#") == std::string::npos)
    if (const Material* fibre = fabric::find_fibre(rest)) {
      p.take_rest();
      if (p.finish()) thread.material = fibre->name;
      return;
    }
  if (rest.find_first_of("%/") != std::string::npos && rest.find('"') == std::string::npos) {
    const std::string_view all = "100%";
    if (const Material* fibre =
            rest.starts_with(all) ? fabric::find_fibre(trimmed(rest.substr(all.size()))) : nullptr) {
      p.take_rest();
      if (p.finish()) thread.material = fibre->name;
      return;
    }
    p.error(p.here(),
            fmt::format("{} is no material: of a blend write the density, as in 'density 1.46', and for its "
                        "elasticity a block 'material NAME'",
                        in_quotes(rest)));
    p.take_rest();
    return;
  }
  const auto name = p.reference(p.materials);
  if (p.finish()) thread.material = *name;
}

void read_color(Parser& p, Thread& thread, std::string_view) {
  fabric::Color color;
  // dark blue, Dark-Blue.
  std::string name(p.peek_rest());
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t' || c == '-' || c == '_'; });
  if (!name.empty() && is_letter(name.front()))
    if (const std::optional<fabric::Color> named = color_named(name)) {
      p.take_rest();
      if (p.finish()) thread.color = named;
      return;
    }
  const std::string_view word = p.peek_word(), code = p.take_color_code();
  if (!code.empty() || (!word.empty() && is_letter(word.front()))) {
    const std::string_view given = code.empty() ? p.take_word() : code;
    const std::optional<fabric::Color> named = color_named(given);
    if (!named)
      return p.error(
          p.last(),
          code.empty()
              ? fmt::format("unknown colour {}{} (or #RRGGBB, #RGB, or three numbers from 0 to 255, as in "
                            "70 130 180)",
                            in_quotes(given), did_you_mean(given, color_names()))
              : fmt::format("{} is no colour: behind # there are 6 or 3 digits from 0 to 9 and a to f, as in "
                            "#4682b4",
                            in_quotes(given)));
    if (p.finish()) thread.color = named;
    return;
  }
  for (int* part : {&color.red, &color.green, &color.blue})
    *part = p.integer("a colour's red, green or blue", 0, 255).value_or(0);
  if (p.finish()) thread.color = color;
}

// --- material
// -------------------------------------------------------------------------------------------------------

void read_isotropic(Parser& p, Material& material) {
  const auto modulus = p.positive("Young's modulus", fabric::modulus_quantity);
  const auto poisson = p.number("Poisson's ratio");
  if (poisson && (*poisson <= -1.0 || *poisson >= 0.5))
    p.error(p.last(), "Poisson's ratio of an isotropic material lies between -1 and 0.5, both excluded");
  if (p.finish()) material.elastic = fabric::IsotropicElastic{*modulus, *poisson};
}

// Positive strain energy for every strain asks for nu12^2 < E1 / E2, |nu23| < 1 and
// 1 - nu23 - 2 nu12^2 E2 / E1 > 0 (Lempriere 1968, for transverse isotropy about axis 1).
void read_transverse(Parser& p, Material& material) {
  std::array<double, 5> value{};
  std::array<Spot, 5> spot;
  constexpr std::array<std::string_view, 5> what = {"the modulus E1", "the modulus E2",
                                                    "Poisson's ratio nu12", "the shear modulus G12",
                                                    "Poisson's ratio nu23"};
  for (std::size_t i = 0; i < value.size(); ++i) {
    const bool is_ratio = i == 2 || i == 4;
    const auto number = is_ratio ? p.number(what[i]) : p.positive(what[i], fabric::modulus_quantity);
    if (!number) return;
    value[i] = *number;
    spot[i] = p.last();
  }
  const fabric::TransverseElastic elastic{value[0], value[1], value[2], value[3], value[4]};
  const double minor = elastic.nu12 * elastic.nu12 * elastic.e2 / elastic.e1;
  if (!(minor < 1.0))
    p.error(spot[2], "nu12 is too large for a stable material: nu12^2 has to be smaller than E1 / E2");
  else if (!(std::abs(elastic.nu23) < 1.0 && 1.0 - elastic.nu23 - 2.0 * minor > 0.0))
    p.error(spot[4],
            "nu23 is not that of a stable material: between -1 and 1 - 2 nu12^2 E2 / E1, both excluded");
  if (p.finish()) material.elastic = elastic;
}

// Alike in all directions, or across the yarn only.
constexpr std::array<Word<bool>, 2> elastic_words{{{"isotropic", false}, {"transverse", true}}};

void read_elastic(Parser& p, Material& material, std::string_view) {
  const auto is_transverse = p.choice("elastic law", elastic_words);
  if (!is_transverse) return;
  *is_transverse ? read_transverse(p, material) : read_isotropic(p, material);
}

// Compression is a positive number, too.
std::optional<double> a_strength(Parser& p, std::string_view what) {
  return p.positive(fmt::format("the strength {}", what), fabric::strength_quantity);
}

void read_isotropic_strength(Parser& p, Material& material) {
  fabric::IsotropicStrength strength;
  const auto tension = a_strength(p, "in tension"), compression = a_strength(p, "in compression");
  if (p.more()) strength.shear = a_strength(p, "in shear");
  if (!p.finish()) return;
  strength.tension = *tension;
  strength.compression = *compression;
  material.strength = strength;
}

// Without the one in shear across it is that of a crack at 45 degrees to the pressure: YC / 2.
void read_transverse_strength(Parser& p, Material& material) {
  const auto tension = a_strength(p, "along in tension (XT)");
  const auto compression = a_strength(p, "along in compression (XC)");
  std::optional<fabric::TransverseStrength::Across> across;
  if (p.more()) {
    const auto yt = a_strength(p, "across in tension (YT)"), yc = a_strength(p, "across in compression (YC)");
    const auto s12 = a_strength(p, "in shear along (S12)");
    const auto s23 = p.more() ? a_strength(p, "in shear across (S23)") : std::nullopt;
    if (yt && yc && s12) across = {*yt, *yc, *s12, s23.value_or(*yc / 2)};
  }
  if (p.finish()) material.strength = fabric::TransverseStrength{*tension, *compression, across};
}

void read_strength(Parser& p, Material& material, std::string_view) {
  const auto is_transverse = p.choice("kind of strength", elastic_words);
  if (!is_transverse) return;
  *is_transverse ? read_transverse_strength(p, material) : read_isotropic_strength(p, material);
}

void read_expansion(Parser& p, Material& material, std::string_view) {
  const auto along = p.number_of(fabric::expansion_quantity, "the expansion along");
  const auto across = p.number_of(fabric::expansion_quantity, "the expansion across");
  if (p.finish()) material.expansion = {*along, *across};
}

// `remedy`: what to give where there is none of it.
std::optional<double> a_transport(Parser& p, const fabric::Quantity& quantity, const std::string& what,
                                  std::string_view remedy) {
  const auto value = p.number(what, quantity.measure);
  if (!value) return value;
  if (*value > 0.0)
    p.check(quantity, *value);
  else
    p.error(p.last(), fmt::format("{} has to be larger than 0: {}", what, remedy));
  return value;
}

// One number for all directions, or one along and one across the yarn.
auto into_transport(std::optional<fabric::Transport> Material::*member, const fabric::Quantity& quantity,
                    std::string_view remedy) {
  return [member, &quantity, remedy](Parser& p, Material& material, std::string_view word) {
    const auto along = a_transport(p, quantity, fmt::format("the {}", word), remedy);
    const auto across =
        along && p.more() ? a_transport(p, quantity, fmt::format("the {} across", word), remedy) : along;
    if (p.finish()) material.*member = {*along, *across};
  };
}

// Across and along the interface.
auto into_pair(std::optional<fabric::Interface::Pair> fabric::Interface::*member,
               const fabric::Quantity& quantity) {
  return [member, &quantity](Parser& p, fabric::Interface& interface, std::string_view word) {
    const auto normal = p.positive(fmt::format("the {} across the interface", word), quantity);
    const auto shear = p.positive(fmt::format("the {} along the interface", word), quantity);
    p.finish();
    interface.*member = {normal.value_or(0), shear.value_or(0)};  // wrong or not, it was given
  };
}

void read_interface(Parser& p, Material& material, std::string_view word) {
  static const Table<fabric::Interface> table(
      {{"stiffness", into_pair(&fabric::Interface::stiffness, fabric::interface_stiffness_quantity)},
       {"strength", into_pair(&fabric::Interface::strength, fabric::interface_strength_quantity)},
       {"energy", into_pair(&fabric::Interface::energy, fabric::interface_energy_quantity)}});
  const Spot opened = p.statement();
  p.finish();
  fabric::Interface& interface = material.interface.emplace();
  if (!p.read_block(word, "", opened, table, interface)) return;
  if (interface.strength.has_value() != interface.energy.has_value())
    p.error(opened, interface.strength
                        ? "an interface that has a strength needs `energy`, too: how much it "
                          "takes to part it"
                        : "an interface that has an energy needs `strength`, too: the traction at "
                          "which it begins to part");
}

}  // namespace

void check_count(Parser& p, const Thread& thread) {
  const CountParts& counted = p.counted;
  const auto differ = [&](std::string_view word, int said, int given) {
    p.error(counted.spot,
            fmt::format("the count has {0} {1}, and `{1}` says {2}: write the same number in both, or "
                        "leave it out of the count",
                        said, word, given));
  };
  if (thread.plies && counted.plies > 1 && counted.plies != thread.plies->count)
    differ("plies", counted.plies, thread.plies->count);
  if (thread.filaments && counted.filaments > 0 && counted.filaments != *thread.filaments)
    differ("filaments", counted.filaments, *thread.filaments);
}

const std::vector<Statement<Thread>>& thread_statements() {
  static const std::vector<Statement<Thread>> list = {
      {"tex", read_linear_density},
      {"dtex", read_linear_density, Times::at_most_once, "tex"},
      {"denier", read_linear_density, Times::at_most_once, "tex"},
      {"Td", read_linear_density, Times::at_most_once, "tex"},
      {"Nm", read_linear_density, Times::at_most_once, "tex"},
      {"Ne", read_linear_density, Times::at_most_once, "tex"},
      {"density", into(&Thread::density, a_positive("the fibre density", fabric::density_quantity))},
      {"packing", read_packing<Thread>},
      {"diameter", into(&Thread::diameter, a_length("the diameter"))},
      {"section", read_section},
      {"twist", read_twist},
      {"plies", read_plies},
      {"filaments", into(&Thread::filaments, a_count("the number of filaments"))},
      {"color", read_color},
      {"colour", read_color, Times::at_most_once, "color"},
      {"material", read_thread_material}};
  return list;
}

// A block that others refer to by its name.
template <class Named>
static void read_named(Parser& p, const Table<Named>& table, Names& names, std::string_view word,
                       std::vector<Named>& all) {
  Named made;
  const Spot opened = p.statement();
  made.place = opened.place();
  const auto name = p.new_name(names);
  p.finish();
  made.name = name.value_or("");
  p.read_block(word, made.name, opened, table, made);
  all.push_back(std::move(made));
}

void read_thread(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Thread> table = [] {
    Table<Thread> made(thread_statements());
    made.word_of_line = system_of_count;
    return made;
  }();
  p.counted = {};
  read_named(p, table, p.threads, word, fabric.threads);
  check_count(p, fabric.threads.back());
}

void read_material(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Material> table(
      {{"density", into(&Material::density, a_positive("the density", fabric::density_quantity))},
       {"packing", read_packing<Material>},
       {"elastic", read_elastic},
       {"strength", read_strength},
       {"expansion", read_expansion},
       {"conductivity", into_transport(&Material::conductivity, fabric::conductivity_quantity,
                                       "an insulator has a small one, still air 0.026")},
       {"diffusivity",
        into_transport(&Material::diffusivity, fabric::diffusivity_quantity,
                       "give what lets nothing through a small one, a thousandth of the others'")},
       {"permittivity", into_transport(&Material::permittivity, fabric::permittivity_quantity,
                                       "it is relative, and that of a vacuum is 1")},
       {"interface", read_interface}});
  read_named(p, table, p.materials, word, fabric.materials);
}

void read_outline(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  fabric::Outline outline;
  const Spot opened = p.statement();
  outline.place = opened.place();
  const auto name = p.new_name(p.outlines);
  p.finish();
  outline.name = name.value_or("");
  PointRows rows{"point", "a point of the outline"};
  if (read_points(p, word, outline.name, opened, rows)) {
    if (rows.points.size() < 3)
      p.error(p.last(), fmt::format("an outline has at least 3 points; this one has {}", rows.points.size()));
    else if (twice_area(rows.points) == 0.0)
      p.error(opened, "the outline's area is 0");
  }
  outline.points = std::move(rows.points);
  fabric.outlines.push_back(std::move(outline));
}

}  // namespace selvage::formats::txt
