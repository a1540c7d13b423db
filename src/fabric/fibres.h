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
// Null: there is none of that name.
const Material* find_fibre(std::string_view name);

}  // namespace selvage::fabric
