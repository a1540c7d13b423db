#include "pipeline/versions.h"

#include <array>

#include "build_identity.h"
#include "libraries_built_with.h"

namespace selvage::pipeline {

std::string_view version() {
  return SELVAGE_VERSION;
}

std::string_view build_identity() {
  return SELVAGE_BUILD_IDENTITY;
}

std::span<const Library> library_versions() {
  static constexpr auto known = std::to_array<Library>({SELVAGE_LIBRARIES});
  return known;
}

std::string version_text() {
  std::string text = "selvage " SELVAGE_VERSION "\n";
  std::string_view before = "with ";
  for (const Library& library : library_versions()) {
    text.append(before).append(library.title).append(" ").append(library.version);
    before = ", ";
  }
  return text;
}

}  // namespace selvage::pipeline
