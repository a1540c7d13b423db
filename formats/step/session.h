// OpenCASCADE's settings are the process's: whoever reads or writes a STEP file holds a Session. Internal to
// the module selvage_occt.
#pragma once

#include <mutex>
#include <string_view>

#include "core/units.h"

namespace selvage::formats::step {

// OpenCASCADE's word for AP242 and AP214; null for others.
const char* schema_word(std::string_view schema);

class Session {
 public:
  // One at a time: waits for the others.
  // Shapes and file are in one unit, so that no number is multiplied on its way.
  static Session to_write(Unit units, std::string_view schema);
  // Lengths are in millimetres until the document of the file says otherwise.
  static Session to_read();

 private:
  Session();
  std::unique_lock<std::mutex> lock_;
};

}  // namespace selvage::formats::step
