// The construction `weave` (formats/txt/README.md): warp i along x at y = (i - 1/2) pitch(warp), weft j along
// y at x = (j - 1/2) pitch(weft), about z = 0. Yarns that cross keep 1 % of their thickness (or
// BuildOptions::gap) and twice the tolerance apart. Paths and sections are in equilibrium (woven_cloth.h), or
// those of a formula (fit.h), which makes yarns thinner where they would touch. As published: they are
// twice the tolerance apart at the crossing itself, and touch in a jammed cloth.
#include "weave/weave.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "core/rounding.h"
#include "fabric/yarn_spec.h"
#include "weave/construction.h"

namespace selvage::fabric {

namespace {

constexpr int most_layers = 100'000;
bool is_polygon(const yarn::Section& section) {
  return std::holds_alternative<yarn::Polygon>(section);
}
bool has_form(const yarn::Section& section) {
  return !std::holds_alternative<yarn::Circle>(section) && !std::holds_alternative<yarn::Ellipse>(section);
}

// Of a thickness, between the surfaces of yarns that cross: less makes poor tetrahedra of what lies between.
constexpr double clearance_share = 0.01;
// Of half of both thicknesses: yarns whose axes lie further apart at their crossings are lifted off each
// other by their flanks.
constexpr double most_lift = 0.1;

// With a unit cell the cloth goes on beyond it by so many pitches. What is different at a spline's end falls
// by 2 + sqrt(3) from section to section: faces of the cell that are a repeat apart cut yarns that agree to
// 1e-10 of it.
constexpr long long continued_pitches = 4;

// 0 .. count x pitch; with a cell, beyond both it and the cloth.
Reach reach_over(const System& crossed, bool has_cell, double low, double high) {
  constexpr double most = 1e15;  // pitches: past what any limit lets through, and exact in both number types
  const double pitch = crossed.text->pitch;
  long long before = 0, after = 0;
  if (has_cell) {
    const auto pitches = [&](double beyond) {
      return continued_pitches + static_cast<long long>(std::clamp(std::ceil(beyond), 0.0, most));
    };
    before = pitches(-low / pitch);
    after = pitches(high / pitch - crossed.text->count);
  }
  const long long last = crossed.text->count - 1 + after;
  return {static_cast<double>(-before) * pitch, static_cast<double>(last + 1) * pitch, -before, last};
}

}  // namespace

std::pair<long long, long long> numbers_of(const Row& row, bool is_periodic, double low, double high) {
  if (!is_periodic) return {0, row.count};
  constexpr double most = 1e9;  // past what any limit lets through
  const auto number = [&](double place) {
    return static_cast<long long>(std::clamp(std::floor((place - row.first) / row.step), -most, most));
  };
  return {std::min(0LL, number(low - 0.5 * row.width) + 1),
          std::max(row.count, -number(2.0 * row.first - high - 0.5 * row.width))};
}

WeaveConstruction::WeaveConstruction(const Fabric& fabric, const Weave& weave, const BuildOptions& options,
                                     System warp, System weft)
    : fabric_(fabric),
      weave_(weave),
      as_published_(options.as_published),
      warp_(std::move(warp)),
      weft_(std::move(weft)),
      has_only_formula_(
          !weave.state && !weave.is_pressed() && !is_stacked() && !has_pile() &&
          (options.as_published || weave.profile || weave.amplitude || any_section(is_polygon))),
      has_formula_(!weave.state && !weave.is_pressed() && !is_stacked() && !has_pile() &&
                   (has_only_formula_ || weave.pucker || any_section(has_form))),
      options_(options) {
  const bool has_cell = fabric.cell.has_value();
  // Both tubes are modelled within the tolerance.
  clearance_ = 2.0 * std::max(tolerance_of(fabric, {}), options.tolerance);
  if (!as_published_) clearance_ += options.gap > 0.0 ? options.gap : clearance_share * thinnest();
  const Cell cell = fabric.cell.value_or(Cell{});
  const Box3 box = cell.shape().bounds();
  along_x_ = reach_over(weft_, has_cell, box.min().x(), box.max().x());
  along_y_ = reach_over(warp_, has_cell, box.min().y(), box.max().y());
}

// Thickness of the thinner system; tows between plates lie flat.
double WeaveConstruction::thinnest() const {
  if (!weave_.is_pressed()) return std::min(warp_.thickest, weft_.thickest);
  return std::min(thickness_in_cloth(warp_, fabric_.units, true),
                  thickness_in_cloth(weft_, fabric_.units, false));
}

void WeaveConstruction::add_block(Block::Kind kind, int layer, std::size_t set, const Row& row) {
  const bool is_weft = kind == Block::Kind::weft;
  const Cell cell = fabric_.cell.value_or(Cell{});
  const int axis = is_weft ? 0 : 1;
  const Box3 box = cell.shape().bounds();
  const auto [begin, end] = numbers_of(row, cell.periodic[is_weft ? 0 : 1], box.min()[axis], box.max()[axis]);
  const auto count = static_cast<std::size_t>(
      kind == Block::Kind::warp ? drawdown_.ends_before(end) - drawdown_.ends_before(begin) : end - begin);
  Block block{kind, layer, set, 0, count, begin, static_cast<std::size_t>(row.count)};
  if (!blocks_.empty()) block.first = blocks_.back().first + blocks_.back().count;
  blocks_.push_back(block);
  data_points_ = sum_of(data_points_, product_of(count, points_of(is_weft)));
}

// Heights at which yarns of these systems are so far apart at the crossings.
Result<Heights> WeaveConstruction::heights_at(const System& warp, const System& weft,
                                              double clearance) const {
  // A sine has room for any height over any pitch.
  const auto [warps_change, wefts_change] = changes_of(drawdown_);
  return share_crimp({&warp, &weft, warp_bend_.value_or(Bend::round), weft_bend_.value_or(Bend::round),
                      warps_change && warp_bend_, wefts_change && weft_bend_},
                     weave_.crimp, clearance);
}

Result<WeaveFit> WeaveConstruction::fit_systems(const System& warp, const System& weft) const {
  return fit_weave({&warp, &weft, &drawdown_, warp_bend_, weft_bend_}, clearance_,
                   [&](double clearance) { return heights_at(warp, weft, clearance); });
}

// Heights at which yarns pass each other at the clearance, and how much thinner they become for it.
Result<Heights> WeaveConstruction::fit_heights(Diagnostics& diagnostics) {
  if (as_published_ || weave_.amplitude) {
    Result<Heights> apart = heights_at(warp_, weft_, clearance_);
    return apart.ok() ? apart : heights_at(warp_, weft_, 0.0);
  }
  Result<WeaveFit> fit = fit_systems(warp_, weft_);
  const std::string_view unit = name_of(fabric_.units);
  const bool is_thin =
      fit && (!weave_.thickness || thickness_of(warp_, weft_, fit->heights) <= *weave_.thickness);
  // With `profile` a formula is asked for; polygons stay what they are.
  if (!(has_room(fit) && is_thin) && !weave_.profile && !any_section(is_polygon)) {
    // Of yarns that overlap nothing is built: neither those that cross, nor neighbours of one system.
    is_jammed_ = !has_only_formula_ || !fit || fit->gap <= 0.0 || is_over_dense(warp_, weft_);
    if (is_jammed_)
      return error(Kind::geometry, "its yarns have no room to pass each other")
          .placed(fit ? weave_.place : fit.error().place);
    if (!is_thin)
      return error(Kind::geometry,
                   fmt::format("by the formula the cloth is {:.6g} {} thick, not {:.6g}",
                               thickness_of(warp_, weft_, fit->heights), unit, *weave_.thickness))
          .placed(weave_.place);
  }
  if (!fit) return fit.error();
  thinner_ = fit->thinner;
  if (fit->gap <= 0.0)
    warn(weave_.place,
         fmt::format(
             "yarns that cross have no room to pass each other and overlap, by about {:.2g} {}: a larger "
             "pitch or narrower sections give it",
             -fit->gap, unit),
         diagnostics);
  else if (thinner_ > 0.0)
    warn(weave_.place,
         fmt::format("the cloth is jammed: its yarns would touch, and are made {:.2g} {} thinner", thinner_,
                     unit),
         diagnostics);
  return fit->heights;
}

// Yarns neither overlap nor are lifted off each other by their flanks.
bool WeaveConstruction::has_room(const Result<WeaveFit>& fit) const {
  return fit && fit->gap > 0.0 &&
         fit->heights.clearance <= 0.5 * most_lift * (warp_.thickest + weft_.thickest) &&
         !is_over_dense(warp_, weft_);
}

bool WeaveConstruction::is_over_dense(const System& warp, const System& weft) {
  return warp.widest > warp.closest || weft.widest > weft.closest;
}

Status WeaveConstruction::prepare_interlacing(Diagnostics& diagnostics) {
  Result<Drawdown> drawdown = has_pile()     ? pile_drawdown()
                              : is_stacked() ? drawdown_of(weave_.columns, layers())
                                             : drawdown_of(weave_.draft);
  if (!drawdown) return drawdown.error().placed(is_stacked() ? drawdown.error().place : weave_.draft.place);
  drawdown_ = std::move(*drawdown);
  Diagnostics own;
  Status made = prepare_heights(own);
  if (!made && is_jammed_ && warp_.text->is_drawn) made = fit_drawing(own);
  if (!made) return is_jammed_ ? jammed(made.error()) : made;
  for (const Message& message : own.messages()) diagnostics.add(message);
  if (has_pile()) return prepare_pile(diagnostics);
  for (int layer = 0; layer < layers(); ++layer) {
    if (layer == 0 || !is_stacked()) add_block(Block::Kind::warp, layer, 0, row_of(warp_));
    add_block(Block::Kind::weft, layer, 0, row_of(weft_));
  }
  return {};
}

// A drawing's threads are as thick as looks well: where they jam, the thickest that have room are built.
Status WeaveConstruction::fit_drawing(Diagnostics& diagnostics) {
  constexpr double step = 0.95, least = 0.1, exactness = 0.01;
  const System warp = warp_, weft = weft_;
  const auto try_at = [&](double by, Diagnostics& own) {
    warp_ = scaled(warp, by);
    weft_ = scaled(weft, by);
    is_thinner_ = true;
    is_jammed_ = false;
    return prepare_heights(own);
  };
  const auto fits = [&](double by) {
    Diagnostics own;
    return try_at(by, own).ok();
  };
  double high = 1.0, low = step;
  for (; !fits(low); low *= step) {
    // Remedies are those of the cloth as it is drawn.
    if (!is_jammed_ || low < least) return try_at(1.0, diagnostics);
    high = low;
  }
  while (high - low > exactness * low) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  Status made = try_at(low, diagnostics);
  if (made)
    warn(weave_.place,
         fmt::format(
             "the cloth is jammed as it is drawn: its threads are built {:.3g} times as thick, the most "
             "that it has room for",
             low),
         diagnostics);
  return made;
}

Status WeaveConstruction::prepare_heights(Diagnostics& diagnostics) {
  if (!has_formula_) {
    Status found = prepare_equilibrium(diagnostics);
    if (found || found.error().kind != Kind::limit) return found;
    const std::string text = fmt::format("no equilibrium of the cloth is looked for: {}", found.error().text);
    if (has_pile()) return error(Kind::limit, text + ", which a pile needs").placed(weave_.place);
    if (weave_.state || weave_.is_pressed() || is_stacked())
      return error(Kind::limit,
                   text + (is_stacked()          ? "; a shorter repeat has fewer"
                           : weave_.is_pressed() ? "; a shorter repeat has fewer"
                                                 : "; without 'state' a formula gives heights and sections"))
          .placed(weave_.place);
    has_formula_ = has_only_formula_ = true;
    space_evenly(weft_);
    space_evenly(warp_);
    warn(weave_.place, text + "; a formula gives its heights and sections", diagnostics);
  }
  Status made = prepare_formula(diagnostics);
  if (made || has_only_formula_ || !is_jammed_) return made;
  // What the formula has no room for presses its yarns flat.
  has_formula_ = is_jammed_ = false;
  space_evenly(weft_);
  space_evenly(warp_);
  return prepare_equilibrium(diagnostics);
}

bool WeaveConstruction::any_section(bool (*is)(const yarn::Section& section)) const {
  for (const System* system : {&warp_, &weft_})
    for (const WovenThread& woven : system->threads)
      if (is(woven.section)) return true;
  return false;
}

Status WeaveConstruction::prepare_formula(Diagnostics& diagnostics) {
  const auto bend_over = [&](const System& crossed) -> std::optional<Bend> {
    if (!weave_.profile) return natural_bend(crossed);
    switch (*weave_.profile) {
      case Weave::Profile::lenticular:
        return Bend::lens;
      case Weave::Profile::racetrack:
        return Bend::racetrack;
      case Weave::Profile::sine:
        return std::nullopt;
      case Weave::Profile::peirce:
      case Weave::Profile::straight:
        break;
    }
    return Bend::round;
  };
  warp_bend_ = bend_over(weft_);
  weft_bend_ = bend_over(warp_);
  const bool is_relaxed = weave_.spacing == Weave::Spacing::relaxed;
  if (is_relaxed) {
    const auto [picks, ends] = changes_between(drawdown_);
    relax_spacing(weft_, picks, weft_.widest + clearance_);
    relax_spacing(warp_, ends, warp_.widest + clearance_);
  }
  Result<Heights> heights = fit_heights(diagnostics);
  if (!heights && is_relaxed) {
    // Yarns may need the places that floats would give away.
    space_evenly(weft_);
    space_evenly(warp_);
    heights = fit_heights(diagnostics);
    if (heights)
      warn(weave_.place, "the spacing is even: the yarns have no room to move together under floats",
           diagnostics);
  }
  if (!heights) return heights.error();
  heights_ = *heights;
  const double thickness = weave_.amplitude
                               ? 2.0 * *weave_.amplitude + std::max(warp_.thickest, weft_.thickest)
                               : thickness_of(warp_, weft_, heights_);
  layer_pitch_ = thickness + clearance_;
  return {};
}

// With remedies.
Message WeaveConstruction::jammed(const Message& failure) const {
  if (!seeks_remedies_) return failure;
  const LooseCloth cloth{warp_, weft_, fabric_.units};
  if (has_formula_)
    return error(failure.kind, fmt::format("the cloth is jammed: {}; {}", failure.text,
                                           remedies_for(cloth,
                                                        [&](const LooseCloth& changed, double) {
                                                          const auto fit =
                                                              fit_systems(changed.warp, changed.weft);
                                                          return fit && fit->gap > 0.0 &&
                                                                 !is_over_dense(changed.warp, changed.weft);
                                                        })))
        .placed(failure.place);
  return error(Kind::geometry,
               fmt::format("the cloth is jammed: {}; {}", failure.text,
                           remedies_for(cloth,
                                        [&](const LooseCloth& changed, double yarns) {
                                          return ClothInEquilibrium::find({&fabric_, &weave_, &changed.warp,
                                                                           &changed.weft, &drawdown_,
                                                                           clearance_, yarns})
                                              .ok();
                                        })))
      .placed(weave_.place);
}

Status WeaveConstruction::prepare_equilibrium(Diagnostics& diagnostics) {
  if (weave_.spacing == Weave::Spacing::relaxed) {
    const auto [picks, ends] = changes_between(drawdown_);
    relax_spacing(weft_, picks, weft_.widest + clearance_);
    relax_spacing(warp_, ends, warp_.widest + clearance_);
  }
  Result<ClothInEquilibrium> found =
      ClothInEquilibrium::find({&fabric_, &weave_, &warp_, &weft_, &drawdown_, clearance_});
  if (!found) {
    is_jammed_ = found.error().kind == Kind::geometry && found.error().place.line == weave_.place.line;
    return found.error().place.line > 0 ? found.error() : found.error().placed(weave_.place);
  }
  equilibrium_ = std::move(*found);
  if (const std::string apart = what_falls_apart(drawdown_); !apart.empty())
    warn(is_stacked()                  ? weave_.columns.front().front().place
         : weave_.draft.place.line > 0 ? weave_.draft.place
                                       : weave_.place,
         fmt::format("the cloth does not hold together: {}, and nothing binds them; they lie on each other",
                     apart),
         diagnostics);
  std::set<const Thread*> told;
  for (const System* system : {&warp_, &weft_})
    for (const WovenThread& woven : system->threads)
      if (!std::holds_alternative<yarn::Circle>(woven.section) &&
          !std::holds_alternative<yarn::Ellipse>(woven.section) && told.insert(woven.thread).second)
        diagnostics.add(
            note(
                Kind::geometry,
                fmt::format("thread '{}' has ellipses for sections in equilibrium, of the area and the width "
                            "over height that its section has at rest",
                            woven.thread->name))
                .placed(woven.thread->place, fabric_.file));
  for (System* system : {&warp_, &weft_}) {
    system->widest = equilibrium_->max_width(system == &weft_);
    system->thickest = equilibrium_->max_height(system == &weft_);
  }
  layer_pitch_ = equilibrium_->thickness() + clearance_;
  return {};
}

void WeaveConstruction::warn(TextPlace place, std::string text, Diagnostics& diagnostics) const {
  diagnostics.add(warning(Kind::geometry, std::move(text)).placed(place, fabric_.file));
}

void WeaveConstruction::warn_of_widths(Diagnostics& diagnostics) const {
  for (const System* system : {&warp_, &weft_})
    if (system->widest > system->closest && !equilibrium_)
      warn(system->text->place,
           fmt::format("yarns {:.6g} wide at a pitch of {:.6g} overlap their neighbours", system->widest,
                       system->closest),
           diagnostics);
  for (std::size_t set = 0; set < binders_.size(); ++set)
    if (const double gap = warp_.text->pitch - warp_.widest; binders_[set].size.width > gap)
      warn(weave_.binders[set].place,
           fmt::format("a binder {:.6g} wide overlaps the warps: between them there is {:.6g}",
                       binders_[set].size.width, gap),
           diagnostics);
}

Status WeaveConstruction::prepare(Diagnostics& diagnostics) {
  if (layers() > most_layers)
    return error(Kind::limit,
                 fmt::format("{} layers are more than the {} that a weave may have", layers(), most_layers));
  const bool is_leno = weave_.draft.form == Draft::Form::leno && !is_straight();
  Status status = is_straight() ? prepare_binders(diagnostics)
                  : is_leno     ? prepare_leno()
                                : prepare_interlacing(diagnostics);
  if (status.ok() && weave_.pucker) status = prepare_pucker(diagnostics);
  if (status.ok()) {
    warn_of_widths(diagnostics);
    warn_of_shared_gaps(diagnostics);
  }
  return status;
}

WeaveConstruction::Place WeaveConstruction::place_of(std::size_t index) const {
  if (has_pile()) {
    static constexpr std::array<Block, 2> of_kind = {Block{Block::Kind::warp}, Block{Block::Kind::weft}};
    return {&of_kind[pile_yarns_[index].kind == Block::Kind::weft ? 1 : 0], pile_yarns_[index].yarn, 0};
  }
  const auto after = std::upper_bound(blocks_.begin(), blocks_.end(), index,
                                      [](std::size_t i, const Block& block) { return i < block.first; });
  const Block& block = *std::prev(after);
  const auto number = static_cast<long long>(index - block.first);
  if (!is_stacked() || block.kind != Block::Kind::warp)
    return {&block, block.begin + number, is_stacked() ? block.layer : 0};
  const auto [column, layer] = drawdown_.column_of(drawdown_.ends_before(block.begin) + number);
  return {&block, column, layer};
}

std::string WeaveConstruction::system(std::size_t index) const {
  if (has_pile() && pile_yarns_[index].is_pile) return "pile";
  const Block::Kind kind = place_of(index).block->kind;
  if (kind == Block::Kind::binder) return "binder";
  return kind == Block::Kind::warp ? "warp" : "weft";
}

std::string WeaveConstruction::name(std::size_t index) const {
  if (has_pile()) return pile_name(pile_yarns_[index]);
  const auto [block, yarn, stacked] = place_of(index);
  if (block->kind == Block::Kind::binder) {
    // Line by line, and then those beyond the cloth's edges.
    const auto in_cloth = static_cast<long long>(block->in_cloth);
    const bool is_beyond = yarn < 0 || yarn >= in_cloth;
    long long number = yarn + 1;
    if (yarn >= in_cloth)
      number = yarn - in_cloth - block->begin + 1;
    else if (yarn < 0)
      number = yarn - block->begin + 1;
    for (const Block& other : std::span(blocks_).last(binders_.size())) {
      if (is_beyond || other.first < block->first) number += static_cast<long long>(other.in_cloth);
      if (is_beyond && other.first < block->first)
        number += static_cast<long long>(other.count - other.in_cloth);
    }
    return fmt::format("binder_{}", number);
  }
  if (is_stacked() && block->kind == Block::Kind::warp)
    return fmt::format("warp_{}_{}", yarn + 1, stacked + 1);
  const std::string_view kind = block->kind == Block::Kind::warp ? "warp" : "weft";
  const std::string layer =
      layers() > 1 || is_straight() ? fmt::format("layer{}_", block->layer + 1) : std::string();
  return fmt::format("{}{}_{}", layer, kind, yarn + 1);
}

const Thread& WeaveConstruction::thread(std::size_t index) const {
  const auto [block, yarn, layer] = place_of(index);
  if (block->kind == Block::Kind::binder) return *binders_[block->set].thread;
  return *(block->kind == Block::Kind::warp ? warp_ : weft_).thread(yarn, layer).thread;
}

double WeaveConstruction::straight_z(bool is_weft, int layer) const {
  return (layer - 0.5 * layers() + (is_weft ? 0.0 : 0.5)) * (warp_layer_ + weft_.thickest + 2.0 * clearance_);
}

std::vector<Pass> WeaveConstruction::passes_of(const Place& place) const {
  const Block* const block = place.block;
  const long long yarn = place.yarn;
  const bool is_weft = block->kind == Block::Kind::weft;
  const Reach& reach = is_weft ? along_y_ : along_x_;
  std::vector<Pass> passes;
  for (long long k = reach.first; k <= reach.last; ++k) {
    if (block->kind == Block::Kind::binder) {
      passes.push_back(binder_pass(block->set, k));
      continue;
    }
    const System &own = is_weft ? weft_ : warp_, &crossed = is_weft ? warp_ : weft_;
    Pass pass;
    pass.s = crossed.at(static_cast<double>(k));
    if (is_straight()) {
      pass.z = straight_z(is_weft, block->layer);
    } else {
      const double thickness = own.thread(yarn).size.height;
      const bool on_top = is_weft ? !drawdown_.warp_on_top(yarn, k) : drawdown_.warp_on_top(k, yarn);
      const double height =
          weave_.amplitude.value_or(is_weft ? heights_.weft(thickness) : heights_.warp(thickness));
      pass.z = on_top ? height : -height;
      pass.below = pass.above = obstacle_of((is_weft ? weft_bend_ : warp_bend_).value_or(Bend::round),
                                            crossed.thread(k).size, thickness, heights_.clearance);
    }
    passes.push_back(pass);
  }
  return passes;
}

// Half waves of a cosine from crossing to crossing, level over floats: a cubic through eight points a pitch.
Status WeaveConstruction::plan_sine(YarnPlan& plan, const std::vector<Pass>& passes, const Reach& reach,
                                    bool is_weft) const {
  const System& crossed = is_weft ? warp_ : weft_;
  const auto place = is_weft ? along_weft : along_warp;
  constexpr int steps = points_a_wave;
  const auto add = [&](double crossing, double z) {
    plan.points.push_back(place(crossed.at(crossing), z, 0.0));
  };
  for (int i = 0; i < steps / 2; ++i)
    add(static_cast<double>(reach.first) - 0.5 + static_cast<double>(i) / steps, passes.front().z);
  for (std::size_t k = 0; k + 1 < passes.size(); ++k) {
    const double middle = 0.5 * (passes[k].z + passes[k + 1].z), half = 0.5 * (passes[k].z - passes[k + 1].z);
    for (int i = 0; i < steps; ++i)
      add(static_cast<double>(reach.first + static_cast<long long>(k)) + static_cast<double>(i) / steps,
          middle + half * std::cos(std::numbers::pi * i / steps));
  }
  for (int i = 0; i <= steps / 2; ++i)
    add(static_cast<double>(reach.last) + static_cast<double>(i) / steps, passes.back().z);
  const Vec3 direction = is_weft ? Vec3::UnitY() : Vec3::UnitX();
  return interpolate(plan, yarn::PathForm::chord, direction, direction);
}

Result<YarnPlan> WeaveConstruction::plan(std::size_t index) const {
  Result<YarnPlan> plan = plan_flat(index);
  if (!plan || !pucker_) return plan;
  if (Status made = pucker(*plan); !made) return made.error();
  return plan;
}

Result<YarnPlan> WeaveConstruction::plan_flat(std::size_t index) const {
  const Place place = place_of(index);
  const auto& [block, yarn, stacked] = place;
  const bool is_weft = block->kind == Block::Kind::weft, is_binder = block->kind == Block::Kind::binder;
  const Role role = is_binder ? Role::binder : is_weft ? Role::weft : Role::warp;
  const TextPlace text = is_binder ? weave_.binders[block->set].place : weave_.place;
  Result<YarnPlan> plan = start_plan(fabric_, thread(index), name(index), role, text);
  if (!plan) return plan;
  if (is_thinner_ && !is_binder) {
    const WovenThread& woven = (is_weft ? weft_ : warp_).thread(yarn);
    const double area = yarn::area(plan->spec.section, plan->spec.sizes.front().size);
    if (const std::optional<double> packing = plan->thread.size_packing())
      plan->thread.packing = std::min(1.0, *packing * area / yarn::area(woven.section, woven.size));
    plan->spec.section = woven.section;
    plan->thread.section = woven.section;
    plan->spec.sizes = {{0.0, woven.size, 0.0}};
  }
  for (yarn::SizeAtParameter& at : plan->spec.sizes) {
    const double share = 1.0 - (is_binder ? 0.0 : thinner_) / at.size.height;
    at.size = {share * at.size.width, share * at.size.height};
  }
  const Reach& reach = is_weft ? along_y_ : along_x_;
  const double across =
      is_binder ? static_cast<double>(binder_gap(weave_.binders[block->set], yarn)) * warp_.text->pitch
                : (is_weft ? weft_ : warp_).at(static_cast<double>(yarn));
  const auto to_place = is_weft ? along_weft : along_warp;
  plan->at = to_place(0.0, is_straight() || is_binder ? 0.0 : layer_shift(block->layer), across);
  if (leno_) {
    if (Status made = plan_leno(*plan, is_weft, yarn); !made) return made.error();
    return plan;
  }
  plan->spec.guide = yarn::FrameGuide::with_across(is_weft ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitY()));
  if (has_pile() && pile_yarns_[index].is_pile) {
    if (Status made = plan_pile(*plan, pile_yarns_[index]); !made) return made.error();
    return plan;
  }
  if (equilibrium_) {
    equilibrium_->shape(*plan, {is_weft, yarn, stacked}, reach.from, reach.to, to_place);
    return plan;
  }
  const std::vector<Pass> passes = passes_of(place);
  if (is_sine(is_weft)) {
    if (Status made = plan_sine(*plan, passes, reach, is_weft); !made) return made.error();
    return plan;
  }
  Result<yarn::CentreLine> line = bridge_passes(passes, reach.from, reach.to, to_place, 0.0);
  if (!line) return line.error();
  plan->line = std::move(*line);
  for (const Pass& pass : passes) plan->points.push_back(to_place(pass.s, pass.z, 0.0));
  return plan;
}

