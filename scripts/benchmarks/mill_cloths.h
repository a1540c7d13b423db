// Mill cloths with stated take-up as cloths of the mechanics (mill_cloths.csv).
#pragma once

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mechanics/woven.h"

namespace selvage::mechanics {

struct MillCloth {
  std::string draft;
  WovenCloth cloth;                           // lengths in mm
  double warp_take_up = 0, weft_take_up = 0;  // stated, per cent
};

inline std::vector<char> ups_of(const std::string& draft, int& size) {
  int over = 1, under = 1, step = 0;
  if (draft.rfind("twill ", 0) == 0) {
    over = draft.at(6) - '0';
    under = draft.at(8) - '0';
  } else if (draft == "satin 5") {
    over = 4;
    step = 2;
  } else if (draft != "plain") {
    throw std::runtime_error("no such draft: " + draft);
  }
  size = over + under;
  std::vector<char> ups;
  for (int pick = 0; pick < size; ++pick)
    for (int end = 0; end < size; ++end)
      ups.push_back((end + size * size - (step > 0 ? step : 1) * pick) % size < over ? 1 : 0);
  return ups;
}

// Yarns of cotton (1.52 g/cm3) with the usual twist factors of warps and wefts, 4,000 and 3,400.
inline std::vector<MillCloth> read_mill_cloths(const std::string& path, const WovenConstants& constants) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<MillCloth> made;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::stringstream cells(line);
    std::vector<std::string> cell;
    for (std::string part; std::getline(cells, part, ',');) cell.push_back(part);
    const auto number = [&](std::size_t k) { return std::strtod(cell.at(k).c_str(), nullptr); };
    MillCloth row;
    row.draft = cell.at(4);
    row.warp_take_up = number(5);
    row.weft_take_up = number(6);
    int size = 0;
    row.cloth.warp_on_top = ups_of(row.draft, size);
    const auto yarn = [&](double tex, double twist_factor) {
      WovenYarn spun;
      spun.fibre_area = tex / 1520.0;
      spun.packing = constants.packing;
      spun.max_packing = densest_packing;
      spun.stiffness = stiffness_by_twist(twist_factor);
      return spun;
    };
    const auto count = static_cast<std::size_t>(size);
    row.cloth.warps.assign(count, yarn(number(0), 4000));
    row.cloth.wefts.assign(count, yarn(number(1), 3400));
    row.cloth.warp_gaps.assign(count, 10.0 / number(2));
    row.cloth.weft_gaps.assign(count, 10.0 / number(3));
    row.cloth.weft_tension = constants.loom_tension;  // on the loom
    row.cloth.constants = constants;
    // As in fabrics: 1 % of the thinner yarn's thickness.
    row.cloth.clearance = 0.01 * std::sqrt(std::min(number(0), number(1)) / 1520.0);
    made.push_back(std::move(row));
  }
  return made;
}

// Built take-up, per cent.
inline double take_up(const WovenEquilibrium& cloth, WovenSystem system) {
  const double crimp = cloth.crimp(system);
  return 100.0 * crimp / (1.0 + crimp);
}

}  // namespace selvage::mechanics
