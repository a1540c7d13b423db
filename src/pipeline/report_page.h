// A report as a page: one HTML file that needs no network, a row an input, errors first. What it does in a
// browser is in view/page/report.*.
#pragma once

#include <vector>

#include "core/output.h"
#include "pipeline/report.h"
#include "pipeline/thumbnails.h"

namespace selvage::pipeline {

// The inputs of a report (read_report(), each with a path) as the page has them: those that failed, then
// those with defects, with warnings, and the rest; among these as they stand there.
std::vector<const Json*> entries_in_order(const Json& report);

// `pictures`: of each entry; empty: none are wanted. Errors: io.
Status write_report_page(const Json& report, const std::vector<const Json*>& entries,
                         const std::vector<Thumbnail>& pictures, OutputFile& file);

}  // namespace selvage::pipeline
