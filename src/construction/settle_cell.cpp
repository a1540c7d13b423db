#include "construction/settle_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>

#include "core/decimal_grid.h"
#include "core/parallel.h"
#include "fabric/repeat.h"
#include "nurbs/divided.h"
#include "nurbs/samples.h"

namespace selvage::fabric {

namespace {

// Of the thinnest yarn's thickness.
constexpr double usual_margin = 0.1, clear_of_turns = 0.1;
// Heights are rounded outward: tubes that differ by their tolerance have one cell.
constexpr double rounding = 0.01;

// A surface, dense enough to see where it reaches to within a thousandth of its thickness.
nurbs::Samples dense_samples(const nurbs::Surface& surface) {
  constexpr int round_a_span = 4, along_a_span = 8;
  return {surface, nurbs::divided(surface.knots_u, surface.degree_u, round_a_span),
          nurbs::divided(surface.knots_v, surface.degree_v, along_a_span)};
}

// The yarns of a fabric with the cell that it has now; only errors are told, for all will be built again.
std::optional<std::vector<yarn::Body>> bodies_of(const Fabric& fabric, const BuildOptions& options,
                                                 int threads, std::optional<Repeat>& repeat,
                                                 Diagnostics& diagnostics) {
  Diagnostics own;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, own);
  std::vector<yarn::Body> bodies;
  if (builder) {
    repeat = builder->repeat();
    bodies.resize(builder->count());
    std::mutex mutex;
    for_each_index(bodies.size(), threads, [&](std::size_t i) {
      Result<yarn::Body> body = builder->build(i);
      const std::lock_guard lock(mutex);
      if (body)
        bodies[i] = std::move(*body);
      else
        own.add(body.error());
    });
  }
  for (const Message& message : own.messages())
    if (message.severity == Severity::error) diagnostics.add(message);
  return own.has_errors() ? std::nullopt : std::optional(std::move(bodies));
}

// How long the cell is along each axis; 0: as the yarns reach.
Result<Vec3> lengths_of(const Cell& cell, const std::optional<Repeat>& repeat) {
  if (!repeat)
    return error(
        Kind::geometry,
        "a repeat is known of constructions only, not of yarns by hand: write two opposite corners, `cell X "
        "Y Z  X Y Z`");
  double shortest = std::numeric_limits<double>::infinity();
  for (const std::optional<double>& along : *repeat)
    if (along.value_or(0.0) > 0.0) shortest = std::min(shortest, *along);
  if (!std::isfinite(shortest))
    return error(Kind::geometry,
                 "this cloth has no repeat, or none of a thousand yarns or less: write two opposite corners, "
                 "`cell X Y "
                 "Z  X Y Z`");
  Vec3 lengths = Vec3::Zero();
  std::size_t next = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double>& along = (*repeat)[static_cast<std::size_t>(axis)];
    // What may be moved by any length is as long as it is wide.
    if (!along) continue;
    const int count = next < 2 ? cell.of_repeats->counts[next] : 1;
    lengths[axis] = count * (*along > 0.0 ? *along : shortest);
    ++next;
  }
  return lengths;
}

// Where surfaces turn round along an axis, within one repeat from `low` on, as shares of it.
std::vector<double> turns_along(int axis, const std::vector<nurbs::Samples>& samples, double low,
                                double repeat) {
  std::vector<double> turns;
  const double flat = 1e-9 * repeat;  // rounding along what is parallel to the face
  const auto turns_round = [&](double before, double here, double after) {
    const double left = here - before, right = after - here;
    return std::abs(left) <= flat || std::abs(right) <= flat || (left > 0) != (right > 0);
  };
  for (const nurbs::Samples& grid : samples) {
    const std::size_t round = grid.us.size() - 1;  // the last one is the first
    const auto place = [&](std::size_t u, std::size_t v) { return grid.at(u % round, v)[axis]; };
    for (std::size_t v = 1; v + 1 < grid.vs.size(); ++v)
      for (std::size_t u = 0; u < round; ++u)
        if (turns_round(place(u + round - 1, v), place(u, v), place(u + 1, v)) &&
            turns_round(place(u, v - 1), place(u, v), place(u, v + 1))) {
          const double share = (place(u, v) - low) / repeat;
          turns.push_back(share - std::floor(share));
        }
  }
  std::sort(turns.begin(), turns.end());
  return turns;
}

