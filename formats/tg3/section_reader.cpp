#include "formats/tg3/section_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage::formats::tg3 {

namespace {

std::vector<Vec2> points_of(const Element& element, std::string_view name, const Fields& fields) {
  std::vector<Vec2> points;
  for (const Element& child : element.children)
    if (child.name == name && !fields.is_full()) points.push_back(fields.pair(child, "value"));
  return points;
}

std::optional<Section> refuse(const Element& element, const Fields& fields, std::string text,
                              Kind kind = Kind::malformed) {
  fields.error(element, std::move(text), kind);
  return std::nullopt;
}

std::optional<Section> read_lenticular(const Element& element, const Fields& fields) {
  double width = 0, height = 0;
  if (element.attribute("Radius") != nullptr && element.attribute("Offset") != nullptr) {
    // As early versions said it: the arcs' radius, and how far their centres are from the middle.
    const double radius = fields.positive(element, "Radius"), offset = fields.number(element, "Offset");
    if (std::abs(offset) >= radius)
      return refuse(element, fields, "the offset of this lens reaches its radius: its arcs do not meet");
    width = 2 * std::sqrt(radius * radius - offset * offset);
    height = 2 * (radius - offset);
  } else {
    width = fields.positive(element, "Width");
    height = fields.positive(element, "Height");
  }
  const double distortion = fields.number(element, "Distortion", 0.0);
  if (fields.errors() > 0) return std::nullopt;
  if (std::abs(distortion) >= height / 2)
    return refuse(
        element, fields,
        fmt::format(
            "the distortion {} of this lens reaches half of its height, {}: one of its arcs is flat or "
            "hollow; make it smaller",
            distortion, height / 2));
  if (height / 2 + std::abs(distortion) > width / 2)
    return refuse(
        element, fields,
        fmt::format("this lens is {} wide and {} high: it has to be as wide as its arcs are high; an ellipse "
                    "may be higher",
                    width, height));
  return lenticular(width, height, distortion);
}

std::optional<Section> read_polygon(const Element& element, const Fields& fields) {
  std::vector<Vec2> points = points_of(element, "PolygonPoint", fields);
  if (points.size() > 1 && points.front() == points.back()) points.pop_back();
  const std::size_t written = points.size();
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3)
    return refuse(element, fields,
                  fmt::format("this polygon has {} points: it needs three at least", points.size()));
  if (points.size() < written)
    fields.warning(element,
                   fmt::format("{} of the {} points of this polygon equal the point before them and are "
                               "left out",
                               written - points.size(), written));
  return polygon(std::move(points), fields.flag(element, "RetainPoints", false));
}

std::optional<Section> read_bezier(const Element& element, const Fields& fields) {
  std::vector<Vec2> points = points_of(element, "BezierPoint", fields);
  if (points.size() < 6 || points.size() % 3 != 0)
    return refuse(
        element, fields,
        fmt::format("this Bezier section has {} points: it needs three for each of two curves or more",
                    points.size()));
  return bezier(std::move(points));
}

std::optional<Section> read_hybrid(const Element& element, const Fields& fields) {
  std::vector<double> divisions;
  std::vector<Section> sections;
  for (const Element& child : element.children) {
    if (child.name == "Division") divisions.push_back(fields.number(child, "Value"));
    if (child.name != "Section") continue;
    if (fields.text(child, "type") == "CSectionRotated")
      return refuse(child, fields,
                    "a rotated section as a part of a hybrid one is not read; rotate the whole",
                    Kind::unsupported);
    std::optional<Section> part = read_section(child, fields);
    if (!part) return std::nullopt;
    sections.push_back(std::move(*part));
  }
  if (divisions.empty() || divisions.size() != sections.size())
    return refuse(
        element, fields,
        fmt::format("this hybrid section has {} divisions and {} sections: as many of both are needed",
                    divisions.size(), sections.size()));
  for (std::size_t k = 0; k < divisions.size(); ++k)
    if (divisions[k] < 0 || divisions[k] >= 1 || (k > 0 && divisions[k] <= divisions[k - 1]))
      return refuse(element, fields,
                    "the divisions of this hybrid section have to increase from 0 to below 1");
  Result<Section> whole = hybrid(std::move(divisions), std::move(sections));
  if (whole) return std::move(*whole);
  fields.error(whole.error(), element.place);
  return std::nullopt;
}

std::optional<Section> inner_section(const Element& element, const Fields& fields) {
  const Element* const inner = element.child("Section");
  if (inner == nullptr) return refuse(element, fields, "the section inside of this one is missing");
  return read_section(*inner, fields);
}

std::optional<Section> read_any(const Element& element, const Fields& fields) {
  const std::string_view type = fields.text(element, "type");
  const auto size = [&](std::string_view name) { return fields.positive(element, name); };
  if (type == "CSectionEllipse") return ellipse(size("Width"), size("Height"));
  if (type == "CSectionRectangle") return rectangle(size("Width"), size("Height"));
  if (type == "CSectionPowerEllipse") {
    const double width = size("Width"), height = size("Height"), power = fields.number(element, "Power");
    const double offset = fields.number(element, "XOffset", 0.0);
    if (fields.errors() > 0) return std::nullopt;
    // Beyond these the section is a box with corners, or a cross without area: as those of Fabric TXT.
    if (power < 0.1 || power > 10)
      return refuse(element, fields,
                    fmt::format("the power {} of this ellipse is not within 0.1 to 10", power));
    if (std::abs(offset) >= width / 2)
      return refuse(element, fields,
                    fmt::format("the offset {} reaches half of the width, {}", offset, width / 2));
    return power_ellipse(width, height, power, offset);
  }
  if (type == "CSectionLenticular") return read_lenticular(element, fields);
  if (type == "CSectionPolygon") return read_polygon(element, fields);
  if (type == "CSectionBezier") return read_bezier(element, fields);
  if (type == "CSectionHybrid") return read_hybrid(element, fields);
  if (type == "CSectionRotated") {
    std::optional<Section> inner = inner_section(element, fields);
    if (!inner) return std::nullopt;
    return rotated(std::move(*inner), fields.number(element, "Angle"));
  }
  if (type == "CSectionScaled") {
    std::optional<Section> inner = inner_section(element, fields);
    if (!inner) return std::nullopt;
    return scaled(std::move(*inner), fields.pair(element, "Scale"));
  }
  return refuse(
      element, fields,
      fmt::format("a section of the type {} is not read{}", in_quotes(type),
                  did_you_mean(type, {"CSectionEllipse", "CSectionRectangle", "CSectionPowerEllipse",
                                      "CSectionLenticular", "CSectionPolygon", "CSectionBezier",
                                      "CSectionHybrid", "CSectionRotated", "CSectionScaled"})),
      Kind::unsupported);
}

}  // namespace

std::optional<Section> read_section(const Element& element, const Fields& fields) {
  const int errors = fields.errors();
  std::optional<Section> section = read_any(element, fields);
  if (!section || fields.errors() > errors) return std::nullopt;
  const double area = area_of(*section);
  if (!(area > 0))
    return refuse(
        element, fields,
        fmt::format("this section's area is {}: it has no inside, or its points run clockwise; give them "
                    "counter-clockwise",
                    area),
        Kind::geometry);
  return section;
}

}  // namespace selvage::formats::tg3
