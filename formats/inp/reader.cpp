#include "formats/inp/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/number_text.h"
#include "core/text_lines.h"
#include "core/text_report.h"
#include "core/words.h"
#include "formats/inp/cards.h"

namespace selvage::formats::inp {

namespace {

using fem::SolvedDeck;

std::size_t nodes_of(std::string type) {
  if (type.starts_with('D')) type.erase(0, 1);
  for (const auto& [name, nodes] :
       {std::pair("C3D10", 10), std::pair("C3D4", 4), std::pair("C3D6", 6), std::pair("C3D8", 8)})
    if (type.starts_with(name)) return static_cast<std::size_t>(nodes);
  return 0;
}

// xx yy zz xy yz zx, of E1 E2 E3 nu12 nu13 nu23 G12 G13 G23.
std::optional<fem::Stiffness> stiffness_of(const std::vector<double>& c) {
  fem::Stiffness compliance = fem::Stiffness::Zero();
  for (int k = 0; k < 3; ++k) compliance(k, k) = 1 / c[static_cast<std::size_t>(k)];
  compliance(0, 1) = compliance(1, 0) = -c[3] / c[0];
  compliance(0, 2) = compliance(2, 0) = -c[4] / c[0];
  compliance(1, 2) = compliance(2, 1) = -c[5] / c[1];
  compliance(3, 3) = 1 / c[6];
  compliance(4, 4) = 1 / c[8];
  compliance(5, 5) = 1 / c[7];
  const Eigen::FullPivLU<fem::Stiffness> solved(compliance);
  if (!compliance.allFinite() || !solved.isInvertible()) return std::nullopt;
  return fem::Stiffness(solved.inverse());
}

// Of a node or an element; 0, which none has, of what is no such number.
long number_of(double value) {
  return value > 0 && value < 1e15 ? static_cast<long>(value) : 0;
}

struct Material {
  fem::Stiffness stiffness = fem::Stiffness::Zero();
  Vec3 expansion = Vec3::Zero();
};
struct Axes {
  Vec3 along = Vec3::UnitX(), across = Vec3::UnitY();
};
struct SectionCard {
  std::string set, material, orientation;
  Spot spot;
};

class Reader {
 public:
  Reader(const Source& source, TextReport& report)
      : report_(report), lines_(source.bytes()), room_(1'000'000 + 8 * source.bytes().size()) {}

  std::optional<SolvedDeck> read() {
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (line.starts_with("**")) {
        comment_ = trimmed(line.substr(2));
        continue;
      }
      if (line.starts_with('*') ? !begin_card() : !take_data()) return std::nullopt;
      comment_ = {};
    }
    if (!end_elastic() || !join_sections()) return std::nullopt;
    return std::move(deck_);
  }

 private:
  [[nodiscard]] Spot spot() const { return lines_.spot(); }
  bool fail(const Spot& spot, std::string text, Kind kind = Kind::malformed) {
    report_.error(spot, std::move(text), kind);
    return false;
  }

  bool begin_card() {
    if (!end_elastic()) return false;
    card_ = card_of(lines_.line());
    is_first_ = true;
    const std::string& word = card_.word;
    if (word == "INCLUDE")
      return fail(spot(), "this deck is in several files: write it without --split-deck, and solve that one",
                  Kind::unsupported);
    if (word == "PLASTIC" || word == "USER MATERIAL" || word == "HYPERELASTIC" || word == "DEPVAR")
      return fail(spot(), fmt::format("*{}: stresses are reckoned of linear elasticity alone", word),
                  Kind::unsupported);
    if (word == "STEP") {
      if (card_.values.contains("NLGEOM") && key_of(card_.value("NLGEOM")) != "NO")
        return fail(spot(), "NLGEOM: stresses are reckoned of small displacements alone", Kind::unsupported);
      deck_.steps.push_back({std::string(comment_), deck_.steps.empty() ? 0.0 : deck_.steps.back().warming});
    }
    if (word == "MATERIAL") material_ = key_of(card_.value("NAME")), materials_[material_];
    if (word == "ELEMENT") {
      nodes_ = nodes_of(key_of(card_.value("TYPE")));
      pending_.clear();
      if (nodes_ == 0)
        return fail(spot(),
                    fmt::format("elements of the type {} are not read: C3D4, C3D6, C3D8 and C3D10 are",
                                in_quotes(card_.value("TYPE"))),
                    Kind::unsupported);
    }
    if (word == "SOLID SECTION")
      sections_.push_back({card_.value("ELSET"), key_of(card_.value("MATERIAL")),
                           key_of(card_.value("ORIENTATION")), spot()});
    return true;
  }

  // The numbers of a line; blanks are 0.
  std::optional<std::vector<double>> numbers(std::string_view text) {
    std::vector<double> values;
    std::vector<std::string_view> parts = split(text, ',');
    while (!parts.empty() && trimmed(parts.back()).empty()) parts.pop_back();
    for (const std::string_view part : parts) {
      const std::string_view word = trimmed(part);
      const std::optional<double> value = word.empty() ? 0.0 : read_number(word);
      if (!value) {
        fail(spot(), fmt::format("{} is not a number", in_quotes(word)));
        return std::nullopt;
      }
      values.push_back(*value);
    }
    return values;
  }

