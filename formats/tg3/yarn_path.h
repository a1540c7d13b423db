// The centre line of a TexGen yarn and the frame that carries its sections, between each two of its nodes.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"

namespace selvage::formats::tg3 {

struct PathNode {
  Vec3 position = Vec3::Zero();
  Vec3 tangent = Vec3::Zero();  // zero: along the chord of its neighbours
  Vec3 up = Vec3::UnitZ();
  double angle = 0;  // radians, by which the section's side is turned about `up`
  TextPlace place;
};

// A shift of the line at a share of the way from one node to the next, linear between two of them.
struct Adjustment {
  double t = 0;
  Vec3 by = Vec3::Zero();
};

struct Interpolation {
  enum class Form { bezier, cubic, linear };
  Form form = Form::bezier;
  bool is_periodic = true;                             // the first node follows the last
  bool has_flat_frames = false;                        // the frame's tangent has no z
  bool has_flat_nodes = false;                         // nor have the tangents at the nodes, of a Bezier
  std::vector<std::vector<Adjustment>> adjustments{};  // of each span, by increasing t; may be empty
};

// A place of the line, its frame there, and their derivatives by t. `up` is a unit vector across the frame's
// tangent; `side` is tangent x up, turned about `up` by the nodes' angle.
struct PathJet {
  Vec3 position, side, up;
  Vec3 position_dt, side_dt, up_dt;
};

// The cubic (periodic or natural, over the nodes' numbers), the Beziers whose inner points are a third of the
// chord away along the nodes' tangents, or the chords; `up` is linear between the nodes, and made square to
// the tangent.
class YarnPath {
 public:
  // An `up` that lies along the line at its node is replaced: by that of the nearest node which has a better
  // one, turned as the line turns between them; without such a node by the default of Fabric TXT. Errors
  // (geometry), at the node: fewer than two nodes, equal neighbours, a tangent or `up` that vanishes, an `up`
  // along the line between two nodes.
  static Result<YarnPath> make(std::vector<PathNode> nodes, Interpolation interpolation);

  [[nodiscard]] std::size_t spans() const { return nodes_.size() - 1; }
  [[nodiscard]] const std::vector<PathNode>& nodes() const { return nodes_; }
  // t from 0 to 1; at an adjustment's own t the derivatives are those of the side of `from`.
  [[nodiscard]] PathJet at(std::size_t span, double t, double from) const;
  [[nodiscard]] double length(std::size_t span) const { return lengths_[span]; }
  [[nodiscard]] std::size_t num_replaced_ups() const { return num_replaced_ups_; }
  [[nodiscard]] const Interpolation& interpolation() const { return interpolation_; }
  // The length of the range of a surface's parameter over the span, with which the line is as smooth as it
  // can be.
  [[nodiscard]] double knot_span(std::size_t span) const;

 private:
  struct Line {
    Vec3 position, d1, tangent, tangent_dt;
  };
  [[nodiscard]] Line line_at(std::size_t span, double t, double from) const;
  Status set_tangents();
  void set_cubics();
  void replace_ups();
  Status check_frames() const;

  std::vector<PathNode> nodes_;
  Interpolation interpolation_;
  std::vector<Vec3> tangents_;  // at the nodes; of a cubic the derivatives
  std::vector<double> lengths_;
  std::size_t num_replaced_ups_ = 0;
};

}  // namespace selvage::formats::tg3
