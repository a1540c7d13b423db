#include "pipeline/option_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <deque>
#include <limits>

#include "core/words.h"
#include "formats/registry.h"
#include "pipeline/limits.h"
#include "pipeline/number_list.h"
#include "pipeline/outputs.h"
#include "pipeline/picture_words.h"
#include "pipeline/roundtrip.h"
#include "pipeline/variants.h"
#include "view/picture.h"

namespace selvage::pipeline {

namespace {

using enum Command;
using Commands = std::vector<Command>;
using Take = decltype(Row::take);

const Commands on_batch = {convert, check, relax, mesh, roundtrip, info, view};
const Commands on_yarns = {convert, check, relax, mesh, roundtrip, diff, info, view};
const Commands writing = {convert, relax, mesh, view};

template <class T>
void store(T& to, const std::string& text) {
  if constexpr (std::is_same_v<T, bool>)
    to = true;
  else if constexpr (std::is_arithmetic_v<T>)
    std::from_chars(text.data(), text.data() + text.size(), to);
  else if constexpr (std::is_same_v<T, std::vector<std::string>>)
    to.push_back(text);
  else if constexpr (std::is_same_v<T, std::optional<double>>)
    store(to.emplace(), text);
  else
    to = text;
}

template <class T>
Take into(T Options::*member) {
  return [=](Options& options, const std::string& text) -> Status {
    return store(options.*member, text), Status();
  };
}
template <class Group, class T>
Take into(Group Options::*group, T Group::*member) {
  return [=](Options& options, const std::string& text) -> Status {
    return store(options.*group.*member, text), Status();
  };
}

// The rows as they are declared.
class OptionTable {
 public:
  // A heading of help, for what follows; `of_run` as Option::is_of_run.
  void begin(std::string heading, bool of_run = false) {
    heading_ = std::move(heading);
    of_run_ = of_run;
  }

  Option& option(Commands of, const Option& option, Take take) {
    rows_.push_back({std::move(of), option, std::move(take), heading_});
    return rows_.back().option;
  }
  Option& option(Commands of, std::string_view name, std::string_view help, const Argument& argument,
                 Take take) {
    Option& made = option(std::move(of), {.name = name, .help = help, .argument = argument}, std::move(take));
    made.is_required = !name.starts_with('-');
    made.is_of_run = of_run_;
    return made;
  }
  template <class T>
  Option& option(Commands of, std::string_view name, std::string_view help, const Argument& argument,
                 T Options::*member) {
    return option(std::move(of), name, help, argument, into(member));
  }
  Option& flag(Commands of, std::string_view name, std::string_view help, bool Options::*member) {
    return option(std::move(of), name, help, {}, into(member));
  }
  // One of some words, which stand for `values`.
  template <class T, class Value>
  Option& choice(Commands of, std::string_view name, std::string_view help, std::string_view words,
                 T Options::*member, std::initializer_list<Value> values) {
    const auto take = [=, values = std::vector<Value>(values)](Options& options, const std::string& text) {
      const std::vector<std::string_view> known = words_of(words);
      options.*member =
          values[static_cast<std::size_t>(std::find(known.begin(), known.end(), text) - known.begin())];
      return Status();
    };
    return option(std::move(of), name, help, Argument::one_of(words), take);
  }

  [[nodiscard]] std::deque<Row> take() { return std::move(rows_); }