// From low to high, as shares of a repeat.
using Interval = std::array<double, 2>;

// What the ends of yarns within the cell fill along an axis, with a margin.
std::vector<Interval> ends_along(int axis, const std::vector<nurbs::Samples>& samples, double low,
                                 double repeat, double clear,
                                 const std::function<bool(const Vec3&)>& is_in_cell) {
  std::vector<Interval> ends;
  for (const nurbs::Samples& grid : samples)
    for (const std::size_t v : {std::size_t{0}, grid.vs.size() - 1}) {
      Box3 end;
      for (std::size_t u = 0; u + 1 < grid.us.size(); ++u) end.extend(grid.at(u, v));
      if (is_in_cell(end.center()))
        ends.push_back({(end.min()[axis] - low) / repeat - clear, (end.max()[axis] - low) / repeat + clear});
    }
  return ends;
}

bool is_in_one(const std::vector<Interval>& intervals, double share) {
  return std::any_of(intervals.begin(), intervals.end(), [&](const Interval& interval) {
    return std::ceil(interval[0] - share) <= interval[1] - share;
  });
}

// By what fraction of a repeat, from -1/2 to 1/2, a face at 0 moves to keep clear of turns and, where there
// is such a place, of ends.
double move_off_turns(const std::vector<double>& turns, const std::vector<Interval>& ends, double clear) {
  if (turns.empty() || (turns.front() >= clear && turns.back() <= 1.0 - clear && !is_in_one(ends, 0.0)))
    return 0.0;
  double widest = 0.0, middle = 0.0;
  bool is_free = false;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double next = i + 1 < turns.size() ? turns[i + 1] : turns.front() + 1.0;
    constexpr double alike = 1e-6;  // of gaps that are alike the first
    const double width = next - turns[i], here = 0.5 * (turns[i] + next);
    const bool is_here_free = width >= 2.0 * clear && !is_in_one(ends, here);
    if (is_free && !is_here_free) continue;
    if (is_free == is_here_free && width <= widest + alike) continue;
    widest = width;
    middle = here;
    is_free = is_here_free;
  }
  return middle - std::round(middle);
}

class Settling {
 public:
  Settling(Fabric& fabric, const BuildOptions& options, int threads, Diagnostics& diagnostics)
      : fabric_(fabric), options_(options), threads_(threads), diagnostics_(diagnostics) {}

  Status settle() {
    Cell cell = *fabric_.cell;
    fabric_.cell.reset();
    std::optional<Repeat> repeat;
    std::optional<std::vector<yarn::Body>> bodies =
        bodies_of(fabric_, options_, threads_, repeat, diagnostics_);
    fabric_.cell = cell;
    if (!bodies) return {};  // it was told
    const Result<Vec3> lengths = lengths_of(cell, repeat);
    if (!lengths) return lengths.error();
    for (const int axis : {0, 1})
      if ((*lengths)[axis] == 0.0)
        diagnostics_.add(
            warning(Kind::geometry, fmt::format("the cloth has no repeat along {}: there the cell reaches "
                                                "beyond all of its yarns",
                                                axis == 0 ? "x" : "y"))
                .placed(cell.place, fabric_.file));
    Box3 cloth;
    for (const yarn::Body& body : *bodies) cloth.extend(yarn::bounds(body));
    if (!cell.names_axes())
      for (int axis = 0; axis < 3; ++axis)
        cell.periodic[static_cast<std::size_t>(axis)] = (*lengths)[axis] > 0.0;
    for (int axis = 0; axis < 3; ++axis)
      place(cell, axis, (*lengths)[axis], (*repeat)[static_cast<std::size_t>(axis)].value_or(0.0), cloth);
    fabric_.cell = cell;
    bodies = bodies_of(fabric_, options_, threads_, repeat, diagnostics_);
    if (!bodies) return {};
    fit(cell, *bodies, *lengths, *repeat);
    fabric_.cell = cell;
    diagnostics_.add(
        note(Kind::geometry, fmt::format("the cell reaches from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, "
                                         "{:.6g}, {:.6g})",
                                         cell.low.x(), cell.low.y(), cell.low.z(), cell.high.x(),
                                         cell.high.y(), cell.high.z()))
            .placed(cell.place, fabric_.file));
    return {};
  }

