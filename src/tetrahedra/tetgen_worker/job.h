// TetGen over one closed surface. Neither of the two returns when TetGen gives up: leave() answers then.
#pragma once

#include <cstdint>
#include <vector>

#include "tetrahedra/tetgen_worker/protocol.h"

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

// How many random numbers TetGen has asked our generator for.
unsigned long random_numbers();

// Does `work` end with TetGen giving up, by our function? That throws here, instead of ending the process.
bool gives_up(void (*work)());

// Ends the process (Outcome::other_library, with the Trial that failed) where TetGen's library is not the one
// that the worker was built for.
void test_library();

// Sends an answer without a mesh, and ends the process.
[[noreturn]] void leave(Outcome outcome, int code);

}  // namespace selvage::fem
