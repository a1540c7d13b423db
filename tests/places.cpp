#include "places.h"

namespace selvage::places {

std::string samples() {
  return SELVAGE_SOURCE "/samples";
}
std::string tests() {
  return SELVAGE_SOURCE "/tests";
}
std::string scripts() {
  return SELVAGE_SOURCE "/scripts";
}
std::string programs() {
  return SELVAGE_BIN;
}
std::string python() {
  return SELVAGE_PYTHON;
}
std::string system_python() {
  return SYSTEM_PYTHON;
}
std::string gmsh() {
  return GMSH;
}
std::string ccx() {
  return CCX;
}

}  // namespace selvage::places
