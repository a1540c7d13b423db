// Files for the tests of the IGES writer, the model beside them, and the programs that judge them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/format.h"
#include "formats/iges/records.h"
#include "yarn/body.h"

namespace selvage::test {

// A folder of this test process, removed at exit.
const std::filesystem::path& scratch();

// Surfaces, or solids; in a unit.
formats::SurfaceOptions surfaces(Unit units = Unit::mm);
formats::SurfaceOptions solids(Unit units = Unit::mm);

// Writes a file the way the program does, at a fixed time (SOURCE_DATE_EPOCH). Fails the test on an error.
std::filesystem::path write_iges(const std::string& name, const std::vector<yarn::Body>& bodies,
                                 formats::SurfaceOptions options = {});

// The same into memory, with limits of the writer's own.
std::string iges_bytes(const std::vector<yarn::Body>& bodies, const formats::SurfaceOptions& options,
                       const formats::iges::Records::Limits& limits = {});

// The geometry in memory for iges_oracle.py: hexadecimal doubles, and places evaluated by nurbs::evaluate.
std::filesystem::path dump_model(const std::string& name, const std::vector<yarn::Body>& bodies,
                                 const formats::SurfaceOptions& options);

struct Output {
  int exit_code = -1;
  std::string text;  // standard output and error
};
Output run(const std::string& command);

// iges_oracle.py; with a model when there is one.
Output judge(const std::filesystem::path& file, const std::filesystem::path& model = {});

// The yarns of a file of samples/.
std::vector<yarn::Body> sample(const std::string& name, yarn::EndStyle ends, Unit* units = nullptr);

}  // namespace selvage::test
