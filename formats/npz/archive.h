// A ZIP archive, and the module that writes it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/diagnostics.h"
#include "core/output.h"

namespace selvage::formats::npz {

struct Member {
  std::string name;
  std::string head;       // its first bytes
  std::string_view data;  // the others
};

// What the module has.
struct ZipModule {
  // Compressed, with sizes of 64 bits and no times: the same members give the same bytes. `output` is empty.
  // Errors: io, limit (memory), internal (what the library says).
  Status (*write)(std::span<const Member> members, OutputFile& output);
};

}  // namespace selvage::formats::npz
