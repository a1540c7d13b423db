// Which entity types are understood, and by what function: one row a type, one list a file of functions.
#pragma once

#include <span>

#include "formats/iges/reading.h"

namespace selvage::formats::iges {

// Each function reads the parameters (the cursor stands behind the type number) up to, not including, the
// pointers to associativities and properties. It gives the shape before the entity's own transformation.
// Where it fails it says so in the parameters (fail, give_up); nothing comes back then.
struct EntityType {
  int number = 0;
  // Null where an entity of this type is no such thing.
  std::optional<nurbs::Curve> (*curve)(Reading&, const DirectoryEntry&, Parameters&) = nullptr;
  std::optional<nurbs::Surface> (*surface)(Reading&, const DirectoryEntry&, Parameters&) = nullptr;
  std::optional<cad::Face> (*face)(Reading&, const DirectoryEntry&, Parameters&) = nullptr;  // 143, 144
  std::optional<cad::Part> (*part)(Reading&, const DirectoryEntry&, Parameters&) = nullptr;  // 186, 514
  // Puts what it holds into the model by Reading::stand(): groups, instances. `context` has this entity's own
  // transformation in it already.
  void (*stand)(Reading&, const DirectoryEntry&, Parameters&, const Context&) = nullptr;
  // The entities that it holds and that do not stand in the model by themselves: groups, subfigure
  // definitions.
  std::vector<int> (*members)(Reading&, const DirectoryEntry&, Parameters&) = nullptr;
  // Which forms are understood; null: all.
  bool (*has_form)(int form) = nullptr;
};

// Null for a type (or form) that is not understood.
const EntityType* type_of(const DirectoryEntry& entry);

// The lists.
std::span<const EntityType> bspline_types();    // 126, 128
std::span<const EntityType> curve_types();      // 100, 102, 104, 106, 110, 112, 116, 123
std::span<const EntityType> surface_types();    // 114, 118, 120, 122
std::span<const EntityType> analytic_types();   // 108, 190, 192, 194, 196, 198
std::span<const EntityType> trimming_types();   // 141, 142, 143, 144
std::span<const EntityType> offset_types();     // 130, 140
std::span<const EntityType> subfigure_types();  // 308, 408, 412, 414
std::span<const EntityType> topology_types();   // 186, 514, 510, 508, 504, 502
std::span<const EntityType> structure_types();  // 124, 314, 402, 406 and what needs no function

}  // namespace selvage::formats::iges
