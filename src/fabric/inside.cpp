#include "fabric/inside.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>

#include "fabric/plan.h"

namespace selvage::fabric {

namespace {

using Matrix = Eigen::Matrix3d;

// Degrees; of quarter turns exact.
std::pair<double, double> sine_and_cosine(double angle) {
  const double quarters = angle / 90.0;
  if (quarters == std::round(quarters)) {
    constexpr std::array<double, 4> sines = {0.0, 1.0, 0.0, -1.0};
    const auto k = static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
    return {sines[k], sines[(k + 1) % 4]};
  }
  const double radians = angle * std::numbers::pi / 180.0;
  return {std::sin(radians), std::cos(radians)};
}

Placement placement_of_move(const Move& move) {
  Placement placement;
  Matrix& m = placement.linear;
  switch (move.form) {
    case Move::Form::place:
      placement.shift = move.by;
      break;
    case Move::Form::rotate: {
      const auto [sine, cosine] = sine_and_cosine(move.angle);
      const int a = (move.axis + 1) % 3, b = (move.axis + 2) % 3;
      m(a, a) = m(b, b) = cosine;
      m(b, a) = sine;
      m(a, b) = -sine;
      break;
    }
    case Move::Form::mirror:
      m(move.axis, move.axis) = -1.0;
      break;
    case Move::Form::shear: {
      const bool is_diagonal = std::abs(move.angle) == 45.0;
      m(move.axis, move.across) =
          is_diagonal ? std::copysign(1.0, move.angle) : std::tan(move.angle * std::numbers::pi / 180.0);
      break;
    }
  }
  return placement;
}

bool is_rigid(const Matrix& m) {
  constexpr double rounding = 1e-12;
  return (m * m.transpose() - Matrix::Identity()).cwiseAbs().maxCoeff() <= rounding;
}

}  // namespace

Placement combined(const Placement& first, const Placement& then) {
  return {then.linear * first.linear, then.linear * first.shift + then.shift};
}

Placement placement_of(const std::vector<Move>& moves) {
  Placement all;
  for (const Move& move : moves) all = combined(all, placement_of_move(move));
  return all;
}

TwoSteps steps_of(const Placement& placement) {
  const Matrix& m = placement.linear;
  TwoSteps steps;
  // A place alone is part of the plan: yarns of one shape stay that.
  const bool is_place_alone = m == Matrix::Identity();
  if (!is_place_alone && is_rigid(m)) {
    steps.body = placement;
  } else if (is_place_alone || m.determinant() > 0.0) {
    steps.line = placement;
  } else {
    // A section is not mirrored by sweeping it.
    Matrix mirror = Matrix::Identity();
    mirror(0, 0) = -1.0;
    steps.line = {mirror * m, mirror * placement.shift};
    steps.body.linear = mirror;
  }
  return steps;
}

Repeat placed_repeat(const Repeat& own, const Matrix& linear) {
  constexpr double rounding = 1e-12;
  const Matrix back = linear.inverse();
  Repeat placed;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 way = back.col(axis);
    Repeat along = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; ++k) {
      if (std::abs(way[k]) <= rounding) continue;
      const std::optional<double> period = own[static_cast<std::size_t>(k)];
      const Repeat next = {period ? std::optional(*period / std::abs(way[k])) : std::nullopt, {}, {}};
      along = common_repeat(along, next);
    }
    placed[static_cast<std::size_t>(axis)] = along[0];
  }
  return placed;
}

