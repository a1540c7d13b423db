// Valid fabrics made at random: every statement of the language, with numbers of every size.
#pragma once

#include <cstdint>

#include "fabric/model.h"

namespace selvage::test {

// The same seed gives the same fabric.
fabric::Fabric random_fabric(std::uint64_t seed);

}  // namespace selvage::test
