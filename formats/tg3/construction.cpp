#include "formats/tg3/construction.h"

#include <fmt/format.h>

namespace selvage::formats::tg3 {

std::optional<std::vector<TextileYarn>> construct(const Element& textile, const Fields& fields) {
  const std::string_view type = fields.text(textile, "type");
  fields.error(
      textile,
      fmt::format(
          "this textile has no yarns, and one of the type {} is not built from its parameters; save it "
          "with its yarns (TexGen's standard output)",
          in_quotes(type)),
      Kind::unsupported);
  return std::nullopt;
}

}  // namespace selvage::formats::tg3
