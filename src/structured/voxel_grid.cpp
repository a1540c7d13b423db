#include "structured/voxel_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage::fem {

std::vector<double> VoxelGrid::middles(std::size_t axis) const {
  std::vector<double> result;
  for (std::size_t i = 0; i < count(axis); ++i) result.push_back((planes[axis][i] + planes[axis][i + 1]) / 2);
  return result;
}

Result<VoxelGrid> make_grid(const Box3& box, int count, double most, const char* what) {
  constexpr int largest_count = 10'000;
  if (count < 1 || count > largest_count)
    return error(Kind::usage, fmt::format("the number of {} along the longest side is 1 to {}, not {}", what,
                                          largest_count, count));
  const double size = box.sizes().maxCoeff() / count;
  std::array<double, 3> numbers{};
  for (int axis = 0; axis < 3; ++axis)
    numbers[static_cast<std::size_t>(axis)] = std::max(1.0, std::round(box.sizes()[axis] / size));
  if (numbers[0] * numbers[1] * numbers[2] > most)
    return error(Kind::limit,
                 fmt::format("{:.1e} {} would be needed, more than {:.0e}; choose a smaller --voxel",
                             numbers[0] * numbers[1] * numbers[2], what, most));
  VoxelGrid grid;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<int>(numbers[static_cast<std::size_t>(axis)]);
    std::vector<double>& planes = grid.planes[static_cast<std::size_t>(axis)];
    for (int i = 0; i < n; ++i) planes.push_back(box.min()[axis] + box.sizes()[axis] * i / n);
    planes.push_back(box.max()[axis]);
  }
  return grid;
}

}  // namespace selvage::fem
