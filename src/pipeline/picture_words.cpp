#include "pipeline/picture_words.h"

#include <fmt/format.h>

#include "core/option.h"
#include "pipeline/number_list.h"
#include "view/picture.h"

namespace selvage::pipeline {

Status take_picture_size(Options& options, const std::string& text) {
  if (const auto size = numbers<2>(text, 'x', 1, view::largest_side)) {
    options.picture_width = (*size)[0];
    options.picture_height = (*size)[1];
    return {};
  }
  return error(Kind::usage,
               fmt::format("'{}' is no size; it is WxH in pixels, up to {}, for example 1200x900", text,
                           view::largest_side));
}

Status take_background(Options& options, const std::string& text) {
  if (const auto color = numbers<3>(text, ',', 0, 255)) {
    options.background = {(*color)[0], (*color)[1], (*color)[2]};
    return {};
  }
  return error(Kind::usage,
               fmt::format("'{}' is no colour; it is R,G,B, each 0-255, for example 255,255,255", text));
}

Status take_value_range(Options& options, const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon != std::string::npos) {
    const std::optional<double> low = read_number(text.substr(0, colon)),
                                high = read_number(text.substr(colon + 1));
    if (low && high && *low < *high) {
      options.value_range = {*low, *high};
      return {};
    }
  }
  return error(
      Kind::usage,
      fmt::format("'{}' is no range; it is LOW:HIGH, the lower value first, for example 0:250", text));
}

Status take_deformed(Options& options, const std::string& text) {
  if (text == "auto") {
    options.deformed.emplace();
    return {};
  }
  const std::optional<double> factor = read_number(text);
  if (!factor) return error(Kind::usage, fmt::format("'{}' is no scale; it is a number, or auto", text));
  options.deformed = DeformedScale{*factor};
  return {};
}

Status take_section(Options& options, const std::string& text) {
  const std::size_t axis = std::string_view("xyz").find(text.empty() ? ' ' : text.front());
  const Argument number = Argument::between(-1e9, 1e9);
  const Result<std::string> place = text.size() > 2 && text[1] == '=' && axis < 3
                                        ? number.canonical(std::string_view(text).substr(2))
                                        : Result<std::string>(error(Kind::usage, ""));
  if (!place)
    return error(Kind::usage, fmt::format("'{}' is no section; it is x=, y= or z= and a place in the input's "
                                          "unit, for example z=0",
                                          text));
  options.section.emplace().axis = static_cast<int>(axis);
  std::from_chars(place->data(), place->data() + place->size(), options.section->place);
  return {};
}

}  // namespace selvage::pipeline
