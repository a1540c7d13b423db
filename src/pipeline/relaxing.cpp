#include "pipeline/relaxing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "contact/interlacing.h"
#include "contact/relax.h"
#include "core/readable.h"
#include "fabric/as_grid.h"
#include "pipeline/table.h"
#include "pipeline/unit_cell.h"
#include "pipeline/writing.h"

namespace selvage::pipeline {

namespace {

constexpr std::size_t most_told = 20;  // jammed pairs

using contact::Relaxation;

struct Built {
  std::vector<yarn::Body> bodies;
  std::vector<fabric::Yarn> yarns;  // what the text says of each, without its shape
};

// What remains to be said of a yarn in the text when it stands there with its surface.
fabric::Yarn yarn_of(const fabric::YarnBuilder& builder, std::size_t index, const yarn::Body& body) {
  const fabric::YarnBuilder::Origin origin = builder.origin(index);
  fabric::Yarn yarn = fabric::yarn_like(body);
  yarn.closed = body.closed_along;
  if (origin.is_part || origin.is_placed) {
    // A part has another size and count than the thread of the whole; a block may have threads of its own.
    if (const Result<fabric::YarnPlan> plan = builder.plan(index)) yarn.own = plan->thread;
    yarn.own.name.clear();
    if (!body.material.empty()) yarn.own.material = body.material;
  } else if (origin.yarn != nullptr) {
    yarn.thread = origin.yarn->thread;
    yarn.own = origin.yarn->own;
  } else {
    yarn.thread = body.thread;
  }
  return yarn;
}

// The text has no blocks any more, but what their yarns are made of.
void keep_materials(fabric::Fabric& fabric) {
  std::vector<const fabric::Fabric*> within = {&fabric};
  std::vector<fabric::Material> materials = fabric.materials;
  for (std::size_t i = 0; i < within.size(); ++i) {
    for (const fabric::Material& material : within[i]->materials)
      if (fabric::find_named(materials, material.name) == nullptr) materials.push_back(material);
    for (const fabric::NamedBlock& block : within[i]->blocks) within.push_back(block.fabric.get());
  }
  fabric.materials = std::move(materials);
}

// Its thread is taken apart no more: `plies` and `filaments` of the thread would ask for it again.
void keep_whole(const fabric::Fabric& fabric, fabric::Yarn& yarn) {
  fabric::Thread thread = fabric::resolved_thread(fabric, yarn);
  if (!thread.plies && !thread.filaments) return;
  thread.plies.reset();
  thread.filaments.reset();
  thread.name.clear();
  yarn.thread.clear();
  yarn.own = std::move(thread);
}

// Names of a text are given once; two constructions may have made the same ones.
void make_names_unique(Built& built) {
  std::unordered_set<std::string> given;
  for (std::size_t i = 0; i < built.bodies.size(); ++i) {
    std::string name = built.bodies[i].name;
    for (int k = 2; !given.insert(name).second; ++k) name = fmt::format("{}_{}", built.bodies[i].name, k);
    built.bodies[i].name = built.yarns[i].name = name;
  }
}

// The yarns as they come; their warnings are said, but for those of tight bends, which are looked for again
// when the yarns have moved.
std::optional<Built> build(Job& job, const fabric::Fabric& fabric, const fabric::YarnBuilder& builder) {
  Built built;
  job.build_each(builder, "building yarn", [&](std::size_t index, Result<yarn::Body>&& body) {
    if (!body) {
      job.say(body.error());
      return true;
    }
    if (!body->tight_bends.empty()) body->messages.pop_back();  // it is the last one
    job.say_all(body->messages);
    built.yarns.push_back(yarn_of(builder, index, *body));
    keep_whole(fabric, built.yarns.back());
    built.bodies.push_back(std::move(*body));
    return true;
  });
  if (built.bodies.size() != builder.count()) return std::nullopt;
  make_names_unique(built);
  return built;
}

// The rows with the word `fixed`, as parameters of the yarns (and of the parts of these).
std::vector<contact::FixedPoint> fixed_points(const Job& job, const fabric::Fabric& fabric,
                                              const fabric::YarnBuilder& builder) {
  std::vector<contact::FixedPoint> fixed;
  std::optional<fabric::YarnBuilder> whole;  // parts have other rows; their parameters are the yarn's
  for (std::size_t i = 0; i < builder.count(); ++i) {
    const fabric::Yarn* yarn = builder.origin(i).yarn;
    const auto* path = yarn != nullptr ? std::get_if<fabric::Path>(&yarn->shape) : nullptr;
    if (path == nullptr || path->fixed.empty()) continue;
    if (!whole) {
      fabric::BuildOptions options = job.build_options();
      options.detail = fabric::Detail::yarn;
      Diagnostics said_before;
      whole = fabric::YarnBuilder::create(fabric, options, said_before);
      if (!whole) return fixed;
    }
    const std::optional<std::size_t> index = whole->find(builder.name(i));
    if (!index) continue;
    const Result<fabric::YarnPlan> plan = whole->plan(*index);
    if (!plan) continue;  // told where it was built
    for (std::size_t row = 0; row < path->fixed.size(); ++row)
      if (path->fixed[row]) fixed.push_back({i, plan->line.parameters[row]});
  }
  return fixed;
}

std::vector<Vec3> periods_of(const fabric::Fabric& fabric) {
  std::vector<Vec3> periods;
  for (int axis = 0; fabric.cell && axis < 3; ++axis)
    if (fabric.cell->periodic[static_cast<std::size_t>(axis)])
      periods.push_back(fabric.cell->shape().edge(axis));
  return periods;
}

contact::RelaxOptions relax_options(Job& job, const fabric::Fabric& fabric,
                                    const fabric::YarnBuilder& builder) {
  const RelaxSettings& given = job.options.relaxing;
  contact::RelaxOptions options;
  options.gap = given.gap;
  if (given.overlap) {
    options.gap = -*given.overlap;
    options.make_contact = true;
  }
  options.stiff_section = given.stiff_section;
  options.fixed = fixed_points(job, fabric, builder);
  options.periods = periods_of(fabric);
  if (given.max_iterations > 0) options.max_iterations = given.max_iterations;
  options.threads = static_cast<int>(job.threads);
  const std::string unit(name_of(fabric.units));
  options.progress = [&job, unit](int iteration, double missing) {
    job.progress(missing > 0
                     ? fmt::format("relaxing: step {}, worst gap missing {:.3g} {}", iteration, missing, unit)
                     : fmt::format("relaxing: step {}", iteration));
    return true;
  };
  return options;
}

// The largest of what yarns paid; 0 where none had to move: what differs then is rounding.
struct Paid {
  double move = 0, area = 0, length = 0, volume = 0;
  std::string moved_most;  // the yarn; empty: none
};

bool is_moved(const Relaxation& relaxation) {
  return relaxation.iterations > 0;
}

Paid paid_for(const Relaxation& relaxation, const std::vector<yarn::Body>& bodies) {
  Paid most;
  for (std::size_t i = 0; is_moved(relaxation) && i < relaxation.changes.size() && i < bodies.size(); ++i) {
    const contact::YarnChange& change = relaxation.changes[i];
    if (std::abs(change.move) > most.move) most.moved_most = bodies[i].name;
    most.move = std::max(most.move, std::abs(change.move));
    most.area = std::max(most.area, std::abs(change.area));
    most.length = std::max(most.length, std::abs(change.length));
    most.volume = std::max(most.volume, std::abs(change.volume));
  }
  return most;
}

Json relax_json(const Relaxation& relaxation, const Paid& paid, const std::vector<yarn::Body>& bodies,
                double mm) {
  const auto state = [&](const contact::RelaxState& from) -> Json {
    return {{"overlaps", from.overlaps},
            {"depth", if_true(from.overlaps > 0, from.depth * mm)},
            {"min_gap", from.min_gap ? Json(*from.min_gap * mm) : Json()}};
  };
  const auto jam_json = [&](const contact::Jam& jam) -> Json {
    return {{"a", bodies[jam.a].name},
            {"b", bodies[jam.b].name},
            {"gap", jam.gap * mm},
            {"at", point_json(jam.at * mm)}};
  };
  return {{"solved", relaxation.solved},
          {"iterations", relaxation.iterations},
          {"before", state(relaxation.before)},
          {"after", state(relaxation.after)},
          {"largest_move", paid.move * mm},
          {"largest_area_change", paid.area},
          {"largest_length_change", paid.length},
          {"largest_volume_change", paid.volume},
          {"moved_most", if_true(!paid.moved_most.empty(), paid.moved_most)},
          {"reason", if_true(!relaxation.reason.empty(), relaxation.reason)},
          {"jams", if_true(!relaxation.jams.empty(), list_json(relaxation.jams, jam_json))}};
}

std::string percent(double share) {
  return fmt::format("{:.3g} %", 100.0 * share);
}

// Before and after, as a table for people.
std::string table_of(const Job& job, const Relaxation& relaxation, const Paid& paid) {
  const Shown shown = job.shown();
  const auto length = [&](double value) { return cell(shown.length(value)); };
  Table table({"", "overlaps", "deepest", "least gap"});
  const auto add = [&](const char* when, const contact::RelaxState& state) {
    table.add({when, std::to_string(state.overlaps), state.overlaps > 0 ? length(state.depth) : "-",
               state.min_gap ? length(*state.min_gap) : "-"});
  };
  add("before", relaxation.before);
  add(relaxation.solved ? "after" : "as far as it went", relaxation.after);
  std::string text =
      fmt::format("{}: lengths in {}\n{}", readable(job.input.path), name_of(shown.unit), table.text());
  if (relaxation.solved && !is_moved(relaxation)) return text + "  nothing had to move\n";
  text += fmt::format("  largest move {}{}\n", length(paid.move),
                      paid.moved_most.empty() ? "" : fmt::format(", of '{}'", shortened(paid.moved_most)));
  text += fmt::format("  largest changes: of a section's area {}, of a yarn's length {}, of its volume {}\n",
                      percent(paid.area), percent(paid.length), percent(paid.volume));
  return text + fmt::format("  {} after {} step{}\n", relaxation.solved ? "solved" : "not solved",
                            relaxation.iterations, relaxation.iterations == 1 ? "" : "s");
}

Message jam_message(const contact::Jam& jam, const std::vector<yarn::Body>& bodies, Unit units) {
  const std::string &a = bodies[jam.a].name, &b = bodies[jam.b].name;
  const std::string who = jam.a == jam.b ? fmt::format("yarn '{}' jams with itself", a)
                                         : fmt::format("yarns '{}' and '{}' jam", a, b);
  return error(
      Kind::geometry,
      fmt::format("{}: the {} that was reached is {:.4g} {}", who,
                  jam.gap < 0 ? "smallest overlap" : "largest gap", std::abs(jam.gap), name_of(units)),
      {.at = jam.at});
}

void tell_jams(Job& job, const Relaxation& relaxation, const std::vector<yarn::Body>& bodies, Unit units) {
  for (std::size_t k = 0; k < std::min(relaxation.jams.size(), most_told); ++k)
    job.say_defect(jam_message(relaxation.jams[k], bodies, units));
  std::string text = "the yarns cannot be moved apart";
  if (!relaxation.reason.empty()) text += ": " + relaxation.reason;
  if (relaxation.jams.size() > most_told)
    text += fmt::format(" ({} more places jam)", relaxation.jams.size() - most_told);
  job.say_defect(error(Kind::geometry, text + "; nothing was written"));
}

// Lines that meet leave no side to which either could go; false when there are such, each pair told once.
bool have_sides(Job& job, const std::vector<yarn::Body>& bodies) {
  const Result<std::vector<contact::Passage>> meetings = contact::find_passages(bodies, bodies);
  if (!meetings) return job.fail(meetings.error());
  std::size_t told = 0;
  for (std::size_t k = 0; k < meetings->size() && told < most_told; ++k) {
    const contact::Passage& meeting = (*meetings)[k];
    if (k > 0 && meeting.a == (*meetings)[k - 1].a && meeting.b == (*meetings)[k - 1].b) continue;
    const yarn::Body &a = bodies[meeting.a], &b = bodies[meeting.b];
    std::string text = fmt::format(
        "yarns '{}' and '{}' cannot be moved apart, for neither of them is above: ", a.name, b.name);
    if (meeting.a == meeting.b)
      text = fmt::format("yarn '{}' cannot be moved out of itself: it runs through its own middle", a.name);
    else
      text += a.axis.points == b.axis.points ? "they have the same centre line"
                                             : "they run through each other's middle";
    job.say_defect(error(Kind::geometry, text, {.at = meeting.at}));
    ++told;
  }
  return meetings->empty();
}

// A yarn that went through another one is another fabric.
bool keeps_interlacing(Job& job, const std::vector<yarn::Body>& before,
                       const std::vector<yarn::Body>& after) {
  const Result<std::vector<contact::Passage>> passages = contact::find_passages(before, after);
  if (!passages) return job.fail(passages.error());
  for (std::size_t k = 0; k < std::min(passages->size(), most_told); ++k) {
    const contact::Passage& passage = (*passages)[k];
    const std::string &a = before[passage.a].name, &b = before[passage.b].name;
    job.say_defect(error(Kind::geometry,
                         passage.a == passage.b
                             ? fmt::format("yarn '{}' would have to go through itself", a)
                             : fmt::format("yarns '{}' and '{}' would have to go through each other", a, b),
                         {.at = passage.at}));
  }
  if (!passages->empty())
    job.say_defect(error(Kind::geometry,
                         "the yarns cannot be moved apart without changing how they are interlaced; nothing "
                         "was written"));
  return passages->empty();
}

// The fabric with these yarns in the places of those that it had.
fabric::Fabric with_yarns(fabric::Fabric fabric, Built built, std::vector<yarn::Body> bodies, bool is_moved,
                          double tolerance) {
  std::vector<fabric::Item> items;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    yarn::Body& body = bodies[i];
    // What follows from the surface is found again, and there is no exact tube any more.
    body.tight_bends.clear();
    body.messages.clear();
    body.tube_error = body.path_miss = 0;
    if (is_moved) body.axis = fabric::grid_axis(body);  // that of the path is no more
    built.yarns[i].shape = std::make_shared<const yarn::Body>(std::move(body));
    items.emplace_back(std::move(built.yarns[i]));
  }
  for (fabric::Item& item : fabric.items)
    if (std::holds_alternative<fabric::Piece>(item)) items.push_back(std::move(item));
  fabric.items = std::move(items);
  keep_materials(fabric);
  fabric.blocks.clear();
  if (fabric.cell) fabric.cell->of_repeats.reset();
  fabric.item_ends.clear();
  fabric.edits.clear();
  if (tolerance > 0) fabric.tolerance = tolerance;
  return fabric;
}

std::optional<fabric::Fabric> moved_apart(Job& job, fabric::Fabric fabric) {
  job.says_once = true;  // the yarns are built again from what comes out
  const std::optional<fabric::YarnBuilder> builder = job.builder(fabric);
  if (!builder) return std::nullopt;
  if (builder->count() == 0) return fabric;
  if (fabric.cell && fabric.cell->names_axes()) snap_cell(job, fabric, *builder);
  std::optional<Built> built = build(job, fabric, *builder);
  if (!built || job.has_failed()) return std::nullopt;
  job.unsolved = !have_sides(job, built->bodies);
  if (job.unsolved) return std::nullopt;
  const contact::RelaxOptions options = relax_options(job, fabric, *builder);
  Result<Relaxation> relaxation = contact::relax(built->bodies, options);
  if (!relaxation) {
    // No room is an answer; everything else is a failure.
    job.unsolved = relaxation.error().kind == Kind::geometry;
    if (!job.unsolved) return job.fail(relaxation.error());
    job.say_defect(relaxation.error());
    return std::nullopt;
  }
  const bool has_room = relaxation->solved;
  relaxation->solved = has_room && keeps_interlacing(job, built->bodies, relaxation->bodies);
  const Paid paid = paid_for(*relaxation, built->bodies);
  job.report["relax"] = relax_json(*relaxation, paid, built->bodies, millimetres_per(fabric.units));
  tell(job, table_of(job, *relaxation, paid));
  if (!has_room) tell_jams(job, *relaxation, built->bodies, fabric.units);
  job.unsolved = !job.has_failed() && !relaxation->solved;
  if (job.has_failed() || job.unsolved) return std::nullopt;
  const bool moved = is_moved(*relaxation);
  const double tolerance = fabric::tolerance_of(fabric, job.build_options());
  if (moved) {  // a CAD file's own; it is another one now
    fabric.date.clear();
    fabric.file_name.clear();
  }
  std::vector<yarn::Body> bodies =
      moved ? std::move(relaxation->bodies) : std::vector<yarn::Body>(built->bodies);
  return with_yarns(std::move(fabric), std::move(*built), std::move(bodies), moved, tolerance);
}

}  // namespace

std::optional<fabric::Fabric> relaxed(Job& job, std::optional<fabric::Fabric> fabric) {
  if (!fabric || !job.options.relaxing.wanted) return fabric;
  return moved_apart(job, std::move(*fabric));
}

}  // namespace selvage::pipeline
