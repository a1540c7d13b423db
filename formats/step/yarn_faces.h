// A yarn as entities of a STEP file: geometry and topology, stated and not found by sewing.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "formats/step/entity_text.h"
#include "yarn/body.h"

namespace selvage::formats::step {

// Body and end face share the edges between them, whose curve is the body's own end curve (patch: its four
// quarters). Curves are in space only: every one is a line of constant u or v, or lies in a plane. Points of
// a yarn's borders that are equal to the bit are one entity.
class YarnFaces {
 public:
  explicit YarnFaces(EntityText& text) : text_(text) {}

  struct Shape {
    Id item;                // MANIFOLD_SOLID_BREP or SHELL_BASED_SURFACE_MODEL, with the body's name
    bool is_solid = false;  // else it has an end without a face
  };
  // Precondition: every number is finite.
  Shape write(const yarn::Body& body);

 private:
  struct Bits {
    std::array<std::uint64_t, 3> words;
    bool operator==(const Bits&) const = default;
  };
  struct Digest {
    std::size_t operator()(const Bits& bits) const {
      std::uint64_t digest = 0;
      for (const std::uint64_t word : bits.words) digest = (digest ^ word) * 0x9E3779B97F4A7C15U;
      return digest ^ digest >> 32U;
    }
  };
  // The edges along the outline of an end, one after the other, and the vertices where they begin.
  struct Outline {
    std::vector<Id> corners, edges;
  };
  struct Use {  // of an edge, in its own direction or against it
    Id edge;
    bool is_forward;
  };

  Id new_point(const Vec3& at) {
    return text_.put("CARTESIAN_POINT", "''", std::array{at.x(), at.y(), at.z()});
  }
  Id point(const Vec3& at);
  // The number of a border's point; one that is new gets its own, and is_new is told.
  std::pair<Id, bool> number_of(const Vec3& at);
  Id direction(const Vec3& along) {
    return text_.put("DIRECTION", "''", std::array{along.x(), along.y(), along.z()});
  }
  Id vertex(const Vec3& at) { return text_.put("VERTEX_POINT", "''", point(at)); }
  Id curve(const nurbs::Curve& curve);
  Id surface(const nurbs::Surface& surface, bool is_closed_u, bool is_closed_v);
  Id edge(const nurbs::Curve& along, Id from, Id to);

  Outline outline(const yarn::Body& body, bool last);
  // `loop` runs counter-clockwise about the surface's own normal.
  void face(Id surface, const std::vector<Use>& loop, bool is_inward);
  void tube(const yarn::Body& body, const Outline& start, const Outline& end);
  void ring(const yarn::Body& body);
  void end_face(const yarn::Body& body, const Outline& outline, bool last);

  EntityText& text_;
  std::unordered_map<Bits, Id, Digest> points_;  // of this yarn's borders
  std::vector<Id> faces_;
};

}  // namespace selvage::formats::step
