// What a file format is to the program: one descriptor a folder, listed in registry.cpp. Detection, `--to`,
// `selvage formats` and the conformance tests all come from it. CONTRIBUTING.md: how to add one.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cad/model.h"
#include "core/diagnostics.h"
#include "core/findings.h"
#include "core/output.h"
#include "core/source.h"
#include "core/units.h"
#include "fabric/model.h"
#include "fabric/piece.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::formats {

// What was written, for the report.
struct WriteFacts {
  std::map<std::string, std::uint64_t> entities;  // by the format's own names: {"128": 12}
  std::vector<Message> messages;                  // warnings
};

struct SurfaceOptions {
  std::string title;                  // of the fabric, may be empty
  std::string file_name;              // the output's own name (without folders), for headers
  Unit units = Unit::mm;              // of all lengths
  std::uint64_t expected_bodies = 0;  // how many will be added; a guess only costs speed
  double max_coordinate = 0;          // upper bound of |coordinate| over all bodies, if known; 0: unknown
  std::string date;                   // YYYYMMDD.HHNNSS for headers; empty: now
  double tolerance = 0;               // of the modelled tubes, file units; 0: unknown
  bool iges_solid = false;            // IGES: 186 solids instead of three 128s a yarn
  std::string step_schema = "AP242";  // AP242 | AP214
};

// Takes the yarns and pieces of one file, one after the other, in the order in which they shall stand there.
// A format that carries only one of the two (Descriptor) is never given the other.
class BodyWriter {
 public:
  virtual ~BodyWriter() = default;
  virtual Status add(const yarn::Body& body) {
    return error(Kind::unsupported, "this format holds no yarns, such as '" + body.name + "'");
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
  std::string length;                   // length
  std::array<std::string, 3> vector{};  // target or direction
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

  // A CAD file as it stands; fabric/from_cad.h makes a fabric of it. A format has this or read_fabric.
  std::optional<cad::Model> (*read_model)(const Source& source, Diagnostics& diagnostics) = nullptr;
  // Does the file keep to its format in every respect? Defects and warnings that the reader puts up with.
  void (*check_structure)(const Source& source, Findings& findings) = nullptr;
  [[nodiscard]] bool is_readable() const { return read_fabric != nullptr || read_model != nullptr; }

  Result<WriteFacts> (*write_fabric)(const fabric::Fabric& fabric, OutputFile& output) = nullptr;
  // The bytes of a text with the edit as a line of its own after line `after` (from 1); no other byte
  // changes.
  std::string (*insert_edit)(std::string_view bytes, int after, const NewEdit& edit) = nullptr;
  // `output` outlives the writer, which takes yarns as surfaces, garment pieces as curves, or both.
  Result<std::unique_ptr<BodyWriter>> (*open_bodies)(OutputFile& output,
                                                     const SurfaceOptions& options) = nullptr;
  bool carries_surfaces = true;
  bool carries_curves = false;
  Result<WriteFacts> (*write_mesh)(const fem::Mesh& mesh, OutputFile& output) = nullptr;
};

// Every format of the program, in the order in which `selvage formats` lists them.
const std::vector<const Descriptor*>& all_formats();

}  // namespace selvage::formats
