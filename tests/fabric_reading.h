// What a reader of fabrics makes of a text in memory, and what it says.
#pragma once

#include <optional>
#include <string>

#include "formats/format.h"

namespace selvage::test {

struct Reading {
  std::optional<fabric::Fabric> fabric;
  Diagnostics diagnostics;

  [[nodiscard]] std::string text() const {
    std::string all;
    for (const Message& message : diagnostics.messages()) all += to_string(message) + "\n";
    return all;
  }
  [[nodiscard]] const fabric::Weave& weave() const { return std::get<fabric::Weave>(fabric->items.at(0)); }
};

inline Reading read(const formats::Descriptor& format, const Source& source) {
  Reading reading;
  reading.fabric = format.read_fabric(source, reading.diagnostics);
  return reading;
}

}  // namespace selvage::test
