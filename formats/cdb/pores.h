// The archive of a pore space: elements that are a mesh and nothing else, and components for its patches.
#pragma once

#include "formats/format.h"

namespace selvage::formats::cdb {

// MESH200 with KEYOPT(1) = 8 or 9 (tetrahedra of 4 or 10 nodes), the component PORES of all of them, and one
// of nodes for each patch. Precondition: there are patches.
Result<WriteFacts> write_pores(const fem::Mesh& mesh, OutputFile& output);

}  // namespace selvage::formats::cdb
