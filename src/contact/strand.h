// A yarn that can be moved: its control net, and the smooth displacements that it may have.
//
// A displacement is given by nodes at even steps of arc length (of the yarn as it came), the coefficients of
// cubic B-splines. Each node holds a translation, and amplitudes of plane fields in the section's axes that
// have no divergence, so that areas stay: (psi_y, -psi_x) for psi = x^i y^j, 2 <= i + j <= 4. Sections turn
// with the path: what a translation t(s) adds to the tangent tilts them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::contact {

inline constexpr int translation_modes = 3, shape_modes = 12, all_modes = translation_modes + shape_modes;

// The section's place at one parameter: unit vectors along the path and across it, half extents.
struct Frame {
  Vec3 centre = Vec3::Zero(), along = Vec3::Zero(), x = Vec3::Zero(), y = Vec3::Zero();
  double half_x = 0, half_y = 0;
  bool tilts = true;  // false for an end, which stays in its plane
};

// The four nodes that reach a place, and their B-splines there with derivatives by arc length.
struct Stencil {
  int first = 0;  // node; on a cyclic lattice those past the last are the first ones again
  std::array<double, 4> value{}, slope{}, bend{};
};

// The plane fields at a point of the section, each of size about 1 at the outline.
std::array<Vec2, shape_modes> shape_fields(const Frame& frame, const Vec2& local);
// Degree of the polynomial displacement of each field.
int field_degree(int mode);

// The linear form: component along `direction` of the displacement of a point of the section, by the
// coefficients of the stencil's nodes. `fields`: how many of the plane fields the yarn may use; the first
// three are affine, so that what was convex stays convex, and flat stays flat.
inline constexpr int affine_fields = 3;
using Form = Eigen::Matrix<double, 4 * all_modes, 1>;  // of node k: k * modes .. ; only 4 * modes are used
void displacement_form(const Frame& frame, const Stencil& stencil, const Vec3& point, const Vec3& direction,
                       int modes, int fields, Form& form);

class Strand {
 public:
  // `spacing`: wanted distance of the nodes. Rows are inserted where they stand farther apart.
  Strand(yarn::Body body, double spacing);

  // Puts it on a lattice that it shares with others: its first point stands at `origin` (>= 0) of the
  // lattice. Cyclic: node `nodes` is the first one again.
  void set_lattice(double spacing, double origin, int nodes, bool cyclic);

  // The plane fields that it may use: all, affine_fields, or none.
  int allowed_fields = shape_modes;

  [[nodiscard]] const yarn::Body& body() const { return body_; }
  [[nodiscard]] double length() const { return length_; }    // of the centre line as it came
  [[nodiscard]] double spacing() const { return spacing_; }  // of the nodes
  [[nodiscard]] int nodes() const { return nodes_; }         // of its lattice
  [[nodiscard]] bool is_cyclic() const { return body_.closed_along; }
  [[nodiscard]] bool has_cyclic_lattice() const { return cyclic_; }
  [[nodiscard]] double thickness() const { return thickness_; }  // yarn::narrowest_section as it came
  [[nodiscard]] double width() const { return width_; }          // largest extent of a section

  [[nodiscard]] Stencil stencil(double arc) const;
  [[nodiscard]] double arc_of(double v) const;
  [[nodiscard]] double parameter_at(double arc) const;
  [[nodiscard]] Vec3 centre_at(double arc) const;
  // A frame from the surface as it is now.
  [[nodiscard]] Frame frame_at(double v) const;
  [[nodiscard]] const Frame& row_frame(int j) const { return row_frames_[static_cast<std::size_t>(j)]; }
  [[nodiscard]] const Stencil& row_stencil(int j) const { return row_stencils_[static_cast<std::size_t>(j)]; }
  [[nodiscard]] int rows() const { return body_.surface.count_v; }

  // Moves the control points by the displacement with these coefficients (nodes x modes, node by node) times
  // `factor`, then brings every section back to its own area.
  void move(const Eigen::Ref<const Eigen::VectorXd>& coefficients, int modes, double factor);
  // The largest translation of a control point by these coefficients.
  [[nodiscard]] double largest_move(const Eigen::Ref<const Eigen::VectorXd>& coefficients, int modes) const;

 private:
  void measure();  // frames and centre line of the present net
  void restore_areas();
  [[nodiscard]] double row_area(int j) const;

  yarn::Body body_;
  nurbs::Curve centres_;
  std::vector<double> table_v_, table_arc_;
  double length_ = 0, spacing_ = 0, origin_ = 0, thickness_ = 0, width_ = 0;
  int nodes_ = 0;
  bool cyclic_ = false;  // the lattice
  std::vector<Stencil> row_stencils_;
  std::vector<Frame> row_frames_;
  std::vector<double> row_arcs_, row_areas_;
};

}  // namespace selvage::contact
