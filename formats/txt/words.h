// The fixed words of the language and what they mean; the reader and the writer share these tables.
#pragma once

#include <array>
#include <string_view>

#include "core/words.h"
#include "fabric/model.h"

namespace selvage::formats::txt {

template <class T>
struct Word {
  std::string_view text;
  T value;
};

using fabric::Draft;
using fabric::Hand;
using fabric::Knit;
using fabric::LinearDensity;
using fabric::Path;
using fabric::PieceCurve;
using fabric::Role;
using fabric::Warpknit;
using fabric::Weave;

// All are compared ignoring case and written as they stand here.
inline constexpr std::array<Word<Hand>, 2> hand_words{{{"Z", Hand::z}, {"S", Hand::s}}};
inline constexpr auto density_words = [] {
  using enum LinearDensity::Measure;
  std::array<Word<LinearDensity::Measure>, 5> words{};
  for (std::size_t i = 0; const LinearDensity::Measure measure : {tex, dtex, denier, nm, ne})
    words[i++] = {fabric::name_of(measure), measure};
  return words;
}();
inline constexpr std::array<Word<Unit>, 5> unit_words{
    {{"m", Unit::m}, {"cm", Unit::cm}, {"mm", Unit::mm}, {"um", Unit::um}, {"inch", Unit::inch}}};
inline constexpr std::array<Word<Role>, 8> role_words{{{"warp", Role::warp},
                                                       {"weft", Role::weft},
                                                       {"wale", Role::wale},
                                                       {"course", Role::course},
                                                       {"braider", Role::braider},
                                                       {"axial", Role::axial},
                                                       {"binder", Role::binder},
                                                       {"other", Role::other}}};
inline constexpr std::array<Word<yarn::PathForm>, 7> path_words{{{"chord", yarn::PathForm::chord},
                                                                 {"uniform", yarn::PathForm::uniform},
                                                                 {"centripetal", yarn::PathForm::centripetal},
                                                                 {"polyline", yarn::PathForm::polyline},
                                                                 {"control", yarn::PathForm::control},
                                                                 {"loop", yarn::PathForm::loop},
                                                                 {"smooth", yarn::PathForm::smooth}}};
// Behind a row of a path.
inline constexpr std::string_view fixed_word = "fixed";
inline constexpr std::string_view outline_word = "outline";
inline constexpr std::array<Word<Draft::Form>, 8> draft_words{{{"plain", Draft::Form::plain},
                                                               {"twill", Draft::Form::twill},
                                                               {"satin", Draft::Form::satin},
                                                               {"basket", Draft::Form::basket},
                                                               {"leno", Draft::Form::leno},
                                                               {"corduroy", Draft::Form::corduroy},
                                                               {"velveteen", Draft::Form::velveteen},
                                                               {"file", Draft::Form::file}}};
inline constexpr std::array<Word<fabric::WarpPile::Side>, 3> pile_words{
    {{"face", fabric::WarpPile::Side::face},
     {"back", fabric::WarpPile::Side::back},
     {"both", fabric::WarpPile::Side::both}}};
inline constexpr std::array<Word<bool>, 2> leno_words{{{"half", false}, {"full", true}}};
inline constexpr std::array<Word<bool>, 2> face_words{{{"warp-faced", true}, {"weft-faced", false}}};
inline constexpr std::array<Word<Weave::Spacing>, 2> spacing_words{
    {{"even", Weave::Spacing::even}, {"relaxed", Weave::Spacing::relaxed}}};
inline constexpr std::array<Word<Weave::State>, 3> state_words{
    {{"loom", Weave::State::loom}, {"relaxed", Weave::State::relaxed}, {"finished", Weave::State::finished}}};
inline constexpr std::array<Word<Weave::Profile>, 5> profile_words{
    {{"peirce", Weave::Profile::peirce},
     {"sine", Weave::Profile::sine},
     {"lenticular", Weave::Profile::lenticular},
     {"racetrack", Weave::Profile::racetrack},
     {"straight", Weave::Profile::straight}}};
inline constexpr std::array<Word<bool>, 2> binder_words{{{"first", true}, {"levels", false}}};
inline constexpr std::array<Word<Knit::Form>, 9> knit_words{{{"jersey", Knit::Form::jersey},
                                                             {"purl", Knit::Form::purl},
                                                             {"rib", Knit::Form::rib},
                                                             {"interlock", Knit::Form::interlock},
                                                             {"full-cardigan", Knit::Form::full_cardigan},
                                                             {"half-cardigan", Knit::Form::half_cardigan},
                                                             {"milano", Knit::Form::milano},
                                                             {"half-milano", Knit::Form::half_milano},
                                                             {"jacquard", Knit::Form::jacquard}}};
inline constexpr std::array<Word<Knit::Shape>, 2> knit_shape_words{
    {{"published", Knit::Shape::published}, {"relaxed", Knit::Shape::relaxed}}};
inline constexpr std::array<Word<char>, 5> stitch_signs{
    {{"K", 'K'}, {"P", 'P'}, {"T", 'T'}, {"U", 'U'}, {"M", 'M'}}};
// Of a loop that is moved: 1 where wales rise.
inline constexpr std::array<Word<int>, 2> side_words{{{"right", 1}, {"left", -1}}};
inline constexpr std::array<Word<Knit::Gating>, 2> gating_words{
    {{"rib", Knit::Gating::rib}, {"opposite", Knit::Gating::opposite}}};
inline constexpr std::array<Word<nurbs::Parameterization>, 3> knit_method_words{
    {{"uniform", nurbs::Parameterization::uniform},
     {"chord", nurbs::Parameterization::chord},
     {"centripetal", nurbs::Parameterization::centripetal}}};
inline constexpr std::array<Word<Warpknit::Stitch>, 2> stitch_words{
    {{"closed", Warpknit::Stitch::closed}, {"open", Warpknit::Stitch::open}}};
inline constexpr std::array<Word<std::string_view>, 7> classic_words{{{"tricot", "tricot"},
                                                                      {"satin", "satin"},
                                                                      {"queens-cord", "queens-cord"},
                                                                      {"locknit", "locknit"},
                                                                      {"atlas", "atlas"},
                                                                      {"velvet", "velvet"},
                                                                      {"cord", "cord"}}};
inline constexpr std::array<Word<PieceCurve::Shape>, 4> curve_words{{{"C", PieceCurve::Shape::c},
                                                                     {"S", PieceCurve::Shape::s},
                                                                     {"control", PieceCurve::Shape::control},
                                                                     {"spline", PieceCurve::Shape::spline}}};
inline constexpr std::array<Word<nurbs::PointParameters>, 3> curve_method_words{
    {{"uniform", nurbs::PointParameters::uniform},
     {"chord", nurbs::PointParameters::chord},
     {"distance", nurbs::PointParameters::distance}}};
inline constexpr std::array<Word<yarn::EndStyle>, 4> end_words{{{"patch", yarn::EndStyle::patch},
                                                                {"fan", yarn::EndStyle::fan},
                                                                {"planar", yarn::EndStyle::planar},
                                                                {"none", yarn::EndStyle::none}}};

inline constexpr std::array<Word<int>, 3> axis_words{{{"x", 0}, {"y", 1}, {"z", 2}}};
inline constexpr std::array<Word<fabric::Move::Form>, 4> move_words{{{"place", fabric::Move::Form::place},
                                                                     {"rotate", fabric::Move::Form::rotate},
                                                                     {"mirror", fabric::Move::Form::mirror},
                                                                     {"shear", fabric::Move::Form::shear}}};

// The sections, by their index in yarn::Section.
inline constexpr std::array<Word<std::size_t>, 7> section_words{{{"circle", 0},
                                                                 {"ellipse", 1},
                                                                 {"lenticular", 2},
                                                                 {"racetrack", 3},
                                                                 {"power", 4},
                                                                 {"loop7", 5},
                                                                 {"polygon", 6}}};

inline constexpr std::array<Word<fabric::Edit::Form>, 3> edit_words{{{"point", fabric::Edit::Form::point},
                                                                     {"weight", fabric::Edit::Form::weight},
                                                                     {"length", fabric::Edit::Form::length}}};

// Whether an enum has this value: the compiler writes one without a name as "(Enum)5".
template <auto Value>
consteval bool is_enumerator() {
  return std::string_view(__PRETTY_FUNCTION__).find("Value = (") == std::string_view::npos;
}
template <class Enum, int First = 0>
consteval std::size_t enumerators() {
  if constexpr (is_enumerator<static_cast<Enum>(First)>()) return enumerators<Enum, First + 1>();
  return First;
}
// Is there a word for each enumerator, but for `without` of them, which are said in other ways?
template <class Enum, std::size_t N>
consteval bool says_all(const std::array<Word<Enum>, N>&, std::size_t without = 0) {
  return N + without == enumerators<Enum>();
}
static_assert(says_all(hand_words) && says_all(density_words) && says_all(unit_words) &&
              says_all(role_words) && says_all(path_words) && says_all(profile_words) &&
              says_all(spacing_words) && says_all(pile_words) && says_all(state_words) &&
              says_all(knit_method_words) && says_all(gating_words) && says_all(knit_shape_words) &&
              says_all(stitch_words) && says_all(end_words) && says_all(edit_words) && says_all(move_words) &&
              section_words.size() == std::variant_size_v<yarn::Section>);
static_assert(says_all(draft_words, 1) && says_all(knit_words, 1) && says_all(curve_words, 1) &&
              says_all(curve_method_words));

template <class T, std::size_t N>
constexpr std::string_view word_of(const std::array<Word<T>, N>& words, const T& value) {
  for (const Word<T>& word : words)
    if (word.value == value) return word.text;
  return {};
}

// A name that needs no quotes: [A-Za-z_][A-Za-z0-9_.-]*. ASCII only, whatever the locale.
constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
constexpr bool starts_name(char c) {
  return is_letter(c) || c == '_';
}
constexpr bool continues_name(char c) {
  return starts_name(c) || (c >= '0' && c <= '9') || c == '.' || c == '-';
}
constexpr bool is_plain_name(std::string_view text) {
  if (text.empty() || !starts_name(text.front())) return false;
  for (char c : text)
    if (!continues_name(c)) return false;
  return true;
}

}  // namespace selvage::formats::txt
