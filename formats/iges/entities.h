// One function an entity of IGES 5.3: each writes its directory entry and its parameters and returns its
// directory pointer. Pointers that are arguments are directory pointers.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "formats/iges/records.h"
#include "yarn/body.h"
#include "yarn/congruence.h"
#include "yarn/end_plane.h"

namespace selvage::formats::iges {

// What all entities of one yarn share.
struct Common {
  int color = 0;           // directory pointer of the 314
  int level = 0;           // by role
  std::string_view label;  // the yarn's name
  int name = 0;            // directory pointer of the 406 form 15; 0: none
  std::string_view status = independent;

  [[nodiscard]] Entity entity(int type, int form = 0) const { return entity(type, form, status); }
  [[nodiscard]] Entity entity(int type, int form, std::string_view its_status) const {
    return {type, form, its_status, color, level, label};
  }
};

// The largest magnitude of numbers that are all finite; nothing where one is not, which cannot be written.
std::optional<double> largest_of(std::span<const double> values);
std::optional<double> largest_of(const std::vector<Vec3>& points);
bool is_finite(const nurbs::Surface& surface);
bool is_finite(const nurbs::Curve& curve);
inline constexpr std::string_view not_finite = "has a coordinate, weight or knot that is not a finite number";

// 128, form 0. `property`: of the entity, or 0.
int write_surface(Records& records, const Entity& entity, const nurbs::Surface& surface, int property = 0);

// 126, form 0. `normal`: unit normal of the plane in which the curve lies; null: it lies in none.
// `property` as above.
int write_curve(Records& records, const Entity& entity, const nurbs::Curve& curve, const Vec3* normal,
                int property = 0);

// 144 on a 128, bounded by a 142 of two 126s, of which the one in space is the body's own end curve.
int write_planar_end(Records& records, const Common& common, const yarn::Body& body, bool last);
inline constexpr int entities_of_planar_end = 5;

// 142: the boundary of a trimmed surface by a curve in its parameters and the same in space; `flat_is_true`:
// the first of them is what holds.
int write_boundary(Records& records, const Common& common, int surface, int flat, int spatial,
                   bool flat_is_true = false);
// 144; the outer boundary is the first.
int write_trimmed(Records& records, const Common& common, std::span<const int> boundaries, int surface);
// 102; `status` is that of the curves.
int write_composite(Records& records, const Common& common, std::string_view status,
                    std::span<const int> curves);

int write_group(Records& records, const Common& common, std::span<const int> members);  // 402, form 7
int write_name(Records& records, const Common& common);  // 406, form 15: the label, all of it
int write_level_name(Records& records, int level, std::string_view name);  // 406, form 3
// 308, of members that say that they are dependent; `ascii_name`: of the shape.
int write_definition(Records& records, const Common& common, std::string_view ascii_name,
                     std::span<const int> members);
// 408, after a 124 where the motion turns. Returns the pointer of the 408.
int write_instance(Records& records, const Common& common, int definition, const yarn::RigidMotion& motion);
inline int entities_of_instance(const yarn::RigidMotion& motion) {
  return motion.is_translation() ? 1 : 2;
}
int write_color(Records& records, const yarn::Color& color);  // 314

}  // namespace selvage::formats::iges
