#include "pipeline/versions.h"

#include "build_identity.h"

namespace selvage::pipeline {

std::string_view version() {
  return SELVAGE_VERSION;
}

std::string_view build_identity() {
  return SELVAGE_BUILD_IDENTITY;
}

std::vector<std::pair<std::string_view, std::string_view>> library_versions() {
  std::vector<std::pair<std::string_view, std::string_view>> known = {{"occt", SELVAGE_OCCT_VERSION},
                                                                      {"cgal", SELVAGE_CGAL_VERSION},
                                                                      {"embree", SELVAGE_EMBREE_VERSION},
                                                                      {"tetgen", SELVAGE_TETGEN_VERSION}};
  std::erase_if(known, [](const auto& library) { return library.second.empty(); });
  return known;
}

}  // namespace selvage::pipeline
