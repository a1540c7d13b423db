#include "formats/tg3/binder_weave.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace selvage::formats::tg3 {

namespace {

constexpr int most_stacks = 1000;                    // of a system
constexpr std::size_t most_stacked = 200;            // levels of a crossing
constexpr double turn_step = std::numbers::pi / 10;  // between the nodes round a y yarn

// The nodes of binders and the levels they come from are those of the models that TexGen 3.13 stores.
class BinderWeave {
 public:
  BinderWeave(const Element& textile, BinderTurn turn, const Fields& fields)
      : textile_(textile), turn_(turn), fields_(fields) {}

  std::optional<std::vector<TextileYarn>> build() {
    if (!read_sizes() || !read_pattern()) return std::nullopt;
    std::vector<TextileYarn> yarns;
    for (std::size_t row = 0; row < xs_.size(); ++row)
      for (std::size_t rank = 0; rank < levels_of(0, row, Level::x).size(); ++rank) add_x(row, rank, yarns);
    for (std::size_t column = 0; column < ys_.size(); ++column)
      for (std::size_t rank = 0; rank < levels_of(column, 0, Level::y).size(); ++rank)
        add_y(column, rank, yarns);
    if (fields_.errors() > errors_) return std::nullopt;
    if (fields_.flag(textile_, "Refine", false))
      fields_.warning(textile_,
                      "the yarns are built with the sections that the file states: TexGen's refinement "
                      "(Refine) to the FabricThickness is not done; save it with its yarns to have it");
    return yarns;
  }

 private:
  enum class Level { y, x, none };
  struct Stack {
    double width = 0, height = 0, spacing = 0;
    double middle = 0;  // of the stack, across its yarns
  };

  bool read_sizes() {
    errors_ = fields_.errors();
    const int x_count = fields_.whole(textile_, "NumXYarns", 1, most_stacks);
    const int y_count = fields_.whole(textile_, "NumYYarns", 1, most_stacks);
    warps_ = static_cast<std::size_t>(fields_.whole(textile_, "WarpRatio", 0, most_stacks, 1));
    binders_ = static_cast<std::size_t>(fields_.whole(textile_, "BinderRatio", 0, most_stacks, 1));
    if (warps_ + binders_ == 0)
      fields_.error(textile_, "WarpRatio and BinderRatio are both 0: one of them has to be 1 or more");
    gap_ = fields_.number(textile_, "GapSize", 0.0);
    constexpr double ellipse_power = 1;
    warp_power_ = fields_.number(textile_, "WarpPower", ellipse_power);
    weft_power_ = fields_.number(textile_, "WeftPower", ellipse_power);
    binder_power_ = fields_.number(textile_, "BinderPower", ellipse_power);
    if (gap_ < 0) fields_.error(textile_, fmt::format("the GapSize {} is negative", gap_));
    for (const double power : {warp_power_, weft_power_, binder_power_})
      if (!(power > 0))
        fields_.error(textile_, fmt::format("the power {} of a section is not above 0", power));
    x_length_ = read_stacks("YYarnData", y_count, ys_);
    y_length_ = read_stacks("XYarnData", x_count, xs_);
    return fields_.errors() == errors_;
  }

  // The sum of their spacings.
  double read_stacks(std::string_view name, int count, std::vector<Stack>& stacks) const {
    double sum = 0;
    for (const Element& child : textile_.children) {
      if (child.name != name) continue;
      Stack one{fields_.positive(child, "Width"), fields_.positive(child, "Height"),
                fields_.positive(child, "Spacing")};
      one.middle = sum + one.spacing / 2;
      sum += one.spacing;
      stacks.push_back(one);
    }
    if (stacks.size() != static_cast<std::size_t>(count))
      fields_.error(textile_,
                    fmt::format("there are {} <{}> for {} yarns: each has one", stacks.size(), name, count));
    return sum;
  }

