// What goes between the program and selvage-tetgen: one request on standard input, one answer on standard
// output, plain arrays in the machine's own byte order (both ends are the same build on the same machine).
//
//   Request: a RequestHead, points (3 doubles each), triangles (3 int32 each, indices from 0, a closed
//   surface). Answer:  an AnswerHead, then
//     mesh      points (3 doubles each; the request's own first, unchanged), tetrahedra (4 int32 each)
//     crossing  the crossing triangles (3 int32 each, into the request's points); where they were asked for
//     any other nothing
#pragma once

#include <cstdint>

namespace selvage::fem {

inline constexpr std::uint64_t request_magic = 0x32514552'54455453;
inline constexpr std::uint64_t answer_magic = 0x32534e41'54455453;

struct RequestHead {
  std::uint64_t magic = request_magic;
  std::uint64_t points = 0;
  std::uint64_t triangles = 0;
  double epsilon = 1e-8;   // TetGen's relative tolerance (of the box's diagonal)
  double memory = 0;       // bytes of address space; 0: no limit
  double cpu_seconds = 0;  // 0: no limit
  std::uint64_t look = 0;  // 1: no mesh is wanted, but the facets that cross; none: a mesh without anything
};

enum class Outcome : std::int32_t {
  mesh = 0,
  crossing = 1,     // facets cross or touch
  bad_request = 2,  // wrong magic, counts, an index out of range, a number that is not finite
  memory = 3,
  refused = 4,        // TetGen gave up; `code` is its own number
  other_library = 5,  // TetGen's library does not do what the worker was built for; `code` is a Trial
};

// What of the library is tried before each job.
enum class Trial : std::int32_t {
  mesh = 1,            // a cube becomes the six tetrahedra that it has to
  random_numbers = 2,  // TetGen asks our generator
  giving_up = 3,       // TetGen gives up by our function
};

struct AnswerHead {
  std::uint64_t magic = answer_magic;
  Outcome outcome = Outcome::bad_request;
  std::int32_t code = 0;
  std::uint64_t points = 0;
  std::uint64_t cells = 0;  // tetrahedra, or crossing triangles
};

}  // namespace selvage::fem
