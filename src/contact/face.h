// The B-spline surfaces of yarns, cut into cells: what the search for contacts looks at.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "core/wrapped.h"
#include "yarn/body.h"

namespace selvage::contact {

// One surface of a yarn: its side, or what seals an end (a flat end as straight lines from its outline to its
// centre).
struct Face {
  std::uint32_t body = 0;
  const nurbs::Surface* surface = nullptr;
  bool is_side = true;
  bool is_last = false;                   // of an end: the one at the last v
  bool inward = false;                    // S_u x S_v points into the yarn
  bool round_u = false, round_v = false;  // the parameter goes round
  std::uint32_t count_u = 0, count_v = 0;
  std::vector<std::uint32_t> rows;  // the first cell of each row; those of a row follow each other

  static constexpr std::uint32_t no_cells =
      std::numeric_limits<std::uint32_t>::max();  // a row that is left out
};

// A part of a face within one knot span of either direction, about as long as its yarn is wide at most.
struct Cell {
  std::uint32_t face = 0;
  std::uint32_t i = 0, j = 0;                    // its place among the face's cells
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // (u, v)
  Box3 box;                                      // of its Bezier control points
  Vec3 normal = Vec3::Zero();                    // unit, outward, of its middle; zero where it has none
};

// Cells that belong together in the tree: some rows of a side, or an end face.
struct Piece {
  std::uint32_t body = 0;
  std::uint32_t first_cell = 0, count = 0;  // first_cell: Face::no_cells where they are left out
  Box3 box;
  double first_v = 0, last_v = 0;  // of the side; of an end face the v at which it stands
  double place = 0;                // its middle, along the yarn, file units of length
  double width = 0;                // of the yarn's section here
  double thickness = 0;            // across its thinner direction
};

// Places of one yarn that are nearer along it than this many widths are one place.
inline constexpr double self_distance = 1.5;

// What is made of one body; its numbers count from the body's own first ones.
struct BodyCells {
  std::vector<Face> faces;  // the side, and what seals its start and its end; none: it has no surface
  std::vector<std::unique_ptr<const nurbs::Surface>> flat_ends;
  std::vector<Cell> cells;
  std::vector<Piece> pieces;  // of the side, along it; then of the ends
  double thickness = 0, length = 0, touching = 0;
  bool is_whole = true;  // the cells of all pieces are there
};
// `wanted`: of each piece whether its cells are made (empty: of all); a piece without them has no box.
BodyCells cells_of(const yarn::Body& body, const std::vector<bool>& wanted = {});

// All bodies' cells.
class CellModel {
 public:
  // `bodies` outlive the model. Empty surfaces take no part.
  CellModel(std::span<const yarn::Body> bodies, int threads);
  // The same of cells that are there, one of each body: one that has no faces takes no part.
  CellModel(std::span<const yarn::Body> bodies, std::vector<BodyCells> cells);

  [[nodiscard]] std::span<const yarn::Body> bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
  [[nodiscard]] const Face& face_of(const Cell& cell) const { return faces_[cell.face]; }
  [[nodiscard]] const Piece& piece_of_cell(std::uint32_t cell) const { return pieces_[piece_of_[cell]]; }
  // No cells of the body are left out.
  [[nodiscard]] bool is_whole(std::size_t body) const { return is_whole_[body]; }
  // The number of the first of a body's pieces.
  [[nodiscard]] std::uint32_t first_piece(std::size_t body) const { return first_pieces_[body]; }
  // The number of the body's side, and of an end face; none where that end is open (or the body a ring).
  [[nodiscard]] std::uint32_t side(std::size_t body) const { return sides_[body]; }
  [[nodiscard]] std::optional<std::uint32_t> end(std::size_t body, bool last) const;
  // Length along the yarn between two places of it; on a ring the shorter way.
  [[nodiscard]] double way_along(const Piece& a, const Piece& b) const;
  // The least thickness of the body's sections (but for those that shrink to a point); 0: it has no surface.
  [[nodiscard]] double thickness(std::size_t body) const { return thickness_[body]; }
  // Depths up to this count as touching: rounding of the coordinates, and what a file that was read resolves.
  [[nodiscard]] double touching(std::size_t body) const { return touching_[body]; }

 private:
  std::span<const yarn::Body> bodies_;
  std::vector<std::unique_ptr<const nurbs::Surface>> flat_ends_;
  std::vector<Face> faces_;
  std::vector<Cell> cells_;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> piece_of_, sides_, first_pieces_;
  std::vector<double> thickness_, length_, touching_;
  std::vector<bool> is_whole_;
};

}  // namespace selvage::contact
