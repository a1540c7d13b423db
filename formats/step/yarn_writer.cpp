#include "formats/step/yarn_writer.h"

#include <fmt/format.h>

#include "core/clock.h"
#include "formats/step/options.h"
#include "formats/step/yarn_faces.h"
#include "formats/step/yarn_measures.h"

namespace selvage::formats::step {

namespace {

// Below this two places are one for the reading system, mm. The solids' faces share their edges, so their
// joints are as exact as doubles are; this is small against the finest fibre.
constexpr double uncertainty = 1e-7;

constexpr std::string_view program = "selvage 0.1.0";

// What the parts of an assembly measure together.
struct Sum {
  double area = 0, volume = 0;
  Vec3 first = Vec3::Zero();  // centre times volume
  bool is_closed = true;

  void add(const YarnMeasures& part, const yarn::RigidMotion* motion) {
    area += part.area;
    volume += part.volume;
    first += part.volume * (motion != nullptr ? (*motion)(part.centre) : part.centre);
    is_closed = is_closed && part.is_closed;
  }
};

Properties properties_of(const YarnMeasures& measures) {
  Properties properties{.volume = {}, .area = measures.area, .centre = {}};
  if (measures.is_closed) {
    properties.volume = measures.volume;
    properties.centre = measures.centre;
  }
  return properties;
}

Properties properties_of(const Sum& sum) {
  return properties_of(YarnMeasures{sum.is_closed, sum.area, sum.volume,
                                    sum.volume > 0 ? Vec3(sum.first / sum.volume) : Vec3::Zero()});
}

void write_head(EntityText& text, Schema schema, const SurfaceOptions& options) {
  const auto line = [&](std::string_view name, const auto&... attributes) {
    text.part(name, attributes...);
    text.end();
  };
  text.token("ISO-10303-21;\nHEADER;\n");
  line("FILE_DESCRIPTION", std::array{Quoted{options.title}}, "'2;1'");
  const std::array nobody{Quoted{""}};
  line("FILE_NAME", Quoted{options.file_name}, Quoted{iso_timestamp()}, nobody, nobody, Quoted{program},
       Quoted{program}, "''");
  line("FILE_SCHEMA",
       std::array{Quoted{schema == Schema::ap242
                             ? "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"
                             : "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }"}});
  text.token("ENDSEC;\nDATA;\n");
}

class YarnWriter : public BodyWriter {
 public:
  YarnWriter(OutputFile& output, const SurfaceOptions& options, Schema schema)
      : text_(output, options.threads),
        products_(begun(text_, schema, options), schema, options.units,
                  uncertainty / millimetres_per(options.units)),
        faces_(text_) {
    whole_.product = products_.add(options.title.empty() ? "fabric" : options.title);
  }

  Status add(const yarn::Body& body) override {
    const Result<Part> part = write_part(body);
    if (!part) return part.error();
    place(*part, body, nullptr);
    return {};
  }

  Status add_instance(const yarn::Body& body, const Instance& instance) override {
    auto known = shapes_.find(instance.shape);
    if (known == shapes_.end()) {
      const Result<Part> part = write_part(*instance.body);
      if (!part) return part.error();
      known = shapes_.emplace(instance.shape, *part).first;
    }
    place(known->second, body, &instance.motion);
    return {};
  }

  Result<WriteFacts> finish() override {
    if (count_ == 0) return error(Kind::geometry, "there is neither a yarn nor a piece to write");
    for (const auto& [name, group] : groups_) complete(group);
    complete(whole_);
    products_.write_layers();
    text_.token("ENDSEC;\nEND-ISO-10303-21;\n");
    if (Status status = text_.finish(); !status.ok()) return status.error();
    return std::move(facts_);
  }

 private:
  struct Part {
    Product product;
    YarnMeasures measures;
  };
  struct Assembly {
    Product product;
    std::vector<Id> places;  // of parts that are not where they were modelled
    Sum sum;
  };

  static EntityText& begun(EntityText& text, Schema schema, const SurfaceOptions& options) {
    write_head(text, schema, options);
    return text;
  }

  Result<Part> write_part(const yarn::Body& body) {
    const Result<YarnMeasures> measures = measures_.of(body);
    if (!measures) return measures.error();
    Part part{products_.add(body.name), *measures};
    const YarnFaces::Shape shape = faces_.write(body);
    ++facts_.entities[shape.is_solid ? "MANIFOLD_SOLID_BREP" : "SHELL_BASED_SURFACE_MODEL"];
    if (!shape.is_solid)
      facts_.messages.push_back(
          warning(Kind::geometry,
                  fmt::format("yarn '{}' has no end faces: it is written as an open shell, "
                              "not as a solid; --ends patch closes it",
                              body.name),
                  about(body)));
    products_.represent(
        part.product,
        shape.is_solid ? "ADVANCED_BREP_SHAPE_REPRESENTATION" : "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
        shape.item);
    products_.color(shape.item, body.color);
    products_.on_layer(yarn::name_of(body.role), shape.item);
    products_.made_of(part.product, body.material, shape.is_solid ? body.density : 0);
    products_.validate(part.product, properties_of(*measures));
    return part;
  }

  // Plies and filaments are parts of an assembly of their own, named as the yarn that they make up.
  Assembly& assembly_of(const std::string& group) {
    if (group.empty()) return whole_;
    const auto [known, is_new] = groups_.try_emplace(group);
    if (is_new) {
      known->second.product = products_.add(group);
      products_.add_component(whole_.product, known->second.product, group, products_.place(nullptr));
    }
    return known->second;
  }

  void place(const Part& part, const yarn::Body& body, const yarn::RigidMotion* motion) {
    ++count_;
    Assembly& assembly = assembly_of(body.group);
    const Id at = products_.place(motion);
    if (motion != nullptr) assembly.places.push_back(at);
    products_.add_component(assembly.product, part.product, body.name, at);
    assembly.sum.add(part.measures, motion);
    if (&assembly != &whole_) whole_.sum.add(part.measures, motion);
  }

  void complete(const Assembly& assembly) {
    products_.represent_assembly(assembly.product, assembly.places);
    products_.validate(assembly.product, properties_of(assembly.sum));
  }

  EntityText text_;
  Products products_;
  YarnFaces faces_;
  MeasuredYarns measures_;
  Assembly whole_;
  std::map<std::string, Assembly> groups_;  // by the yarn's name
  std::map<std::size_t, Part> shapes_;      // that stand in several places, by their number
  std::size_t count_ = 0;
  WriteFacts facts_;
};

}  // namespace

Result<Schema> schema_of(const SurfaceOptions& options) {
  const std::string_view schema = options.own.text(option::schema);
  if (schema == "AP242") return Schema::ap242;
  if (schema == "AP214") return Schema::ap214;
  return error(Kind::usage, fmt::format("unknown STEP schema '{}': AP242 or AP214", schema));
}

Result<std::unique_ptr<BodyWriter>> open_yarn_writer(OutputFile& output, const SurfaceOptions& options) {
  const Result<Schema> schema = schema_of(options);
  if (!schema) return schema.error();
  return std::unique_ptr<BodyWriter>(std::make_unique<YarnWriter>(output, options, *schema));
}

}  // namespace selvage::formats::step
