// What a file format is to the program: one descriptor a folder, listed in registry.h. Detection, `--to`,
// `selvage formats` and the conformance tests all come from it. CONTRIBUTING.md: how to add one.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cad/model.h"
#include "core/diagnostics.h"
#include "core/findings.h"
#include "core/option.h"
#include "core/output.h"
#include "core/source.h"
#include "core/text_buffer.h"
#include "core/units.h"
#include "fabric/measured.h"
#include "fabric/model.h"
#include "fem/forming.h"
#include "fem/mesh.h"
#include "formats/language.h"
#include "garment/piece.h"
#include "results/field_mesh.h"
#include "results/solved_deck.h"
#include "solid/gap_map.h"
#include "structured/beams.h"
#include "structured/raster.h"
#include "yarn/body.h"
#include "yarn/congruence.h"

namespace selvage::formats {

// By the format's own names: {"128": 12}.
using EntityCounts = std::map<std::string, std::uint64_t>;

// What was written, for the report.
struct WriteFacts {
  EntityCounts entities{};
  std::vector<Message> messages{};    // warnings
  std::vector<EntityCounts> parts{};  // of each file where there are several; else empty
};

// A file that is one of several that hold a fabric together, as it says itself.
struct PartMark {
  int number = 1, count = 1;  // from 1
  std::string set;            // the same in all files of one writing, and in no other
  bool operator==(const PartMark&) const = default;
};

struct SurfaceOptions {
  std::string title;                  // of the fabric, may be empty
  std::string file_name;              // the output's own name (without folders), for headers
  Unit units = Unit::mm;              // of all lengths
  std::uint64_t expected_bodies = 0;  // how many will be added; a guess only costs speed
  double max_coordinate = 0;          // upper bound of |coordinate| over all bodies, if known; 0: unknown
  std::string date;                   // YYYYMMDD.HHNNSS for headers; empty: now
  double tolerance = 0;               // of the modelled tubes, file units; 0: unknown
  double chord = 0;                   // of triangles, from surfaces, file units; 0: as `tolerance`
  double resolution =
      0;  // of the file that free faces and solids come from (fabric::Fabric), file units; 0: unknown
  std::string companion;          // the name of the file beside (Descriptor::companion); empty: there is none
  bool yarns_are_solids = false;  // in the file of this format that they come from (fabric::Fabric)
  bool has_others = false;        // pieces, parts or curves will be added, not yarns alone
  OptionValues own;               // of Descriptor::options
  int threads = 1;                // that may format text
  // For formats whose files have a largest size: opens file `number` (2, 3, ...) of the fabric. What it gives
  // outlives the writer. Null: there can be one file only.
  std::function<Result<OutputFile*>(int number)> next_part;
};

// A yarn that is another one in another place.
struct Instance {
  std::size_t shape = 0;  // the same for all copies of one shape, in one colour, role and density
  std::shared_ptr<const yarn::Body> body;  // the shape, where it was modelled: the first copy
  yarn::RigidMotion motion;                // from there to this copy
};

// Takes the yarns and pieces of one file, one after the other, in the order in which they shall stand there.
// A format that carries only one of the two (Descriptor) is never given the other; of a yarn it is given the
// surface, or the centre line.
class BodyWriter {
 public:
  virtual ~BodyWriter() = default;
  virtual Status add(const yarn::Body& body) {
    return error(Kind::unsupported, "this format holds no yarns, such as '" + body.name + "'");
  }
  // `body` is what the copy is by itself: its name and group are the copy's. A format that repeats nothing
  // writes it in full.
  virtual Status add_instance(const yarn::Body& body, const Instance& /*instance*/) { return add(body); }
  // The yarn's centre line instead of its surface.
  virtual Status add_line(const yarn::Body& body) {
    cad::NamedCurve line;
    line.name = body.name;
    if (body.is_colored) line.color = body.color;
    line.curve = body.axis;
    return add_curve(line);
  }
  // Geometry of a CAD file that is neither a yarn nor a piece.
  virtual Status add_part(const cad::Part& part) {
    return error(Kind::unsupported, "this format holds no free surfaces, such as '" + part.name + "'");
  }
  virtual Status add_curve(const cad::NamedCurve& curve) {
    return error(Kind::unsupported, "this format holds no free curves, such as '" + curve.name + "'");
  }
  virtual Status add_piece(const fabric::PieceShape& piece) {
    return error(Kind::unsupported, "this format holds no garment pieces, such as '" + piece.name + "'");
  }
  // Completes the file's bytes; committing the OutputFile is the caller's.
  virtual Result<WriteFacts> finish() = 0;
};

// An `edit` to be added to a text, its numbers spelt as they shall stand there.
struct NewEdit {
  fabric::Edit edit;                    // its place means nothing
  std::string piece;                    // whose curve it edits, in the plane; empty: a yarn
  std::string length;                   // length
  std::array<std::string, 3> vector{};  // target or direction
};

struct Descriptor;

// A second file that goes with each file of a format, beside it.
struct Companion {
  const Descriptor& (*format)() = nullptr;  // null: there is none
  std::string_view ending{};                // of its name, behind the first one's stem: "_mesh"
  const Option* asked_by = nullptr;         // only where this is given; null: always
  bool is_of_load_cases = false;            // only beside meshes that have some
};

struct MeshFileOptions {
  std::string companion{};  // the name of the file beside (Descriptor::companion); empty: there is none
  OptionValues own{};       // of Descriptor::options
  const fem::Forming* forming = nullptr;  // the step of --deck explicit; null: another one
  // Of a format that is a folder: opens another file in it ("constant/points"). What it gives outlives the
  // writer.
  std::function<Result<OutputFile*>(std::string_view name)> open_member{};
};

struct Descriptor {
  std::string_view name;                     // the word of --to: "iges"
  std::string_view title;                    // one line for `selvage formats`
  std::vector<std::string_view> extensions;  // with the dot; the first is the one that is written
  // Is this the format of a file that begins with these bytes (at most 4 KiB)? Null: only the extension
  // tells.
  bool (*sniff)(std::string_view head) = nullptr;

