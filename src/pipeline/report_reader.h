// Reports as they come from outside: from a file, or from whoever wrote its bytes.
#pragma once

#include <string_view>

#include "core/diagnostics.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

// A report of any run; `inputs` is there and a list, of whatever. `name`: of messages. Error: malformed.
Result<Json> parse_report(std::string_view bytes, std::string_view name);

}  // namespace selvage::pipeline