Cell cell_inside(const Cell& cell, const Placement& placement) {
  constexpr double rounding = 1e-12;
  const Matrix back = placement.linear.inverse();
  Cell inside;
  inside.place = cell.place;
  Box3 box;
  const Parallelepiped shape = cell.shape();
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner = shape.axes.place(shape.box.corner(static_cast<Box3::CornerType>(i)));
    box.extend(Vec3(back * (corner - placement.shift)));
  }
  inside.low = box.min();
  inside.high = box.max();
  for (int k = 0; k < 3; ++k) {
    bool& periodic = inside.periodic[static_cast<std::size_t>(k)] = cell.names_axes();
    for (int axis = 0; axis < 3; ++axis)
      if (!cell.periodic[static_cast<std::size_t>(axis)] && std::abs(placement.linear(axis, k)) > rounding)
        periodic = false;
  }
  return inside;
}

const NamedBlock* find_block(const Fabric& fabric, std::string_view name) {
  return find_named(fabric.blocks, name);
}

namespace {

void add_used(const Fabric& fabric, std::set<std::string_view>& names) {
  for (const Item& item : fabric.items)
    if (const auto* const use = std::get_if<Use>(&item)) names.insert(use->what);
  for (const NamedBlock& block : fabric.blocks) add_used(*block.fabric, names);
}

}  // namespace

const NamedBlock* used_block(const Fabric& fabric, const Item& item) {
  const auto* const use = std::get_if<Use>(&item);
  return use != nullptr && !use->is_file ? find_block(fabric, use->what) : nullptr;
}

Fabric inside(const Fabric& user, const NamedBlock& block) {
  const Fabric& around = block.home != nullptr ? *block.home : user;
  Fabric fabric = *block.fabric;
  const auto add_missing = [](auto& own, const auto& outer, const auto& is_needed) {
    const std::size_t count = own.size();
    for (const auto& thing : outer) {
      if (!is_needed(thing)) continue;
      const auto end = own.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::none_of(own.begin(), end, [&](const auto& o) { return o.name == thing.name; }))
        own.push_back(thing);
    }
  };
  const auto always = [](const auto&) { return true; };
  add_missing(fabric.threads, around.threads, always);
  add_missing(fabric.materials, around.materials, always);
  add_missing(fabric.outlines, around.outlines, always);
  // What those that it did not define itself mean is decided where they stand.
  const std::size_t own_blocks = fabric.blocks.size();
  // A text may have thousands of blocks, of which each uses few.
  std::set<std::string_view> used;
  add_used(fabric, used);
  add_missing(fabric.blocks, around.blocks,
              [&](const NamedBlock& outer) { return used.contains(outer.name); });
  std::shared_ptr<Fabric> home;
  for (std::size_t i = own_blocks; i < fabric.blocks.size(); ++i) {
    if (fabric.blocks[i].home != nullptr) continue;
    if (home == nullptr) {
      home = std::make_shared<Fabric>(around);
      home->items.clear();
    }
    fabric.blocks[i].home = home;
  }
  fabric.units = around.units;
  fabric.units_given = around.units_given;
  if (!fabric.tolerance) fabric.tolerance = around.tolerance;
  if (fabric.file.empty()) fabric.file = around.file;
  fabric.cell.reset();
  fabric.tell_threads_their_materials();
  return fabric;
}

namespace {

constexpr std::uint64_t most_copies = 1'000'000;

class UseCheck {
 public:
  // Copies of blocks in a fabric, all levels together, and how many levels there are.
  struct Inside {
    std::uint64_t copies = 0;
    std::size_t depth = 0;
  };
  Result<Inside> look_into(const Fabric& fabric) { return look_into(Text{&fabric, nullptr}); }

 private:
  static constexpr std::size_t deepest = 100;  // each level is built within the one above it

  // A fabric and what stands round it: names that it does not define mean what they mean there.
  struct Text {
    const Fabric* fabric;
    const Text* around;
  };

  static Message too_deep() {
    return error(Kind::limit, fmt::format("more than {} blocks use each other in turn", deepest));
  }

