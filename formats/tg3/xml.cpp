#include "formats/tg3/xml.h"

#include <algorithm>

#include "core/module.h"

namespace selvage::formats::tg3 {

const std::string* Element::attribute(std::string_view wanted) const {
  const auto found = std::ranges::find(attributes, wanted, &Attribute::name);
  return found == attributes.end() ? nullptr : &found->value;
}

const Element* Element::child(std::string_view wanted) const {
  const auto found = std::ranges::find(children, wanted, &Element::name);
  return found == children.end() ? nullptr : &*found;
}

Result<Element> read_xml(std::string_view bytes, Skipped skipped) {
  return call(module_table<XmlModule>("pugixml", "selvage_pugixml"), &XmlModule::read, bytes, skipped);
}

}  // namespace selvage::formats::tg3