 private:
  // Whole repeats from the axes' origin, next to the middle of the cloth; elsewhere the cloth itself.
  static void place(Cell& cell, int axis, double length, double repeat, const Box3& cloth) {
    cell.low[axis] = cloth.min()[axis];
    cell.high[axis] = cloth.max()[axis];
    if (length == 0.0) return;
    const double step = repeat > 0.0 ? repeat : length, middle = cloth.center()[axis];
    constexpr double as_near = 1e-6;  // of two that are as near the lower one
    cell.low[axis] = std::ceil((middle - 0.5 * length) / step - 0.5 - as_near) * step + 0.0;
    cell.high[axis] = cell.low[axis] + length;
  }

  // Is it in the cell as far as that has faces?
  static bool is_beside(const Vec3& p, const Cell& cell, const Vec3& lengths) {
    for (int axis = 0; axis < 3; ++axis)
      if (lengths[axis] > 0.0 && (p[axis] < cell.low[axis] || p[axis] > cell.high[axis])) return false;
    return true;
  }

  // What is left to find: where no yarn runs along a face or ends in one, and how far they reach.
  void fit(Cell& cell, const std::vector<yarn::Body>& bodies, const Vec3& lengths, const Repeat& repeat) {
    std::vector<nurbs::Samples> samples;
    Box3 yarns;
    const double thinnest = yarn::narrowest_section(bodies);
    for (const yarn::Body& body : bodies) {
      nurbs::Samples& grid = samples.emplace_back(dense_samples(body.surface));
      for (const Vec3& p : grid.points)
        if (is_beside(p, cell, lengths)) yarns.extend(p);
    }
    const DecimalGrid digits(rounding * thinnest);
    const double margin = cell.of_repeats->margin.value_or(usual_margin * thinnest);
    for (int axis = 0; axis < 3; ++axis) {
      if (lengths[axis] == 0.0) {
        cell.low[axis] = digits.rounded(yarns.min()[axis] - margin - 0.5 * digits.step());
        cell.high[axis] = digits.rounded(yarns.max()[axis] + margin + 0.5 * digits.step());
        continue;
      }
      const double own = repeat[static_cast<std::size_t>(axis)].value_or(0.0);
      if (own == 0.0) continue;
      const double clear = clear_of_turns * thinnest / own;
      const std::vector<Interval> ends =
          ends_along(axis, samples, cell.low[axis], own, clear,
                     [&](const Vec3& p) { return is_beside(p, cell, lengths); });
      const double share = move_off_turns(turns_along(axis, samples, cell.low[axis], own), ends, clear);
      cell.low[axis] += share * own;
      cell.high[axis] = cell.low[axis] + lengths[axis];
    }
  }

  Fabric& fabric_;
  const BuildOptions& options_;
  int threads_;
  Diagnostics& diagnostics_;
};

// The cell of these edges that reaches from one height to another.
void place_by_vectors(Cell& cell, double low, double high) {
  const CellVectors& vectors = *cell.of_vectors;
  cell.axes = ObliqueAxes({vectors.first, vectors.second, Vec3::UnitZ()});
  Vec3 corner = vectors.at.value_or(Vec3::Zero());
  corner.z() = low;
  cell.low = cell.axes.own(corner);
  cell.high = cell.low + Vec3(vectors.first.norm(), vectors.second.norm(), high - low);
}

