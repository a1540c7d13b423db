// The language that people write: that of the format which has one (formats/language.h).
#pragma once

#include "formats/language.h"

namespace selvage::cli {

const formats::Language& language();

}  // namespace selvage::cli
