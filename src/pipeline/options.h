// What the command line asks for, after it was understood (pipeline/command_line.h, where defaults that are
// values stand, too). The contract is in src/cli/README.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/containment.h"
#include "core/option.h"
#include "core/units.h"
#include "fabric/plies.h"
#include "fem/forming.h"
#include "fem/mesh.h"
#include "fem/physics.h"
#include "formats/format.h"
#include "view/picture.h"
#include "yarn/body.h"

namespace selvage::pipeline {

enum class Command {
  convert,
  check,
  relax,
  mesh,
  roundtrip,
  diff,
  info,
  edit,
  view,
  sweep,
  report,
  formats,
  new_text,
  explain,
  help,
  show_version
};
std::string_view name_of(Command command);

// --relax and what goes with it; lengths in the input's unit.
struct RelaxSettings {
  bool wanted = false;
  std::optional<double> gap;      // the least one, >= 0; none: 1 % of the smaller thickness
  std::optional<double> overlap;  // > 0: contact to this depth instead of a gap
  bool stiff_section = false;     // only paths move
  int max_iterations = 0;         // 0: the default
};

// What yarns are meshed with.
enum class Elements { tetrahedra, hexahedra, beams, trusses };
constexpr bool are_lines(Elements elements) {
  return elements == Elements::beams || elements == Elements::trusses;
}

// The explicit step of `mesh --deck explicit`; lengths in the input's unit.
struct FormingSettings {
  bool wanted = false;
  fem::FormingLoad load = fem::FormingLoad::biaxial;
  std::optional<double> stroke, thickness, duration;  // as fem::FormingOptions
  double friction = 0;
};

// When a page of `view` lists contacts; `automatic`: where all yarns together have at most a few million
// points.
enum class PageContacts { automatic, yes, no };

// How large displacements are in a picture of results.
struct DeformedScale {
  std::optional<double> factor;  // none: so that the largest is a twentieth of the mesh's diagonal
};
// Of a mesh with yarns: the half of the matrix is that behind a plane through the middle.
enum class ShownMatrix { whole, half, none };

// Of `edit`, as given.
struct EditWords {
  std::string yarn, piece, curve, to, by, length, along;
  int point = 0;  // from 1
};

// Variants of inputs with other values of their params, as given: `--set` of all commands, the rest of
// `sweep`.
struct SweepWords {
  bool wanted = false;
  std::vector<std::string> sets;  // NAME=VALUE, NAME=LOW:HIGH:STEP, NAME=LOW:HIGH, NAME=V1,V2,...
  std::string table;              // a CSV file
  std::size_t samples = 0;        // of a Latin hypercube
  std::uint64_t seed = 1;
};

struct Options {
  Command command = Command::convert;
  std::string settings;  // the options that outputs depend on, as words
  std::vector<std::string>
      inputs;             // as given: files, folders, patterns, "-", "@list"; of `diff` the two files
  std::string output;     // -o; empty: beside the inputs; "-": standard output
  std::string file_name;  // of headers; empty: the output's own
  std::string formats;    // --to, as given

  std::size_t workers = 0;       // 0: one a core
  double timeout = 0;            // seconds an input; 0: those of limits.h
  double memory = 0;             // MiB an input; 0: its share of the machine
  bool memory_is_share = false;  // it was not given
  Sandbox sandbox = Sandbox::automatic;
  std::size_t part = 0, parts = 1;
  bool quiet = false, verbose = false, no_progress = false, progress_json = false;
  bool strict = false;
  std::string report;
  bool resume = false;

  std::optional<Unit> units;   // of surfaces and tables; none: the input's
  bool allow_outside = false;  // files that a text names may be anywhere, not only below its folder
  double tolerance = 0;        // input's unit; 0: the input's
  double chord = 0;            // of triangles, input's unit; 0: the tolerance
  bool full_digits = false;    // of the tubes' control points
  fabric::Detail detail = fabric::Detail::usual;  // how far yarns are taken apart
  bool as_published = false;                      // constructions as their paper gives them, overlaps and all
  std::optional<yarn::EndStyle> ends;             // none: as the input has them, or patch
  bool instances = false;                         // repeat equal yarns by reference
  bool lines = false;                             // centre lines instead of surfaces
  OptionValues of_formats;                        // what formats declare for themselves

