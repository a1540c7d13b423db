// What stands in a STEP file beside geometry: units, products and their places, colours, properties. All that
// a file has once is written once.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/units.h"
#include "formats/step/entity_text.h"
#include "yarn/congruence.h"

namespace selvage::formats::step {

enum class Schema { ap214, ap242 };

// A product, and what others refer to of it.
struct Product {
  Id definition;      // PRODUCT_DEFINITION
  Id shape;           // PRODUCT_DEFINITION_SHAPE
  Id representation;  // the number kept for its SHAPE_REPRESENTATION
};

// What one is made of, and what it is to one who checks his reading. File units; not known: not written.
struct Properties {
  std::optional<double> volume, area;
  std::optional<Vec3> centre;  // of the volume
};

class Products {
 public:
  // Writes what all products refer to. `uncertainty`: below this distance two places are one, file units.
  Products(EntityText& text, Schema schema, Unit units, double uncertainty);

  // A part, or an assembly.
  Product add(std::string_view name);
  // The representation of a part, `type` by its name, which holds the one item.
  void represent(const Product& part, std::string_view type, Id item);
  // The representation of an assembly, whose parts were placed at these.
  void represent_assembly(const Product& assembly, const std::vector<Id>& places);

  // A place for parts: without a motion where they were modelled (always the same entity).
  Id place(const yarn::RigidMotion* motion);
  // A part of an assembly under this name, at a place().
  void add_component(const Product& assembly, const Product& part, std::string_view name, Id place);

  // The colour of a solid or a shell.
  void color(Id item, const yarn::Color& color);
  // What the part is made of: the material's name, may be empty, and its density, g/cm3, 0: not known.
  void made_of(const Product& part, std::string_view material, double density);
  // A part's solid or shell is on the layer of this name; write_layers() writes all layers.
  void on_layer(std::string_view name, Id item) { layers_[std::string(name)].push_back(item); }
  void write_layers();
  // Volume, area and centre, by the CAx-IF's recommended practice for validation properties.
  void validate(const Product& product, const Properties& properties);

 private:
  void write_units(Unit units, double uncertainty);
  Id axes(const Vec3& origin, const Vec3& z, const Vec3& x);
  Id style_of(const yarn::Color& color);

  EntityText& text_;
  Id product_context_, definition_context_;
  Id length_, area_, volume_;  // units
  Id density_;                 // of grams and centimetres; written when the first part has one
  Id context_;                 // of all representations
  Id modelled_, unmoved_;      // the axes in which parts are modelled, and those in which they are placed
  std::map<std::array<int, 3>, Id> styles_;
  std::map<std::string, std::vector<Id>> layers_;
  int placed_ = 0;
};

}  // namespace selvage::formats::step
