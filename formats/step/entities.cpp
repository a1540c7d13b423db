#include "formats/step/entities.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <unordered_map>

#include "core/words.h"
#include "formats/step/entity_table.h"

namespace selvage::formats::step {

namespace {

// The table, read once.
class Entities {
 public:
  static const Entities& all() {
    static const Entities self;
    return self;
  }

  [[nodiscard]] const Entity* find(std::string_view name) const {
    const auto found = numbers_.find(name);
    return found == numbers_.end() ? nullptr : &list_[found->second];
  }
  [[nodiscard]] const std::vector<Entity>& list() const { return list_; }

 private:
  Entities() {
    static_assert(std::size(entity_rows) <= most_entities);
    for (const EntityRow& row : entity_rows) numbers_.emplace(row.name, numbers_.size());
    for (const EntityRow& row : entity_rows) list_.push_back(make(row));
  }

  // Supertypes stand above their subtypes in the table.
  [[nodiscard]] Entity make(const EntityRow& row) const {
    Entity entity;
    entity.name = row.name;
    entity.kinds.set(numbers_.at(row.name));
    for (const std::string_view name : words_of(row.supertypes))
      entity.kinds |= list_.at(numbers_.at(name)).kinds;
    entity.is_open = row.attributes == "...";
    if (entity.is_open) return entity;
    entity.own = attributes_of(row.attributes);
    if (!row.whole.empty()) {
      entity.whole = attributes_of(row.whole);
      return entity;
    }
    // What several supertypes have from one above them is there once.
    EntitySet taken;
    append_inherited(row.supertypes, taken, entity.whole);
    entity.whole.insert(entity.whole.end(), entity.own.begin(), entity.own.end());
    return entity;
  }

  void append_inherited(std::string_view supertypes, EntitySet& taken, std::vector<Attribute>& whole) const {
    for (const std::string_view name : words_of(supertypes)) {
      const std::size_t number = numbers_.at(name);
      if (taken.test(number)) continue;
      taken.set(number);
      append_inherited(entity_rows[number].supertypes, taken, whole);
      const std::vector<Attribute>& own = list_.at(number).own;
      whole.insert(whole.end(), own.begin(), own.end());
    }
  }

  [[nodiscard]] std::vector<Attribute> attributes_of(std::string_view pattern) const {
    std::vector<Attribute> attributes;
    for (const std::string_view word : words_of(pattern)) attributes.push_back(attribute_of(word));
    return attributes;
  }

  // "[[CARTESIAN_POINT]2]2", "AXIS2_PLACEMENT_2D|AXIS2_PLACEMENT_3D", "DIRECTION?", "s"
  [[nodiscard]] Attribute attribute_of(std::string_view word) const {
    Attribute attribute;
    for (; word.ends_with('?') || word.ends_with('*') || word.ends_with('!'); word.remove_suffix(1))
      (word.ends_with('?')   ? attribute.is_omissible
       : word.ends_with('*') ? attribute.is_derived
                             : attribute.may_lack) = true;
    if (word.starts_with('[')) {
      const std::size_t close = word.rfind(']');
      attribute.element.push_back(attribute_of(word.substr(1, close - 1)));
      const std::string_view bounds = word.substr(close + 1);  // "", "2" or "1-3"
      attribute.least = bounds.empty() ? 1 : static_cast<std::size_t>(bounds.front() - '0');
      attribute.most = bounds.size() == 3 ? static_cast<std::size_t>(bounds.back() - '0') : SIZE_MAX;
      return attribute;
    }
    while (!word.empty()) {
      const std::size_t length = std::min(word.find('|'), word.size());
      allow(word.substr(0, length), attribute);
      word.remove_prefix(std::min(length + 1, word.size()));
    }
    return attribute;
  }

  void allow(std::string_view kind, Attribute& attribute) const {
    if (kind == "s")
      attribute.takes_string = attribute.is_omissible = true;  // left out where they have nothing to say
    else if (kind == "n")
      attribute.takes_number = true;
    else if (kind == "e")
      attribute.takes_enumeration = true;
    else if (kind == "m")
      attribute.takes_number = attribute.takes_typed = true;
    else if (kind == "x")
      attribute.takes_anything = true;
    else
      attribute.references.set(numbers_.at(kind));
  }

  std::vector<Entity> list_;
  std::unordered_map<std::string_view, std::size_t> numbers_;
};

}  // namespace

const Entity* find_entity(std::string_view name) {
  return Entities::all().find(name);
}

std::string names_of(const EntitySet& set) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < std::size(entity_rows); ++i)
    if (set.test(i)) names.push_back(entity_rows[i].name);
  return alternatives(names);
}

}  // namespace selvage::formats::step
