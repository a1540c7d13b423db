// Words of `view` on the command line. Errors (usage): it is no such word.
#pragma once

#include <string>

#include "core/diagnostics.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

Status take_picture_size(Options& options, const std::string& text);  // 1200x900
Status take_background(Options& options, const std::string& text);    // 255,255,255
Status take_value_range(Options& options, const std::string& text);   // 0:250
Status take_deformed(Options& options, const std::string& text);      // 20 or auto
Status take_section(Options& options, const std::string& text);       // z=0

}  // namespace selvage::pipeline
