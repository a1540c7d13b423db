// What a `use` places, among the yarns to build: each entry knows the builder of its own block, however deep
// that is nested, and one map from there.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "construction/build.h"
#include "construction/shape_memo.h"
#include "fabric/loft.h"
#include "yarn/finish.h"

namespace selvage::fabric {

// Among the builders of a text and its blocks.
struct YarnBuilder::Shared {
  std::shared_ptr<ShapeMemo> shapes = std::make_shared<ShapeMemo>();
  // Those of blocks that do not go on beyond a cell: the same for every use.
  std::map<const Fabric*, std::shared_ptr<const YarnBuilder>> builders;
  std::set<const Fabric*> told;  // blocks whose warnings were said
};

std::shared_ptr<YarnBuilder::Shared> YarnBuilder::share_among_blocks() {
  return std::make_shared<Shared>();
}

std::shared_ptr<ShapeMemo> YarnBuilder::memo_of(const Shared& shared) {
  return shared.shapes;
}

// Null: it has errors, which are told. `goes_on`: beyond the cell, since it is placed like that.
std::shared_ptr<const YarnBuilder> YarnBuilder::builder_inside(const NamedBlock& block,
                                                               const Placement* goes_on,
                                                               Diagnostics& diagnostics) {
  const Fabric* const key = block.fabric.get();
  const bool is_shared = goes_on == nullptr || !fabric_->cell;
  if (const auto known = shared_->builders.find(key); is_shared && known != shared_->builders.end())
    return known->second;
  auto fabric = std::make_shared<Fabric>(inside(*fabric_, block));
  if (!is_shared) fabric->cell = cell_inside(*fabric_->cell, *goes_on);
  Diagnostics own;
  loft(*fabric, own);
  std::optional<YarnBuilder> made;
  if (!own.has_errors()) made = make(*fabric, options_, own, shared_);
  if (shared_->told.insert(key).second || own.has_errors())
    for (const Message& message : own.messages()) diagnostics.add(message);
  std::shared_ptr<YarnBuilder> builder;
  if (made) {
    builder = std::make_shared<YarnBuilder>(std::move(*made));
    builder->own_fabric_ = std::move(fabric);
  }
  if (is_shared) shared_->builders[key] = builder;
  return builder;
}

// Of all yarns: those by hand that are straight along an axis may be moved along it.
std::optional<Repeat> YarnBuilder::repeat_inside() const {
  std::optional<int> along;
  for (const Entry& entry : entries_) {
    if (entry.yarn == nullptr) return repeat();
    const auto* const path = std::get_if<Path>(&entry.yarn->shape);
    if (path == nullptr || !path->sizes.empty() || entry.yarn->closed) return std::nullopt;
    const Vec3 way = path->points.back() - path->points.front();
    int axis = 0;
    way.cwiseAbs().maxCoeff(&axis);
    for (const Vec3& p : path->points)
      for (int k = 0; k < 3; ++k)
        if (k != axis && p[k] != path->points.front()[k]) return std::nullopt;
    if (along.value_or(axis) != axis) return std::nullopt;
    along = axis;
  }
  if (!along || !fabric_->edits.empty()) return std::nullopt;
  Repeat repeat;
  repeat[static_cast<std::size_t>(*along)] = 0.0;
  return repeat;
}

void YarnBuilder::add_use(const Use& use, Diagnostics& diagnostics) {
  const auto fail = [&](Kind kind, std::string text) {
    diagnostics.add(error(kind, std::move(text)).placed(use.place, fabric_->file));
  };
  const NamedBlock* const block = use.is_file ? nullptr : find_block(*fabric_, use.what);
  if (block == nullptr)
    return fail(Kind::io, fmt::format("the {} '{}' was not read", use.is_file ? "file" : "block", use.what));
  const Placement placement = placement_of(use.moves);
  const bool is_repeated = use.repeats != std::array{1, 1};
  const auto within = builder_inside(*block, is_repeated ? nullptr : &placement, diagnostics);
  if (within == nullptr) return;
  insides_.push_back(within);
  std::optional<Repeat> repeat = within->repeat_inside();
  std::array<double, 2> steps{};
  for (const std::size_t k : {0U, 1U}) {
    if (use.repeats[k] == 1) continue;
    steps[k] = use.steps ? (*use.steps)[k] : repeat ? (*repeat)[k].value_or(0.0) : 0.0;
    if (steps[k] == 0.0)
      return fail(Kind::geometry,
                  fmt::format("'{}' has no repeat of its own along {}: 'repeat {} {} step SX SY' "
                              "says how far apart its copies are",
                              use.what, k == 0 ? "x" : "y", use.repeats[0], use.repeats[1]));
    if (!repeat) repeat.emplace();
    (*repeat)[k] = std::abs(steps[k]);
  }
  repeats_of_uses_.push_back(repeat ? std::optional(placed_repeat(*repeat, placement.linear)) : std::nullopt);
  const std::uint64_t copies =
      product_of(static_cast<std::uint64_t>(use.repeats[0]), static_cast<std::uint64_t>(use.repeats[1]));
  const Work work{product_of(copies, within->count()), product_of(copies, within->work_.points),
                  within->work_.longest};
  if (!take_on(work, use.place, diagnostics)) return;
  const std::string prefix = new_name(prefixes_, use.as.empty() ? use.what : use.as);
  for (int j = 0; j < use.repeats[1]; ++j)
    for (int i = 0; i < use.repeats[0]; ++i) {
      Placement copy;
      copy.shift = {i * steps[0], j * steps[1], 0.0};
      std::string name = prefix + ".";
      if (use.repeats[0] > 1) name += fmt::format("{}{}", i + 1, use.repeats[1] > 1 ? "-" : ".");
      if (use.repeats[1] > 1) name += fmt::format("{}.", j + 1);
      add_copy(use, *within, combined(copy, placement), name);
    }
}

void YarnBuilder::add_copy(const Use& use, const YarnBuilder& within, const Placement& placement,
                           const std::string& prefix) {
  const auto new_placed = [&](const YarnBuilder& builder, const Placement& all, std::string name) {
    const TwoSteps steps = steps_of(all);
    return placed_
        .emplace_back(std::make_unique<Placed>(
            Placed{&builder, all, {steps.line, std::move(name)}, steps.body, use.place}))
        .get();
  };
  std::map<const Placed*, const Placed*> placed;  // by that of the block's builder; null: its own yarns
  for (std::size_t k = 0; k < within.entries_.size(); ++k) {
    const Entry& theirs = within.entries_[k];
    const Placed*& here = placed[theirs.placed];
    if (here == nullptr)
      here = theirs.placed == nullptr
                 ? new_placed(within, placement, prefix)
                 : new_placed(*theirs.placed->builder, combined(theirs.placed->placement, placement),
                              prefix + theirs.placed->where.prefix);
    Entry entry = theirs;
    entry.yarn = nullptr;
    entry.made = nullptr;
    entry.placed = here;
    if (theirs.placed == nullptr) entry.index = static_cast<std::uint32_t>(k);
    entries_.push_back(entry);
  }
}

Result<yarn::Body> YarnBuilder::build_placed(const Entry& entry) const {
  const Placed& to = *entry.placed;
  const Entry& theirs = to.builder->entries_[entry.index];
  Result<yarn::Body> body = to.builder->build_here(theirs, &to.where);
  const std::string name = name_of(entry), their_name = to.builder->name_of(theirs);
  const auto rename = [&](Message& message) {
    if (message.yarn == their_name) message.yarn = name;
  };
  if (!body) {
    rename(body.error());
    return body;
  }
  for (Message& message : body->messages) rename(message);
  body->place = to.place;
  if (to.body.linear == Eigen::Matrix3d::Identity()) return body;
  yarn::map_rigidly(*body, to.body.linear, to.body.shift);
  if (body->shape != 0) body->shape = shapes_->mapped(body->shape, to.body.linear);
  return body;
}

}  // namespace selvage::fabric
