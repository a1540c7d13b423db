#include <fmt/format.h>

#include <array>
#include <charconv>

#include "cli/cli.h"
#include "view/picture.h"

namespace selvage::cli {

namespace {

// Whole numbers between `separator`s, each within [low, high]: exactly as many as the array holds.
template <std::size_t Count>
std::optional<std::array<int, Count>> numbers(std::string_view text, char separator, int low, int high) {
  std::array<int, Count> values{};
  const char *at = text.data(), *end = at + text.size();
  for (std::size_t k = 0; k < Count; ++k) {
    if (k > 0 && (at == end || *at++ != separator)) return std::nullopt;
    const auto [rest, failure] = std::from_chars(at, end, values[k]);
    if (failure != std::errc() || values[k] < low || values[k] > high) return std::nullopt;
    at = rest;
  }
  if (at != end) return std::nullopt;
  return values;
}

void set_size(pipeline::Options& options, const std::string& text) {
  const auto size = numbers<2>(text, 'x', 1, view::largest_side);
  if (!size)
    throw CLI::ValidationError(
        "--size", fmt::format("'{}' is no size; it is WxH in pixels, up to {}, for example 1200x900", text,
                              view::largest_side));
  options.picture_width = (*size)[0];
  options.picture_height = (*size)[1];
}

void set_background(pipeline::Options& options, const std::string& text) {
  const auto color = numbers<3>(text, ',', 0, 255);
  if (!color)
    throw CLI::ValidationError(
        "--background",
        fmt::format("'{}' is no colour; it is R,G,B, each 0-255, for example 255,255,255", text));
  options.background = {(*color)[0], (*color)[1], (*color)[2]};
}

}  // namespace

void add_view(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand("view", "a picture of the yarns, ray-traced (PNG)");
  pipeline::Options& o = parsed.options;
  add_common(command, parsed);
  add_place(command, parsed);
  command
      .add_option_function<std::string>(
          "--from", [&o](const std::string& word) { o.from = *view::view_named(word); },
          "where the eye is: top, bottom, front, back, side (from +x), iso (default: top)")
      ->check(CLI::IsMember({"top", "bottom", "front", "back", "side", "iso"}));
  command.add_option_function<std::string>(
      "--size", [&o](const std::string& text) { set_size(o, text); }, "WxH in pixels (default: 1200x900)");
  command.add_option_function<std::string>(
      "--background", [&o](const std::string& text) { set_background(o, text); },
      "its colour, R,G,B, each 0-255 (default: white)");
  command.add_flag("--flat", o.flat, "without shadows, which is faster");
  run_pipeline(command, parsed, pipeline::Command::view);
}

}  // namespace selvage::cli
