// Solids of ten kinds of faces that OpenCASCADE makes, and the IGES files that it writes of them.
#pragma once

#include <TopoDS_Shape.hxx>

#include <filesystem>
#include <string>
#include <vector>

namespace selvage::test {

struct OcctSample {
  std::string name;
  TopoDS_Shape shape;
  int faces = 0;
  int untrimmed = 0;  // of them, by us
  double volume = 0;  // by formula
  int only_brep = 0;  // untrimmed in the B-rep mode only: there planes have no border of their own
  double area = 0;    // by formula; 0: as OpenCASCADE measures it
};

std::vector<OcctSample> occt_solids();

// In its faces mode (144) or its B-rep mode (186).
std::filesystem::path write_with_occt(const TopoDS_Shape& shape, bool brep);
std::string bytes_of(const std::filesystem::path& file);

}  // namespace selvage::test
