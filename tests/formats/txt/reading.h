// Reads a text in memory, as the tests like it.
#pragma once

#include <optional>
#include <string>

#include "formats/txt/txt.h"

namespace selvage::test {

struct Reading {
  std::optional<fabric::Fabric> fabric;
  Diagnostics diagnostics;

  [[nodiscard]] std::string text() const {
    std::string all;
    for (const Message& message : diagnostics.messages()) all += to_string(message) + "\n";
    return all;
  }
};

inline Reading read(const Source& source) {
  Reading reading;
  reading.fabric = formats::txt::descriptor().read_fabric(source, reading.diagnostics);
  return reading;
}

inline Reading read(std::string text) {
  return read(Source::from_memory(std::move(text), "test.txt"));
}

}  // namespace selvage::test