  Result<Inside> look_into(const Text& text) {
    // Its own, used or not.
    for (const NamedBlock& block : text.fabric->blocks)
      if (Result<Inside> within = look_into(text, block); !within) return within;
    Inside all;
    for (const Item& item : text.fabric->items) {
      const auto* const use = std::get_if<Use>(&item);
      if (use == nullptr || use->is_file) continue;
      const NamedBlock* block = nullptr;
      const Text* home = &text;
      for (; home != nullptr && (block = find(*home->fabric, use->what)) == nullptr; home = home->around) {
      }
      if (block == nullptr) continue;
      const Result<Inside> within = look_into(*home, *block);
      if (!within) return within.error().placed(use->place);
      all.depth = std::max(all.depth, 1 + within->depth);
      if (all.depth > deepest) return too_deep().placed(use->place);
      const std::uint64_t copies = product_of(static_cast<std::uint64_t>(use->repeats[0]),
                                              static_cast<std::uint64_t>(use->repeats[1]));
      all.copies = sum_of(all.copies, product_of(copies, sum_of(1, within->copies)));
      if (all.copies > most_copies)
        return error(Kind::limit,
                     fmt::format("with all that they use in turn these would be {:.2g} copies of blocks; a "
                                 "fabric may have {}",
                                 static_cast<double>(all.copies), most_copies))
            .placed(use->place);
    }
    return all;
  }

  Result<Inside> look_into(const Text& home, const NamedBlock& block) {
    const Fabric* const key = block.fabric.get();
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    const auto open = std::find_if(open_.begin(), open_.end(),
                                   [&](const NamedBlock* b) { return b->fabric == block.fabric; });
    if (open != open_.end()) {
      std::string circle;
      for (auto one = open; one != open_.end(); ++one) circle += fmt::format("'{}' uses ", (*one)->name);
      return error(Kind::malformed,
                   fmt::format("blocks use each other in a circle: {}'{}'", circle, block.name));
    }
    if (open_.size() == deepest) return too_deep();
    open_.push_back(&block);
    Result<Inside> found = look_into(Text{block.fabric.get(), &home});
    open_.pop_back();
    if (found) known_[key] = *found;
    return found;
  }

  // Null: it has none of this name itself.
  const NamedBlock* find(const Fabric& fabric, const std::string& name) {
    auto& names = names_[&fabric];
    if (names.empty())
      for (const NamedBlock& block : fabric.blocks) names.try_emplace(block.name, &block);
    const auto found = names.find(name);
    return found == names.end() ? nullptr : found->second;
  }

  std::map<const Fabric*, Inside> known_;
  std::map<const Fabric*, std::unordered_map<std::string_view, const NamedBlock*>> names_;
  std::vector<const NamedBlock*> open_;
};

// Outputs know a material by its name: it means the same in all blocks. `known`: those found so far.
Status check_materials(const Fabric& fabric, std::map<std::string, const Material*>& known) {
  for (const Material& material : fabric.materials) {
    const Material* const other = known.try_emplace(material.name, &material).first->second;
    if (material.density != other->density || material.packing != other->packing ||
        material.elastic != other->elastic || material.strength != other->strength ||
        material.expansion != other->expansion || material.conductivity != other->conductivity ||
        material.diffusivity != other->diffusivity || material.permittivity != other->permittivity ||
        material.interface != other->interface)
      return error(Kind::malformed,
                   fmt::format("the material '{}' is another one elsewhere: give one of them another "
                               "name",
                               material.name))
          .placed(material.place);
  }
  for (const NamedBlock& block : fabric.blocks)
    if (Status fits = check_materials(*block.fabric, known); !fits)
      return block.fabric->file.empty() ? fits.error()
                                        : fits.error().placed(fits.error().place, block.fabric->file);
  return {};
}

}  // namespace

Status check_uses(const Fabric& fabric) {
  std::map<std::string, const Material*> materials;
  if (Status fits = check_materials(fabric, materials); !fits) return fits;
  const Result<UseCheck::Inside> found = UseCheck().look_into(fabric);
  return found ? Status() : Status(found.error());
}

}  // namespace selvage::fabric