  bool take_data() {
    if (trimmed(lines_.line()).empty()) return true;
    const std::string& word = card_.word;
    const bool is_first = std::exchange(is_first_, false);
    if (word == "ELEMENT") return take_element();
    if (word == "ELSET") return take_set();
    if (word == "ELASTIC" || word == "EXPANSION") return take_law();
    if (word == "DISTRIBUTION") return take_distribution();
    if (word == "ORIENTATION" && is_first) return take_orientation();
    if (word == "TEMPERATURE" ||
        (word == "INITIAL CONDITIONS" && key_of(card_.value("TYPE")) == "TEMPERATURE"))
      return take_temperature(is_first);
    return true;
  }

  bool take_element() {
    const auto values = numbers(lines_.line());
    if (!values) return false;
    if (pending_.empty()) pending_spot_ = spot();
    pending_.insert(pending_.end(), values->begin(), values->end());
    if (pending_.size() < nodes_ + 1) return true;
    SolvedDeck::Element element;
    for (std::size_t k = 1; k <= nodes_; ++k) element.nodes.push_back(number_of(pending_[k]));
    const long number = number_of(pending_.front());
    const std::string set = key_of(card_.value("ELSET"));
    const auto [known, is_new] =
        region_of_.try_emplace(set, static_cast<std::uint32_t>(deck_.regions.size()));
    if (is_new) deck_.regions.push_back(card_.value("ELSET"));
    element.region = known->second;
    deck_.elements[number] = std::move(element);
    without_section_[number] = pending_spot_;
    sets_[set].push_back(number);
    pending_.clear();
    return true;
  }

  bool take_set() {
    std::vector<long>& set = sets_[key_of(card_.value("ELSET"))];
    if (card_.values.contains("GENERATE")) {
      const auto range = numbers(lines_.line());
      if (!range) return false;
      if (range->size() < 2) return fail(spot(), "a first and a last number are expected here");
      const long first = number_of((*range)[0]), last = number_of((*range)[1]),
                 step = range->size() > 2 ? std::max(1L, number_of((*range)[2])) : 1;
      if (last < first) return true;
      const auto count = static_cast<std::size_t>((last - first) / step) + 1;
      if (!take_room(std::min(count, deck_.elements.size()))) return false;
      if (count <= deck_.elements.size()) {
        for (long number = first; number <= last; number += step) set.push_back(number);
      } else {
        for (const auto& [number, element] : deck_.elements)
          if (number >= first && number <= last && (number - first) % step == 0) set.push_back(number);
      }
      return true;
    }
    for (const std::string_view part : split(lines_.line(), ',')) {
      const std::string_view word = trimmed(part);
      if (word.empty()) continue;
      if (const std::optional<double> number = read_number(word))
        set.push_back(number_of(*number));
      else if (const auto other = sets_.find(key_of(word)); other != sets_.end() && &other->second != &set) {
        if (!take_room(other->second.size())) return false;
        set.insert(set.end(), other->second.begin(), other->second.end());
      }
    }
    return true;
  }

  // Sets may be of other sets: their numbers are counted, here and where a section takes them.
  bool take_room(std::size_t numbers) {
    if (numbers <= room_) {
      room_ -= numbers;
      return true;
    }
    return fail(spot(),
                "the sets of this deck have far more numbers than a deck of its size has elements: leave out "
                "sets that repeat others",
                Kind::limit);
  }

  bool take_law() {
    const auto values = numbers(lines_.line());
    if (!values) return false;
    if (card_.word == "ELASTIC") {
      if (elastic_.empty()) elastic_spot_ = spot();
      elastic_.insert(elastic_.end(), values->begin(), values->end());
      return true;
    }
    Vec3& expansion = materials_[material_].expansion;
    if (values->empty()) return fail(spot(), "an expansion is expected here");
    const bool is_ortho = values->size() >= 3 && key_of(card_.value("TYPE")) == "ORTHO";
    for (int k = 0; k < 3; ++k) expansion[k] = (*values)[is_ortho ? static_cast<std::size_t>(k) : 0];
    return true;
  }

  // The constants of an *ELASTIC, once all lines of it are there.
  bool end_elastic() {
    if (elastic_.empty()) return true;
    std::vector<double> c = std::exchange(elastic_, {});
    const std::string type = key_of(card_.value("TYPE"));
    if (type.empty() || type == "ISOTROPIC" || type == "ISO") {
      if (c.size() < 2) return fail(elastic_spot_, "E and nu are expected here");
      const double g = c[0] / 2 / (1 + c[1]);
      c = {c[0], c[0], c[0], c[1], c[1], c[1], g, g, g};
    } else if (type != "ENGINEERING CONSTANTS") {
      return fail(elastic_spot_,
                  fmt::format("elastic constants of the type {} are not read: isotropic ones and ENGINEERING "
                              "CONSTANTS are",
                              in_quotes(type)),
                  Kind::unsupported);
    }
    if (c.size() < 9) return fail(elastic_spot_, "nine constants are expected here");
    const auto stiffness = stiffness_of(c);
    if (!stiffness) return fail(elastic_spot_, "these elastic constants have no stiffness");
    materials_[material_].stiffness = *stiffness;
    return true;
  }