  bool read_pattern() {
    cells_.assign(xs_.size() * ys_.size(), {});
    for (const Element& child : textile_.children) {
      if (child.name != "PatternCell") continue;
      const int x = fields_.whole(child, "x", 0, static_cast<int>(ys_.size()) - 1);
      const int y = fields_.whole(child, "y", 0, static_cast<int>(xs_.size()) - 1);
      if (fields_.errors() > errors_) return false;
      std::vector<Level>& cell =
          cells_[static_cast<std::size_t>(x) + ys_.size() * static_cast<std::size_t>(y)];
      for (const Element& level : child.children)
        if (level.name == "PatternElement")
          cell.push_back(static_cast<Level>(fields_.whole(level, "value", 0, 2)));
      if (cell.size() > most_stacked)
        fields_.error(
            child, fmt::format("this crossing has {} levels; up to {} are read", cell.size(), most_stacked),
            Kind::limit);
    }
    for (std::size_t row = 0; row < xs_.size(); ++row)
      for (std::size_t column = 0; column < ys_.size(); ++column)
        if (!check_cell(column, row)) return false;
    return fields_.errors() == errors_;
  }

  bool check_cell(std::size_t column, std::size_t row) const {
    const std::vector<Level>& one = cell(column, row);
    const std::string place = fmt::format("at the crossing x = {}, y = {}", column, row);
    std::string wrong;
    if (one.empty() || one.size() != cell(0, 0).size())
      wrong = fmt::format("there are {} levels, at the first one {}: as many are needed at all", one.size(),
                          cell(0, 0).size());
    else if (one[0] == Level::y || (one[0] == Level::x && !is_binder(row)))
      wrong = "the lowest level has no binder: it has to have one or nothing (2)";
    else if (levels_of(column, row, Level::x).size() != levels_of(0, row, Level::x).size() ||
             levels_of(column, row, Level::y).size() != levels_of(column, 0, Level::y).size())
      wrong =
          "the yarns of the first crossing of its row or column do not go on: as many are needed all along";
    if (wrong.empty()) return true;
    fields_.error(textile_, fmt::format("{} {}", place, wrong));
    return false;
  }

  [[nodiscard]] const std::vector<Level>& cell(std::size_t column, std::size_t row) const {
    return cells_[column % ys_.size() + ys_.size() * (row % xs_.size())];
  }
  // From the bottom up.
  [[nodiscard]] std::vector<std::size_t> levels_of(std::size_t column, std::size_t row, Level kind) const {
    std::vector<std::size_t> levels;
    const std::vector<Level>& one = cell(column, row);
    for (std::size_t k = 0; k < one.size(); ++k)
      if (one[k] == kind) levels.push_back(k);
    return levels;
  }
  [[nodiscard]] bool is_binder(std::size_t row) const { return row % (warps_ + binders_) >= warps_; }

  // The row itself, or after a binder the next one with warps; the row again where there is none.
  [[nodiscard]] std::size_t warp_row(std::size_t row) const {
    for (std::size_t k = 0; k < xs_.size(); ++k)
      if (!is_binder((row + k) % xs_.size())) return (row + k) % xs_.size();
    return row;
  }

  // The room of a level: that of the warp or y yarn beside a binder that lies there, or does not.
  [[nodiscard]] double room(std::size_t column, std::size_t row, std::size_t level) const {
    const std::size_t warp = warp_row(row);
    for (const std::size_t beside : {row, warp})
      if (cell(column, beside)[level] == Level::y) return ys_[column].height;
    if (cell(column, warp)[level] == Level::x) return xs_[warp].height;
    return xs_[row].height;
  }

  // The middle of a level; the stack begins at 0 above the lowest one.
  [[nodiscard]] double height(std::size_t column, std::size_t row, std::size_t level) const {
    if (level == 0) return -xs_[row].height / 2 - gap_;
    double bottom = 0;
    for (std::size_t k = 1; k < level; ++k) bottom += room(column, row, k) + gap_;
    const bool is_own = turn_ == BinderTurn::orthogonal && cell(column, row)[level] == Level::x;
    return bottom + (is_own ? xs_[row].height : room(column, row, level)) / 2;
  }

  static void add_node(TextileYarn& yarn, const Vec3& position, const Vec3& tangent) {
    PathNode node;
    node.position = position;
    node.tangent = tangent;
    node.place = yarn.place;
    yarn.nodes.push_back(node);
  }

