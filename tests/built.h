// The yarns of a fabric, for tests to which building is not the question: an error fails the test.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "construction/build.h"

namespace selvage::test {

inline std::vector<yarn::Body> built(const fabric::Fabric& fabric, const fabric::BuildOptions& options = {}) {
  std::vector<yarn::Body> bodies;
  Diagnostics diagnostics;
  const std::optional<fabric::YarnBuilder> builder =
      fabric::YarnBuilder::create(fabric, options, diagnostics);
  EXPECT_TRUE(builder.has_value());
  for (const Message& message : diagnostics.messages())
    EXPECT_NE(message.severity, Severity::error) << to_string(message);
  for (std::size_t i = 0; builder && i < builder->count(); ++i) {
    Result<yarn::Body> body = builder->build(i);
    EXPECT_TRUE(body.ok()) << to_string(body.error());
    if (body) bodies.push_back(std::move(*body));
  }
  return bodies;
}

}  // namespace selvage::test
