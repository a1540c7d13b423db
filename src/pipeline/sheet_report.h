// The data sheet of a cloth (construction/sheet.h) as text and in the report.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "construction/sheet.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

// g, m2, mm, threads a cm and an inch, per cent. `file`: the one that it is looked at in.
std::string sheet_text(const fabric::Sheet& sheet, std::string_view file);

// By the kind of construction, the second weave as weave_2; systems and threads by their names.
Json sheets_json(std::span<const fabric::Sheet> sheets);

}  // namespace selvage::pipeline
