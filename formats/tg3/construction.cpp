#include "formats/tg3/construction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/tg3/binder_weave.h"

namespace selvage::formats::tg3 {

namespace {

using fabric::Role;
using Yarns = std::vector<TextileYarn>;

constexpr int most_of_system = 1000;      // yarns
constexpr std::size_t most_levels = 200;  // yarns one above the other at a crossing

PathNode node_at(const Vec3& position, const Vec3& tangent, TextPlace place) {
  PathNode node;
  node.position = position;
  node.tangent = tangent;
  node.place = place;
  return node;
}

// --- weaves: crossings of x and y yarns, each with the yarns that lie there one above the other

struct YarnSize {
  double width = 0, height = 0, spacing = 0;
};

class WeaveBuilder {
 public:
  WeaveBuilder(const Element& textile, const Fields& fields) : textile_(textile), fields_(fields) {}

  std::optional<Yarns> build(bool is_sheared) {
    const int errors = fields_.errors();
    x_count_ = static_cast<std::size_t>(fields_.whole(textile_, "NumXYarns", 1, most_of_system));
    y_count_ = static_cast<std::size_t>(fields_.whole(textile_, "NumYYarns", 1, most_of_system));
    thickness_ = fields_.positive(textile_, "FabricThickness");
    shear_ = is_sheared ? fields_.number(textile_, "ShearAngle") : 0.0;
    if (std::abs(std::cos(shear_)) < 1e-3)
      fields_.error(textile_, fmt::format("the ShearAngle {} lays one system upon the other", shear_));
    x_sizes_ = read_sizes("XYarnData", x_count_);
    y_sizes_ = read_sizes("YYarnData", y_count_);
    if (fields_.errors() > errors || !read_pattern()) return std::nullopt;
    Yarns yarns;
    for (std::size_t i = 0; i < x_count_; ++i) add_x(i, yarns);
    const Interpolation::Form form = is_sheared ? Interpolation::Form::cubic : Interpolation::Form::bezier;
    for (std::size_t j = 0; j < y_count_; ++j) add_y(j, form, yarns);
    const bool is_flat = fields_.flag(textile_, "InPlaneTangents", false);
    const Vec3 along_x(width(y_sizes_), 0, 0), along_y = sheared(0, width(x_sizes_), 0);
    for (TextileYarn& yarn : yarns) {
      yarn.interpolation.has_flat_nodes = is_flat;
      yarn.repeats = {along_x, along_y};
    }
    if (fields_.errors() > errors) return std::nullopt;
    if (fields_.flag(textile_, "Refine", false))
      fields_.warning(
          textile_,
          "the yarns are built with the sections that the file states: TexGen's refinement (Refine), which "
          "makes them narrower where they meet, is not done; save it with its yarns to have it");
    return yarns;
  }

 private:
  std::vector<YarnSize> read_sizes(std::string_view name, std::size_t count) {
    std::vector<YarnSize> sizes;
    for (const Element& child : textile_.children)
      if (child.name == name)
        sizes.push_back({fields_.positive(child, "Width"), fields_.positive(child, "Height"),
                         fields_.positive(child, "Spacing")});
    if (sizes.size() != count)
      fields_.error(textile_,
                    fmt::format("there are {} <{}> for {} yarns: each has one", sizes.size(), name, count));
    return sizes;
  }

  // A crossing: from the bottom up, true where an x yarn lies.
  using Cell = std::vector<bool>;
  [[nodiscard]] const Cell& cell(std::size_t x, std::size_t y) const {
    return cells_[x % y_count_ + y_count_ * (y % x_count_)];
  }

  bool read_pattern() {
    const int errors = fields_.errors();
    cells_.assign(x_count_ * y_count_, {});
    for (const Element& child : textile_.children) {
      if (child.name != "PatternCell") continue;
      const int x = fields_.whole(child, "x", 0, static_cast<int>(y_count_) - 1);
      const int y = fields_.whole(child, "y", 0, static_cast<int>(x_count_) - 1);
      if (fields_.errors() > errors) return false;
      Cell& one = cells_[static_cast<std::size_t>(x) + y_count_ * static_cast<std::size_t>(y)];
      for (const Element& level : child.children)
        if (level.name == "PatternElement") one.push_back(fields_.whole(level, "value", 0, 1) == 1);
      if (one.size() > most_levels)
        fields_.error(
            child, fmt::format("{} yarns lie at this crossing; up to {} are read", one.size(), most_levels),
            Kind::limit);
    }
    // A yarn that begins at one crossing goes on to the next.
    for (std::size_t y = 0; y < x_count_; ++y)
      for (std::size_t x = 0; x < y_count_; ++x) {
        const auto levels = [&](std::size_t at_x, std::size_t at_y, bool of_x) {
          return std::ranges::count(cell(at_x, at_y), of_x);
        };
        if (levels(x, y, true) == levels(0, y, true) && levels(x, y, false) == levels(x, 0, false)) continue;
        fields_.error(
            textile_,
            fmt::format("at the crossing x = {}, y = {} there are {} x yarns and {} y yarns, at the first "
                        "of the row {} x yarns and at the first of the column {} y yarns: as many "
                        "are needed all along",
                        x, y, levels(x, y, true), levels(x, y, false), levels(0, y, true),
                        levels(x, 0, false)));
        return false;
      }
    return fields_.errors() == errors;
  }