  // Readers report every error and warning to `diagnostics`; nothing comes back exactly when there was an
  // error.
  std::optional<fabric::Fabric> (*read_fabric)(const Source& source, Diagnostics& diagnostics) = nullptr;

  // The same with other values of its params. Null: a format without params.
  std::optional<fabric::Fabric> (*read_with)(const Source& source,
                                             const std::vector<fabric::Setting>& settings,
                                             Diagnostics& diagnostics) = nullptr;
  // The same with surfaces within a tolerance (file units, > 0) of what the file says. Null: a format whose
  // surfaces are exact, or tubes, which have their tolerance when they are built.
  std::optional<fabric::Fabric> (*read_within)(const Source& source, double tolerance,
                                               Diagnostics& diagnostics) = nullptr;

  // A CAD file as it stands; fabric/from_cad.h makes a fabric of it. A format has this, read_fabric or
  // read_points.
  std::optional<cad::Model> (*read_model)(const Source& source, Diagnostics& diagnostics) = nullptr;
  // Yarns as points: fabric/measured.h makes a fabric of them, or a yarn of a text (`points FILE`).
  std::optional<fabric::Measured> (*read_points)(const Source& source, Diagnostics& diagnostics) = nullptr;
  // Does the file keep to its format in every respect? Defects and warnings that the reader puts up with.
  void (*check_structure)(const Source& source, Findings& findings) = nullptr;
  // What the beginning of a file (at most 4 KiB) says of the set that it is part of; none: it stands alone.
  std::optional<PartMark> (*part_mark)(std::string_view head) = nullptr;
  // The library that reads it, for the message when it dies of a file: "STEP". Empty: a reader of our own.
  std::string_view foreign_reader{};
  // Some systems ignore a few of its entities (cad/judge.h: judge_for_receivers).
  bool is_partly_ignored = false;
  [[nodiscard]] bool is_readable() const {
    return read_fabric != nullptr || read_model != nullptr || read_points != nullptr;
  }

