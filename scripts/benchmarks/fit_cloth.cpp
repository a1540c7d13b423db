// Take-up of mill cloths in equilibrium, by the constants of the command line: what scripts/fit-cloth runs.
// fit_cloth ROWS.csv [bending=X loom_tension=X flattening=X packing=X compaction=X]
// Prints a row a cloth: draft, stated and built take-up of warp and weft (per cent); `none` where no
// equilibrium was found.
#include <cstdio>
#include <exception>
#include <string_view>

#include "scripts/benchmarks/mill_cloths.h"

namespace {

using namespace selvage::mechanics;

void run(int count, char** arguments) {
  WovenConstants constants;
  for (int k = 2; k < count; ++k) {
    const std::string_view argument = arguments[k];
    const std::size_t equals = argument.find('=');
    if (equals == std::string_view::npos)
      throw std::runtime_error("NAME=VALUE expected: " + std::string(argument));
    const std::string_view name = argument.substr(0, equals);
    double* value = name == "bending"        ? &constants.bending
                    : name == "loom_tension" ? &constants.loom_tension
                    : name == "flattening"   ? &constants.flattening
                    : name == "packing"      ? &constants.packing
                    : name == "compaction"   ? &constants.compaction
                                             : nullptr;
    if (value == nullptr) throw std::runtime_error("no such constant: " + std::string(name));
    *value = std::strtod(arguments[k] + equals + 1, nullptr);
  }
  std::printf("bending=%.6g loom_tension=%.6g flattening=%.6g packing=%.6g compaction=%.6g\n",
              constants.bending, constants.loom_tension, constants.flattening, constants.packing,
              constants.compaction);
  for (const MillCloth& row : read_mill_cloths(arguments[1], constants)) {
    const auto found = find_equilibrium(row.cloth);
    std::printf("%s,%g,%g,", row.draft.c_str(), row.warp_take_up, row.weft_take_up);
    if (found)
      std::printf("%.4f,%.4f\n", take_up(*found, WovenSystem::warp), take_up(*found, WovenSystem::weft));
    else
      std::printf("none,none\n");
  }
}

}  // namespace

int main(int count, char** arguments) {
  try {
    if (count < 2) throw std::runtime_error("fit_cloth ROWS.csv [NAME=VALUE ...]");
    run(count, arguments);
    return 0;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "fit_cloth: %s\n", failure.what());
    return 1;
  }
}
