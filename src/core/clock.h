// The time that is written into files: now, or SOURCE_DATE_EPOCH (seconds since 1970, UTC) so that outputs
// can be reproduced to the byte.
#pragma once

#include <string>

#include "core/diagnostics.h"

namespace selvage {

// To be asked before files are written. Error (usage): SOURCE_DATE_EPOCH is no whole number, or in no year
// from 1970 to 9999.
Status check_clock();

// UTC as "YYYYMMDD.HHNNSS", the form of IGES.
std::string iges_timestamp();
// UTC as "YYYY-MM-DDTHH:MM:SS", the form of ISO 8601 (STEP, reports).
std::string iso_timestamp();

}  // namespace selvage