Repeat WeaveConstruction::repeat() const {
  long long wefts = 1, warps = 1;
  if (is_straight()) {
    warps = repeat_of_binders();
    wefts = repeat_of_levels();
  } else {
    wefts = leno_ && !leno_->full ? 2 : drawdown_.repeat_of_picks();
    warps = drawdown_.repeat_of_ends();
  }
  if (pucker_) {
    wefts = std::lcm(wefts, static_cast<long long>(weave_.pucker->picks));
    warps = std::lcm(warps, static_cast<long long>(pucker_->tight) + pucker_->slack);
  }
  if (wefts > longest_repeat || warps > longest_repeat) return {};
  wefts = std::lcm(wefts, weft_.repeat_of_threads());
  warps =
      std::lcm(warps, std::lcm(warp_.repeat_of_threads(), static_cast<long long>(warp_.text->ends_of_one)));
  return {static_cast<double>(wefts) * weft_.text->pitch, static_cast<double>(warps) * warp_.text->pitch,
          std::nullopt};
}

Result<std::unique_ptr<WeaveConstruction>> WeaveConstruction::make(const Fabric& fabric, const Weave& weave,
                                                                   const BuildOptions& options) {
  Result<System> warp = system_of(fabric, weave.warp);
  if (!warp) return warp.error();
  Result<System> weft = system_of(fabric, weave.weft);
  if (!weft) return weft.error();
  if (weave.pile) {
    const std::string& name = weave.pile->thread;
    Result<WovenThread> pile =
        woven_thread(fabric, name.empty() ? weave.warp.threads.front() : name, weave.pile->place);
    if (!pile) return pile.error();
    *warp = with_pile_ends(*warp, *pile);
  }
  if (!weave.columns.empty())
    if (Status stacked = stack_columns(*warp, fabric, weave.columns); !stacked) return stacked.error();
  return std::make_unique<WeaveConstruction>(fabric, weave, options, std::move(*warp), std::move(*weft));
}

Result<std::unique_ptr<Construction>> make_weave(const Fabric& fabric, const Weave& weave,
                                                 const BuildOptions& options, Diagnostics& diagnostics) {
  Result<std::unique_ptr<WeaveConstruction>> made = WeaveConstruction::make(fabric, weave, options);
  if (!made) return made.error();
  if (Status prepared = (*made)->prepare(diagnostics); !prepared) return prepared.error();
  return std::unique_ptr<Construction>(std::move(*made));
}

}  // namespace selvage::fabric
