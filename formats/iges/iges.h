// IGES 5.3, B-spline surfaces or solids. README.md in this folder says what the files hold and why.
#pragma once

#include "formats/format.h"

namespace selvage::formats::iges {

// Extensions .igs and .iges; recognised by the `S` in column 73 of the first line.
const Descriptor& descriptor();

}  // namespace selvage::formats::iges
