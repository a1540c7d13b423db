// An input as `diff` and `roundtrip` compare it: its yarns as parts of surfaces, then what else is in it.
#pragma once

#include <functional>
#include <optional>

#include "cad/things.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// In the fabric's unit. `look` is given each yarn before it becomes a part; may be null. Nothing when the
// input failed (it was said why).
std::optional<cad::Subject> subject_of(Job& job, const fabric::Fabric& fabric,
                                       const std::function<void(const yarn::Body&)>& look = nullptr);

// The same in another unit.
void convert_lengths(cad::Subject& subject, Unit to);

}  // namespace selvage::pipeline