// As high as its yarns.
void find_height(Fabric& fabric, const BuildOptions& options, int threads, Diagnostics& diagnostics) {
  std::optional<Repeat> repeat;
  place_by_vectors(*fabric.cell, -1, 1);
  const std::optional<std::vector<yarn::Body>> bodies =
      bodies_of(fabric, options, threads, repeat, diagnostics);
  if (!bodies) return;  // it was told
  const Parallelepiped cell = fabric.cell->shape();
  Box3 yarns;
  const double thinnest = yarn::narrowest_section(*bodies);
  for (const yarn::Body& body : *bodies) {
    for (const Vec3& p : dense_samples(body.surface).points) {
      Vec3 beside = cell.axes.own(p);
      beside.z() = 0;
      if (cell.box.contains(beside)) yarns.extend(p);
    }
  }
  if (yarns.isEmpty()) {
    diagnostics.add(error(Kind::geometry,
                          "no yarn enters this cell, which is to be as high as its yarns: `at X Y Z` "
                          "behind the vectors puts it elsewhere")
                        .placed(fabric.cell->place, fabric.file));
    return;
  }
  const DecimalGrid digits(rounding * thinnest);
  const double margin = fabric.cell->of_vectors->margin.value_or(usual_margin * thinnest);
  place_by_vectors(*fabric.cell, digits.rounded(yarns.min().z() - margin - 0.5 * digits.step()),
                   digits.rounded(yarns.max().z() + margin + 0.5 * digits.step()));
  diagnostics.add(note(Kind::geometry, fmt::format("the cell reaches from z = {:.6g} to z = {:.6g}",
                                                   fabric.cell->low.z(), fabric.cell->high.z()))
                      .placed(fabric.cell->place, fabric.file));
}

void settle_vectors(Fabric& fabric, const BuildOptions& options, int threads, Diagnostics& diagnostics) {
  Cell& cell = *fabric.cell;
  if (!cell.names_axes()) cell.periodic = {true, true, false};
  if (!cell.of_vectors->height) return find_height(fabric, options, threads, diagnostics);
  const double height = *cell.of_vectors->height,
               low = cell.of_vectors->at ? cell.of_vectors->at->z() : -height / 2;
  place_by_vectors(cell, low, low + height);
}

}  // namespace

std::optional<std::array<Vec3, 2>> shortest_vectors(const Fabric& fabric, const BuildOptions& options,
                                                    int threads) {
  constexpr double near = 0.02;  // of the thinnest yarn: how far copies of yarns by hand may be off
  Diagnostics unsaid;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, unsaid);
  std::optional<Repeat> repeat;
  if (builder) repeat = builder->repeat();
  if (!repeat || !((*repeat)[0].value_or(0.0) > 0.0) || !((*repeat)[1].value_or(0.0) > 0.0))
    return std::nullopt;
  const double x = *(*repeat)[0], y = *(*repeat)[1];
  Fabric wide = fabric;
  wide.cell.emplace();
  wide.cell->low = {-x, -y, -1};
  wide.cell->high = {2 * x, 2 * y, 1};
  wide.cell->periodic = {true, true, false};
  const std::optional<std::vector<yarn::Body>> bodies = bodies_of(wide, options, threads, repeat, unsaid);
  if (!bodies) return std::nullopt;
  const double thinnest = yarn::narrowest_section(*bodies);
  constexpr double any = std::numeric_limits<double>::infinity();
  return oblique_repeat(*bodies, Box3(Vec3(-x, -y, -any), Vec3(2 * x, 2 * y, any)), {x, y}, near * thinnest);
}

void settle_cell(Fabric& fabric, const BuildOptions& options, int threads, Diagnostics& diagnostics) {
  if (fabric.cell && fabric.cell->of_vectors) settle_vectors(fabric, options, threads, diagnostics);
  if (!fabric.cell || !fabric.cell->of_repeats) return;
  if (const Status settled = Settling(fabric, options, threads, diagnostics).settle(); !settled)
    diagnostics.add(settled.error().placed(fabric.cell->place, fabric.file));
}

}  // namespace selvage::fabric
