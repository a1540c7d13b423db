// The edges of faces, and the shells that they make by them.
#pragma once

#include <cstddef>
#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// The edges of loops, loop by loop; `Loops` is const where they are.
template <class Loops>
class EdgeRange {
 public:
  class Iterator {
   public:
    Iterator(Loops& loops, std::size_t loop) : loops_(&loops), loop_(loop) { skip_empty(); }
    auto& operator*() const { return (*loops_)[loop_].edges[edge_]; }
    Iterator& operator++() {
      ++edge_;
      skip_empty();
      return *this;
    }
    bool operator==(const Iterator&) const = default;

   private:
    void skip_empty() {
      for (; loop_ < loops_->size() && edge_ == (*loops_)[loop_].edges.size(); ++loop_) edge_ = 0;
    }
    Loops* loops_;
    std::size_t loop_, edge_ = 0;
  };
  explicit EdgeRange(Loops& loops) : loops_(loops) {}
  [[nodiscard]] Iterator begin() const { return {loops_, 0}; }
  [[nodiscard]] Iterator end() const { return {loops_, loops_.size()}; }

 private:
  Loops& loops_;
};

inline auto edges_of(const Face& face) {
  return EdgeRange(face.loops);
}
inline auto edges_of(Face& face) {
  return EdgeRange(face.loops);
}

// Those of a whole surface, too (Face::border).
inline auto boundary_edges_of(const Face& face) {
  return EdgeRange(boundary_of(face));
}
inline auto boundary_edges_of(Face& face) {
  return EdgeRange(face.loops.empty() ? face.border : face.loops);
}

// The numbers of the faces that hang together by edges of one id (poles aside), in the order of their first
// ones.
std::vector<std::vector<std::size_t>> shells_of(const std::vector<Face>& faces);

}  // namespace selvage::cad
