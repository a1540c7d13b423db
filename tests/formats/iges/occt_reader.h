// OpenCASCADE as a reader of IGES.
#pragma once

#include <filesystem>
#include <vector>

namespace selvage::test {

struct OcctSolid {
  bool valid = false;    // BRepCheck_Analyzer
  bool closed = false;   // its shell
  int free_edges = 0;    // that only one face has
  double volume = 0;     // BRepGProp with a tolerance, positive; in millimetres
  double tolerance = 0;  // the largest of any vertex, edge or face, millimetres
};

struct OcctReading {
  int load_fails = 0,
      load_warnings = 0;  // of its check list; the note that a closed surface was made periodic aside
  int roots = 0, faces = 0, solids_in_file = 0;
  double area = 0;                // of all faces, mm^2
  std::vector<OcctSolid> solids;  // those of the file, or one a shell of what was sewn
};

// Reads the file and, when `sewing` > 0 [mm], sews each root's faces and makes solids of the shells.
OcctReading read_with_occt(const std::filesystem::path& file, double sewing);

}  // namespace selvage::test
