// Yarns in contact that hold together: what lies in the narrow gap between two yarns becomes part of them, so
// that they share faces there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace selvage::fem {

struct Bonding {
  std::size_t cells = 0;  // that changed from the matrix to a yarn
  double volume = 0;      // theirs
  double area = 0;        // of the faces that regions of different yarns share now
};

// What the points of a mesh belong to.
inline constexpr std::uint32_t no_yarn = static_cast<std::uint32_t>(-1);

// `yarns`: of each point, the region of the yarn on whose surface it stands, or no_yarn (inside of a region,
// or only on the box). A cell of region `matrix` lies in a gap where the points of two yarns that it joins
// are at most `reach` apart, measured across it; cells whose other points are inner ones of the gap (joined
// to both yarns by such short ways) belong to it too. Each goes to the yarn to which more of its corners
// belong (then to the lower one), inner points counting by the nearer yarn. `regions` is changed in place;
// the number of cells and all points stay.
Bonding bond_contacts(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 4>> cells,
                      std::span<const std::uint32_t> yarns, std::uint32_t matrix, double reach,
                      std::vector<std::uint32_t>& regions);

}  // namespace selvage::fem