 private:
  std::string heading_;
  bool of_run_ = false;
  std::deque<Row> rows_;  // where they are, they stay
};

Status take_shard(Options& options, const std::string& text) {
  const auto shard = numbers<2>(text, '/', 0, std::numeric_limits<int>::max());
  if (!shard || (*shard)[0] >= (*shard)[1])
    return error(Kind::usage, fmt::format("'{}' is not I/N with 0 <= I < N, for example 0/4", text));
  options.part = static_cast<std::size_t>((*shard)[0]);
  options.parts = static_cast<std::size_t>((*shard)[1]);
  return {};
}

// Text that is made, for as long as the program runs.
std::string_view kept(std::string text) {
  static std::deque<std::string> all;
  return all.emplace_back(std::move(text));
}

void inputs_and_outputs(OptionTable& t) {
  t.begin("Inputs and outputs", true);
  const Argument file = Argument::text("FILE"), place = Argument::text("PLACE"), unnamed = Argument::text("");
  t.option(on_batch, "INPUT", "files, folders, patterns, @LIST of paths, - for standard input",
           Argument::texts(""), &Options::inputs);
  t.option({edit}, "INPUT", "a text with yarns, or - for standard input", unnamed, &Options::inputs);
  t.option({diff}, "A", "a file of any readable format, or - for standard input", unnamed, &Options::inputs);
  t.option({diff}, "B", "another one, of the same or another format", unnamed, &Options::inputs);
  t.option(writing, "-o,--output",
           "a file (by its extension), a folder, or - for standard output (default: beside the input)", place,
           &Options::output);
  t.option({edit}, "-o,--output", "the new text (may be INPUT), or - for standard output", place,
           &Options::output)
      .required();
  t.option({convert, relax, mesh}, "--to", "formats to write, separated by commas (see selvage formats)",
           Argument::text("FORMAT"), &Options::formats);
  t.option({roundtrip}, "--to",
           kept(fmt::format("formats to go through, separated by commas (default: {})", trip_names())),
           Argument::text("FORMAT"), &Options::formats);
  t.option({convert, relax}, "--file-name",
           "what an IGES or STEP file calls itself in its header (default: the output's own name)",
           Argument::text("NAME"), &Options::file_name);
  t.flag({info, diff}, "--json", "one JSON object instead of text", &Options::json);
  t.flag(
      {diff, check}, "--all",
      "every difference (default: the first 20 and a count); of check: every finding of a CAD file (default: "
      "one a kind with the worst and a count)",
      &Options::all);
  t.option({check}, "--gap-map",
           kept(fmt::format("write the yarns coloured by the gap to the next one to this file ({})",
                            extension_of_gap_maps())),
           file, &Options::gap_map);
  t.option(on_batch, "--report", "write a JSON report to this file", file, &Options::report);
  t.option({info}, "--csv", "write a table of the data sheets to this file, a row an input", file,
           &Options::csv);
  t.option({check, roundtrip, diff}, "--junit", "write the results as JUnit XML to this file", file,
           &Options::junit);
  t.option(on_batch, "--set", "another value of a param of the input (more than one: selvage sweep)",
           Argument::texts("NAME=VALUE"), into(&Options::sweep, &SweepWords::sets))
      .is_of_run = false;
  t.flag({convert, relax, mesh, view, check}, "--resume",
         "skip inputs that --report says are done, if their outputs are whole", &Options::resume);
}

void of_a_sweep(OptionTable& t) {
  t.begin("The sweep", true);
  t.option({sweep}, "--do", "what is done with each variant; its own options go with it",
           Argument::one_of("check convert mesh info"), [](Options&, const std::string&) { return Status(); })
      .with_preset("check");
  t.option(
      {sweep}, "--set",
      "values of a param: V, or V1,V2,..., or LOW:HIGH:STEP; LOW:HIGH with --lhs (several: all combinations)",
      Argument::texts("NAME=VALUES"), into(&Options::sweep, &SweepWords::sets));
  t.option({sweep}, "--table", "a CSV file: its columns are params, and each row is a variant",
           Argument::text("FILE"), into(&Options::sweep, &SweepWords::table))
      .goes_with("lists variants", "", "--lhs");
  t.option({sweep}, "--lhs", "so many variants, a Latin hypercube of the ranges that --set gives",
           Argument::whole(1, static_cast<std::int64_t>(most_variants)),
           into(&Options::sweep, &SweepWords::samples));
  t.option({sweep}, "--seed", "another hypercube", Argument::whole(0, std::numeric_limits<int>::max()),
           into(&Options::sweep, &SweepWords::seed))
      .with_preset("1")
      .goes_with("is of a hypercube", "--lhs", "");
  t.option({sweep}, "--csv", "the table of parameters and results", Argument::text("FILE"), &Options::csv)
      .with_preset("sweep.csv");
}

void of_yarns(OptionTable& t) {
  t.begin("Yarns");
  t.option({convert, check, relax, mesh, info, view}, "--tolerance",
           "of tubes, and of the surfaces of a TexGen model, in the input's unit, instead of the input's own",
           Argument::positive(), &Options::tolerance);
  t.option(
      {roundtrip, diff}, "--tolerance",
      "distances up to this, in the first input's unit, are no difference (default: 0, every bit counts)",
      Argument::non_negative(), &Options::difference_tolerance);
  t.choice(
      {convert, relax, check, info}, "--units",
      "of surfaces that are written, and of lengths that are shown (default: the input's, which costs no "
      "bits)",
      "m cm mm um inch", &Options::units, {Unit::m, Unit::cm, Unit::mm, Unit::um, Unit::inch});
  t.option({convert, relax}, "--chord",
           "how far triangles may be from the surfaces that they stand for, in the input's unit (default: "
           "1/100 of the yarn's thinnest section)",
           Argument::positive(), &Options::chord)
      .goes_with("is of triangles", "", "--cut --matrix --lines");
  t.choice({convert, check, relax, mesh, roundtrip, info}, "--ends",
           "how a yarn is sealed (default: as the input has it, else patch)", "patch fan planar none",
           &Options::ends,
           {yarn::EndStyle::patch, yarn::EndStyle::fan, yarn::EndStyle::planar, yarn::EndStyle::none});
  t.choice(
       on_yarns, "--detail",
       "how far yarns are taken apart, where their threads say so; usual: into filaments up to 300 of them",
       "yarn plies usual filaments", &Options::detail,
       {fabric::Detail::yarn, fabric::Detail::plies, fabric::Detail::usual, fabric::Detail::filaments})
      .with_preset("usual");
  t.choice(on_yarns, "--digits",
           "of the tubes' control points: as few as the tolerance needs, or all that the computation has",
           "short full", &Options::full_digits, {false, true})
      .with_preset("short");
  t.flag(on_yarns, "--as-published", "constructions exactly as their paper gives them, overlaps and all",
         &Options::as_published);
  t.flag(on_yarns, "--strict", "a warning fails its input", &Options::strict);
  t.flag({convert, relax}, "--instances",
         "yarns that are equal up to a motion are written once and placed, where the format can (not every "
         "system reads such references)",
         &Options::instances)
      .goes_with("repeats yarns that are whole", "", "--cut --matrix");
  t.flag({convert}, "--lines",
         "the yarns' centre lines instead of their surfaces, as curves (svg: seen from above), or as points "
         "where the format has these",
         &Options::lines)
      .goes_with("writes centre lines, not solids", "", "--cut --matrix --instances");
  t.option({check, view}, "--reach", "near contacts, too, up to this", Argument::positive(), &Options::reach);
  t.flag({info}, "--table",
         "garment curves: each fixed point's error, and the control points by both methods", &Options::table);
}

void of_an_edit(OptionTable& t) {
  t.begin("The edit");
  t.option({edit}, "--yarn", "the name of the yarn whose centre line is edited", Argument::text("NAME"),
           into(&Options::edit, &EditWords::yarn));
  t.option({edit}, "--piece", "instead of --yarn: the garment piece whose --curve is edited",
           Argument::text("NAME"), into(&Options::edit, &EditWords::piece));
  t.option({edit}, "--curve", "the name of the curve in the outline of --piece", Argument::text("NAME"),
           into(&Options::edit, &EditWords::curve));
  t.option({edit}, "--point", "which joint of the curve, from 1",
           Argument::whole(1, std::numeric_limits<int>::max()), into(&Options::edit, &EditWords::point))
      .required();
  t.option({edit}, "--to", "where the joint goes, in the file's unit (of a --piece X,Y)",
           Argument::text("X,Y,Z"), into(&Options::edit, &EditWords::to));
  t.option({edit}, "--by", "what moves it: a control point, or a weight", Argument::one_of("control weight"),
           into(&Options::edit, &EditWords::by))
      .with_preset("control");
  t.option({edit}, "--length", "instead of --to: the length that the curve gets", Argument::text("L"),
           into(&Options::edit, &EditWords::length));
  t.option({edit}, "--along", "the direction in which the joint moves for --length", Argument::text("X,Y,Z"),
           into(&Options::edit, &EditWords::along));
}

void of_a_picture(OptionTable& t) {
  t.begin("The picture");
  using enum view::From;
  t.choice({view}, "--from",
           "where the eye is; plan: above, the warp or wales upright; top: above, x to the right; side: +x "
           "(default: plan; of a section across x side, across y front)",
           "plan top bottom front back side iso", &Options::from,
           {plan, top, bottom, front, back, side, iso});
  t.option({view}, "--azimuth", "about z, degrees: 90 side", Argument::between(-360, 360), &Options::azimuth)
      .goes_with("is of an eye elsewhere", "", "--from");
  t.option({view}, "--elevation", "above, degrees: 90 top", Argument::between(-90, 90), &Options::elevation)
      .goes_with("is of an eye elsewhere", "", "--from");
  t.option({view}, "--zoom", "nearer", Argument::between(0.01, 1000), &Options::zoom).with_preset("1");
  t.option({view}, "--yarns", "only these; * is anything", Argument::texts("NAME"), &Options::shown_yarns);
  t.option(
      {view}, "--section",
      "cut at this plane, in the input's unit, such as z=0: what lies on the eye's side of it is left out",
      Argument::text("AXIS=PLACE"), take_section);
  t.option({view}, "--field",
           "colours by this field of a mesh's results: a name of the file's, displacement, stress or strain; "
           "perhaps with a part: stress.mises, stress.fibre, stress.xx, displacement.x",
           Argument::text("NAME[.PART]"), &Options::field);
  t.option({view}, "--step", "results of this step, in the order of the file (default: the last)",
           Argument::whole(1, 1'000'000), &Options::step);
  t.option({view}, "--range",
           "values of the ends of the colours, such as 0:250 (default: the least and the largest)",
           Argument::text("LOW:HIGH"), take_value_range)
      .goes_with("is of a field's values", "--field", "");
  t.option({view}, "--deformed",
           "moves a mesh by its displacements times this; auto: the largest is a twentieth of the mesh",
           Argument::text("SCALE"), take_deformed);
  t.choice({view}, "--show-matrix",
           "of a unit cell's mesh: half is what lies behind a plane through the middle (default: half; whole "
           "with --yarns)",
           "whole half none", &Options::shown_matrix,
           {ShownMatrix::whole, ShownMatrix::half, ShownMatrix::none});
  t.option(
      {view}, "--deck",
      "the deck that results are of, which tells yarns, fibres and materials (default: the one beside them "
      "under the same name)",
      Argument::text("FILE.inp"), &Options::deck);
  t.option({view}, "--size", "in pixels", Argument::text("WxH"), take_picture_size).with_preset("1200x900");
  t.option({view}, "--background", "its colour, each 0-255", Argument::text("R,G,B"), take_background)
      .with_preset("255,255,255");
  t.flag({view}, "--flat", "without shadows, which is faster", &Options::flat);
  t.flag({view}, "--no-scale-bar", "without the scale bar at the picture's foot", &Options::no_scale_bar);
  t.choice({view}, "--contacts", "overlaps and near contacts on a page; auto: of few yarns", "auto yes no",
           &Options::page_contacts, {PageContacts::automatic, PageContacts::yes, PageContacts::no})
      .with_preset("auto");
}

void of_a_mesh(OptionTable& t) {
  t.begin("The mesh");
  constexpr std::string_view of_tetrahedra = "is of tetrahedra, and voxels are hexahedra of eight nodes";
  t.choice(
       {mesh}, "--elements",
       "of dry yarns: tetrahedra, hexahedra swept along each yarn (wedges at the tips of its section), "
       "beams with the constants of its sections and a list of the yarns that touch, or trusses, which do "
       "not bend",
       "tet hex beam truss", &Options::elements,
       {Elements::tetrahedra, Elements::hexahedra, Elements::beams, Elements::trusses})
      .goes_with("is of dry yarns, and a unit cell is meshed with tetrahedra or voxels", "",
                 "--cut --matrix --pores --periodic --voxel")
      .with_preset("tet");
  t.option({mesh}, "--size",
           "wanted edge length, in the input's unit (default: a quarter of the thinnest section; of "
           "hexahedra a third; of beams four times it)",
           Argument::positive(), &Options::size)
      .goes_with(of_tetrahedra, "", "--voxel");
  t.option({mesh}, "--order",
           "1: four nodes, 2: ten nodes a tetrahedron (default: 1; 2 of a periodic cell with --matrix, and "
           "of one that is "
           "periodic along one axis, if not --interface cohesive)",
           Argument::one_of("1 2"), &Options::order)
      .goes_with(of_tetrahedra, "", "--voxel", "2");
  t.option({mesh}, "--min-dihedral",
           "wanted smallest angle between faces of a tetrahedron, degrees (default: 10)",
           Argument::between(0.1, 30), &Options::min_dihedral)
      .goes_with(of_tetrahedra, "", "--voxel");
  t.flag({mesh}, "--allow-overlap", "mesh overlapping yarns as they are, with a warning",
         &Options::allow_overlap);
  t.flag({mesh}, "--force",
         "go on where the estimate says more than 10^8 tetrahedra, or yarns nearly touch each other or "
         "a face",
         &Options::force);
}

void of_forming(OptionTable& t) {
  t.begin("The explicit step");
  constexpr std::string_view why = "is of an explicit step";
  using enum fem::FormingLoad;
  t.option({mesh}, "--deck",
           "static: a small tension, or the load cases of a cell; explicit: the forming of dry cloth, with "
           "general "
           "contact and friction (to Abaqus and LS-DYNA)",
           Argument::one_of("static explicit"),
           [](Options& options, const std::string& text) {
             return options.forming.wanted = text == "explicit", Status();
           })
      .goes_with("explicit is of dry yarns", "", "--matrix --pores --periodic --voxel")
      .with_preset("static");
  t.option(
       {mesh}, "--load",
       "biaxial: yarn ends at four edges move outwards; bias: a cloth that was cut at 45 degrees (--cut) is "
       "pulled; frame: the edges are those of a picture frame; compaction: between two rigid plates",
       Argument::one_of("biaxial bias frame compaction"),
       [](Options& options, const std::string& text) {
         for (const fem::FormingLoad load : {biaxial, bias, frame, compaction})
           if (text == fem::name_of(load)) options.forming.load = load;
         return Status();
       })
      .goes_with(why, "--deck", "")
      .with_preset("biaxial");
  t.option({mesh}, "--stroke",
           "elongation, or how much thinner, in the input's unit; of --load frame the shear angle in degrees "
           "(default: 1 %, bias 10 %, frame 30 degrees, compaction 20 %)",
           Argument::positive(), into(&Options::forming, &FormingSettings::stroke))
      .goes_with(why, "--deck", "");
  t.option({mesh}, "--thickness", "instead of --stroke: between the plates at the end, in the input's unit",
           Argument::positive(), into(&Options::forming, &FormingSettings::thickness))
      .goes_with("is of --load compaction", "--load", "--stroke");
  t.option({mesh}, "--friction", "Coulomb's coefficient of yarns on each other and on plates",
           Argument::non_negative(), into(&Options::forming, &FormingSettings::friction))
      .goes_with(why, "--deck", "")
      .with_preset("0.3");
  t.option(
       {mesh}, "--duration",
       "seconds that the step takes (default: 20 passages of a wave along the longest yarn, at most 5 m/s)",
       Argument::positive(), into(&Options::forming, &FormingSettings::duration))
      .goes_with(why, "--deck", "");
}

void of_a_cell(OptionTable& t) {
  t.begin("The unit cell");
  t.flag({convert, mesh}, "--cut", "yarns cut flush by the faces of the input's cell (convert: as solids)",
         &Options::cut);
  t.flag(
      {convert, mesh}, "--matrix",
      "with them what they leave of the cell, the matrix, which shares its faces with theirs (implies --cut)",
      &Options::matrix);
  t.option({mesh}, "--matrix-material",
           "the material of the matrix: a material of the input, or Young's modulus (MPa) and Poisson's "
           "ratio, as "
           "3400,0.35 (default: as the input's cell says)",
           Argument::text("NAME|E,NU"), &Options::matrix_material)
      .goes_with("is of a matrix", "--matrix", "--pores");
  t.flag({mesh}, "--pores",
         "instead of yarns and matrix the space between the yarns, for a fluid: a wall for each yarn, inlet "
         "and outlet on the cell's faces, or with --periodic pairs of them (to OpenFOAM, Gmsh, ANSYS, VTK)",
         &Options::pores)
      .goes_with("is the space that the yarns leave", "",
                 "--cut --matrix --voxel --interface --physics --yarn-stiffness");
  t.option({mesh}, "--layers",
           "with --pores: so many layers of wedges along the walls, each 1.2 times as thick as the one "
           "before it (to OpenFOAM, Gmsh, VTK)",
           Argument::whole(1, 100), &Options::layers)
      .goes_with("is of walls round a fluid", "--pores", "");
  t.option({mesh}, "--layer-thickness",
           "of all these layers together, in the input's unit (default: two fifths of the edges there); less "
           "where the space is narrow",
           Argument::positive(), &Options::layer_thickness)
      .goes_with("is of layers along walls", "--layers", "");
  t.flag({mesh}, "--periodic",
         "opposite faces of the cell get the same nodes, and equations between them (as its "
         "`periodic` says; without that word along every axis that can be)",
         &Options::periodic);
  t.option({mesh}, "--voxel",
           "mesh the cell with so many hexahedra along its longest side instead (always works; yarns "
           "have stairs); to HDF5 and NPZ as fields",
           Argument::whole(1, 10'000), &Options::voxels);
  t.choice(
       {mesh}, "--physics",
       "what the deck finds: stiffness, or the conductivity, diffusivity or permittivity of a cell whose "
       "materials say theirs",
       "elastic conduction diffusion permittivity", &Options::physics,
       {fem::Physics::elastic, fem::Physics::conduction, fem::Physics::diffusion, fem::Physics::permittivity})
      .goes_with("is of a unit cell", "--matrix --periodic --cut --voxel", "--yarn-stiffness")
      .with_preset("elastic");
  t.choice({mesh}, "--twist",
           "follow: the fibres of a thread with a twist lie on helices round its middle, and so do the axes "
           "of its "
           "stiffness; ignore: they run along the yarn",
           "follow ignore", &Options::ignores_twist, {false, true})
      .with_preset("follow");
  t.choice({mesh}, "--yarn-stiffness",
           "given: a yarn's material is the yarn's; chamis: it is its fibres', and the yarn's follows "
           "from the local fibre fraction by Chamis's formulas",
           "given chamis", &Options::chamis, {false, true})
      .goes_with("is of a unit cell", "--matrix --periodic --cut --voxel", "")
      .with_preset("given");
  t.option({mesh}, "--segments", "so many edges go round each yarn, thin or thick",
           Argument::whole(6, 10'000), &Options::segments)
      .goes_with("is of tetrahedra in a unit cell", "--matrix --pores --periodic --cut", "--voxel");
  t.option(
       {mesh}, "--matrix-size",
       "with --matrix or --pores: to which edges may grow away from the yarns, in the input's unit (default: "
       "--size, or twice the edges that are made without it)",
       Argument::positive(), &Options::matrix_size)
      .goes_with("is of tetrahedra between the yarns", "--matrix --pores", "--voxel");
  t.flag({mesh}, "--bond",
         "with --matrix or --pores: yarns in contact share faces (what lies between yarns nearer than 1.5 "
         "times "
         "the gap becomes part of them), instead of a gap filled with matrix",
         &Options::bond)
      .goes_with("joins yarns in a mesh of tetrahedra with its matrix", "--matrix --pores", "--voxel");
  t.choice(
       {mesh}, "--interface",
       "where yarns meet the matrix, and with --bond each other: bonded: they share nodes; surfaces: each "
       "has "
       "nodes of its own, and named surfaces are tied; cohesive: and elements without thickness between them",
       "bonded surfaces cohesive", &Options::joining,
       {fem::Joining::bonded, fem::Joining::surfaces, fem::Joining::cohesive})
      .goes_with("is of yarns in a matrix, where yarns that only keep a gap hold nothing", "--matrix",
                 "--voxel")
      .with_preset("bonded");
}

void of_relaxing(OptionTable& t) {
  t.begin("Moving yarns apart");
  constexpr std::string_view why = "says how yarns are moved apart";
  const Commands all = {convert, relax, mesh};

  t.option({convert, mesh}, "--relax",
           "first move and reshape yarns until none overlap (exit code 3: no solution)", {},
           into(&Options::relaxing, &RelaxSettings::wanted));
  t.option(
       all, "--gap",
       "the least gap between yarns, in the input's unit; of a unit cell, too (default: 1 % of the smaller "
       "thickness; in a cell that is meshed 5 %)",
       Argument::non_negative(), into(&Options::relaxing, &RelaxSettings::gap))
      .goes_with(why, "--relax --matrix --pores --periodic --cut --voxel", "");
  t.option(all, "--overlap",
           "let yarns that meet overlap to this depth, and bring them to it, instead of a gap",
           Argument::positive(), into(&Options::relaxing, &RelaxSettings::overlap))
      .goes_with("lets yarns overlap to a depth", "--relax", "--gap");
  t.option(all, "--stiff-section", "sections keep their shape, only centre lines move", {},
           into(&Options::relaxing, &RelaxSettings::stiff_section))
      .goes_with(why, "--relax", "");
  t.option(all, "--max-iterations", "give up after so many steps", Argument::whole(1, 1'000'000),
           into(&Options::relaxing, &RelaxSettings::max_iterations))
      .goes_with(why, "--relax", "");
}

void of_running(OptionTable& t) {
  t.begin("Running", true);
  const Commands all = {convert, check, relax, mesh, roundtrip, diff, info, edit, view, report};
  Commands side_by_side = on_yarns;
  side_by_side.push_back(report);
  t.option(side_by_side, "-j", "inputs worked on at once (default: one a core)", Argument::whole(1, 4096),
           &Options::workers);
  t.flag(all, "-q,--quiet", "errors only", &Options::quiet);
  t.flag(on_yarns, "-v,--verbose", "say more", &Options::verbose);
  t.flag(side_by_side, "--no-progress", "no progress bar or lines", &Options::no_progress);
  t.choice(side_by_side, "--progress",
           "json: an object a line on standard error, for programs (with -q, too)", "auto json",
           &Options::progress_json, {false, true})
      .with_preset("auto")
      .goes_with("asks for what --no-progress refuses", "", "--no-progress", "json");
  t.option(on_batch, "--shard", "only the I-th of N equal parts of the inputs, from 0", Argument::text("I/N"),
           take_shard);
  t.option(all, "--timeout",
           kept(fmt::format("seconds an input may take (default: {:g} for texts, {:g} for formats of other "
                            "programs)",
                            text_timeout, foreign_timeout)),
           Argument::positive(), &Options::timeout);
  t.option(all, "--memory",
           "MB of memory an input may take (default: what the machine, or the container, has free, shared by "
           "the inputs worked on at once; at least 1024)",
           Argument::positive(), &Options::memory);
  t.choice(
       all, "--sandbox",
       "keep the processes that read files to their inputs and outputs, without network: require (or refuse "
       "to run), auto (as far as the kernel can), off",
       "require auto off", &Options::sandbox, {Sandbox::required, Sandbox::automatic, Sandbox::off})
      .with_preset("auto");
  t.flag(all, "--allow-outside",
         "files that a text names (`draft file`) may be anywhere, not only in its folder or below; symbolic "
         "links that lead out of an input folder are followed",
         &Options::allow_outside);
}

void of_a_report(OptionTable& t) {
  t.begin("The reports", true);
  t.option({report}, "ACTION", "merge: the reports as one; html: a page of them",
           Argument::one_of("merge html"), &Options::subject);
  t.option({report}, "REPORT", "reports, as --report wrote them", Argument::texts(""), &Options::inputs);
  t.option({report}, "-o,--output",
           "the report of all (merge), the page (html: its name ends with .html), or - for standard output",
           Argument::text("FILE"), &Options::output)
      .required();
  t.flag({report}, "--no-pictures", "html: without a picture of each input", &Options::no_pictures);
}

void of_learning(OptionTable& t) {
  t.begin("What is asked", true);
  t.option({new_text}, "KIND", "of the text", Argument::text(""), &Options::subject).is_required = false;
  t.option({new_text}, "-o,--output", "the new file, which must not be there (default: standard output)",
           Argument::text("FILE"), &Options::output);
  t.option({explain}, "WORD", "without it the words that there are", Argument::text(""), &Options::subject)
      .is_required = false;
  t.option({help}, "TOPIC", "a subcommand, a topic, or a word as of explain", Argument::text(""),
           &Options::subject)
      .is_required = false;
}

// What formats declare for themselves.
void of_formats(OptionTable& t) {
  for (const formats::Descriptor* format : formats::all_formats()) {
    t.begin(fmt::format("Written as {}", format->name));
    Commands writers;
    for (const Command command : {convert, relax, mesh})
      if (can_be_written(*format, command)) writers.push_back(command);
    for (const Option* option : format->options) t.option(writers, *option, nullptr);
  }
}

}  // namespace

const std::deque<Row>& all_rows() {
  static const std::deque<Row> rows = [] {
    OptionTable table;
    for (auto* const part :
         {inputs_and_outputs, of_a_report, of_a_sweep, of_an_edit, of_a_picture, of_yarns, of_relaxing,
          of_a_mesh, of_forming, of_a_cell, of_formats, of_running, of_learning})
      part(table);
    return table.take();
  }();
  return rows;
}

}  // namespace selvage::pipeline
