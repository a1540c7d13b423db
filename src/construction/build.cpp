#include "construction/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <set>
#include <span>

#include "braid/braid.h"
#include "construction/shape_memo.h"
#include "core/overloaded.h"
#include "fabric/edits.h"
#include "fabric/helix.h"
#include "fabric/plies.h"
#include "fabric/quantities.h"
#include "fabric/yarn_spec.h"
#include "knit/knit.h"
#include "knit/warpknit.h"
#include "weave/system.h"
#include "weave/weave.h"
#include "yarn/ends.h"
#include "yarn/finish.h"
#include "yarn/grid.h"
#include "yarn/role_color.h"
#include "yarn/tube.h"

namespace selvage::fabric {

namespace {

// How well a section of a grid is known: to the last digit that it is given with, as far as that is no more
// than a thousandth of its size, and to a tolerance that somebody asks for.
double resolution_of(const Fabric& fabric, const Grid& grid, bool last, const BuildOptions& options) {
  const auto count = std::min(static_cast<std::size_t>(grid.per_section), grid.points.size());
  const std::span<const Vec3> points(grid.points);
  const std::span<const Vec3> row = last ? points.last(count) : points.first(count);
  Box3 section;
  for (const Vec3& p : row) section.extend(p);
  // Each coordinate is off by half a digit, and so is the plane.
  const double digits = std::sqrt(3.0) * yarn::last_digit(row);
  const double asked = options.tolerance > 0.0 ? options.tolerance : fabric.tolerance.value_or(0.0);
  return std::max(std::min(digits, 1e-3 * section.sizes().maxCoeff()), asked);
}

// How a yarn of the text is sealed: as the options say, or the yarn itself.
yarn::Sealings sealings_of(const Fabric& fabric, const Yarn* yarn, const BuildOptions& options) {
  yarn::Sealings sealings;
  const Grid* grid = yarn != nullptr ? std::get_if<Grid>(&yarn->shape) : nullptr;
  for (std::size_t end = 0; end < 2; ++end) {
    if (yarn != nullptr && yarn->ends) sealings[end].style = (*yarn->ends)[end];
    if (options.ends) sealings[end].style = *options.ends;
    if (grid == nullptr) continue;
    sealings[end].centre = grid->fan_centres[end];
    sealings[end].resolution = resolution_of(fabric, *grid, end == 1, options);
  }
  return sealings;
}

// Data points that a yarn may have: every one becomes a section at least. What cannot be held is refused
// before it is computed.
std::size_t most_rows(const BuildOptions& options) {
  constexpr std::size_t fewest_round = 8;
  return options.max_control_points / fewest_round;
}

// The yarn of a path block as a plan, before edits.
Result<YarnPlan> plan_of_path(const Fabric& fabric, const Yarn& yarn, const BuildOptions& options) {
  YarnPlan plan;
  plan.name = yarn.name;
  plan.role = yarn.role.value_or(Role::other);
  plan.place = yarn.place;
  plan.thread_name = yarn.thread;
  plan.thread = resolved_thread(fabric, yarn);
  Result<yarn::PathRows> rows = path_rows_of(fabric, yarn, plan.thread);
  if (!rows) return rows.error();
  const Path& path = std::get<Path>(yarn.shape);
  if (path.points.size() > most_rows(options))
    return error(
        Kind::limit,
        fmt::format(
            "yarn '{}' has {} points: its surface would need more than {} control points; split the yarn",
            yarn.name, path.points.size(), options.max_control_points));
  plan.points = path.points;
  Result<yarn::CentreLine> line = yarn::make_centre_line(*rows);
  if (!line) {
    Message message = line.error();
    const int row = message.place.line;  // from 1
    if (row > 0)
      message.place.line =
          path.lines.empty() ? path.place.line + row : path.lines[static_cast<std::size_t>(row - 1)];
    return message;
  }
  plan.line = std::move(*line);
  Result<yarn::TubeSpec> spec = tube_spec_of(fabric, yarn, plan.thread, plan.line.parameters);
  if (!spec) return spec.error();
  plan.spec = std::move(*spec);
  return plan;
}

void describe(yarn::BodyLabel& body, const std::string& name, const std::string& thread_name,
              const Thread& thread, Unit units, Role role, TextPlace place) {
  body.name = name;
  body.thread = thread_name;
  body.material = thread.material.value_or("");
  body.role = role;
  body.twist = fibre_twist(thread, units);
  const bool is_lighter = body.twist > 0;  // Z
  body.color = thread.color.value_or(yarn::role_color(role, is_lighter ? 1 : 0));
  body.has_own_color = thread.color && body.is_colored;
  if (thread.linear_density && thread.fibre_density())
    body.fibre_area =
        thread.linear_density->tex() / (1000 * *thread.fibre_density()) / std::pow(millimetres_per(units), 2);
  body.place = place;
}

// By the mass along it, else what its material has, else by what the thread says of its section.
double density_of(const Fabric& fabric, const Thread& thread, const yarn::Body& body) {
  if (thread.linear_density && body.volume > 0)  // g/km by mm2 is 1e-3 g/cm3
    return 1e-3 * thread.linear_density->tex() * body.length /
           (body.volume * std::pow(millimetres_per(fabric.units), 2));
  if (const Material* const material = fabric.find_material(body.material))
    if (material->density) return *material->density * thread.size_packing().value_or(1.0);
  return thread.fibre_density() && thread.size_packing() ? *thread.fibre_density() * *thread.size_packing()
                                                         : 0;
}

// A thread whose plies or filaments a cloth in equilibrium does not show.
void note_equilibrium(const Thread& thread, Detail detail, const Fabric& fabric, Diagnostics& diagnostics) {
  if (part_count(thread, detail) == 1) return;
  std::string text = fmt::format(
      "the yarns of thread '{}' are built as a whole: their sections change along them, as the cloth is in "
      "equilibrium; with a `profile` plies and filaments are built",
      thread.name);
  diagnostics.add((detail == Detail::usual ? note(Kind::unsupported, std::move(text))
                                           : warning(Kind::unsupported, std::move(text)))
                      .placed(thread.place, fabric.file));
}

// A yarn of more filaments than are built without being asked for.
void note_whole(const Thread& thread, Detail detail, const Fabric& fabric, Diagnostics& diagnostics) {
  if (detail != Detail::usual || thread.filaments.value_or(1) <= max_usual_filaments) return;
  diagnostics.add(note(Kind::unsupported,
                       fmt::format("the yarns of thread '{}' are built as a whole, not as {} filaments each; "
                                   "'--detail filaments' builds every one",
                                   thread.name, *thread.filaments))
                      .placed(thread.place, fabric.file));
}

}  // namespace

namespace {

std::optional<double> thickness_in_cloth(const Fabric& fabric, const Weave& weave) {
  const Result<System> warp = system_of(fabric, weave.warp), weft = system_of(fabric, weave.weft);
  if (!warp || !weft) return std::nullopt;
  return std::min(thickness_in_cloth(*warp, fabric.units, true),
                  thickness_in_cloth(*weft, fabric.units, false));
}

// Of weaves, as thick as they lie. Blocks that were looked into are not looked into again.
void look_for_thinnest(const Fabric& fabric, std::set<const Fabric*>& seen, double& thinnest) {
  for (const Item& item : fabric.items) {
    if (const auto* weave = std::get_if<Weave>(&item))
      if (const std::optional<double> size = thickness_in_cloth(fabric, *weave))
        thinnest = std::min(thinnest, *size);
    const NamedBlock* block = used_block(fabric, item);
    if (block != nullptr && seen.insert(block->fabric.get()).second)
      look_for_thinnest(inside(fabric, *block), seen, thinnest);
  }
}

}  // namespace

double meshed_gap(const Fabric& fabric) {
  double smallest = smallest_section(fabric).value_or(std::numeric_limits<double>::infinity());
  std::set<const Fabric*> seen;
  look_for_thinnest(fabric, seen, smallest);
  return std::isfinite(smallest) ? meshed_gap_fraction * smallest : 0.0;
}

bool YarnBuilder::take_on(const Work& work, TextPlace place, Diagnostics& diagnostics) {
  work_ += work;
  WorkLimits limits = options_.work;
  limits.longest = std::min<std::uint64_t>(limits.longest, most_rows(options_));
  const Status fits = check_work(work_, limits);
  if (!fits) diagnostics.add(fits.error().placed(place, fabric_->file));
  return fits.ok();
}

void YarnBuilder::add_entries(Entry entry, std::uint64_t parts) {
  entry.parts = static_cast<std::uint32_t>(parts);  // checked: fewer than data points
  for (entry.part = 0; entry.part < entry.parts; ++entry.part) entries_.push_back(entry);
}

void YarnBuilder::add_yarn(const Yarn& yarn, Diagnostics& diagnostics) {
  if (const auto* const helix = std::get_if<Helix>(&yarn.shape)) {
    const std::uint64_t rows = helix_rows(*helix, tolerance_);
    if (!take_on({1, rows, rows}, helix->place, diagnostics)) return;
    drawn_.push_back(std::make_unique<const Yarn>(drawn_helix(yarn, tolerance_)));
    return add_yarn(*drawn_.back(), diagnostics);
  }
  const Thread thread = resolved_thread(*fabric_, yarn);
  const auto* const path = std::get_if<Path>(&yarn.shape);
  // A grid is built as it stands, and costs no more than it does in the text.
  const std::uint64_t parts = path != nullptr ? part_count(thread, options_.detail) : 1;
  const std::uint64_t points = path != nullptr ? path->points.size() : 0;
  if (parts > 1 && !take_on(in_parts({1, points, 0}, parts), yarn.place, diagnostics)) return;
  if (path != nullptr) note_whole(thread, options_.detail, *fabric_, diagnostics);
  Entry entry;
  entry.yarn = &yarn;
  add_entries(entry, parts);
  if (std::holds_alternative<Grid>(yarn.shape) && part_count(thread, options_.detail) > 1)
    diagnostics.add(
        warning(Kind::unsupported, fmt::format("yarn '{}' is a grid: it is built as it stands, without plies "
                                               "and filaments",
                                               yarn.name))
            .placed(yarn.place, fabric_->file));
}

void YarnBuilder::add_construction(std::string_view kind, Result<std::unique_ptr<Construction>> made,
                                   const Item& item, TextPlace place, Diagnostics& diagnostics) {
  if (!made) return diagnostics.add(made.error().placed(place, fabric_->file));
  const Construction& construction = **made;
  const std::size_t count = construction.count();
  const Work plain{count, construction.data_points(), construction.longest()};
  if (!take_on(plain, place, diagnostics)) return;
  const bool has_whole_yarns = construction.has_whole_yarns();
  const auto parts_of = [&](std::size_t i) {
    return has_whole_yarns ? 1 : part_count(construction.thread(i), options_.detail);
  };
  Work more;  // than plain yarns
  for (std::size_t i = 0; i < count; ++i) more += in_parts({1, plain.points / count, 0}, parts_of(i) - 1);
  if (more.yarns > 0 && !take_on(more, place, diagnostics)) return;
  std::set<const Thread*> seen;
  for (std::size_t i = 0; i < count; ++i)
    if (const Thread& thread = construction.thread(i); seen.insert(&thread).second)
      (has_whole_yarns ? note_equilibrium : note_whole)(thread, options_.detail, *fabric_, diagnostics);
  constructions_.push_back(std::make_unique<Made>(Made{std::move(*made), &item, place, kind, {}}));
  Entry entry;
  entry.made = constructions_.back().get();
  for (std::size_t i = 0; i < count; ++i) {
    entry.index = static_cast<std::uint32_t>(i);
    add_entries(entry, parts_of(i));
  }
}

std::string YarnBuilder::name_of(const Entry& entry) const {
  if (entry.placed != nullptr) return entry.placed->where.prefix + entry.placed->builder->name(entry.index);
  return entry.yarn != nullptr ? entry.yarn->name
                               : entry.made->prefix + entry.made->construction->name(entry.index);
}

std::optional<Repeat> YarnBuilder::repeat() const {
  for (const Entry& entry : entries_)
    if (entry.yarn != nullptr) return std::nullopt;
  std::vector<Repeat> all;
  for (const auto& made : constructions_) all.push_back(made->construction->repeat());
  for (const std::optional<Repeat>& of_use : repeats_of_uses_) {
    if (!of_use) return std::nullopt;
    all.push_back(*of_use);
  }
  if (all.empty()) return std::nullopt;
  return std::accumulate(all.begin() + 1, all.end(), all.front(), common_repeat);
}

YarnBuilder::Origin YarnBuilder::origin(std::size_t index) const {
  const Entry& entry = entries_[index];
  if (entry.placed != nullptr) {
    Origin origin = entry.placed->builder->origin(entry.index);
    origin.is_placed = true;
    return origin;
  }
  Origin origin{entry.yarn, entry.parts > 1};
  if (entry.made != nullptr) origin.construction = entry.made->construction.get();
  origin.index = entry.index;
  return origin;
}

void YarnBuilder::add_cloths(std::vector<Cloth>& all) const {
  const auto is_known = [&](const Construction* construction) {
    return std::ranges::find(all, construction, &Cloth::construction) != all.end();
  };
  for (const auto& made : constructions_)
    if (!is_known(made->construction.get())) all.push_back({fabric_, made->item, made->construction.get()});
  for (const auto& inside : insides_) inside->add_cloths(all);
}

std::vector<YarnBuilder::Cloth> YarnBuilder::cloths() const {
  std::vector<Cloth> all;
  add_cloths(all);
  return all;
}

std::optional<YarnBuilder> YarnBuilder::create(const Fabric& fabric, const BuildOptions& options,
                                               Diagnostics& diagnostics) {
  return make(fabric, options, diagnostics, share_among_blocks());
}

std::optional<YarnBuilder> YarnBuilder::make(const Fabric& fabric, const BuildOptions& options,
                                             Diagnostics& diagnostics,
                                             const std::shared_ptr<Shared>& shared) {
  YarnBuilder builder;
  builder.fabric_ = &fabric;
  builder.options_ = options;
  builder.last_bundle_ = std::make_shared<LastBundle>();
  builder.shared_ = shared;
  builder.shapes_ = memo_of(*shared);
  builder.names_ = std::make_shared<NameIndex>();
  const int errors_before = diagnostics.error_count();
  builder.tolerance_ = tolerance_of(fabric, options);
  check_lengths(fabric, builder.tolerance_, diagnostics);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  std::set<std::string> warned;  // a warning about a thread is worth saying once
  const auto warn = [&](std::optional<Message> warning) {
    if (warning && warned.insert(warning->text).second) diagnostics.add(std::move(*warning));
  };
  for (const Item& item : fabric.items) {
    builder.add_item(item, diagnostics);
    if (const auto* yarn = std::get_if<Yarn>(&item)) {
      const Thread thread = resolved_thread(fabric, *yarn);
      warn(fibre_share_warning(fabric, *yarn, thread));
      warn(roundness_note(fabric, thread, yarn->place));
    }
    for (const std::string& name : threads_of(item))
      if (const Thread* thread = fabric.find_thread(name)) {
        warn(fibre_share_warning(fabric, *thread, thread->place));
        warn(roundness_note(fabric, *thread, thread->place));
        warn(turning_warning(fabric, *thread, thread->place));
      }
  }
  builder.shared_ = nullptr;  // it holds builders of blocks, which would hold it
  if (diagnostics.error_count() == errors_before) {
    builder.make_names_unique(diagnostics);
    builder.check_part_names(diagnostics);
    builder.check_edited_names(diagnostics);
  }
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return builder;
}

void YarnBuilder::add_item(const Item& item, Diagnostics& diagnostics) {
  const auto construct = [&](std::string_view kind, const auto& construction, const auto& make) {
    add_construction(kind, make(*fabric_, construction, options_, diagnostics), item, construction.place,
                     diagnostics);
  };
  std::visit(Overloaded{
                 [&](const Yarn& yarn) { add_yarn(yarn, diagnostics); },
                 [&](const Weave& weave) { construct("weave", weave, make_weave); },
                 [&](const Knit& knit) { construct("knit", knit, make_knit); },
                 [&](const Warpknit& warpknit) { construct("warpknit", warpknit, make_warpknit); },
                 [&](const Braid& braid) { construct("braid", braid, make_braid); },
                 [&](const Use& use) { add_use(use, diagnostics); },
                 [](const Piece&) {},
             },
             item);
}

Message YarnBuilder::placed(Message message, const Entry& entry) const {
  message.file = fabric_->file;
  if (message.place.line == 0 && entry.placed != nullptr) message.place = entry.placed->place;
  if (message.place.line == 0 && entry.yarn != nullptr) message.place = entry.yarn->place;
  if (message.yarn.empty()) message.yarn = name_of(entry);
  return message;
}

// Its line sheared, and all that holds its sections: a normal stays one of what it is normal to.
void YarnBuilder::move_to(const Where& where, YarnPlan& plan) {
  const Eigen::Matrix3d& linear = where.line.linear;
  plan.name = where.prefix + plan.name;
  plan.at = where.line.of(plan.at);
  if (linear == Eigen::Matrix3d::Identity()) return;
  for (Vec3& p : plan.points) p = linear * p;
  for (Vec3& p : plan.line.curve.points) p = linear * p;
  yarn::FrameGuide& guide = plan.spec.guide;
  const bool is_axis = guide.form == yarn::FrameGuide::Form::radial;
  if (is_axis) guide.origin = linear * guide.origin;
  const Eigen::Matrix3d of_guide = is_axis ? linear : Eigen::Matrix3d(linear.inverse().transpose());
  if (guide.direction) guide.direction = of_guide * *guide.direction;
}

Result<YarnPlan> YarnBuilder::whole_plan(const Entry& entry, const Where* where) const {
  if (const auto* const points =
          entry.yarn != nullptr ? std::get_if<PointsFile>(&entry.yarn->shape) : nullptr)
    return error(Kind::geometry, fmt::format("the points of yarn '{}' stand in a file that was not read: {}",
                                             entry.yarn->name, points->file))
        .placed(points->place);
  if (entry.yarn != nullptr && !std::holds_alternative<Path>(entry.yarn->shape))
    return error(Kind::geometry, fmt::format("yarn '{}' has neither a path nor a grid", entry.yarn->name));
  Result<YarnPlan> plan = entry.yarn != nullptr ? plan_of_path(*fabric_, *entry.yarn, options_)
                                                : entry.made->construction->plan(entry.index);
  if (!plan) return plan;
  if (entry.made != nullptr) plan->name = name_of(entry);
  const auto is_of_it = [&](const Edit& edit) { return edit.yarn == plan->name; };
  if (std::any_of(fabric_->edits.begin(), fabric_->edits.end(), is_of_it)) {
    tell_from_origin(*plan);
    if (Status edited = apply_edits(*fabric_, plan->name, plan->line); !edited) return edited.error();
  }
  if (where != nullptr) move_to(*where, *plan);
  return plan;
}

// The bundle is a function of the yarn alone: that the last one is kept changes no result.
struct YarnBuilder::LastBundle {
  std::mutex mutex;
  std::size_t first_entry = 0;
  const Where* where = nullptr;
  std::shared_ptr<const Bundle> bundle;
};

Result<YarnPlan> YarnBuilder::part_plan(const Entry& entry, const Where* where) const {
  const auto first = static_cast<std::size_t>(&entry - entries_.data()) - entry.part;
  std::shared_ptr<const Bundle> bundle;
  {
    const std::lock_guard lock(last_bundle_->mutex);
    if (last_bundle_->first_entry == first && last_bundle_->where == where) bundle = last_bundle_->bundle;
  }
  if (bundle == nullptr) {
    Result<YarnPlan> parent = whole_plan(entry, where);
    if (!parent) return parent;
    const bool own_tolerance = options_.tolerance <= 0.0 && !fabric_->tolerance;
    Result<Bundle> made = Bundle::make(std::move(*parent), fabric_->units, options_.detail, own_tolerance);
    if (!made) return made.error();
    bundle = std::make_shared<const Bundle>(std::move(*made));
    const std::lock_guard lock(last_bundle_->mutex);
    last_bundle_->first_entry = first;
    last_bundle_->where = where;
    last_bundle_->bundle = bundle;
  }
  return bundle->part(entry.part);
}

Result<YarnPlan> YarnBuilder::plan_of(const Entry& entry, const Where* where) const {
  if (entry.placed != nullptr)
    return entry.placed->builder->plan_of(entry.placed->builder->entries_[entry.index]);
  Result<YarnPlan> plan = entry.parts > 1 ? part_plan(entry, where) : whole_plan(entry, where);
  if (!plan) return placed(plan.error(), entry);
  return plan;
}

Result<YarnPlan> YarnBuilder::plan(std::size_t index) const {
  Result<YarnPlan> plan = plan_of(entries_[index]);
  if (plan) tell_from_origin(*plan);
  return plan;
}

Result<yarn::Body> YarnBuilder::build_grid(const Yarn& yarn) const {
  const Grid& grid = std::get<Grid>(yarn.shape);
  yarn::Body body;
  describe(body, yarn.name, yarn.thread, resolved_thread(*fabric_, yarn), fabric_->units,
           yarn.role.value_or(Role::other), yarn.place);
  for (const Edit& edit : fabric_->edits)
    if (edit.yarn == yarn.name)
      return error(
                 Kind::unsupported,
                 fmt::format(
                     "yarn '{}' is a grid: it has no centre line to edit (rows that name outlines make one)",
                     yarn.name))
          .placed(edit.place, fabric_->file);
  body.group = yarn.group;
  // Its rows are as they are; the word `rotate` says that the fibres keep to their columns.
  const std::optional<Twist> twist = resolved_thread(*fabric_, yarn).twist;
  body.section_turns = twist && twist->rotates && twist->turns != 0.0;
  yarn::GridNet net = grid;
  net.closed_along = net.closed_along || yarn.closed;
  if (const Status filled = yarn::fill_from_grid(body, net); !filled)
    return filled.error().placed(grid.place);
  return body;
}

// A yarn of a CAD file keeps its end faces unless others are asked for.
Result<yarn::Body> YarnBuilder::as_read(yarn::Body body, const Entry& entry) const {
  const Status finished = options_.ends ? yarn::finish(body, *options_.ends) : yarn::finish_as_sealed(body);
  if (!finished) return placed(finished.error(), entry);
  for (Message& message : body.messages) message = placed(message, entry);
  return body;
}

Result<yarn::Body> YarnBuilder::build(std::size_t index) const {
  const Entry& entry = entries_[index];
  return entry.placed != nullptr ? build_placed(entry) : build_here(entry, nullptr);
}

Result<yarn::Body> YarnBuilder::build_here(const Entry& entry, const Where* where) const {
  if (has_surface(entry)) {
    Result<yarn::Body> body = build_surface(entry);
    if (body && where != nullptr) {
      if (where->line.linear != Eigen::Matrix3d::Identity())
        return placed(
            error(Kind::unsupported,
                  fmt::format("yarn '{}' is a grid, which has no centre line to shear: a path has one",
                              entry.yarn->name)),
            entry);
      yarn::map_rigidly(*body, where->line.linear, where->line.shift);
      body->name = where->prefix + body->name;
    }
    return body;
  }
  Result<YarnPlan> made = plan_of(entry, where);
  if (!made) return made.error();
  return build_swept(entry, std::move(*made), where);
}

bool YarnBuilder::has_surface(const Entry& entry) {
  return entry.yarn != nullptr && !std::holds_alternative<Path>(entry.yarn->shape);
}

// Of a yarn that has its surface.
Result<yarn::Body> YarnBuilder::build_surface(const Entry& entry) const {
  if (const auto* read = std::get_if<std::shared_ptr<const yarn::Body>>(&entry.yarn->shape))
    return as_read(**read, entry);
  if (!std::holds_alternative<Grid>(entry.yarn->shape)) return plan_of(entry).error();  // it has no shape
  Result<yarn::Body> body = build_grid(*entry.yarn);
  if (!body) return placed(body.error(), entry);
  if (Status finished = yarn::finish(*body, sealings_of(*fabric_, entry.yarn, options_)); !finished)
    return placed(finished.error(), entry);
  body->density = density_of(*fabric_, resolved_thread(*fabric_, *entry.yarn), *body);
  for (Message& message : body->messages) message = placed(message, entry);
  return body;
}

yarn::BodyLabel YarnBuilder::label_of(const Entry& entry, const YarnPlan& plan, const Where* where) const {
  yarn::BodyLabel label;
  describe(label, plan.name, plan.thread_name, plan.thread, fabric_->units, plan.role, plan.place);
  label.group = plan.group;
  if (plan.group.empty() && entry.yarn != nullptr && !entry.yarn->group.empty())
    label.group = (where != nullptr ? where->prefix : std::string()) + entry.yarn->group;
  label.section_turns = plan.spec.twist != 0.0;
  return label;
}

// Takes the plan's line.
ShapeMemo::Plan YarnBuilder::shape_plan(const Entry& entry, YarnPlan& plan) const {
  yarn::TubeSpec& spec = plan.spec;
  spec.tolerance = spec.tolerance > 0.0 ? std::min(spec.tolerance, tolerance_) : tolerance_;
  if (!options_.full_digits) spec.grid = DecimalGrid(1e-4 * spec.tolerance);
  spec.max_control_points = options_.max_control_points;
  return {std::move(plan.line), spec, sealings_of(*fabric_, entry.yarn, options_)};
}

Status YarnBuilder::sweep(yarn::Body& body, const ShapeMemo::Plan& shape, const YarnPlan& plan) const {
  body.messages = plan.messages;
  body.path_miss = shape.line.largest_miss;
  if (Status swept = yarn::sweep(body, shape.line, shape.spec); !swept) return swept;
  return yarn::finish(body, shape.sealings);
}

Result<YarnBuilder::Shaped> YarnBuilder::shape_of(const Entry& entry, YarnPlan plan,
                                                  const Where* where) const {
  Shaped shaped{nullptr, label_of(entry, plan, where), plan.at, {}};
  const ShapeMemo::Plan shape = shape_plan(entry, plan);
  shaped.grid = shape.spec.grid;
  // A yarn of the text is planned once, but for one that is placed.
  const bool may_be_known = entry.yarn == nullptr || where != nullptr;
  if (may_be_known) shaped.body = shapes_->find(shape);
  if (shaped.body == nullptr) {
    auto body = std::make_shared<yarn::Body>();
    static_cast<yarn::BodyLabel&>(*body) = shaped.label;
    if (Status swept = sweep(*body, shape, plan); !swept) return placed(swept.error(), entry);
    if (may_be_known) shapes_->keep(shape, *body);
    for (Message& message : body->messages) message = placed(message, entry);
    shaped.body = std::move(body);
  }
  shaped.label.density = density_of(*fabric_, plan.thread, *shaped.body);
  return shaped;
}

Result<yarn::Body> YarnBuilder::build_swept(const Entry& entry, YarnPlan plan, const Where* where) const {
  Result<Shaped> shaped = shape_of(entry, std::move(plan), where);
  if (!shaped) return shaped.error();
  yarn::Body body = *shaped->body;
  static_cast<yarn::BodyLabel&>(body) = std::move(shaped->label);
  if (shaped->at != Vec3::Zero()) yarn::move(body, shaped->at, shaped->grid);
  return body;
}

Result<YarnBuilder::Shaped> YarnBuilder::shape(std::size_t index) const {
  const Entry& entry = entries_[index];
  if (entry.placed == nullptr && !has_surface(entry)) {
    Result<YarnPlan> plan = plan_of(entry);
    if (!plan) return plan.error();
    return shape_of(entry, std::move(*plan), nullptr);
  }
  Result<yarn::Body> body = build(index);
  if (!body) return body.error();
  yarn::BodyLabel label = *body;
  return Shaped{std::make_shared<const yarn::Body>(std::move(*body)), std::move(label), Vec3::Zero(), {}};
}

}  // namespace selvage::fabric
