// A fabric as its text says it: every statement of Fabric TXT (formats/txt/README.md), typed, checked for
// grammar but not yet built. Numbers are as written, in the file's unit.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cad/model.h"
#include "core/diagnostics.h"
#include "core/parallelepiped.h"
#include "core/units.h"
#include "core/vec.h"
#include "nurbs/bezier_fit.h"
#include "nurbs/interpolate.h"
#include "yarn/body.h"
#include "yarn/grid.h"
#include "yarn/path.h"
#include "yarn/section.h"

namespace selvage::fabric {

using yarn::Color;
using yarn::Role;

struct LinearDensity {
  enum class Measure { tex, dtex, denier, nm, ne };
  double value = 0;
  Measure measure = Measure::tex;
  [[nodiscard]] double tex() const;  // g/km; dtex / 10, denier / 9, 1000 / Nm, 590.5412... / Ne
  // Length per mass, not mass per length: the finer the yarn, the larger the number.
  [[nodiscard]] bool is_indirect() const { return measure == Measure::nm || measure == Measure::ne; }
  // In the same measure, of a yarn of so many times the mass per length.
  [[nodiscard]] LinearDensity times(double mass) const {
    return {is_indirect() ? value / mass : value * mass, measure};
  }
  bool operator==(const LinearDensity&) const = default;
};

// As Fabric TXT has it: tex, dtex, denier, Nm, Ne.
constexpr std::string_view name_of(LinearDensity::Measure measure) {
  constexpr std::array<std::string_view, 5> names{"tex", "dtex", "denier", "Nm", "Ne"};
  return names[static_cast<std::size_t>(measure)];
}

enum class Hand { z, s };

struct Twist {
  double turns = 0;  // per metre
  Hand hand = Hand::z;
  bool rotates = false;  // the section turns with it
  bool operator==(const Twist&) const = default;
};

struct Plies {
  int count = 0;
  double turns = 0;  // of the ply, per metre
  Hand hand = Hand::s;
  bool operator==(const Plies&) const = default;
};

// What a yarn is made of. In a yarn block the same statements override the named thread's, one by one.
struct Thread {
  std::string name;
  TextPlace place;
  std::optional<LinearDensity> linear_density;
  std::optional<double> density;   // of the fibre, g/cm3
  std::optional<double> packing;   // 0 < packing <= 1
  std::optional<double> diameter;  // file units
  std::optional<yarn::Section> section;
  std::optional<Twist> twist;
  std::optional<Plies> plies;
  std::optional<int> filaments;
  std::optional<Color> color;
  std::optional<std::string> material;

