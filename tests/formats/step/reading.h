// A STEP file as OpenCASCADE's reader sees it: the other end's view, in millimetres.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/vec.h"

namespace selvage::tests {

struct ReadPart {
  std::string name;
  std::array<int, 3> color{-1, -1, -1};  // 0-255
  bool is_solid = false;
  bool valid = false;  // BRepCheck_Analyzer
  int faces = 0;
  int free_edges = 0;
  double volume = 0;  // mm^3
  std::string material, layer;
  double density = 0;    // g/cm3
  double tolerance = 0;  // the largest of its edges and vertices, mm
  Box3 box;              // of its control points, mm
};

struct ReadFile {
  bool ok = false;
  std::string title;
  std::vector<std::string> units;  // of lengths, as the file names them
  std::vector<ReadPart> parts;
};

// Of the root assembly's components; `into_groups`: those of the assemblies among them instead.
ReadFile read_step(const std::string& path, bool into_groups = false);

}  // namespace selvage::tests
