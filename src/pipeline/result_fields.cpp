#include "pipeline/result_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/text_report.h"
#include "core/words.h"
#include "results/solved_deck.h"

namespace selvage::pipeline {

namespace {

using Field = fem::FieldMesh::Field;

// What programs call the quantities of mechanics and heat. The units are those of decks in mm, N and s.
struct Quantity {
  std::string_view word;
  std::string_view names;  // in CalculiX's results; in VTU made from them
  std::string_view unit;   // empty: as the deck has it
};
constexpr std::array quantities = {Quantity{"displacement", "DISP U", "mm"},
                                   Quantity{"stress", "STRESS S", "MPa"},
                                   Quantity{"strain", "TOSTRAIN E", ""},
                                   Quantity{"temperature", "NDTEMP NT", ""},
                                   Quantity{"flux", "FLUX HFL", ""},
                                   Quantity{"force", "FORC RF", "N"},
                                   Quantity{"gap", "gap", "mm"},
                                   Quantity{"angle", "min_dihedral", "degrees"}};

bool is_among(std::string_view name, std::string_view names) {
  const std::vector<std::string_view> all = words_of(names);
  return std::any_of(all.begin(), all.end(), [&](std::string_view one) { return same_word(one, name); });
}

const Quantity* quantity_of(std::string_view name) {
  const auto* const found = std::find_if(quantities.begin(), quantities.end(), [&](const Quantity& one) {
    return same_word(one.word, name) || is_among(name, one.names);
  });
  return found == quantities.end() ? nullptr : found;
}

bool is_of_step(const Field& field, int step) {
  return field.step == 0 || field.step == step;
}

// By the name itself before the words of the table.
const Field* find(const fem::FieldMesh& mesh, std::string_view name, int step) {
  const auto first = [&](const auto& fits) -> const Field* {
    const auto found = std::find_if(mesh.fields.begin(), mesh.fields.end(), [&](const Field& field) {
      return is_of_step(field, step) && fits(field);
    });
    return found == mesh.fields.end() ? nullptr : &*found;
  };
  if (const Field* const own = first([&](const Field& field) { return same_word(field.name, name); }))
    return own;
  const Quantity* const quantity = quantity_of(name);
  if (quantity == nullptr) return nullptr;
  return first([&](const Field& field) { return is_among(field.name, quantity->names); });
}

std::string list_of_fields(const fem::FieldMesh& mesh, int step) {
  std::vector<std::string> names;
  for (const Field& field : mesh.fields)
    if (is_of_step(field, step)) names.push_back(field.name);
  return names.empty() ? "it has none" : fmt::format("it has {}", fmt::join(names, ", "));
}

// A part of a field: its word in the title, and how it follows from the components.
struct Part {
  std::string title;  // "{}": the field's
  enum class Kind { component, size, mises } kind = Kind::component;
  std::size_t component = 0;
};

std::vector<std::string_view> components_of(const Field& field) {
  if (field.components == 3) return {"x", "y", "z"};
  if (field.components == 6) return {"xx", "yy", "zz", "xy", "yz", "zx"};
  return {};
}

Result<Part> part_of(const Field& field, std::string_view word) {
  if (field.components == 1 && word.empty()) return Part{"{}", Part::Kind::component, 0};
  if (field.components == 6 && (word.empty() || same_word(word, "mises")))
    return Part{"von Mises {}", Part::Kind::mises, 0};
  if (field.components != 1 && (word.empty() || same_word(word, "size")))
    return Part{"{}", Part::Kind::size, 0};
  const std::vector<std::string_view> names = components_of(field);
  for (std::size_t k = 0; k < names.size(); ++k)
    if (same_word(word, names[k])) return Part{fmt::format("{{}} {}", names[k]), Part::Kind::component, k};
  std::size_t number = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (failure == std::errc() && end == word.data() + word.size() && field.components > 1 &&
      number < static_cast<std::size_t>(field.components))
    return Part{fmt::format("{{}} {}", number), Part::Kind::component, number};
  const std::string known =
      field.components == 1   ? "it has none"
      : field.components == 3 ? "it has size, x, y, z"
      : field.components == 6
          ? "it has mises, xx, yy, zz, xy, yz, zx, and fibre where a deck tells the fibres"
          : fmt::format("it has size and 0 to {}", field.components - 1);
  return error(Kind::unsupported,
               fmt::format("the field {} has no part {}: {}", in_quotes(field.name), in_quotes(word), known));
}

float value_of(const Part& part, const float* v, std::size_t components) {
  if (part.kind == Part::Kind::component) return v[part.component];
  if (part.kind == Part::Kind::mises)
    return std::sqrt(0.5F * ((v[0] - v[1]) * (v[0] - v[1]) + (v[1] - v[2]) * (v[1] - v[2]) +
                             (v[2] - v[0]) * (v[2] - v[0])) +
                     3.0F * (v[3] * v[3] + v[4] * v[4] + v[5] * v[5]));
  float sum = 0;
  for (std::size_t k = 0; k < components; ++k) sum += v[k] * v[k];
  return std::sqrt(sum);
}

// "von Mises stress, MPa; step 2".
std::string title_of(const fem::FieldMesh& mesh, const Field& field, const Part& part, bool along) {
  const std::string_view base =
      along ? std::string_view(field.name).substr(0, field.name.find(' ')) : std::string_view(field.name);
  const Quantity* const quantity = quantity_of(base);
  std::string title = fmt::format(fmt::runtime(part.title), quantity == nullptr ? base : quantity->word);
  if (along) title += " along the fibre";
  if (quantity != nullptr && !quantity->unit.empty()) title += fmt::format(", {}", quantity->unit);
  if (field.step > 0) title += fmt::format("; {}", mesh.steps[static_cast<std::size_t>(field.step) - 1]);
  return title;
}

ShownValues values_of(const fem::FieldMesh& mesh, const Field& field, const Part& part, bool along) {
  const auto components = static_cast<std::size_t>(field.components);
  ShownValues shown{{}, field.of_nodes, title_of(mesh, field, part, along)};
  shown.values.reserve(field.values.size() / components);
  for (std::size_t at = 0; at < field.values.size(); at += components)
    shown.values.push_back(value_of(part, &field.values[at], components));
  return shown;
}

Result<ShownValues> along_fibre(const fem::FieldMesh& mesh, const Field& field, int step) {
  const Field* const along = find(mesh, fmt::format("{}{}", field.name, fem::along_the_fibre), step);
  if (along != nullptr) return values_of(mesh, *along, {"{}", Part::Kind::component, 0}, true);
  return error(
      Kind::unsupported,
      field.components != 6
          ? fmt::format("{} is no stress or strain: it has no part along the fibre", in_quotes(field.name))
          : "nothing says where the fibres are: name the deck that was solved with --deck FILE.inp, or keep "
            "it "
            "beside the results under the same name");
}

}  // namespace

Result<int> step_of(const fem::FieldMesh& mesh, int step) {
  const auto count = static_cast<int>(mesh.steps.size());
  if (step <= count) return step == 0 ? count : step;
  if (count == 0) return error(Kind::unsupported, "the file has no steps: leave out --step");
  std::vector<std::string> names;
  for (int k = 0; k < std::min(count, 12); ++k)
    names.push_back(fmt::format("{} {}", k + 1, in_quotes(mesh.steps[static_cast<std::size_t>(k)])));
  return error(Kind::unsupported,
               fmt::format("there is no step {}: there are {}{}", step, fmt::join(names, ", "),
                           count > 12 ? fmt::format(" and so on to {}", count) : ""));
}

Result<ShownValues> values_of(const fem::FieldMesh& mesh, std::string_view wanted, int step) {
  if (const Field* const whole = find(mesh, wanted, step)) {
    const Result<Part> part = part_of(*whole, {});
    if (!part) return part.error();
    return values_of(mesh, *whole, *part, whole->name.ends_with(fem::along_the_fibre));
  }
  const std::size_t dot = wanted.rfind('.');
  const Field* const field =
      dot == std::string_view::npos ? nullptr : find(mesh, wanted.substr(0, dot), step);
  if (field == nullptr)
    return error(Kind::unsupported,
                 fmt::format("the file has no field {}: {}", in_quotes(wanted), list_of_fields(mesh, step)));
  const std::string_view word = wanted.substr(dot + 1);
  if (same_word(word, "fibre")) return along_fibre(mesh, *field, step);
  const Result<Part> part = part_of(*field, word);
  if (!part) return part.error();
  return values_of(mesh, *field, *part, false);
}

const Field* displacements_of(const fem::FieldMesh& mesh, int step) {
  const Field* const field = find(mesh, "displacement", step);
  return field != nullptr && field->of_nodes && field->components == 3 ? field : nullptr;
}

}  // namespace selvage::pipeline