  static double width(const std::vector<YarnSize>& sizes) {
    double sum = 0;
    for (const YarnSize& size : sizes) sum += size.spacing;
    return sum;
  }
  [[nodiscard]] Vec3 sheared(double x, double y, double z) const {
    return {x + y * std::sin(shear_), y * std::cos(shear_), z};
  }

  // The heights at which yarns of the system lie in a cell, from the bottom up.
  [[nodiscard]] std::vector<double> heights(const Cell& one, bool of_x) const {
    std::vector<double> heights;
    const double step = thickness_ / static_cast<double>(one.size());
    for (std::size_t k = 0; k < one.size(); ++k)
      if (one[k] == of_x) heights.push_back((static_cast<double>(k) + 0.5) * step);
    return heights;
  }

  TextileYarn& add(const YarnSize& size, Role role, Interpolation::Form form, Yarns& yarns) const {
    TextileYarn& yarn = yarns.emplace_back();
    yarn.name = fmt::format("yarn_{}", yarns.size() - 1);
    yarn.place = textile_.place;
    yarn.role = role;
    yarn.interpolation.form = form;
    yarn.sections = {ellipse(size.width, size.height)};
    return yarn;
  }

  void add_x(std::size_t i, Yarns& yarns) const {
    const std::size_t levels = heights(cell(0, i), true).size();
    const double y = width({x_sizes_.begin(), x_sizes_.begin() + static_cast<std::ptrdiff_t>(i)});
    for (std::size_t level = 0; level < levels; ++level) {
      TextileYarn& yarn = add(x_sizes_[i], Role::warp, Interpolation::Form::bezier, yarns);
      double x = 0;
      for (std::size_t j = 0; j <= y_count_; ++j) {
        yarn.nodes.push_back(
            node_at(sheared(x, y, heights(cell(j, i), true)[level]), Vec3::UnitX(), textile_.place));
        x += y_sizes_[j % y_count_].spacing;
      }
    }
  }
  void add_y(std::size_t j, Interpolation::Form form, Yarns& yarns) const {
    const std::size_t levels = heights(cell(j, 0), false).size();
    const double x = width({y_sizes_.begin(), y_sizes_.begin() + static_cast<std::ptrdiff_t>(j)});
    for (std::size_t level = 0; level < levels; ++level) {
      TextileYarn& yarn = add(y_sizes_[j], Role::weft, form, yarns);
      double y = 0;
      for (std::size_t i = 0; i <= x_count_; ++i) {
        yarn.nodes.push_back(
            node_at(sheared(x, y, heights(cell(j, i), false)[level]), Vec3::UnitY(), textile_.place));
        y += x_sizes_[i % x_count_].spacing;
      }
    }
  }

  const Element& textile_;
  const Fields& fields_;
  std::size_t x_count_ = 0, y_count_ = 0;
  double thickness_ = 0, shear_ = 0;
  std::vector<YarnSize> x_sizes_, y_sizes_;
  std::vector<Cell> cells_;
};

// --- weft knits

// A loop of nine nodes, after Ravandi and others (2021) as TexGen has it: its feet, and its head `LoopHeight`
// above them.
std::optional<Yarns> build_weft_knit(const Element& textile, const Fields& fields) {
  const int errors = fields.errors();
  const double thickness = fields.positive(textile, "YarnThickness"),
               course = fields.positive(textile, "WaleHeight"), loop = fields.positive(textile, "LoopHeight"),
               wale = fields.positive(textile, "CourseWidth");
  if (fields.errors() > errors) return std::nullopt;
  TextileYarn yarn;
  yarn.name = "yarn_0";
  yarn.place = textile.place;
  yarn.role = Role::course;
  yarn.interpolation.form = Interpolation::Form::cubic;
  yarn.sections = {ellipse(thickness, thickness)};
  yarn.repeats = {{wale, 0, 0}, {0, course, 0}};
  // Up one leg, from the foot to the head; the other leg mirrors it.
  const std::vector<Vec3> leg = {{0, 0, thickness / 2},
                                 {wale / 4 + thickness / 2, (loop - course) / 2, 0},
                                 {wale / 4, loop / 2, -thickness / 2},
                                 {wale / 4 - thickness / 2, (loop + course) / 2, 0},
                                 {wale / 2, loop, thickness / 2}};
  for (const Vec3& point : leg) yarn.nodes.push_back(node_at(point, Vec3::Zero(), textile.place));
  for (std::size_t k = leg.size() - 1; k-- > 0;)
    yarn.nodes.push_back(node_at({wale - leg[k].x(), leg[k].y(), leg[k].z()}, Vec3::Zero(), textile.place));
  return Yarns{yarn};
}

}  // namespace

std::optional<std::vector<TextileYarn>> construct(const Element& textile, const Fields& fields) {
  const std::string_view type = fields.text(textile, "type");
  if (type == "CTextileWeave2D" || type == "CTextileWeave3D")
    return WeaveBuilder(textile, fields).build(false);
  if (type == "CShearedTextileWeave2D") return WeaveBuilder(textile, fields).build(true);
  if (type == "CTextileOrthogonal") return build_binder_weave(textile, BinderTurn::orthogonal, fields);
  if (type == "CTextileAngleInterlock")
    return build_binder_weave(textile, BinderTurn::angle_interlock, fields);
  if (type == "CTextileLayerToLayer") return build_binder_weave(textile, BinderTurn::layer_to_layer, fields);
  if (type == "CTextileWeftKnit") return build_weft_knit(textile, fields);
  if (type == "CTextile") {
    fields.error(textile, "the textile has no <Yarn>");
    return std::nullopt;
  }
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
