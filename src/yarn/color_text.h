// A yarn's colour as files spell it.
#pragma once

#include <fmt/format.h>

#include <string>

#include "yarn/body.h"

namespace selvage::yarn {

// "c8c8c8": two hexadecimal digits for each of red, green and blue.
inline std::string hex(const Color& color) {
  return fmt::format("{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

}  // namespace selvage::yarn