  bool take_distribution() {
    const bool is_default = trimmed(lines_.line()).starts_with(',');
    const auto values = numbers(lines_.line());
    if (!values) return false;
    if (values->size() < 7) return fail(spot(), "an element and two directions are expected here");
    const auto at = [&](std::size_t k) { return Vec3((*values)[k], (*values)[k + 1], (*values)[k + 2]); };
    if (!is_default) distributions_[key_of(card_.value("NAME"))][number_of(values->front())] = {at(1), at(4)};
    return true;
  }

  bool take_orientation() {
    const std::string name = key_of(card_.value("NAME"));
    if (!read_number(trimmed(split(lines_.line(), ',').front()))) {
      orientations_[name] = {key_of(split(lines_.line(), ',').front()), {}};
      return true;
    }
    const auto values = numbers(lines_.line());
    if (!values) return false;
    if (values->size() < 6) return fail(spot(), "two directions are expected here");
    orientations_[name] = {
        {}, {Vec3((*values)[0], (*values)[1], (*values)[2]), Vec3((*values)[3], (*values)[4], (*values)[5])}};
    return true;
  }

  bool take_temperature(bool is_first) {
    const std::vector<std::string_view> parts = split(lines_.line(), ',');
    const std::optional<double> value = parts.size() > 1 ? read_number(trimmed(parts[1])) : std::nullopt;
    if (!value) return fail(spot(), "a set and its temperature are expected here");
    const bool is_initial = card_.word != "TEMPERATURE";
    if (!is_first && *value != last_)
      return fail(spot(), "temperatures that differ from place to place are not read", Kind::unsupported);
    last_ = *value;
    if (is_initial)
      initial_ = *value;
    else if (!deck_.steps.empty())
      deck_.steps.back().warming = *value - initial_;
    return true;
  }

  bool join_sections() {
    for (const SectionCard& card : sections_) {
      const auto set = sets_.find(key_of(card.set));
      const auto material = materials_.find(card.material);
      if (set == sets_.end() || material == materials_.end())
        return fail(card.spot, "the element set or the material of this section is not there");
      const auto number = static_cast<std::uint32_t>(deck_.sections.size());
      deck_.sections.push_back(
          {!card.orientation.empty(), material->second.stiffness, material->second.expansion});
      if (!take_room(set->second.size())) return false;
      for (const long one : set->second) {
        const auto element = deck_.elements.find(one);
        if (element == deck_.elements.end()) continue;
        element->second.section = number;
        without_section_.erase(one);
        if (!card.orientation.empty() && !orient(card, one, element->second)) return false;
      }
    }
    if (without_section_.empty()) return true;
    const auto& [number, spot] = *without_section_.begin();
    return fail(spot, fmt::format("element {} has no solid section", number));
  }

  bool orient(const SectionCard& card, long number, SolvedDeck::Element& element) {
    const auto orientation = orientations_.find(card.orientation);
    if (orientation == orientations_.end())
      return fail(card.spot, "the orientation of this section is not there");
    const auto& [distribution, axes] = orientation->second;
    Axes own = axes;
    if (!distribution.empty()) {
      const auto& listed = distributions_[distribution];
      const auto found = listed.find(number);
      if (found == listed.end())
        return fail(card.spot,
                    fmt::format("the distribution {} has no directions of element {}", distribution, number));
      own = found->second;
    }
    if (own.along.cross(own.across).norm() < 1e-9)
      return fail(card.spot, fmt::format("the directions of element {} are none, or parallel", number));
    element.along = own.along.normalized();
    element.across = own.across.normalized();
    return true;
  }

  TextReport& report_;
  TextLines lines_;
  std::size_t room_;  // for numbers of sets
  std::string_view comment_;
  Card card_;
  bool is_first_ = false;  // no line of data of this card was read
  std::string material_;
  std::size_t nodes_ = 0;
  std::vector<double> pending_, elastic_;
  Spot pending_spot_, elastic_spot_;
  double initial_ = 0, last_ = 0;
  std::map<std::string, std::vector<long>> sets_;
  std::map<std::string, std::uint32_t> region_of_;
  std::map<std::string, Material> materials_;
  std::map<std::string, std::map<long, Axes>> distributions_;
  std::map<std::string, std::pair<std::string, Axes>> orientations_;
  std::vector<SectionCard> sections_;
  std::map<long, Spot> without_section_;  // elements, and where each stands
  SolvedDeck deck_;
};

}  // namespace

std::optional<SolvedDeck> read_deck(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [](const Source& text, TextReport& report) { return Reader(text, report).read(); });
}

}  // namespace selvage::formats::inp
