#include "fabric/inside.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

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

Fabric inside(const Fabric& user, const NamedBlock& block) {
  const Fabric& around = block.home != nullptr ? *block.home : user;
  Fabric fabric = *block.fabric;
  const auto add_missing = [](auto& own, const auto& outer) {
    const std::size_t count = own.size();
    for (const auto& thing : outer) {
      const auto end = own.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::none_of(own.begin(), end, [&](const auto& o) { return o.name == thing.name; }))
        own.push_back(thing);
    }
  };
  add_missing(fabric.threads, around.threads);
  add_missing(fabric.materials, around.materials);
  add_missing(fabric.outlines, around.outlines);
  // What those that it did not define itself mean is decided where they stand.
  const std::size_t own_blocks = fabric.blocks.size();
  add_missing(fabric.blocks, around.blocks);
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
  // How many copies of blocks are in the fabric, all levels together.
  Result<std::uint64_t> copies_in(const Fabric& fabric) {
    // Its own, used or not.
    for (const NamedBlock& block : fabric.blocks)
      if (block.home == nullptr)
        if (Result<std::uint64_t> within = copies_of(fabric, block); !within) return within;
    std::uint64_t all = 0;
    for (const Item& item : fabric.items) {
      const auto* const use = std::get_if<Use>(&item);
      const NamedBlock* const block =
          use != nullptr && !use->is_file ? find_block(fabric, use->what) : nullptr;
      if (block == nullptr) continue;
      const Result<std::uint64_t> within = copies_of(fabric, *block);
      if (!within) return within.error().placed(use->place);
      const std::uint64_t copies = product_of(static_cast<std::uint64_t>(use->repeats[0]),
                                              static_cast<std::uint64_t>(use->repeats[1]));
      all = sum_of(all, product_of(copies, sum_of(1, *within)));
      if (all > most_copies)
        return error(Kind::limit,
                     fmt::format("with all that they use in turn these would be {:.2g} copies of blocks; a "
                                 "fabric may have {}",
                                 static_cast<double>(all), most_copies))
            .placed(use->place);
    }
    return all;
  }

 private:
  Result<std::uint64_t> copies_of(const Fabric& around, const NamedBlock& block) {
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
    open_.push_back(&block);
    Result<std::uint64_t> copies = copies_in(inside(around, block));
    open_.pop_back();
    if (copies) known_[key] = *copies;
    return copies;
  }

  std::map<const Fabric*, std::uint64_t> known_;
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
  const Result<std::uint64_t> copies = UseCheck().copies_in(fabric);
  return copies ? Status() : Status(copies.error());
}

}  // namespace selvage::fabric
