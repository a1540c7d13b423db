// Names that nothing else has.
#pragma once

#include <map>
#include <string>

namespace selvage {

// The names that are taken, each with the number that the next of the same name gets, at first 2.
using TakenNames = std::map<std::string, int>;

// `name`, or the first of NAME_2, NAME_3, ... that is not taken. It is taken then.
inline std::string new_name(TakenNames& taken, const std::string& name) {
  const auto [known, is_new] = taken.try_emplace(name, 2);
  if (is_new) return name;
  for (;;) {
    std::string next = name + "_" + std::to_string(known->second++);
    if (taken.try_emplace(next, 2).second) return next;
  }
}

}  // namespace selvage
