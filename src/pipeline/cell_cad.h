// `convert --cut` and `--matrix`: the unit cell as CAD.
#pragma once

#include <optional>
#include <vector>

#include "cad/model.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// Yarns cut flush by the fabric's cell and, where it is asked for, the matrix: solids in the file's unit.
// Nothing when that failed (it was said why): no cell, garment pieces or other geometry, no yarn in the cell,
// with the matrix also yarns that overlap or that touch a face along them.
std::optional<std::vector<cad::Part>> cell_solids(Job& job, const fabric::Fabric& fabric,
                                                  const fabric::YarnBuilder& builder);

}  // namespace selvage::pipeline
