#include "formats/step/products.h"

namespace selvage::formats::step {

namespace {

// (FIRST(...) SECOND(...)): parts in the order of their names.
template <class... Parts>
Id put_complex(EntityText& text, Parts... parts) {
  const Id id = text.reserve();
  text.begin(id);
  text.token("(");
  ((text.token(" "), parts()), ...);
  text.token(" )");
  text.end();
  return id;
}

std::array<double, 3> coordinates(const Vec3& at) {
  return {at.x(), at.y(), at.z()};
}

}  // namespace

Products::Products(EntityText& text, Schema schema, Unit units, double uncertainty) : text_(text) {
  const bool is_242 = schema == Schema::ap242;
  const Id application = text_.put("APPLICATION_CONTEXT",
                                   Quoted{is_242 ? "managed model based 3d engineering"
                                                 : "core data for automotive mechanical design processes"});
  text_.put("APPLICATION_PROTOCOL_DEFINITION", "'international standard'",
            Quoted{is_242 ? "ap242_managed_model_based_3d_engineering" : "automotive_design"},
            is_242 ? 2013 : 2000, application);
  product_context_ = text_.put("PRODUCT_CONTEXT", "''", application, "'mechanical'");
  definition_context_ = text_.put("PRODUCT_DEFINITION_CONTEXT", "'part definition'", application, "'design'");
  write_units(units, uncertainty);
  modelled_ = axes(Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitX());
  unmoved_ = axes(Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitX());
}

void Products::write_units(Unit units, double uncertainty) {
  const auto part = [this](std::string_view name, const auto&... attributes) {
    return [this, name, attributes...] { text_.part(name, attributes...); };
  };
  const auto metres = [&](const char* prefix) {
    return put_complex(text_, part("LENGTH_UNIT"), part("NAMED_UNIT", "*"),
                       part("SI_UNIT", prefix, ".METRE."));
  };
  if (units == Unit::inch) {
    const Id exponents = text_.put("DIMENSIONAL_EXPONENTS", 1., 0., 0., 0., 0., 0., 0.);
    const Id size = text_.put("LENGTH_MEASURE_WITH_UNIT", Measure{"LENGTH_MEASURE", millimetres_per(units)},
                              metres(".MILLI."));
    length_ = put_complex(text_, part("CONVERSION_BASED_UNIT", "'INCH'", size), part("LENGTH_UNIT"),
                          part("NAMED_UNIT", exponents));
  } else {
    // In the order of Unit.
    constexpr std::array<const char*, 4> prefixes = {"$", ".CENTI.", ".MILLI.", ".MICRO."};
    length_ = metres(prefixes[static_cast<std::size_t>(units)]);
  }
  const Id angle =
      put_complex(text_, part("NAMED_UNIT", "*"), part("PLANE_ANGLE_UNIT"), part("SI_UNIT", "$", ".RADIAN."));
  const Id solid_angle = put_complex(text_, part("NAMED_UNIT", "*"), part("SI_UNIT", "$", ".STERADIAN."),
                                     part("SOLID_ANGLE_UNIT"));
  const auto power = [&](double exponent) {
    return text_.put("DERIVED_UNIT", std::array{text_.put("DERIVED_UNIT_ELEMENT", length_, exponent)});
  };
  area_ = power(2);
  volume_ = power(3);
  const Id exactness = text_.put("UNCERTAINTY_MEASURE_WITH_UNIT", Measure{"LENGTH_MEASURE", uncertainty},
                                 length_, "'distance_accuracy_value'", "'confusion accuracy'");
  context_ = put_complex(text_, part("GEOMETRIC_REPRESENTATION_CONTEXT", 3),
                         part("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", std::array{exactness}),
                         part("GLOBAL_UNIT_ASSIGNED_CONTEXT", std::array{length_, angle, solid_angle}),
                         part("REPRESENTATION_CONTEXT", "''", "'3D'"));
}

Id Products::axes(const Vec3& origin, const Vec3& z, const Vec3& x) {
  const Id at = text_.put("CARTESIAN_POINT", "''", coordinates(origin));
  const Id axis = text_.put("DIRECTION", "''", coordinates(z)),
           first = text_.put("DIRECTION", "''", coordinates(x));
  return text_.put("AXIS2_PLACEMENT_3D", "''", at, axis, first);
}

Product Products::add(std::string_view name) {
  const Id product = text_.put("PRODUCT", Quoted{name}, Quoted{name}, "''", std::array{product_context_});
  text_.put("PRODUCT_RELATED_PRODUCT_CATEGORY", "'part'", "$", std::array{product});
  const Id formation = text_.put("PRODUCT_DEFINITION_FORMATION", "''", "''", product);
  Product added;
  added.definition = text_.put("PRODUCT_DEFINITION", "'design'", "''", formation, definition_context_);
  added.shape = text_.put("PRODUCT_DEFINITION_SHAPE", "''", "''", added.definition);
  added.representation = text_.reserve();
  text_.put("SHAPE_DEFINITION_REPRESENTATION", added.shape, added.representation);
  return added;
}

void Products::represent(const Product& part, std::string_view type, Id item) {
  text_.put_as(part.representation, type, "''", std::array{modelled_, item}, context_);
}

void Products::represent_assembly(const Product& assembly, const std::vector<Id>& places) {
  std::vector<Id> items = {modelled_, unmoved_};
  items.insert(items.end(), places.begin(), places.end());
  text_.put_as(assembly.representation, "SHAPE_REPRESENTATION", "''", items, context_);
}

Id Products::place(const yarn::RigidMotion* motion) {
  if (motion == nullptr) return unmoved_;
  return axes(motion->offset, motion->rotation.col(2), motion->rotation.col(0));
}

void Products::add_component(const Product& assembly, const Product& part, std::string_view name, Id place) {
  const Id use = text_.put("NEXT_ASSEMBLY_USAGE_OCCURRENCE", Quoted{std::to_string(++placed_)}, Quoted{name},
                           "''", assembly.definition, part.definition, "$");
  const Id shape = text_.put("PRODUCT_DEFINITION_SHAPE", "'Placement'", "'Placement of an item'", use);
  const Id motion = text_.put("ITEM_DEFINED_TRANSFORMATION", "''", "''", modelled_, place);
  const Id relation = put_complex(
      text_,
      [&] {
        text_.part("REPRESENTATION_RELATIONSHIP", "''", "''", part.representation, assembly.representation);
      },
      [&] { text_.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION", motion); },
      [&] { text_.part("SHAPE_REPRESENTATION_RELATIONSHIP"); });
  text_.put("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION", relation, shape);
}

Id Products::style_of(const yarn::Color& color) {
  Id& style = styles_[{color.red, color.green, color.blue}];
  if (style.number != 0) return style;
  const Id rgb = text_.put("COLOUR_RGB", "''", color.red / 255.0, color.green / 255.0, color.blue / 255.0);
  const Id fill =
      text_.put("FILL_AREA_STYLE", "''", std::array{text_.put("FILL_AREA_STYLE_COLOUR", "''", rgb)});
  const Id side =
      text_.put("SURFACE_SIDE_STYLE", "''", std::array{text_.put("SURFACE_STYLE_FILL_AREA", fill)});
  const Id usage = text_.put("SURFACE_STYLE_USAGE", ".BOTH.", side);
  return style = text_.put("PRESENTATION_STYLE_ASSIGNMENT", std::array{usage});
}

void Products::color(Id item, const yarn::Color& color) {
  const Id styled = text_.put("STYLED_ITEM", "'color'", std::array{style_of(color)}, item);
  text_.put("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION", "''", std::array{styled}, context_);
}

void Products::made_of(const Product& part, std::string_view material, double density) {
  const auto property = [&](std::string_view name, Id item) {
    const Id definition =
        text_.put("PROPERTY_DEFINITION", "'material property'", Quoted{name}, part.definition);
    const Id representation = text_.put("REPRESENTATION", Quoted{name}, std::array{item}, context_);
    text_.put("PROPERTY_DEFINITION_REPRESENTATION", definition, representation);
  };
  if (!material.empty())
    property("material name",
             text_.put("DESCRIPTIVE_REPRESENTATION_ITEM", Quoted{material}, Quoted{material}));
  if (!(density > 0)) return;
  if (density_.number == 0) {
    const auto unit = [this](std::string_view kind, const char* prefix, const char* name) {
      return put_complex(
          text_, [&] { text_.part(kind); }, [&] { text_.part("NAMED_UNIT", "*"); },
          [&] { text_.part("SI_UNIT", prefix, name); });
    };
    const Id gram = unit("MASS_UNIT", "$", ".GRAM."), centimetre = unit("LENGTH_UNIT", ".CENTI.", ".METRE.");
    density_ = text_.put("DERIVED_UNIT", std::array{text_.put("DERIVED_UNIT_ELEMENT", gram, 1.),
                                                    text_.put("DERIVED_UNIT_ELEMENT", centimetre, -3.)});
  }
  property("density", text_.put("MEASURE_REPRESENTATION_ITEM", "'density measure'",
                                Measure{"POSITIVE_RATIO_MEASURE", density}, density_));
}

void Products::write_layers() {
  for (const auto& [name, items] : layers_)
    text_.put("PRESENTATION_LAYER_ASSIGNMENT", Quoted{name}, "''", items);
}

void Products::validate(const Product& product, const Properties& properties) {
  std::vector<Id> items;
  if (properties.volume)
    items.push_back(text_.put("MEASURE_REPRESENTATION_ITEM", "'volume measure'",
                              Measure{"VOLUME_MEASURE", *properties.volume}, volume_));
  if (properties.area)
    items.push_back(text_.put("MEASURE_REPRESENTATION_ITEM", "'surface area measure'",
                              Measure{"AREA_MEASURE", *properties.area}, area_));
  if (properties.centre)
    items.push_back(text_.put("CARTESIAN_POINT", "'centre point'", coordinates(*properties.centre)));
  for (const Id item : items) {
    const Id property =
        text_.put("PROPERTY_DEFINITION", "'geometric validation property'", "''", product.shape);
    const Id representation = text_.put("REPRESENTATION", "''", std::array{item}, context_);
    text_.put("PROPERTY_DEFINITION_REPRESENTATION", property, representation);
  }
}

}  // namespace selvage::formats::step