  TextileYarn& add(const Stack& stack, double power, fabric::Role role,
                   std::vector<TextileYarn>& yarns) const {
    TextileYarn& yarn = yarns.emplace_back();
    yarn.name = fmt::format("yarn_{}", yarns.size() - 1);
    yarn.place = textile_.place;
    yarn.role = role;
    yarn.interpolation.form = Interpolation::Form::bezier;
    yarn.sections = {power_ellipse(stack.width, stack.height, power, 0)};
    yarn.repeats = {{x_length_, 0, 0}, {0, y_length_, 0}};
    return yarn;
  }

  static void close(TextileYarn& yarn, const Vec3& period) {
    const PathNode first = yarn.nodes.front();
    add_node(yarn, first.position + period, first.tangent);
  }

  // Where a binder is steeper than 45 degrees between its neighbours, its section's up is along x.
  static void set_ups(TextileYarn& yarn) {
    const std::size_t last = yarn.nodes.size() - 1;
    const Vec3 period = yarn.nodes[last].position - yarn.nodes[0].position;
    for (std::size_t k = 0; k <= last; ++k) {
      const std::size_t here = k % last;  // the last node is the first one
      const Vec3 before = here > 0 ? yarn.nodes[here - 1].position : yarn.nodes[last - 1].position - period;
      const Vec3 way = yarn.nodes[here + 1].position - before;
      if (std::abs(way.z()) > std::abs(way.x()))
        yarn.nodes[k].up = way.z() < 0 ? Vec3::UnitX() : Vec3(-Vec3::UnitX());
      else
        yarn.nodes[k].up = way.x() < 0 ? Vec3(-Vec3::UnitZ()) : Vec3::UnitZ();
    }
  }

  void add_y(std::size_t column, std::size_t rank, std::vector<TextileYarn>& yarns) const {
    TextileYarn& yarn = add(ys_[column], weft_power_, fabric::Role::weft, yarns);
    for (std::size_t row = 0; row < xs_.size(); ++row) {
      const std::size_t level = levels_of(column, row, Level::y)[rank];
      add_node(yarn, {ys_[column].middle, xs_[row].middle, height(column, row, level)}, Vec3::UnitY());
    }
    close(yarn, {0, y_length_, 0});
  }

  void add_x(std::size_t row, std::size_t rank, std::vector<TextileYarn>& yarns) const {
    const bool binds = is_binder(row);
    TextileYarn& yarn = add(xs_[row], binds ? binder_power_ : warp_power_, fabric::Role::warp, yarns);
    for (std::size_t column = 0; column < ys_.size(); ++column) {
      if (binds && !add_binder(column, row, rank, yarn)) return;
      if (binds) continue;
      const std::size_t level = levels_of(column, row, Level::x)[rank];
      add_node(yarn, {ys_[column].middle, xs_[row].middle, height(column, row, level)}, Vec3::UnitX());
    }
    close(yarn, {x_length_, 0, 0});
    if (binds) set_ups(yarn);
  }

  // --- a binder at a crossing

  struct Crossing {
    std::size_t column = 0;
    double middle = 0;  // x
    int level = 0;
  };
  [[nodiscard]] Crossing crossing(std::size_t column, int step, std::size_t row, std::size_t rank) const {
    const std::size_t count = ys_.size();
    Crossing one;
    one.column = (column + count + static_cast<std::size_t>(step + 1) - 1) % count;  // step is -1, 0 or 1
    one.middle = ys_[one.column].middle;
    if (step < 0 && column == 0) one.middle -= x_length_;
    if (step > 0 && column + 1 == count) one.middle += x_length_;
    one.level = static_cast<int>(levels_of(one.column, row, Level::x)[rank]);
    return one;
  }

  [[nodiscard]] bool has_weft(const Crossing& at, std::size_t row, int side) const {
    const int level = at.level - side;
    const std::vector<Level>& one = cell(at.column, row);
    return level >= 0 && level < static_cast<int>(one.size()) &&
           one[static_cast<std::size_t>(level)] == Level::y;
  }