  Result<WriteFacts> (*write_fabric)(const fabric::Fabric& fabric, OutputFile& output) = nullptr;
  // The bytes of a text with the edit as a line of its own after line `after` (from 1); no other byte
  // changes.
  std::string (*insert_edit)(std::string_view bytes, int after, const NewEdit& edit) = nullptr;
  // `output` outlives the writer, which takes yarns as surfaces, garment pieces as curves, or both.
  Result<std::unique_ptr<BodyWriter>> (*open_bodies)(OutputFile& output,
                                                     const SurfaceOptions& options) = nullptr;
  bool carries_surfaces = true;
  bool carries_curves = false;
  bool carries_parts = false;  // free faces and solids: of CAD files, and what --cut makes
  bool carries_lines =
      false;  // centre lines of yarns; a format without surfaces is given nothing else of them
  // A mesh with what was computed on it, for pictures and pages; lengths in mm.
  std::optional<fem::FieldMesh> (*read_mesh)(const Source& source, Diagnostics& diagnostics) = nullptr;
  // The deck that such results are of: which yarn an element is of, its fibres and material.
  std::optional<fem::SolvedDeck> (*read_deck)(const Source& source, Diagnostics& diagnostics) = nullptr;
  Result<WriteFacts> (*write_mesh)(const fem::Mesh& mesh, OutputFile& output,
                                   const MeshFileOptions& options) = nullptr;
  // Yarns as beams (`mesh --elements beam`).
  Result<WriteFacts> (*write_beams)(const fem::BeamModel& beams, OutputFile& output,
                                    const MeshFileOptions& options) = nullptr;
  bool carries_forming = false;    // explicit decks (MeshFileOptions::forming), of solids and of beams
  bool carries_transport = false;  // decks of every Mesh::physics, not of elasticity alone
  // The largest order of meshes whose regions share no nodes (Mesh::joining) that the format holds, as
  // surfaces and as cohesive elements; 0: of none.
  int order_of_surfaces = 0, order_of_cohesive = 0;
  // The largest order of pore spaces (Mesh::patches) that the format holds; 0: of none.
  int order_of_pores = 0;
  bool is_of_pores = false;  // and of nothing else
  bool has_layers = false;   // wedges along their walls (Mesh::layers), too
  // An output is a folder with a file of the same name in it, which the writer is given; and these folders
  // below it, in which its other files are ("constant/polyMesh"). None: it is a file.
  std::vector<std::string_view> folders{};
  // A unit cell on voxels (`mesh --voxel`), for a format that holds no elements.
  Result<WriteFacts> (*write_raster)(const fem::Raster& raster, OutputFile& output) = nullptr;
  Companion companion{};
  bool is_companion = false;  // never written by itself
  // What the command line says of this format alone: of subcommands that can write it.
  std::vector<const Option*> options{};
  // A flag of these that makes another form of the format; a round trip goes through both.
  const Option* other_form = nullptr;
  bool is_own = false;  // the program's own text: what it reads and writes where it works on the text
  // What the program teaches of its words. Null: nobody writes it by hand.
  const Language& (*language)() = nullptr;
  bool is_usual = false;  // written where no format is named
  // Lengths in mm.
  Result<WriteFacts> (*write_gap_map)(const solid::GapMap& map, OutputFile& output) = nullptr;
};

// How far polygons of a centre line may be from it: as far as tubes from theirs.
inline double line_tolerance(const SurfaceOptions& options, const yarn::Body& body) {
  return options.tolerance > 0.0 ? options.tolerance : 1e-3 * yarn::narrowest_section(body);
}

// How far triangles, which are drawn and printed, may be from the surface that they stand for: 1/100 of the
// yarn's thinnest section where no chord is given.
inline double chord_height(const SurfaceOptions& options, const yarn::Body& body) {
  constexpr double of_thickness = 0.01;
  return options.chord > 0.0 ? options.chord : of_thickness * yarn::narrowest_section(body);
}

// Descriptor::open_bodies of a writer that is made of its arguments.
template <class Writer>
Result<std::unique_ptr<BodyWriter>> open_by(OutputFile& output, const SurfaceOptions& options) {
  return std::unique_ptr<BodyWriter>(std::make_unique<Writer>(output, options));
}

// What a mesh or drawing writer gives at its end: all of `counts`, and those of `others` that are not 0.
inline Result<WriteFacts> finished(TextBuffer& text, EntityCounts counts, const EntityCounts& others = {}) {
  if (Status done = text.finish(); !done) return done.error();
  for (const auto& [name, count] : others)
    if (count > 0) counts[name] = count;
  return WriteFacts{.entities = std::move(counts)};
}

}  // namespace selvage::formats
