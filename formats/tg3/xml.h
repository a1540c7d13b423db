// The elements of an XML text, by pugixml (https://pugixml.org), which is opened only where there is one to
// read.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::formats::tg3 {

struct Attribute {
  std::string name, value;
};

struct Element {
  std::string name;
  TextPlace place;  // of its '<'
  std::vector<Attribute> attributes;
  std::vector<Element> children;

  // Null: there is none. Of several the first.
  [[nodiscard]] const std::string* attribute(std::string_view wanted) const;
  [[nodiscard]] const Element* child(std::string_view wanted) const;
};

// Parts of an XML text that do not matter: elements of these names, with all that stands in them.
using Skipped = std::span<const std::string_view>;

// The outermost element. Errors, at their place: malformed (no well-formed XML in UTF-8, no element),
// unsupported (a document type: entities are not read), limit (elements that stand in each other more than 32
// deep).
Result<Element> read_xml(std::string_view bytes, Skipped skipped);

// What the module has.
struct XmlModule {
  Result<Element> (*read)(std::string_view bytes, Skipped skipped);
};

}  // namespace selvage::formats::tg3