  // What its material says where the thread does not; of the fibres.
  std::optional<double> material_density, material_packing;
  [[nodiscard]] std::optional<double> fibre_density() const { return density ? density : material_density; }
  // Of a monofilament all of the section is fibre.
  [[nodiscard]] std::optional<double> size_packing() const {
    if (packing) return packing;
    return filaments == 1 ? std::optional(1.0) : material_packing;
  }
};

struct IsotropicElastic {
  double modulus = 0;  // MPa
  double poisson = 0;
  bool operator==(const IsotropicElastic&) const = default;
};
// 1 is along the yarn.
struct TransverseElastic {
  double e1 = 0, e2 = 0;  // MPa
  double nu12 = 0;
  double g12 = 0;  // MPa
  double nu23 = 0;
  bool operator==(const TransverseElastic&) const = default;
};
struct Expansion {
  double along = 0, across = 0;  // 1/K
  bool operator==(const Expansion&) const = default;
};

// Of a quantity whose flux follows the gradient of a potential; isotropic where both are equal. Both > 0.
struct Transport {
  double along = 0, across = 0;  // of a yarn
  bool operator==(const Transport&) const = default;
};

// How a surface at which a material ends holds on to another one: what opens it (normal), and what slides
// along it (shear). All > 0; strength and energy are there both, or neither.
struct Interface {
  struct Pair {
    double normal = 0, shear = 0;
    bool operator==(const Pair&) const = default;
  };
  std::optional<Pair> stiffness;  // traction by opening, MPa/mm
  std::optional<Pair> strength;   // largest traction, MPa
  std::optional<Pair> energy;     // of fracture, N/mm (kJ/m2)
  bool operator==(const Interface&) const = default;
};

// The largest stresses, all > 0, MPa. Of a material alike in all directions.
struct IsotropicStrength {
  double tension = 0, compression = 0;
  std::optional<double> shear;
  bool operator==(const IsotropicStrength&) const = default;
};
// 1 is along the yarn.
struct TransverseStrength {
  double tension = 0, compression = 0;  // along
  struct Across {
    double tension = 0, compression = 0;
    double s12 = 0;  // shear along
    double s23 = 0;  // shear across
    bool operator==(const Across&) const = default;
  };
  std::optional<Across> across;  // none: of fibres
  bool operator==(const TransverseStrength&) const = default;
};

struct Material {
  std::string name;
  TextPlace place;
  std::optional<double> density;  // g/cm3
  std::optional<double> packing;  // share of a yarn's section that such fibres fill, 0 < packing <= 1
  std::variant<std::monostate, IsotropicElastic, TransverseElastic> elastic;
  std::variant<std::monostate, IsotropicStrength, TransverseStrength> strength;
  std::optional<Expansion> expansion;
  std::optional<Transport> conductivity;  // of heat, W/(m K)
  std::optional<Transport> diffusivity;   // mm2/s
  std::optional<Transport> permittivity;  // over that of a vacuum
  std::optional<Interface> interface;     // for `mesh --interface cohesive`
};

// The size of the section at one path point.
struct SizeAt {
  double width = 0, height = 0;
  std::optional<double> angle;  // degrees, rotation about the path
  bool operator==(const SizeAt&) const = default;
};

// A section by its control points, round the path; a file has them by name.
struct Outline {
  std::string name;
  TextPlace place;
  std::vector<Vec2> points;
};

// The section at one path point: on the way between two outlines of as many points.
struct OutlineAt {
  std::string from, to;  // `to` is empty: `from` alone
  TextPlace place;
  double share = 0;   // of `to`, 0 .. 1
  double weight = 1;  // of its control points
};

struct Path {
  yarn::PathForm form = yarn::PathForm::chord;
  TextPlace place;
  std::vector<Vec3> points;
  // Empty when no row carries a size; else one entry a point (a row without a size has nullopt).
  std::vector<std::optional<SizeAt>> sizes;
  // Empty when no row names an outline; else one entry a point. Such a yarn is lofted (fabric/loft.h).
  std::vector<std::optional<OutlineAt>> outlines;
  // Empty when no row has the word `fixed`; else one entry a point: it stays where it is when yarns are moved
  // apart.
  std::vector<bool> fixed;
  std::vector<int>
      lines;         // source line of each row; empty when the rows stand on consecutive lines after `place`
  double error = 0;  // smooth: how far rows may be from the centre line, file units
  std::vector<double> knots;  // control: of the clamped cubic, rows + 4; empty: uniform
};

// A path or a grid that stands in a file of points: `points FILE`. The pipeline puts it there
// (pipeline/named_files.h).
struct PointsFile {
  std::string file;
  std::string yarn;             // which one of the file; empty: it has one
  std::optional<double> error;  // of a smooth path, file units; none: the line as the file says it
  TextPlace place;
};

// Round the z axis, from z = 0 upwards.
struct Helix {
  TextPlace place;
  double radius = 0, pitch = 0;  // file units
  double turns = 0;
  bool is_left = false;
  double start = 0;  // angle from the x axis at z = 0, degrees
};

// Control points of the surface itself. `closed_along`: the word `closed` of the grid, not that of the yarn.
struct Grid : yarn::GridNet {
  TextPlace place;
  std::array<std::optional<Vec3>, 2> fan_centres;  // at the start, at the end; none: the section's
};

// A yarn as it was read from a CAD file, end faces and all: name, role, colour, group, surface, axis,
// quarters, and of the end faces style and surface. What follows from these (which way normals point,
// lengths, volume, bends) is found when it is built.
using ReadBody = std::shared_ptr<const yarn::Body>;

struct Yarn {
  std::string name;
  TextPlace place;
  std::string group;   // the yarn whose ply or filament this is; mostly empty
  std::string thread;  // empty: the statements are all inline
  TextPlace thread_place;
  Thread own;  // inline statements; its name is empty
  std::optional<Role> role;
  std::optional<yarn::EndTangent> tangent_start, tangent_end;
  std::optional<Vec3> up;
  TextPlace up_place;
  bool closed = false;
  std::optional<std::array<yarn::EndStyle, 2>> ends;  // of its start and its end; none: not said
  std::variant<std::monostate, Path, Grid, ReadBody, PointsFile, Helix> shape;
};

// What stands in a text of a body beside its thread, its statements and its shape.
Yarn yarn_like(const yarn::Body& body);

// Threads used in turn: `W1,W2`.
struct WeaveSystem {
  std::vector<std::string> threads;
  TextPlace place;
  int count = 0;
  double pitch = 0;
  std::optional<double> counted_on{};  // mm: the text counts yarns on a length, an inch or 10 mm
  bool is_drawn = false;               // a drawing's: its threads are as thick as looks well
  int ends_of_one = 1;  // with warp pile 2: an end of ground and one of pile for each of the text
};

struct Draft {
  enum class Form { rows, plain, twill, satin, basket, leno, corduroy, velveteen, file };
  Form form = Form::plain;
  TextPlace place;
  std::vector<std::string> rows;  // of '0' and '1', top row = weft 1
  int a = 0, b = 0;               // twill a/b/..., satin a/b (0: the trade's step), basket a/b; corduroy,
                                  // velveteen: a ends to a repeat
  std::vector<int> further;       // of a twill: over, under, ... behind the first two
  Hand hand = Hand::z;            // of a twill: which way its diagonal rises
  bool warp_faced = false;        // satin
  bool full_turns = false;        // leno: the doup ends go all round their standing ends
  std::string file;
  // Pile picks among its picks, whose floats are cut.
  [[nodiscard]] bool has_pile() const { return form == Form::corduroy || form == Form::velveteen; }
};

// Warp pile: an end of pile beside each end of the warp.
struct WarpPile {
  enum class Side { face, back, both };  // both: of ends in turn
  TextPlace place;
  double height = 0;   // over the ground, file units
  std::string thread;  // empty: the first one of the warp
  int picks = 3;       // from loop to loop
  Side side = Side::both;
  bool is_cut = false;
};

// A yarn of a weave with straight yarns that runs along the warp, in gaps between warps, and through the
// layers.
struct Binder {
  std::string thread;
  TextPlace place;
  int every = 1;            // every how many gaps there is one
  int first = 1;            // the gap of the first one; gap 1 is between warp 1 and warp 2
  std::vector<int> levels;  // at weft 1, 2, ...; how many layers of weft are below it; repeats
};

// One of the warps that lie above each other in a column, each with its own way through the layers of weft.
struct StackedWarp {
  std::string thread;  // empty: that of the column
  TextPlace place;
  std::vector<int> levels;  // at weft 1, 2, ...; how many layers of weft are below it; repeats
};
using WarpColumn = std::vector<StackedWarp>;  // from the lowest

// Seersucker: warps in stripes, one group longer than the other, so that its stripes stand out of the cloth
// in waves.
struct Pucker {
  TextPlace place;
  int tight = 1, slack = 1;  // warps of each group, in turn
  double ratio = 1;          // of the slack warps' length to that of the tight ones, > 1
  int picks = 1;             // from wave to wave
};

struct Weave {
  enum class Profile { peirce, sine, lenticular, racetrack, straight };
  TextPlace place;
  WeaveSystem warp, weft;
  Draft draft;
  std::optional<Profile> profile;
  std::optional<double> amplitude;  // sine: of both systems, file units
  std::optional<double> crimp;      // the warp's share of the crimp height, 0 .. 1
  std::optional<double> thickness;  // of the cloth (of a layer), at most; file units
  // Between plates that press each layer: until fibres are this fraction of the cloth, or with a pressure,
  // MPa.
  std::optional<double> fraction, pressure;
  [[nodiscard]] bool is_pressed() const { return fraction || pressure; }
  enum class Spacing { even, relaxed };
  std::optional<Spacing> spacing;
  // Equilibrium of the cloth under the tensions of its two systems. loom: those of weaving, wefts nearly
  // straight; relaxed: little tension in both; finished: equal tensions in both. None: finished, but where a
  // formula is asked for (a profile, a pucker, leno, sections other than circles and ellipses).
  enum class State { loom, relaxed, finished };
  std::optional<State> state;
  std::optional<Pucker> pucker;
  std::optional<int> layers;
  std::vector<Binder> binders;
  std::vector<WarpColumn> columns;  // used in turn, in the place of a draft: layers are those of weft
  std::optional<WarpPile> pile;
};

// A user's own loop, as data points from its beginning to its end. Weft knits: x in wales from the left side
// of the wale, y in courses from the course's lower crossings. Warp knits: x in wales from the middle of the
// needle, y in courses from the course's line, of an overlap that begins on the needle's right. z in
// thicknesses of the thickest yarn, to the face.
struct OwnLoop {
  char sign = 'K';  // weft knits: of the chart
  TextPlace place;
  std::vector<Vec3> points;
};
inline constexpr std::size_t most_points_of_a_loop = 11;  // of a warp knit

// What becomes of a loop of a chart before a loop is drawn through it, other than staying on its needle.
struct LoopMove {
  TextPlace place;
  int row = 1, wale = 1;    // of the chart, from the bottom left
  int right = 0;            // a transfer, so many wales to the right
  bool is_dropped = false;  // or: it leaves its needle, and nothing is drawn through it
};

struct Knit {
  enum class Form {
    jersey,
    purl,
    rib,
    interlock,
    full_cardigan,
    half_cardigan,
    milano,
    half_milano,
    jacquard,
    chart
  };
  // Where the needles of the back bed stand: each in a wale of its own, or opposite those of the front bed.
  enum class Gating { rib, opposite };
  TextPlace place;
  Form form = Form::jersey;
  int rib_a = 0, rib_b = 0;
  std::vector<std::string> threads;  // in turn, a row of the chart each
  TextPlace thread_place;
  int courses = 0, wales = 0;
  double course_pitch = 0, wale_pitch = 0;  // 0: as they follow from the yarn
  std::optional<double> loop;               // the length of a stitch
  std::optional<double> unit;               // of the published loop: its r; none: half the yarn's thickness
  std::optional<Vec3> crossing;             // where the yarns of the first stitch cross, in its middle
  // Of given lengths: the published loop, spread to them, or the one that bends least.
  enum class Shape { published, relaxed };
  std::optional<Shape> shape;
  std::vector<OwnLoop> own_loops;  // of each sign of the chart, or none at all
  std::optional<int> feeds;        // rows of the chart in a course
  std::optional<Gating> gating;
  std::optional<double> bed_distance;  // between the middle planes of both beds' loops
  std::string plating;                 // a second thread, knitted behind the others; empty: none
  std::optional<double> pile;          // its sinkers stand out of the back by this
  bool pile_is_cut = false;
  std::optional<nurbs::Parameterization> method;
  std::vector<std::string> chart;  // of 'K', 'P', 'T', 'U', 'M', '.', top row = last course, or of a jacquard
                                   // '1', '2', ...; else empty
  TextPlace chart_place;
  std::vector<int> chart_lines;  // source line of each row; may be empty
  std::vector<LoopMove> moves;   // of loops that cross or meet, from the technical face to the back
};

struct WarpknitBar {
  std::string thread;
  TextPlace place;
  std::string lapping;      // as written, blanks kept as they separate the overlaps
  TextPlace lapping_place;  // of its first character
  bool fall_plate = false;
  std::optional<OwnLoop> own_loop;
};

// Straight yarns across a warp knit, between its loops and its underlaps.
struct WarpknitWeft {
  std::vector<std::string> threads;  // in turn
  TextPlace place;
  int every = 1;  // every how many courses
  int first = 1;  // the course of the first one, from 1
};

struct Warpknit {
  enum class Stitch { closed, open };
  TextPlace place;
  std::string classic;  // tricot, satin, queens-cord, ...; empty: the bars say it
  std::string thread;   // of a classic
  TextPlace thread_place;
  std::vector<WarpknitBar> bars;
  std::optional<WarpknitWeft> weft;
  int wales = 0, courses = 0;
  double wale_pitch = 0, course_pitch = 0;
  std::optional<Stitch> stitch;
  std::optional<double> substrate;  // thickness of the layers that it stitches together
};

// A place of a mandrel's axis, and the radius of the cloth's middle surface there; file units.
struct MandrelRow {
  Vec3 axis = Vec3::Zero();
  double radius = 0;
};

struct Braid {
  TextPlace place;
  std::string thread;
  TextPlace thread_place;
  int carriers = 0;  // even but on a strip
  TextPlace carriers_place;
  int over = 1, under = 1;          // pattern 2/2
  bool flat = false;                // a strip instead of a tube
  bool planar = false;              // a tube's cloth laid flat instead
  double radius = 0;                // of a tube
  std::vector<MandrelRow> mandrel;  // of a tube, instead of radius and length: its axis goes through them
  double width = 0;                 // of a strip or a planar braid; 0: what its yarns need
  TextPlace radius_place;           // of `radius`, `flat` or `planar`
  double angle = 0 /* degrees */, length = 0;
  std::string axial_thread;
  TextPlace axial_place;
  int axial_count = 0;
};

struct PieceCurve {
  // c, s, found: a Bezier near its fixed points. control: the points are the control points of the clamped
  // uniform cubic; spline: the clamped cubic goes through them.
  enum class Shape { found, c, s, control, spline };
  std::string name;
  TextPlace place;
  bool is_line = false;
  Shape shape = Shape::found;
  std::optional<nurbs::PointParameters> by;  // none: `distance` where a curve cannot meet all points, else
                                             // `uniform`
  std::optional<nurbs::Parameterization> method;  // of a spline; none: chord
  std::vector<Vec2> points;                       // a line has two
  std::vector<double> weights;                    // of control and spline: one a point; empty: all are 1
  std::vector<double> knots;                      // of control: points + 4 over [0, 1]; empty: uniform
};

// The length of curves of a piece together, and what is added to it.
struct LengthOf {
  std::string piece;
  std::vector<std::string> curves;
  double ease = 0;
};

struct Edit {
  enum class Form { point, weight, length };
  TextPlace place;
  std::string yarn;  // in a piece: the curve
  Form form = Form::point;
  int joint = 0;                  // 1-based
  Vec3 target = Vec3::Zero();     // point, weight: goes there
  double length = 0;              // length
  std::optional<LengthOf> like;   // in a piece, instead of `length`
  Vec3 direction = Vec3::Zero();  // length: along
};

struct Piece {
  std::string name;
  TextPlace place;
  std::vector<PieceCurve> curves;
  std::vector<Edit> edits;  // of its curves, in the plane
};

// One step on the way of a used block to its place.
struct Move {
  enum class Form { place, rotate, mirror, shear };
  Form form = Form::place;
  Vec3 by = Vec3::Zero();  // place
  int axis = 2;            // rotate: about it; mirror: across it; shear: along it
  int across = 1;          // shear: the farther along this axis, the farther along `axis`
  double angle = 0;        // rotate, shear: degrees
};

// The yarns of a block, or of another text, at another place.
struct Use {
  TextPlace place;
  std::string what;      // the block's name, or the file's
  bool is_file = false;  // not yet read
  std::string as;        // what its yarns' names begin with; empty: the block's name
  // Copies side by side, along the block's own x and y, before it is moved.
  std::array<int, 2> repeats{1, 1};
  std::optional<std::array<double, 2>> steps;  // from copy to copy; none: the block's own repeat
  std::vector<Move> moves;                     // one after the other
};

struct Fabric;

// A fabric by name, to be used. What it does not define itself it has from the text round it.
struct NamedBlock {
  std::string name;
  TextPlace place;
  std::shared_ptr<Fabric> fabric;
  std::shared_ptr<const Fabric> home;  // where it was defined; null: in the fabric that it is in
};

// So many of the smallest repeats of the cloth, as high as its yarns.
struct CellOfRepeats {
  std::array<int, 2> counts{1, 1};
  std::optional<double> margin;  // beyond the yarns; none: a tenth of the thinnest one's thickness
};

// The edges of a cell that need be no rectangle, seen along z.
struct CellVectors {
  Vec3 first = Vec3::Zero(), second = Vec3::Zero();  // z: 0
  std::optional<double> height;                      // along z; none: as high as its yarns
  std::optional<Vec3> at;        // the corner from which they go; none: (0, 0, -height / 2)
  std::optional<double> margin;  // as that of CellOfRepeats
};

struct Cell {
  TextPlace place;
  // What says the corners otherwise, which settle_cell() finds.
  std::optional<CellOfRepeats> of_repeats;
  std::optional<CellVectors> of_vectors;
  // Its corners in the coordinates of its own axes, along its edges: those of space where it is a box.
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  ObliqueAxes axes;
  std::string matrix;              // a material; empty: none
  std::array<bool, 3> periodic{};  // along x, y, z, as its text says
  [[nodiscard]] bool names_axes() const { return periodic[0] || periodic[1] || periodic[2]; }
  [[nodiscard]] Parallelepiped shape() const { return {Box3(low, high), axes}; }
};

using Item = std::variant<Yarn, Weave, Knit, Warpknit, Braid, Piece, Use>;

struct Fabric {
  std::string file;  // as messages name it
  std::optional<std::string> title;
  Unit units = Unit::mm;
  bool units_given = false;
  std::optional<double> tolerance;
  std::vector<Thread> threads;
  std::vector<Material> materials;
  std::vector<Outline> outlines;
  std::vector<NamedBlock> blocks;
  std::vector<Item> items;     // in file order
  std::vector<int> item_ends;  // the last line of each item, where they come from a text; else empty
  std::vector<Edit> edits;
  std::optional<Cell> cell;
  // Of a CAD file: what is neither a yarn nor a piece, as it was read, and the file's date and form.
  std::vector<cad::Part> parts;
  std::vector<cad::NamedCurve> curves;
  std::string date;               // YYYYMMDD.HHNNSS; empty: not known
  std::string file_name;          // that it gives itself in its header; empty: none
  bool yarns_are_solids = false;  // IGES: 186s, not groups of 128s
  double resolution = 0;          // below which it calls two points one, file units; 0: it does not say

  [[nodiscard]] const Thread* find_thread(std::string_view name) const;
  // One of the text's own, else a fibre of the trade (fibres.h).
  [[nodiscard]] const Material* find_material(std::string_view name) const;
  // The same, of the text's blocks as well: of a body that any of them made.
  [[nodiscard]] const Material* find_material_anywhere(std::string_view name) const;
  // Tells the threads what their materials say. To be called once all are there.
  void tell_threads_their_materials();
};

// The names of the threads that a construction uses.
std::vector<std::string> threads_of(const Item& item);

// What is asked of a text from outside: another value of one of its params.
struct Setting {
  std::string name, value;
  bool operator==(const Setting&) const = default;
};

// Null: none has that name.
template <class T>
const T* find_named(const std::vector<T>& list, std::string_view name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const T& item) { return item.name == name; });
  return found == list.end() ? nullptr : &*found;
}

// The thread's statements with the yarn's own over them.
Thread resolved_thread(const Fabric& fabric, const Yarn& yarn);

}  // namespace selvage::fabric
