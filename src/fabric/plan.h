// A yarn before it is swept: everything that decides its geometry. Yarn blocks and constructions give plans,
// edits move their centre lines, plies and filaments replace one by several, and the tube maker sweeps them.
// All lengths in file units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/equilibrium_report.h"
#include "fabric/model.h"
#include "fabric/repeat.h"
#include "yarn/path.h"
#include "yarn/tube.h"

namespace selvage::fabric {

struct YarnPlan {
  std::string name;   // warp_1, course_2, ...
  std::string group;  // of a ply or a filament: the yarn that it is part of; else empty
  Role role = Role::other;
  TextPlace place;
  std::string thread_name;  // may be empty
  Thread thread;            // with the yarn's own statements over it
  // Where the yarn stands: points and line are told from there, so that yarns of one shape are planned alike.
  Vec3 at = Vec3::Zero();
  std::vector<Vec3> points;  // the data points of the centre line; empty where it was not made from points
  yarn::CentreLine line;
  yarn::TubeSpec spec;  // its tolerance and limit are the builder's; a tolerance above 0 is an upper bound
  std::vector<Message> messages;  // warnings made while planning; they become the body's
};

// Of a weave with pile, mm.
struct PileReport {
  double height = 0;  // out of the ground; of cut weft pile the largest
  double ground = 0;  // thickness of the cloth without it
  std::optional<double> wales_per_mm;
  std::optional<double> ends_per_mm;  // of warp pile
};

// The yarns of one fabric by construction, known by number and name before any of them is computed, and
// planned one at a time: nothing is kept, so that a cloth of a million loops needs the memory of one yarn.
// Exactly periodic: yarn i + repeat has the plan of yarn i at another place, n * pitch away.
class Construction {
 public:
  virtual ~Construction() = default;
  [[nodiscard]] virtual std::size_t count() const = 0;
  [[nodiscard]] virtual std::string name(std::size_t index) const = 0;
  // The thread of a yarn, of the fabric's list.
  [[nodiscard]] virtual const Thread& thread(std::size_t index) const = 0;
  // Data points of all yarns together: what the cloth will cost, before it is built.
  [[nodiscard]] virtual std::uint64_t data_points() const = 0;
  // Those of the longest yarn: what has to be held at once.
  [[nodiscard]] virtual std::uint64_t longest() const = 0;
  // Errors: geometry (the place and the yarn are filled in by the builder where they are missing).
  [[nodiscard]] virtual Result<YarnPlan> plan(std::size_t index) const = 0;
  // Of the endless cloth, exact.
  [[nodiscard]] virtual Repeat repeat() const = 0;
  // What the cloth counts: from crossing to crossing or loop to loop, along x and y; of a braid 0.
  [[nodiscard]] virtual Vec2 unit() const = 0;
  // What yarns that do the same are called together: warp, course, bar1, braider.
  [[nodiscard]] virtual std::string system(std::size_t index) const = 0;
  // True: yarns are built whole, never as plies or filaments, since their sections vary along them.
  [[nodiscard]] virtual bool has_whole_yarns() const { return false; }
  // Of a cloth in equilibrium.
  [[nodiscard]] virtual std::optional<EquilibriumReport> equilibrium() const { return std::nullopt; }
  [[nodiscard]] virtual std::optional<PileReport> pile() const { return std::nullopt; }
};

struct BuildOptions;

// What a statement of a text becomes (formats/txt/README.md), made in the folder of its kind: errors at their
// lines; `fabric` and the statement outlive the construction; warnings go to `diagnostics`.
template <class Statement>
using Make = Result<std::unique_ptr<Construction>>(const Fabric& fabric, const Statement& statement,
                                                   const BuildOptions& options, Diagnostics& diagnostics);

// The same plan, told from the origin.
void tell_from_origin(YarnPlan& plan);

// Counts that end at the largest that there is instead of beginning anew.
std::uint64_t sum_of(std::uint64_t a, std::uint64_t b);
std::uint64_t product_of(std::uint64_t a, std::uint64_t b);

// What a fabric costs to build, known before any of it is computed.
struct Work {
  std::uint64_t yarns = 0;    // plies and filaments counted for themselves
  std::uint64_t points = 0;   // data points of all their centre lines
  std::uint64_t longest = 0;  // data points of one of them
  Work& operator+=(const Work& more);
};

// Twelve million loops are four square metres of a fine jersey, 900 GB of IGES; the longest course of a
// machine has some 4000 loops of eight data points.
struct WorkLimits {
  std::uint64_t points = 100'000'000;  // and for each yarn its share
  std::uint64_t longest = 250'000;
};
inline constexpr std::uint64_t least_points_of_a_yarn = 16;  // what a tube costs whatever its path

// Every yarn as so many parts as `parts` says.
Work in_parts(const Work& work, std::uint64_t parts);

// Errors (limit): more than any use, with the number and what helps.
Status check_work(const Work& work, const WorkLimits& limits);

// The start of a plan: names, thread, its section with its size, and its twist. Errors: as section_of.
Result<YarnPlan> start_plan(const Fabric& fabric, const Thread& thread, std::string name, Role role,
                            TextPlace place);

// The plan's centre line through its points, by one of the interpolating forms of a path. Errors: as
// yarn::make_centre_line.
Status interpolate(YarnPlan& plan, yarn::PathForm form, const Vec3& tangent_start, const Vec3& tangent_end);

// Sections whose thickness points as these directions say, one at each parameter of the centre line, as near
// as its tangent lets them. Errors: as yarn::FrameField::make.
Status hold_up(YarnPlan& plan, const std::vector<Vec3>& ups);

}  // namespace selvage::fabric
