// A unit cell, a box or a parallelepiped, as fields on a grid of voxels, for methods without elements (FFT):
// who fills each voxel, by how much, and which way the fibres run there. Other than the hexahedra of voxel.h,
// whose yarns are stairs, it says what share of a voxel on a yarn's surface lies inside.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "fabric/model.h"
#include "yarn/body.h"

namespace selvage::fem {

struct RasterPhase {
  std::string name;      // the yarn's; of phase 0 "matrix"
  std::string material;  // may be empty
  double fraction = 0;   // of the cell's volume
};

struct Raster {
  std::array<std::size_t, 3> count{};  // of voxels along the cell's three edges: x, y, z of a box
  Vec3 origin = Vec3::Zero();          // the cell's corner, mm
  std::array<Vec3, 3> edges = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // from there, mm
  std::string title;
  std::vector<RasterPhase> phases;  // 0: what no yarn fills; then the yarns that enter the cell
  // One entry a voxel, number (k * count[1] + j) * count[0] + i of the i-th along the first edge.
  std::vector<std::uint16_t> phase;   // the largest yarn in it where yarns fill half of it or more; else 0
  std::vector<float> yarn_fraction;   // share of it inside yarns, 0 .. 1
  std::vector<float> fibre_fraction;  // share of it that is fibre; NaN where a yarn's is not known
  std::vector<std::array<float, 3>>
      orientation;             // unit tangent of the largest yarn in it; 0 where there is none
  double yarn = 0, fibre = 0;  // shares of the cell; the second may be NaN
  double overlap = 0;          // share of the cell that lies in two yarns

  [[nodiscard]] Vec3 lengths() const { return {edges[0].norm(), edges[1].norm(), edges[2].norm()}; }
  [[nodiscard]] std::size_t voxels() const { return count[0] * count[1] * count[2]; }
};

struct RasterOptions {
  int count = 0;  // along the longest side of the cell, 1 .. 10 000
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress{};  // of yarns; may be empty
};

// The fields of the fabric's cell (there must be one). Shares are exact of a polyhedron inside the yarn's
// surface, which has 256 edges or more round it (a volume too small by 1e-4 to 3e-4): each of its triangles
// is cut by the planes of the grid, and what is under the pieces summed up; in the coordinates of the cell,
// whose linear map keeps shares. Orientations are those of space. Warnings: fibres of a yarn that
// are not known; yarns that overlap. Errors: usage (count), limit (more than 2e8 voxels, or 65 535 yarns),
// geometry (no yarn in the cell).
Result<Raster> rasterize(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                         const RasterOptions& options, Diagnostics& diagnostics);

// One of its arrays, as files have them: rows of `components` numbers, a voxel each.
struct RasterField {
  enum class Type { uint16, float32 };
  std::string_view name;
  Type type = Type::float32;
  std::size_t components = 1;
  const void* data = nullptr;
  std::size_t bytes = 0;
};
std::array<RasterField, 4> fields_of(const Raster& raster);

// The phases as columns.
struct PhaseColumns {
  std::vector<std::string> names, materials;
  std::vector<double> fractions;
};
PhaseColumns columns_of(const std::vector<RasterPhase>& phases);

}  // namespace selvage::fem
