// Yarns that share space are moved apart: centre lines move, sections change their shape, and what makes the
// fabric (interlacing, section areas, lengths, volumes, ends, periods) stays.
//
// Displacements are smooth: along a yarn they are cubic B-splines over even steps of length, in each section
// a translation and area-preserving changes of shape (the curl of polynomials in the section's axes). They
// minimise an elastic energy under the condition that no gap is smaller than what is asked for.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::contact {

// A place of a yarn that does not move.
struct FixedPoint {
  std::size_t yarn = 0;
  double parameter = 0;  // of the body's axis (its v)
};

struct RelaxOptions {
  // The least gap that is wanted, file units. None: 1 % of the smaller of the two thicknesses. Negative: an
  // overlap of that depth is allowed.
  std::optional<double> gap;
  // Also pull yarns together that are farther apart than `gap` but overlapped (or met) before: --overlap D
  // makes that depth.
  bool make_contact = false;
  bool stiff_section = false;  // sections keep their shape; only centre lines move
  std::vector<FixedPoint> fixed;
  std::vector<Vec3> periods;  // translations that map the cloth onto itself; at most three; may be empty
  int max_iterations = 60;
  int threads = 1;
  // What is being done, and how far the worst gap is from the wanted one. Returns false to stop.
  std::function<bool(int iteration, double missing)> progress;  // may be empty
};

// The state of the fabric before or after.
struct RelaxState {
  std::size_t overlaps = 0;  // connected places
  double depth = 0;          // of the deepest, file units
  std::optional<double> min_gap;
};

// What one yarn paid.
struct YarnChange {
  double move = 0;    // largest distance of a point of its centre line from where it was, file units
  double length = 0;  // relative changes
  double volume = 0;
  double area = 0;  // of that section which changed most
  // The least turning of a section's outline that was convex before (section_shape.h), radians: below zero it
  // became concave.
  double turning = 0;
  // Relative change of how far the section reaches inward in its tightest bend, in radii, where it folds over
  // itself there; infinity: it did not before.
  double folding = 0;
};

// A pair of yarns that could not be parted.
struct Jam {
  std::size_t a = 0, b = 0;
  double gap = 0;  // the largest that was reached, file units; negative: overlap
  Vec3 at = Vec3::Zero();
};

struct Relaxation {
  bool solved = false;
  std::vector<yarn::Body> bodies;  // the moved ones; where not solved: as far as it went
  RelaxState before, after;
  std::vector<YarnChange> changes;  // one a yarn
  std::vector<Jam> jams;            // where not solved, worst first
  int iterations = 0;
  std::string reason;  // where not solved: which bound stands in the way
};

// Bounds that hold in a solved relaxation.
inline constexpr double area_bound = 0.02, length_bound = 0.01, volume_bound = 0.01, folding_bound = 0.01;

// Yarns that cannot be moved apart at all (two identical ones, one inside another, one through another's
// centre line, a gap of the size of a section) and jammed ones are not errors: the result is not solved, and
// says why. Errors: geometry (a body without a surface), limit. Bodies keep names, knots round, colours;
// knots along may be refined; end faces are made anew in their planes.
Result<Relaxation> relax(std::vector<yarn::Body> bodies, const RelaxOptions& options);

}  // namespace selvage::contact