  Elements elements = Elements::tetrahedra;
  double size = 0;          // wanted edge length, input's unit; 0: the mesher's choice
  int order = 0;            // 1, 2; 0: 2 of beams, of plates with a matrix, else 1
  double min_dihedral = 0;  // degrees; 0: the mesher's choice
  bool allow_overlap = false;
  FormingSettings forming;

  // The unit cell: of `mesh` and `convert`.
  bool cut = false;     // by the cell's faces
  bool matrix = false;  // with the rest of the cell
  std::string
      matrix_material;  // of the cell's matrix: a name, or modulus and Poisson's ratio; empty: the input's
  bool pores = false;   // the rest of the cell alone, as a space for a fluid (implies matrix)
  int layers = 0;       // of wedges along the walls of pores
  double layer_thickness = 0;  // of all of them, input's unit; 0: the mesher's choice
  bool periodic = false;       // opposite faces alike, and equations between them
  int segments = 0;            // edges round each yarn; 0: by size
  double matrix_size = 0;      // to which edges may grow away from the yarns, input's unit; 0: size
  bool bond = false;           // yarns in contact share faces, instead of a gap filled with matrix
  fem::Joining joining = fem::Joining::bonded;  // of regions where they meet
  int voxels = 0;              // hexahedra along the longest side instead of tetrahedra; 0: tetrahedra
  bool ignores_twist = false;  // of fibres, in meshes: they run along the yarn
  bool chamis = false;  // stiffness of yarns from that of their fibres (Chamis), not as their material says
  fem::Physics physics = fem::Physics::elastic;  // of the deck
  bool force = false;  // go on where the estimate, or a gap, says that it is not worth it

  [[nodiscard]] bool wants_cell() const { return cut || matrix || periodic || voxels > 0; }

  RelaxSettings relaxing;

  // check
  double reach = 0;     // input's unit: near contacts with a gap up to this are listed too. 0: none
  std::string gap_map;  // a VTU of the yarns coloured by gap goes to this file; empty: nowhere

  // view
  PageContacts page_contacts = PageContacts::automatic;
  std::optional<view::From> from;            // none: plan, but of a section the side from which it is seen
  std::optional<double> azimuth, elevation;  // degrees; instead of `from`
  std::optional<view::Section> section;
  double zoom = 1;
  std::vector<std::string> shown_yarns;                  // patterns of names; empty: all
  std::string field;                                     // of a mesh's results, as given; empty: its regions
  int step = 0;                                          // from 1; 0: the last
  std::optional<std::pair<double, double>> value_range;  // low < high; none: of the values
  std::optional<DeformedScale> deformed;                 // none: as it was before
  std::optional<ShownMatrix> shown_matrix;  // none: the half beside yarns, whole where names are asked for
  std::string deck;  // that the results are of; empty: the one beside them, if there is one
  int picture_width = 0, picture_height = 0;  // pixels
  yarn::Color background{};
  bool flat = false, no_scale_bar = false;

  // roundtrip, diff
  double difference_tolerance = 0;  // the first input's unit; distances up to it are no difference
  std::string csv;                  // sweep, info: a table of the results, a row an input or variant
  std::string junit;                // JUnit XML goes to this file; empty: nowhere
  std::string scratch;              // a folder that is there while the run is
  bool all = false;                 // every difference, not only the first ones

  EditWords edit;
  SweepWords sweep;

  std::string subject;  // new, explain, help: what is asked for; may be empty; report: merge or html

  bool no_pictures = false;  // report

  bool json = false;   // info, diff: JSON instead of text
  bool table = false;  // info: the fixed points and control points of garment curves

  [[nodiscard]] bool wants_report() const {
    return !report.empty() || !junit.empty() || !csv.empty() || (json && command == Command::info);
  }
};

}  // namespace selvage::pipeline
