// What OpenCASCADE's check (BRepCheck_Analyzer) finds wrong with a shape, in words. Internal to the module
// selvage_occt.
#pragma once

#include <TopoDS_Shape.hxx>
#include <gp_Pnt.hxx>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::solid::occt {

struct Fault {
  std::string_view words;   // what it is
  std::string_view remedy;  // for a yarn
  std::string name;         // OpenCASCADE's own name for it
  gp_Pnt at;                // of the part that has it
};

// The vertex, the middle of the edge, or the first vertex of what is larger.
gp_Pnt place_of(const TopoDS_Shape& shape);

// Each kind once, with the first place where it stands; empty for a valid shape, and one of no name where
// the check says no more than that it is not.
std::vector<Fault> faults_of(const TopoDS_Shape& shape);

// The words, and the name behind them.
std::string to_string(const Fault& fault);

}  // namespace selvage::solid::occt
