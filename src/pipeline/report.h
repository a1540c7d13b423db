// What the JSON report says (README.md: the report). One InputReport is filled while an input is worked on,
// turned into JSON text in its process, and put together with the others by the parent. Lengths in mm; what
// is unknown is left out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/units.h"
#include "core/vec.h"

namespace selvage::pipeline {

struct YarnReport {
  std::string name;
  std::optional<bool> closed;        // body and end faces leave no gap
  std::optional<bool> self_overlap;  // the yarn's own surface crosses itself
  double length = 0, volume = 0;
  std::optional<double> min_bend_radius;
  double tube_error = 0;
  std::optional<double> path_miss;  // loop paths: largest distance of the centre line from its points
  int count_u = 0, count_v = 0;     // control points round and along
};

// A garment piece. Lengths in mm, areas in mm2; points are x, y.
struct PieceReport {
  struct Point {
    double parameter = 0;
    Vec2 at = Vec2::Zero();
    double error = 0, distance = 0;  // to the curve at the parameter, and to its nearest point
  };
  struct Fit {  // with --table
    std::string shape;
    std::vector<Point> points;
    std::array<Vec2, 4> solved, descended;  // control points
    int iterations = 0;
    double largest_error = 0, largest_distance = 0;
  };
  struct Edge {
    std::string name;
    bool is_line = false;
    double length = 0;
    std::optional<Fit> fit;
  };
  std::string name;
  double area = 0, perimeter = 0;
  std::vector<Edge> edges;
  std::optional<bool> valid;  // the face, by OpenCASCADE
};

struct OverlapReport {
  std::string a, b;  // equal: a yarn meets itself
  double depth = 0;
  Vec3 at = Vec3::Zero();
  Vec3 direction = Vec3::Zero();       // unit; b has to go `depth` along it
  double area = 0;                     // of a's surface that lies in b
  std::optional<Vec2> site_a, site_b;  // (u, v) on their surfaces; none on an end face
};

// Yarns that are near each other without an overlap.
struct ContactReport {
  std::string a, b;  // equal: a yarn meets itself
  double gap = 0;
  Vec3 at = Vec3::Zero();
  std::optional<Vec2> site_a, site_b;  // as in OverlapReport
};

struct OutputReport {
  std::string path, format, sha256;
  std::uint64_t bytes = 0;
  std::map<std::string, std::uint64_t> entities;
};

// What --instances found.
struct InstancesReport {
  std::size_t shapes = 0, copies = 0;  // the yarns that are written by reference, and of how many shapes
  double largest_deviation = 0;        // of a copy from the yarn as it was built; mm
};

// Yarns moved apart: before and after. Lengths in mm, changes relative.
struct RelaxReport {
  struct State {
    std::size_t overlaps = 0;
    double depth = 0;  // of the deepest
    std::optional<double> min_gap;
  };
  struct Jam {
    std::string a, b;
    double gap = 0;  // the largest that was reached; negative: an overlap
    Vec3 at = Vec3::Zero();
  };
  bool solved = false;
  int iterations = 0;
  State before, after;
  double largest_move = 0;
  std::string moved_most;                                        // the yarn; empty: none moved
  double area_change = 0, length_change = 0, volume_change = 0;  // the largest ones
  std::string reason;                                            // where not solved
  std::vector<Jam> jams;

  [[nodiscard]] bool is_moved() const { return iterations > 0; }
};

struct MeshReport {
  struct Region {
    std::string name, kind;  // kind: "yarn" or "matrix"
    std::size_t elements = 0;
    double volume = 0;
    std::optional<double> exact_volume;  // of the B-spline solid; none: not known
    double min_dihedral = 0;
  };
  struct Worst {
    double min_dihedral = 0;
    std::string region;
    Vec3 at = Vec3::Zero();
  };
  std::size_t nodes = 0, tets = 0;
  std::optional<std::size_t> hexahedra;     // of voxels, instead of tets
  double min_dihedral = 0, max_aspect = 0;  // of tetrahedra
  double volume = 0;
  double volume_error = 0;  // relative to the B-spline yarns, >= 0
  // Elements below the angle that was wanted, and how many of them stand in wedges of the geometry; none: no
  // angle was wanted.
  std::optional<std::size_t> below_target, in_wedges;
  // Of a unit cell.
  std::optional<double> estimate;    // tetrahedra, before it was meshed
  std::optional<double> yarn_share;  // of the cell's volume
  std::string periodic;              // "x y"
  std::size_t equations = 0, load_cases = 0;
  std::vector<Region> regions;
  std::vector<Worst> worst;  // at most ten, worst first
};

// Through one format and back. Lengths in mm, volumes in mm3.
struct RoundtripReport {
  std::string format;
  std::string error;  // why it did not come back; empty: it did
  bool equal = false;
  double seconds = 0;
  double largest = 0;  // deviation: a bound on the distance, or of control points
  std::string largest_of;
  std::size_t yarns_before = 0, yarns_after = 0, closed_before = 0, closed_after = 0;
  double volume_before = 0, volume_after = 0;  // of all yarns
  struct Yarn {
    std::string name;
    double deviation = 0;
  };
  std::vector<Yarn> yarns;
  std::vector<std::string> differences, notes;
};

struct InputReport {
  std::string path;
  std::string settings;  // what the outputs depend on beside the input: `--resume` compares it
  bool ok = false;
  double seconds = 0;
  std::string sha256;
  std::optional<Unit> units;
  std::optional<std::size_t> yarn_count;
  std::map<std::string, std::uint64_t> entities, unknown;  // of a CAD input, by their names: `info`
  std::vector<YarnReport> yarns;
  std::vector<PieceReport> pieces;
  std::optional<std::vector<OverlapReport>> overlaps;  // none: not looked for
  std::optional<std::vector<ContactReport>> contacts;  // none: not asked for
  std::optional<double> min_gap;
  std::optional<double> creo_absolute_accuracy;
  std::vector<OutputReport> outputs;
  std::optional<InstancesReport> instances;
  std::optional<RelaxReport> relax;
  std::optional<MeshReport> mesh;
  std::vector<RoundtripReport> roundtrips;
  std::vector<Message> messages;
};

// One JSON object as text.
std::string to_json(const InputReport& report);

struct Counts {
  std::size_t inputs = 0, done = 0, failed = 0, skipped = 0;
};

// The whole report; `inputs` are the texts of to_json(), empty ones (not done yet) are left out.
std::string whole_report(const std::string& started, double seconds, bool ok, const Counts& counts,
                         const std::vector<std::string>& inputs);

// An earlier report: the entry of each path as JSON text. Errors: io, malformed.
Result<std::map<std::string, std::string>> read_entries(const std::string& report_path);

// True when `entry` (JSON text of an earlier run) says that this input, with these settings, gave whole
// outputs at `output_paths` that are still there, byte for byte.
bool is_still_valid(const std::string& entry, const std::string& input_sha256, const std::string& settings,
                    const std::vector<std::string>& output_paths);

// The entry of an earlier run with `"skipped": true`.
std::string marked_skipped(const std::string& entry);

}  // namespace selvage::pipeline
