// What is filled with tetrahedra at once: a yarn by itself, or all that a cell holds.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/units.h"
#include "fem/mesh.h"
#include "surface_mesh/skin.h"
#include "tetrahedra/worker.h"
#include "yarn/body.h"

namespace selvage::fem {

// What the meshes of yarns and of cells are asked for alike.
struct MeshOptions {
  double size = 0;           // largest edge on yarns, file units; 0: a quarter of the narrowest section
  int order = 1;             // 1 | 2
  double min_dihedral = 10;  // degrees wanted, 0..30 (improve.h)
  double timeout = 300;      // seconds, of each run of TetGen
  double memory = 4096;      // MiB, likewise
  int threads = 1;
  // What is being done, in words, and how much of it. May be empty.
  std::function<void(const char* step, std::size_t done, std::size_t total)> progress{};
};

// Edges along the narrowest section where no size is given.
inline constexpr double default_edges_per_extent = 4;

// Error (usage): an option out of its range.
Status check_options(const MeshOptions& options);

struct Block {
  // The sides of the skin's triangles, which are bodies, become numbers of regions.
  Block(std::span<const yarn::Body> bodies, Unit units, const Parallelepiped& cell,
        const std::array<bool, 3>& periodic, Skin skin);

  std::span<const yarn::Body> bodies;  // outlive this
  Unit units;                          // of files
  Parallelepiped cell;                 // file units: what the bodies were cut by
  std::array<bool, 3> periodic{};
  Skin skin;
  // Of each region its body: those that are there, in their order; CellTriangles::matrix, the last.
  std::vector<std::uint32_t> of_regions;
};

// Tetrahedra inside the skin, of its points alone. `kept`: other places of these points (empty: none). Where
// triangles come into each other's way there, which happens when they are longer than the yarn is thin, it is
// the skin as it is that is filled, and then moved; or left, where a tetrahedron would turn. `smallest`:
// edges wanted on the skin, file units. Errors: of run_tetgen().
Result<TetMesh> fill(const Block& block, std::span<const Vec3> kept, double smallest,
                     const MeshOptions& options, const std::filesystem::path& program);

struct Improved {
  AngleTarget angles;
  std::vector<Message> notes;  // each with its place: tetrahedra below the wanted angle, and why
};

// Puts points in, for edges of about `largest` (file units) and for the wanted angle (refine.h, improve.h).
// Where a matrix is around the yarns, points of their surfaces slide as well (slide.h).
Improved improve(TetMesh& tets, Block& block, double largest, const MeshOptions& options);

// The mesh of the block in mm: corner nodes, elements region by region, faces of yarns.
Mesh assemble(const Block& block, const TetMesh& tets);

// Fibres of the yarns' elements and, with order 2, midside nodes. Gives notes.
std::vector<Message> complete(Mesh& mesh, const Block& block, int order);

// Error (geometry) of a measured mesh (mm): an element is turned inside out; with its place in file units.
Status check_elements(const Mesh& mesh, Unit units);

}  // namespace selvage::fem
