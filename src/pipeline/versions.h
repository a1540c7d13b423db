// The program's version and those of the libraries that it was built with (their modules need not be opened
// for it).
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace selvage::pipeline {

// That of the git tag where the sources are a clone that has one (scripts/packaging/version.cmake), else the
// project's: "0.1.0", or "0.1.0+5.g774f580", five commits later.
std::string_view version();
// 16 hexadecimal digits of the sources that the program was built from: the same on every machine, another
// one for every program that may write other bytes.
std::string_view build_identity();

struct Library {
  std::string_view name;     // in reports: "occt"
  std::string_view title;    // as it calls itself: "OpenCASCADE"
  std::string_view version;  // "7.6.3"
};
// Without those whose headers do not tell.
std::span<const Library> library_versions();

// What `--version` prints, two lines: "selvage 0.1.0", and "with OpenCASCADE 7.6.3, CGAL 5.5.1, ...". The
// last one is not ended.
std::string version_text();

}  // namespace selvage::pipeline
