// ANSYS mesh archive, and the macro that solves the load cases of a unit cell
#pragma once

#include "formats/format.h"

namespace selvage::formats::cdb {

const Descriptor& descriptor();
// NAME.mac, which belongs to NAME.cdb.
const Descriptor& macro_descriptor();

}  // namespace selvage::formats::cdb
