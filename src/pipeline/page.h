// Pages of `selvage view` (view/page/page.h): what is put into them.
#pragma once

#include "construction/build.h"
#include "core/output.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// A page of the yarns; false when that failed (it was said why).
bool write_page(Job& job, const fabric::Fabric& fabric, const fabric::YarnBuilder& builder, OutputFile& file);

}  // namespace selvage::pipeline