  // A place of the binder over the y yarn below it (side 1) or under the one above it (-1): `number` steps up
  // from that yarn's end towards x = +-infinity (end 1, -1); at 0 beside it.
  [[nodiscard]] Vec3 on_weft(const Crossing& at, std::size_t row, int side, int end, int number) const {
    const Stack& weft = ys_[at.column];
    const double apart = xs_[row].height / 2 + gap_;
    const double z = height(at.column, row, static_cast<std::size_t>(at.level - side));
    if (number == 0) return {at.middle + end * (weft.width / 2 + apart), xs_[row].middle, z};
    const double angle = number * turn_step;
    const double rise = weft.height / 2 * std::pow(std::sin(angle), weft_power_) + apart;
    return {at.middle + end * weft.width / 2 * std::cos(angle), xs_[row].middle, z + side * rise};
  }

  // Is the way from beside one y yarn to beside the other steeper than the one a step up from there?
  [[nodiscard]] bool goes_beside(const Crossing& at, const Crossing& next, std::size_t row, int side,
                                 int end) const {
    const auto slope = [&](int number) {
      const Vec3 way = on_weft(next, row, -side, -end, number) - on_weft(at, row, side, end, number);
      return std::atan2(std::abs(way.z()), end * way.x());
    };
    return slope(0) > slope(1);
  }

  // The nodes between the crossing's middle and the next one at this end, from the middle on.
  [[nodiscard]] std::vector<Vec3> leaving(const Crossing& at, const Crossing& next, const Crossing& other,
                                          std::size_t row, int end) const {
    const int fall = at.level - next.level;
    const bool is_angle = turn_ == BinderTurn::angle_interlock;
    if (fall == 0 || (is_angle && std::abs(fall) != 2)) return {};
    const int side = fall > 0 ? 1 : -1;
    const bool goes_on = side * (at.level - other.level) < 0;  // through, no turn
    const int turned = is_angle ? 3 : 4;
    std::vector<Vec3> nodes;
    for (int number = goes_on ? 2 : turned; number > 0; --number)
      nodes.push_back(on_weft(at, row, side, end, number));
    if (turn_ == BinderTurn::orthogonal || (!is_angle && goes_beside(at, next, row, side, end)))
      nodes.push_back(on_weft(at, row, side, end, 0));
    return nodes;
  }

  bool add_binder(std::size_t column, std::size_t row, std::size_t rank, TextileYarn& yarn) const {
    const Crossing at = crossing(column, 0, row, rank), before = crossing(column, -1, row, rank),
                   after = crossing(column, 1, row, rank);
    const int down = std::max(at.level - before.level, at.level - after.level),
              up = std::max(before.level - at.level, after.level - at.level);
    if ((down > 0 && !has_weft(at, row, 1)) || (up > 0 && !has_weft(at, row, -1))) {
      fields_.error(textile_,
                    fmt::format("the binder at the crossing x = {}, y = {} has no y yarn {} it to turn at",
                                column, row, down > 0 && !has_weft(at, row, 1) ? "below" : "above"));
      return false;
    }
    Vec3 middle{at.middle, xs_[row].middle, height(column, row, static_cast<std::size_t>(at.level))};
    Vec3 tangent = Vec3::UnitX();
    if (turn_ == BinderTurn::layer_to_layer && (down > 0) != (up > 0)) {
      middle.z() = on_weft(at, row, down > 0 ? 1 : -1, 1, 5).z();
      tangent = Vec3::Zero();
    }
    std::vector<Vec3> left = leaving(at, before, after, row, -1);
    std::ranges::reverse(left);
    for (const Vec3& node : left) add_node(yarn, node, Vec3::Zero());
    add_node(yarn, middle, tangent);
    for (const Vec3& node : leaving(at, after, before, row, 1)) add_node(yarn, node, Vec3::Zero());
    return true;
  }

  const Element& textile_;
  const BinderTurn turn_;
  const Fields& fields_;
  int errors_ = 0;
  std::vector<Stack> xs_, ys_;
  std::vector<std::vector<Level>> cells_;
  std::size_t warps_ = 1, binders_ = 1;
  double gap_ = 0, warp_power_ = 1, weft_power_ = 1, binder_power_ = 1;
  double x_length_ = 0, y_length_ = 0;
};

}  // namespace

std::optional<std::vector<TextileYarn>> build_binder_weave(const Element& textile, BinderTurn turn,
                                                           const Fields& fields) {
  return BinderWeave(textile, turn, fields).build();
}

}  // namespace selvage::formats::tg3
