#include "fem/names.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/readable.h"
#include "fem/forming.h"

namespace selvage::fem {
namespace {

std::string in_lower_case(std::string name) {
  for (char& letter : name)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return name;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_fit(const NameRule& rule, const Character& character) {
  if (!character.is_valid) return false;
  const char first = character.bytes.front();
  if (rule.is_text)
    return !is_control(character.code()) && rule.unfit.find(character.bytes) == std::string_view::npos;
  return is_letter(first) || (first >= '0' && first <= '9') || first == '_' ||
         rule.also.find(first) != std::string_view::npos;
}

std::string section_ending(std::size_t number) {
  return "_Section" + std::to_string(number + 1);
}

// How many sections the region with most of them has; 0: all have one material each.
std::size_t most_sections(const Mesh& mesh) {
  std::size_t most = 1;
  if (mesh.element_material.empty()) return 0;
  for (const Region& region : mesh.regions) {
    const auto begin = mesh.element_material.begin();
    const std::set<std::uint32_t> materials(begin + static_cast<std::ptrdiff_t>(region.first_element),
                                            begin + static_cast<std::ptrdiff_t>(region.last_element));
    most = std::max(most, materials.size());
  }
  return most > 1 ? most : 0;
}

// Empty where the second region is the matrix.
std::string interface_number(const Mesh& mesh, std::size_t interface) {
  const Interface& own = mesh.interfaces[interface];
  if (mesh.regions[own.second].kind == Region::Kind::matrix) return {};
  std::size_t first = interface;
  while (first > 0 && mesh.interfaces[first - 1].first == own.first) --first;
  return std::to_string(interface - first + 1);
}

// What decks call other things than yarns.
std::vector<std::string> common_names() {
  std::vector<std::string> names = {"All", "AllNodes", "AllElements", "Drivers", "Dependent"};
  for (char letter = 'A'; letter <= 'F'; ++letter) names.push_back(std::string("Face") + letter);
  for (int k = 1; k <= 12; ++k) names.push_back("Edge" + std::to_string(k));
  for (int k = 1; k <= 8; ++k) names.push_back("Corner" + std::to_string(k));
  for (int k = 0; k <= 5; ++k) names.push_back("ConstraintsDriver" + std::to_string(k));
  for (int k = 0; k <= 2; ++k) names.push_back("CurvatureDriver" + std::to_string(k));
  for (int k = 0; k <= 3; ++k) names.push_back("BeamDriver" + std::to_string(k));
  for (int k = 0; k <= 2; ++k) names.push_back("GradientDriver" + std::to_string(k));
  for (const std::string_view name : names_of_rigid_parts()) names.emplace_back(name);
  return names;
}

// Names that keep to a rule, one after the other.
class NameMaker {
 public:
  explicit NameMaker(NameRule rule);
  // As it is, if the rule allows that and it was not taken before; else nothing is taken, and false.
  bool take(const std::string& name);
  std::string make(const std::string& own);

 private:
  [[nodiscard]] std::string fitting(const std::string& own) const;

  NameRule rule_;
  std::size_t room_ = 0;                      // for a name without its endings
  std::set<std::string> taken_;               // in lower case, with all endings
  std::map<std::string, std::size_t> count_;  // of what had to be told apart: the last number
};

// A third of what is left is the end: that is where names differ.
std::string shortened_to(const std::string& name, std::size_t room) {
  if (name.size() <= room) return name;
  constexpr std::string_view gap = "__";
  std::size_t tail = (room - gap.size()) / 3, head = room - gap.size() - tail;
  while (head > 0 && is_continuation(name[head])) --head;
  while (tail > 0 && is_continuation(name[name.size() - tail])) --tail;
  return name.substr(0, head) + std::string(gap) + name.substr(name.size() - tail);
}

NameMaker::NameMaker(NameRule rule) : rule_(std::move(rule)) {
  std::size_t ending = 0;
  for (const std::string_view one : rule_.endings) ending = std::max(ending, one.size());
  room_ = rule_.longest - ending;
  for (const std::string_view word : rule_.taken) taken_.insert(in_lower_case(std::string(word)));
}

bool NameMaker::take(const std::string& name) {
  if (name.size() > room_ || fitting(name) != name) return false;
  std::vector<std::string> all = {in_lower_case(name)};
  for (const std::string_view ending : rule_.endings)
    all.push_back(in_lower_case(name + std::string(ending)));
  if (std::any_of(all.begin(), all.end(), [&](const std::string& one) { return taken_.contains(one); }))
    return false;
  taken_.insert(all.begin(), all.end());
  return true;
}

std::string NameMaker::make(const std::string& own) {
  const std::string whole = fitting(own);
  std::string first = shortened_to(whole, room_);
  if (take(first)) return first;
  for (std::size_t& number = count_.try_emplace(in_lower_case(first), 1).first->second;;) {
    const std::string ending = "_" + std::to_string(++number);
    if (std::string name = shortened_to(whole, room_ - ending.size()) + ending; take(name)) return name;
  }
}

std::string NameMaker::fitting(const std::string& own) const {
  std::string name;
  for (std::string_view rest = own; !rest.empty();) {
    const Character character = take_character(rest);
    name += is_fit(rule_, character) ? character.bytes : "_";
  }
  if (rule_.is_text) {
    for (std::size_t k = 0; k < name.size() && name[k] == ' '; ++k) name[k] = '_';
    for (std::size_t k = name.size(); k > 0 && name[k - 1] == ' '; --k) name[k - 1] = '_';
  }
  if (name.empty() || (!rule_.is_text && !is_letter(name.front()))) name.insert(0, rule_.begin);
  return name;
}

}  // namespace

std::vector<std::string> unique_names(const std::vector<std::string>& own, const NameRule& rule) {
  NameMaker maker(rule);
  std::vector<std::string> names(own.size());
  for (std::size_t i = 0; i < own.size(); ++i)
    if (maker.take(own[i])) names[i] = own[i];
  for (std::size_t i = 0; i < own.size(); ++i)
    if (names[i].empty()) names[i] = maker.make(own[i]);
  return names;
}

DeckNames::DeckNames(const Mesh& mesh, NameRule rule) {
  const std::vector<std::string> common = common_names();
  rule.taken.insert(rule.taken.end(), common.begin(), common.end());
  std::vector<std::string> endings;
  for (std::size_t k = 0; k < most_sections(mesh); ++k) endings.push_back(section_ending(k));
  if (!mesh.cell) endings.insert(endings.end(), {"_Start", "_End"});
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i)
    for (const std::string_view ending : interface_endings)
      endings.push_back(std::string(ending) + interface_number(mesh, i));
  std::sort(endings.begin(), endings.end());
  endings.erase(std::unique(endings.begin(), endings.end()), endings.end());
  rule.endings.insert(rule.endings.end(), endings.begin(), endings.end());
  const auto is_matrix = [](const Region& region) { return region.kind == Region::Kind::matrix; };
  // The matrix stands first: no yarn takes its name, nor those of its sections.
  std::vector<std::string> own = {"Matrix"};
  for (const Region& region : mesh.regions)
    if (!is_matrix(region)) own.push_back(region.name);
  const std::vector<std::string> unique = unique_names(own, rule);
  std::size_t yarn = 0;
  for (const Region& region : mesh.regions) names_.push_back(unique[is_matrix(region) ? 0 : ++yarn]);
}

std::string DeckNames::of_section(std::size_t region, std::size_t number) const {
  return of(region) + section_ending(number);
}

std::string DeckNames::of_interface(const Mesh& mesh, std::size_t interface, std::string_view ending) const {
  return of(mesh.interfaces[interface].first) + std::string(ending) + interface_number(mesh, interface);
}

void write_yarn_names(TextBuffer& text, const Mesh& mesh, const DeckNames& names, std::string_view mark,
                      std::size_t width) {
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const Region& region = mesh.regions[i];
    if (region.kind == Region::Kind::matrix || names.of(i) == region.name) continue;
    const std::string own = readable(region.name);
    const std::string begin = std::string(mark) + ' ' + names.of(i) + " is yarn";
    text << begin;
    const std::size_t quotes = 3;  // with a blank
    if (begin.size() + quotes + own.size() <= width) {
      text << " '" << own << "'\n";
      continue;
    }
    text << '\n';
    const std::size_t room = width - mark.size() - quotes;
    for (std::string_view rest = own; !rest.empty();) {
      std::size_t part = std::min(room, rest.size());
      while (part < rest.size() && is_continuation(rest[part])) --part;
      text << mark << " '" << rest.substr(0, part) << "'\n";
      rest.remove_prefix(part);
    }
  }
}

}  // namespace selvage::fem
