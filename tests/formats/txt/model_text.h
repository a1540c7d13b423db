// Every field of a fabric as a list of lines, numbers by their bits, places left out: what two models are
// compared by.
#pragma once

#include <string>
#include <vector>

#include "fabric/model.h"

namespace selvage::test {

std::vector<std::string> flattened(const fabric::Fabric& fabric);

// The first field in which the two differ, with both values; empty when every field is the same, bit for bit.
std::string first_difference(const fabric::Fabric& a, const fabric::Fabric& b);

}  // namespace selvage::test
