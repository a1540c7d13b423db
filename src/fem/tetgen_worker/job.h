// TetGen over one closed surface. Neither of the two returns when TetGen gives up: leave() answers then.
#pragma once

#include <cstdint>
#include <vector>

#include "fem/tetgen_worker/protocol.h"

namespace selvage::fem {

struct Job {
  RequestHead settings;
  std::vector<double> points;           // 3 each
  std::vector<std::int32_t> triangles;  // 3 each
};

struct Tetrahedra {
  std::vector<double> points;
  std::vector<std::int32_t> cells;  // 4 each
};

// The triangles that cross or touch others elsewhere than in their common corners and edges; empty: none do.
std::vector<std::int32_t> find_crossings(const Job& job);

Tetrahedra tetrahedralize(const Job& job);

// Sends an answer without a mesh, and ends the process.
[[noreturn]] void leave(Outcome outcome, int code);

}  // namespace selvage::fem
