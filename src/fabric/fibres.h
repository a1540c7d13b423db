// The fibres of the trade that a text may name without a material block of its own.
#pragma once

#include <span>
#include <string_view>

#include "fabric/model.h"

namespace selvage::fabric {

struct Fibre {
  Material material;
  std::string_view source;  // of its numbers
};

std::span<const Fibre> all_fibres();

// Another name of a fibre, in lower-case letters and digits alone.
struct FibreAlias {
  std::string_view alias, name;
};
std::span<const FibreAlias> fibre_aliases();

// By its name or an alias; letters of any case, with or without hyphens, blanks, points, `_`. Null: there is
// none of that name.
const Material* find_fibre(std::string_view name);

}  // namespace selvage::fabric
