// An input as `diff` and `roundtrip` compare it: its yarns as parts of surfaces, then what else is in it.
#pragma once

#include <functional>
#include <optional>

#include "cad/things.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// Is shown each yarn and piece before it becomes a part; either may be null.
struct Onlooker {
  std::function<void(const yarn::Body&)> yarn;
  std::function<void(const fabric::PieceShape&)> piece;
};

// In the fabric's unit. Nothing when the input failed (it was said why).
std::optional<cad::Subject> subject_of(Job& job, const fabric::Fabric& fabric, const Onlooker& onlooker = {});

// The same in another unit.
void convert_lengths(cad::Subject& subject, Unit to);

}  // namespace selvage::pipeline
