// All yarns of a fabric, or the end of the program with what went wrong.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "construction/build.h"
#include "scripts/benchmarks/measuring.h"

namespace selvage::benchmarks {

// Of size x size loops of yarn of 0.2 mm.
inline fabric::Fabric jersey(int size) {
  fabric::Fabric cloth;
  fabric::Thread thread;
  thread.name = "cotton30";
  thread.diameter = 0.2;
  cloth.threads = {thread};
  fabric::Knit knit;
  knit.threads = {thread.name};
  knit.courses = knit.wales = size;
  cloth.items = {knit};
  return cloth;
}

inline std::vector<yarn::Body> built(const fabric::Fabric& cloth, const fabric::BuildOptions& options) {
  Diagnostics diagnostics;
  const std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(cloth, options, diagnostics);
  if (!builder) fail(to_string(*diagnostics.first_error()));
  std::vector<yarn::Body> bodies;
  for (std::size_t i = 0; i < builder->count(); ++i) {
    Result<yarn::Body> body = builder->build(i);
    if (!body) fail(to_string(body.error()));
    bodies.push_back(std::move(*body));
  }
  return bodies;
}

}  // namespace selvage::benchmarks
