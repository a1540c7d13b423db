// What a CAD file holds, whoever wrote it: surfaces, their trimming, solids, curves, names and colours. The
// readers of IGES and STEP fill it; yarns are recognised in it (cad/recognize.h), files are compared and
// judged by it. Everything is placed (transformations and instances applied) and in the file's unit.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/units.h"
#include "core/vec.h"
#include "nurbs/spline.h"
#include "yarn/body.h"

namespace selvage::cad {

using yarn::Color;

// Where something stands in its file.
struct Origin {
  TextPlace place;     // line 0: unknown
  std::string entity;  // as its format names it: "128 at D37", "#120"; may be empty
};

// One piece of a face's boundary, in the direction of its loop.
struct Edge {
  nurbs::Curve curve;  // in space; without points at a pole, where the surface's own edge has no length, and
                       // where the file gives `flat` only
  nurbs::Curve flat;   // in the surface's parameters, z = 0; without points where the file gives none
  int id = -1;         // the faces of a part that share an edge have it under one id; -1: not shared by name
};
// A closed chain: each edge's end is the next one's start.
struct Loop {
  std::vector<Edge> edges;
};

// What the file says of a thing in it.
struct Label {
  std::string name;  // may be empty
  std::optional<Color> color;
  int level = 0;  // IGES
  Origin origin;

  Label& label() { return *this; }
};

struct Face : Label {
  // As in the file, restricted to the range that the file gives; it need not be clamped.
  nurbs::Surface surface;
  bool reversed = false;    // the face's outside is against S_u x S_v
  std::vector<Loop> loops;  // empty: the whole surface; else the outer one first, then holes
  // Of a whole surface the edges round it that the file has, seams and all: who makes a solid of the faces
  // needs to know which of them they share. Empty: the file has none.
  std::vector<Loop> border;
  // As another program's kernel measured it in the file that it read; none: nobody did. Who makes the face
  // anew has to find it again.
  std::optional<double> area;
};

// What belongs together, by the file's own word.
struct Part : Label {
  enum class Kind {
    surfaces,  // one face, or a group of them (IGES 402 form 7 with nothing but faces in it)
    shell,     // faces joined along their edges, not said to enclose anything
    solid      // faces that enclose a volume (IGES 186, STEP manifold solid); the first shell's come first
  };
  Kind kind = Kind::surfaces;
  std::vector<Face> faces;
  std::string group;  // of the outermost group or assembly below the file that holds it; empty: none
  // What the kernel that read the file made of it, whose lengths times `kernel_scale` are those of the faces:
  // a writer of that kernel gives it back as it was. Null: there is none. Who changes the faces takes it
  // away.
  std::shared_ptr<const void> kernel;
  double kernel_scale = 1;
};

// The face's loops, or the edges round a whole surface.
inline const std::vector<Loop>& boundary_of(const Face& face) {
  return face.loops.empty() ? face.border : face.loops;
}

// Are all edges of all faces shared by name, each by two of them (poles, which have no curve in space, need
// not be)? Not when nothing is known of what bounds a face.
bool has_shared_edges(const Part& part);

struct NamedCurve : Label {
  nurbs::Curve curve;
};

// Of control points; of a part those of its surfaces.
Box3 box_of(const std::vector<Vec3>& points);
Box3 box_of(const Part& part);

struct Model {
  std::string file;  // as messages name it
  std::string title;
  std::string file_name;  // that the file gives itself in its header (IGES); empty: none
  std::string system;     // the program that wrote it, by its header; may be empty
  std::string date;       // YYYYMMDD.HHNNSS of the file; empty: not known
  Unit units = Unit::mm;
  double resolution = 0;              // IGES parameter 19, STEP uncertainty; file units; 0: not given
  std::vector<Part> parts;            // in file order; every face is in one
  std::vector<NamedCurve> curves;     // that stand for themselves
  std::map<int, std::string> levels;  // names of levels, as far as the file gives them (IGES 406 form 3)
  // Every entity of the file, by its format's name ("128", "MANIFOLD_SOLID_BREP"), and of these the ones that
  // are not understood, with a word on what they are ("212 (general note)").
  std::map<std::string, std::uint64_t> entities, unknown;

  [[nodiscard]] std::size_t face_count() const;
};

}  // namespace selvage::cad
