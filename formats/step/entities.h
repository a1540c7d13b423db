// What STEP entities are: attributes and supertypes of those of AP203, AP214 and AP242 that OpenCASCADE makes
// shapes, products, places, units, names and colours of (ISO 10303-41, -42, -43, -46, -511 to -514).
#pragma once

#include <bitset>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::formats::step {

inline constexpr std::size_t most_entities = 256;
using EntitySet = std::bitset<most_entities>;  // by their number in the table

// What may stand in one place of an entity.
struct Attribute {
  bool is_omissible = false;  // '$'
  bool is_derived = false;    // '*'
  bool may_lack = false;      // against the standard, but harmless: '$', or nothing behind it either
  bool takes_string = false, takes_number = false, takes_enumeration = false;
  bool takes_typed = false;         // NAME(value)
  bool takes_anything = false;      // every kind above, references to anything, lists
  EntitySet references;             // to these and their subtypes; none: no reference
  std::size_t least = 0, most = 0;  // of a list's elements
  std::vector<Attribute> element;   // one for a list, none else
};

struct Entity {
  std::string_view name;
  EntitySet kinds;               // itself and its supertypes
  bool is_open = false;          // its attributes are not told here
  std::vector<Attribute> own;    // those that it adds to its supertypes
  std::vector<Attribute> whole;  // of NAME(...) by itself: its supertypes' first
};

// Null for entities that nobody translates.
const Entity* find_entity(std::string_view name);

// The entities of a set, without the subtypes of others in it: "CURVE or SURFACE".
std::string names_of(const EntitySet& set);

}  // namespace selvage::formats::step
