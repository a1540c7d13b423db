#include "formats/tg3/yarn_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/tg3/section_reader.h"

namespace selvage::formats::tg3 {

namespace {

const Element* required(const Element& element, std::string_view name, const Fields& fields) {
  const Element* const child = element.child(name);
  if (child == nullptr) fields.error(element, fmt::format("this <{}> has no <{}>", element.name, name));
  return child;
}

std::vector<std::vector<Adjustment>> read_adjustments(const Element& element, const Fields& fields) {
  std::vector<std::vector<Adjustment>> all;
  for (const Element& child : element.children) {
    if (child.name != "Adjustment") continue;
    std::vector<Adjustment>& adjustments = all.emplace_back();
    for (const Element& section : child.children) {
      if (section.name != "AdjustmentSection") continue;
      const double t = fields.number(section, "T");
      if (t < 0 || t > 1 || (!adjustments.empty() && t <= adjustments.back().t))
        fields.error(section, fmt::format("T is {}: adjustments have to increase from 0 to 1", t));
      adjustments.push_back({t, fields.vector(section, "Vector")});
    }
  }
  return all;
}

std::optional<Interpolation> read_interpolation(const Element& element, const Fields& fields) {
  const std::string_view type = fields.text(element, "type");
  if (type == "CInterpolationAdjusted") {
    const Element* const inner = required(element, "Interpolation", fields);
    if (inner == nullptr) return std::nullopt;
    if (fields.text(*inner, "type") == type) {
      fields.error(*inner, "an adjusted interpolation of an adjusted one is not read; join their adjustments",
                   Kind::unsupported);
      return std::nullopt;
    }
    std::optional<Interpolation> adjusted = read_interpolation(*inner, fields);
    if (adjusted) adjusted->adjustments = read_adjustments(element, fields);
    return adjusted;
  }
  Interpolation interpolation;
  if (type == "CInterpolationCubic")
    interpolation.form = Interpolation::Form::cubic;
  else if (type == "CInterpolationLinear")
    interpolation.form = Interpolation::Form::linear;
  else if (type != "CInterpolationBezier") {
    fields.error(element,
                 fmt::format("an interpolation of the type {} is not read{}", in_quotes(type),
                             did_you_mean(type, {"CInterpolationBezier", "CInterpolationCubic",
                                                 "CInterpolationLinear", "CInterpolationAdjusted"})),
                 Kind::unsupported);
    return std::nullopt;
  }
  interpolation.is_periodic = fields.flag(element, "Periodic", true);
  interpolation.has_flat_frames = fields.flag(element, "ForceInPlaneTangent", false);
  interpolation.has_flat_nodes = fields.flag(element, "ForceMasterNodeTangent", false);
  return interpolation;
}

class YarnSections {
 public:
  YarnSections(const Element& element, TextileYarn& yarn, const Fields& fields)
      : element_(element), yarn_(yarn), fields_(fields) {}

  void read() {
    const std::string_view type = fields_.text(element_, "type");
    if (type == "CYarnSectionConstant") {
      take(element_);
      return;
    }
    if (type == "CYarnSectionAdjusted") return read_adjusted();
    yarn_.blend.is_ramped = fields_.flag(element_, "Ramped", false);
    yarn_.blend.is_polar = fields_.flag(element_, "Polar", false);
    if (type == "CYarnSectionInterpNode") return read_nodes();
    if (type == "CYarnSectionInterpPosition") return read_positions();
    fields_.error(element_,
                  fmt::format("sections of the type {} are not read{}", in_quotes(type),
                              did_you_mean(type, {"CYarnSectionConstant", "CYarnSectionInterpNode",
                                                  "CYarnSectionInterpPosition", "CYarnSectionAdjusted"})),
                  Kind::unsupported);
  }

 private:
  // The section within the element; its number.
  std::size_t take(const Element& element) {
    const Element* const section = required(element, "Section", fields_);
    if (section == nullptr || fields_.is_full()) return 0;
    if (std::optional<Section> read = read_section(*section, fields_))
      yarn_.sections.push_back(std::move(*read));
    return yarn_.sections.empty() ? 0 : yarn_.sections.size() - 1;
  }

  // Other sections, whose outlines are shifted.
  void read_adjusted() {
    const Element* const inner = required(element_, "YarnSection", fields_);
    if (inner == nullptr) return;
    if (fields_.text(*inner, "type") == "CYarnSectionAdjusted") {
      fields_.error(*inner, "adjusted sections of adjusted ones are not read; join their adjustments",
                    Kind::unsupported);
      return;
    }
    for (const Element& span : element_.children) {
      if (span.name != "Adjustment" || fields_.is_full()) continue;
      std::vector<SectionAdjustment> adjustments;
      for (const Element& section : span.children)
        if (section.name == "AdjustmentSection") adjustments.push_back(read_shifts(section));
      std::ranges::stable_sort(adjustments, {}, &SectionAdjustment::t);
      yarn_.adjustments.add_span(std::move(adjustments));
    }
    YarnSections(*inner, yarn_, fields_).read();
  }

