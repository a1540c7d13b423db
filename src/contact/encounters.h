// The pieces of all yarns' surfaces, once for each shape; where yarns come near each other by them; and which
// of these places are the same: what is measured in one of them holds in all.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "contact/contact.h"
#include "contact/face.h"
#include "core/box_tree.h"

namespace selvage::contact {

// By their numbers among the pieces of their bodies.
struct PiecePair {
  std::uint32_t a = 0, b = 0;
};

// Pieces of two bodies (or of one) that are near each other: all that hang together.
struct Encounter {
  std::uint32_t a = 0, b = 0;    // bodies, a <= b
  std::vector<PiecePair> pairs;  // of a body with itself: the one that comes first along it is the first
};

// A place of an encounter: both bodies' pieces, and two more along them to either side, are moved by one
// vector.
struct EncounterPlace {
  std::uint32_t kind = 0;      // into Encounters::kinds
  std::uint32_t a = 0, b = 0;  // bodies
  PiecePair first;             // that stands for the first pair of its kind
};

struct Encounters {
  std::vector<Encounter> kinds;  // each where it was found first
  std::vector<EncounterPlace> places;
};

class PieceModel {
 public:
  // `bodies` outlive the model. Empty surfaces take no part.
  PieceModel(std::span<const yarn::Body> bodies, int threads);

  // The least thickness of all; infinity: there is no surface.
  [[nodiscard]] double thinnest() const { return thinnest_; }
  // 0: it has no surface.
  [[nodiscard]] double thickness(std::size_t body) const { return shape(body).thickness; }
  [[nodiscard]] double touching(std::size_t body) const { return shape(body).touching; }
  [[nodiscard]] const Box3& box(std::size_t body) const {
    return boxes_.box(static_cast<std::uint32_t>(body));
  }
  [[nodiscard]] Box3 box(std::size_t body, std::uint32_t piece) const;
  [[nodiscard]] const std::vector<Piece>& pieces(std::size_t body) const { return shape(body).pieces; }
  // Bodies of one number are one shape.
  [[nodiscard]] std::uint32_t shape_of(std::size_t body) const { return shape_of_[body]; }
  // Pairs of bodies (a < b) whose boxes are no farther apart, by their numbers.
  [[nodiscard]] std::vector<PiecePair> near_bodies(double reach) const;

  // Marks, of each body, the pieces whose cells are looked at where an encounter is measured; of one without
  // pairs all of both bodies. Nothing is marked of bodies that take no part (an empty list).
  void add_needed(const Encounter& encounter, std::vector<std::vector<bool>>& wanted) const;
  // The cells of the pieces that are wanted; none are kept.
  [[nodiscard]] std::vector<BodyCells> take_cells(const std::vector<std::vector<bool>>& wanted);

  // Where bodies are no farther apart than `reach`, for the pairs that are `wanted` (a <= b); each body with
  // itself where it does not lie along itself there. `is_joined`: pairs of pieces that share one are one
  // encounter; else each is one. The same for any number of threads.
  [[nodiscard]] Encounters encounters(double reach, bool is_joined,
                                      const std::function<bool(std::size_t a, std::size_t b)>& wanted) const;

  // A contact that was found in a kind's own place, where it is in another one.
  [[nodiscard]] Contact placed(Contact contact, const Encounter& kind, const EncounterPlace& place) const;
  // The place's own pairs.
  [[nodiscard]] Encounter encounter_at(const Encounter& kind, const EncounterPlace& place) const;

  // Calls visit(piece) for each piece of the body that the ray from the point along +x may meet.
  template <class Visit>
  void along_ray(std::size_t body, const Vec3& point, const Visit& visit) const {
    shape(body).tree.along_ray(point - shifts_[body], visit);
  }

 private:
  struct Shape {
    std::uint32_t body = 0;  // the first that is one
    BodyCells cells;         // of that body, until take_cells()
    std::vector<Piece> pieces;
    double thickness = 0, length = 0, touching = 0;
    std::uint32_t side_pieces = 0;
    std::vector<std::uint32_t> kinds;  // of each piece
    BoxTree tree{{}};                  // of the pieces
  };
  [[nodiscard]] const Shape& shape(std::size_t body) const { return shapes_[shape_of_[body]]; }
  // How far pieces may differ and be of one kind.
  [[nodiscard]] double slack() const { return 1e-7 * thinnest_; }
  void find_kinds();
  [[nodiscard]] bool is_same(const Shape& s, const Piece& a, const Shape& t, const Piece& b) const;
  [[nodiscard]] Vec3 origin(std::size_t body, std::uint32_t piece) const;
  [[nodiscard]] Vec2 moved_site(const Vec2& site, std::uint32_t from, std::uint32_t to,
                                std::int64_t pieces) const;
  [[nodiscard]] std::vector<Encounter> near_pieces(std::uint32_t a, std::uint32_t b, double reach,
                                                   bool is_joined) const;

  std::span<const yarn::Body> bodies_;
  int threads_;
  std::vector<Shape> shapes_;
  std::vector<std::uint32_t> shape_of_;
  std::vector<Vec3> shifts_;  // of each body from the first of its shape
  BoxTree boxes_{{}};         // of the bodies
  double thinnest_;
};

}  // namespace selvage::contact
