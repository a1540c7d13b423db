// Forming of dry cloth in one explicit step: what is gripped and how that moves, the plates that press, and
// how long the increments of the step may be.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "fem/mesh.h"

namespace selvage::fem {

enum class FormingLoad {
  biaxial,    // the yarn ends at the four edges are moved outwards
  bias,       // a cloth cut at 45 degrees to its yarns is pulled along the longer one of x and y
  frame,      // the four edges are the bars of a hinged frame, which is sheared
  compaction  // two rigid plates press the cloth along z
};
// "biaxial", "bias", "frame", "compaction".
std::string_view name_of(FormingLoad load);

struct FormingOptions {
  FormingLoad load = FormingLoad::biaxial;
  // Biaxial, bias: elongation, mm; none: a hundredth (of each direction), a tenth of the length. Frame: shear
  // angle, degrees, below 90; none: 30. Compaction: how much thinner, mm; none: a fifth.
  std::optional<double> stroke;
  std::optional<double> thickness;  // compaction, instead of `stroke`: between the plates at the end, mm
  double friction = 0.3;            // Coulomb's coefficient
  std::optional<double> duration;   // of the step, s; none: slow enough as a rule (plan_forming)
  std::string file{};               // as messages name it
};

// A value by the share of the step's time that has passed, from 0 to 1 in equal steps.
struct MotionCurve {
  std::string name;
  bool is_smooth_step = false;  // t^3 (10 - 15 t + 6 t^2)
  std::vector<std::array<double, 2>> points;
};

// Nodes of the yarns that move as one, or a plate. Directions without a motion are held.
struct RigidPart {
  struct Motion {
    int direction = 0;      // 0, 1, 2: along x, y, z, mm; 3, 4, 5: about them, radians
    std::size_t curve = 0;  // index into Forming::curves
    double factor = 0;
  };
  std::string name;               // GripXLow, GripXHigh, GripYLow, GripYHigh, PlateLow, PlateHigh
  Vec3 reference = Vec3::Zero();  // the point that the displacements are those of, mm
  double size = 0;                // of a cube that would hold about as much, mm
  std::vector<std::size_t> grip;  // nodes of the mesh, increasing; empty: a plate
  // Of a plate: its face, which looks at the cloth (counter-clockwise seen from there); indices into `nodes`.
  std::vector<Vec3> nodes;
  std::vector<std::array<std::size_t, 4>> quads;
  std::vector<Motion> motions;
};
// All of their names.
std::span<const std::string_view> names_of_rigid_parts();

// The time that a wave needs through the smallest element: an estimate of the longest stable increment.
struct StableIncrement {
  double time = 0;          // s
  std::size_t element = 0;  // of Mesh::elements
  double length = 0;      // mm: of a tetrahedron its least height (of ten nodes half of it), of a hexahedron
                          // or wedge its volume over its largest side, of a beam its own
  double wave_speed = 0;  // mm/s: of pressure waves in the stiffest direction; of beams along them
};

struct Forming {
  FormingLoad load = FormingLoad::biaxial;
  std::array<double, 2> stroke{};  // as of FormingOptions; biaxial: along x and along y, else the first
  double friction = 0;
  double duration = 0;                        // s
  double mass = 0;                            // of the yarns, tonne
  double thickness = 0, final_thickness = 0;  // compaction: of the cloth, between the plates at the end; mm
  std::size_t loose_ends = 0;                 // ends of yarns that no grip holds
  std::vector<MotionCurve> curves;
  std::vector<RigidPart> parts;
  StableIncrement stable;
  [[nodiscard]] double increments() const { return duration / stable.time; }
};

// Of dry yarns, which a cell may have cut: then what stands on its faces is gripped, else the ends of yarns,
// by the axis along which they look. `radii`: of each region of beams, mm, half of its thickness; empty: of
// solids. The frame's kinematics are closed: its bars stay as long as they are, and turn by half the shear
// angle each. A step without a given duration takes 20 passages of a wave along the longest yarn, or as long
// that nothing moves faster than 5 m/s on average. Plates stand off the cloth by a hundredth of its
// thickness.
// Errors: unsupported: a material without density; a load case that the cloth cannot take; geometry: a stroke
// that is too long.
Result<Forming> plan_forming(const Mesh& mesh, std::span<const double> radii, const FormingOptions& options);

// The pressure wave of a material, in its stiffest direction, or along a beam; mm/s. Precondition: it has
// elastic constants and a density.
double wave_speed(const fabric::Material& material, bool in_beams);

// Precondition: the same of all materials; the mesh has elements.
StableIncrement stable_increment(const Mesh& mesh);

}  // namespace selvage::fem
