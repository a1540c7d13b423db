#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <pugixml.hpp>

#include "core/module.h"
#include "formats/tg3/xml.h"

namespace selvage::formats::tg3 {

namespace {

constexpr int deepest = 32;

// The places of offsets that come in increasing order.
class Places {
 public:
  explicit Places(std::string_view bytes) : bytes_(bytes) {}
  TextPlace of(std::ptrdiff_t offset) {
    const std::size_t to =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)), bytes_.size());
    for (; at_ < to; ++at_)
      if (bytes_[at_] == '\n') {
        ++line_;
        line_begin_ = at_ + 1;
      }
    return {line_, static_cast<int>(to - line_begin_) + 1};
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
};

class Converter {
 public:
  Converter(std::string_view bytes, Skipped skipped) : places_(bytes), skipped_(skipped) {}

  Result<Element> convert(const pugi::xml_node& node, int depth = 1) {
    Element element;
    element.name = node.name();
    element.place = places_.of(node.offset_debug() - 1);
    if (depth > deepest)
      return error(Kind::limit, fmt::format("elements stand in each other more than {} deep here", deepest))
          .placed(element.place);
    for (const pugi::xml_attribute& attribute : node.attributes())
      element.attributes.push_back({attribute.name(), attribute.value()});
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element || std::ranges::find(skipped_, child.name()) != skipped_.end())
        continue;
      Result<Element> inner = convert(child, depth + 1);
      if (!inner) return inner;
      element.children.push_back(std::move(*inner));
    }
    return element;
  }

 private:
  Places places_;
  Skipped skipped_;
};

Result<Element> parse(std::string_view bytes, Skipped skipped) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(
      bytes.data(), bytes.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (parsed.status == pugi::status_out_of_memory) return error(Kind::limit, "the XML: " + memory_ended());
  if (!parsed)
    return error(Kind::malformed,
                 fmt::format("this is no whole XML text: {}; is the file cut off?", parsed.description()))
        .placed(Places(bytes).of(parsed.offset));
  for (const pugi::xml_node& node : document.children())
    if (node.type() == pugi::node_doctype)
      return error(Kind::unsupported,
                   "the file has a document type (DOCTYPE): entities are not read; remove it")
          .placed(Places(bytes).of(static_cast<std::ptrdiff_t>(bytes.find("<!DOCTYPE"))));
  if (!document.document_element()) return error(Kind::malformed, "the file has no element").placed({1, 1});
  return Converter(bytes, skipped).convert(document.document_element());
}

Result<Element> guarded(std::string_view bytes, Skipped skipped) {
  return guarded_by_module("the XML", [&] { return parse(bytes, skipped); });
}

}  // namespace

}  // namespace selvage::formats::tg3

extern "C" __attribute__((visibility("default"))) const void* selvage_pugixml() {
  using namespace selvage::formats::tg3;
  static const XmlModule table = {&guarded};
  return &table;
}
