// JSON reports of earlier runs and lists of inputs, which may come from anyone.
#pragma once

#include <string_view>

namespace selvage::fuzz {

// All that is done with a report: --resume, `report html`, JUnit.
void run_report(std::string_view bytes);

// The bytes of `@list`.
void run_lists(std::string_view bytes);

}  // namespace selvage::fuzz