  [[nodiscard]] SectionAdjustment read_shifts(const Element& section) const {
    SectionAdjustment adjustment;
    adjustment.t = fraction(section);
    for (const Element& shift : section.children)
      if (shift.name == "AdjustmentPerimeter")
        adjustment.around.push_back({fraction(shift), fields_.pair(shift, "Vector")});
    std::ranges::stable_sort(adjustment.around, {}, &OutlineShift::t);
    return adjustment;
  }

  [[nodiscard]] double fraction(const Element& element) const {
    const double t = fields_.number(element, "T");
    if (t < 0 || t > 1) fields_.error(element, fmt::format("T is {}: it is a fraction, from 0 to 1", t));
    return t;
  }

  // A section at each node, and others between it and the next.
  void read_nodes() {
    std::vector<std::vector<std::pair<double, std::size_t>>> at_nodes;
    for (const Element& child : element_.children) {
      if (child.name != "NodeSection") continue;
      auto& here = at_nodes.emplace_back();
      here.emplace_back(0.0, take(child));
      for (const Element& between : child.children) {
        if (between.name != "MidNodeSection") continue;
        const double t = fields_.number(between, "t");
        if (t <= here.back().first || t >= 1)
          fields_.error(
              between,
              fmt::format("t is {}: sections between two nodes have to increase between 0 and 1", t));
        here.emplace_back(t, take(between));
      }
    }
    if (at_nodes.size() != yarn_.nodes.size()) {
      fields_.error(element_, fmt::format("there are {} sections at nodes and {} nodes: each node has one",
                                          at_nodes.size(), yarn_.nodes.size()));
      return;
    }
    for (std::size_t span = 0; span + 1 < at_nodes.size(); ++span) {
      const auto& here = at_nodes[span];
      for (std::size_t k = 0; k < here.size(); ++k) {
        const bool is_last = k + 1 == here.size();
        yarn_.pieces.push_back({.span = span,
                                .t0 = here[k].first,
                                .t1 = is_last ? 1.0 : here[k + 1].first,
                                .from = here[k].second,
                                .to = is_last ? at_nodes[span + 1].front().second : here[k + 1].second});
      }
    }
  }

  void read_positions() {
    for (const Element& child : element_.children) {
      if (child.name != "PositionSection") continue;
      const double t = fields_.number(child, "t");
      if (t < 0 || t > 1 || (!yarn_.positions.empty() && t <= yarn_.positions.back()))
        fields_.error(child, fmt::format("t is {}: positions of sections have to increase from 0 to 1", t));
      yarn_.positions.push_back(t);
      take(child);
    }
    if (yarn_.positions.empty()) fields_.error(element_, "this <YarnSection> has no <PositionSection>");
  }

  const Element& element_;
  TextileYarn& yarn_;
  const Fields& fields_;
};

PathNode read_node(const Element& element, const Fields& fields) {
  PathNode node;
  node.place = element.place;
  node.position = fields.vector(element, "Position");
  node.tangent = fields.vector(element, "Tangent", Vec3::Zero());
  node.up = fields.vector(element, "Up", Vec3::Zero());
  if (node.up == Vec3::Zero()) node.up = Vec3::UnitZ();
  node.angle = fields.number(element, "Angle", 0.0);
  return node;
}

}  // namespace

std::optional<TextileYarn> read_yarn(const Element& element, const Fields& fields) {
  const int errors = fields.errors();
  TextileYarn yarn;
  yarn.place = element.place;
  for (const Element& child : element.children) {
    if (fields.is_full()) return std::nullopt;
    if (child.name == "MasterNode") yarn.nodes.push_back(read_node(child, fields));
    if (child.name == "Repeat") yarn.repeats.push_back(fields.vector(child, "value"));
  }
  if (yarn.nodes.size() < 2)
    fields.error(element,
                 fmt::format("this yarn has {} master nodes: it needs two at least", yarn.nodes.size()));
  const Element* const interpolation = required(element, "Interpolation", fields);
  if (interpolation != nullptr)
    if (std::optional<Interpolation> read = read_interpolation(*interpolation, fields))
      yarn.interpolation = std::move(*read);
  if (const Element* const sections = required(element, "YarnSection", fields))
    YarnSections(*sections, yarn, fields).read();
  if (const Element* const fibres = element.child("FibreDistribution"))
    if (fields.text(*fibres, "type") != "CFibreDistributionConst")
      fields.warning(*fibres,
                     fmt::format("the fibre distribution {} is left out: fibres fill a section evenly here",
                                 in_quotes(fields.text(*fibres, "type"))));
  if (fields.errors() > errors) return std::nullopt;
  return yarn;
}

}  // namespace selvage::formats::tg3
