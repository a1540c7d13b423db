#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/readable.h"
#include "formats/registry.h"
#include "solid/tessellation.h"
#include "yarn/color_text.h"

namespace selvage::formats::obj {

namespace {

// A name ends at a blank, and a line that ends with a backslash goes on.
std::string word_of(std::string_view name) {
  std::string word = readable(name);
  std::ranges::replace_if(
      word, [](char c) { return c == ' ' || c == '\\'; }, '_');
  return word.empty() ? "_" : word;
}

// What the library of materials calls the yarn's colour.
std::string material_of(const yarn::Body& body) {
  return "color_" + yarn::hex(body.color);
}

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options) : options_(options), text_(output) {
    text_ << "# Selvage " SELVAGE_VERSION ", unit: " << name_of(options_.units) << '\n';
    if (!options_.title.empty()) text_ << "# " << readable(options_.title) << '\n';
    if (!options_.companion.empty()) text_ << "mtllib " << readable(options_.companion) << '\n';
  }

  Status add(const yarn::Body& body) override {
    const Result<solid::Tessellation> skin = solid::tessellate(body, chord_height(options_, body));
    if (!skin) return skin.error();
    const std::string name = word_of(body.name);
    text_ << "o " << name << "\ng " << name << '\n';
    if (!options_.companion.empty()) text_ << "usemtl " << material_of(body) << '\n';
    for (const Vec3& p : skin->vertices)
      text_ << "v " << p.x() + 0.0 << ' ' << p.y() + 0.0 << ' ' << p.z() + 0.0 << '\n';
    for (const auto& t : skin->triangles) {
      text_ << 'f';
      for (const std::uint32_t corner : t) text_ << ' ' << vertices_ + corner + 1;  // from 1
      text_ << '\n';
    }
    vertices_ += skin->vertices.size();
    triangles_ += skin->triangles.size();
    ++yarns_;
    return {};
  }

  Result<WriteFacts> finish() override {
    if (yarns_ == 0) return error(Kind::geometry, "there is no yarn to write");
    return finished(text_, {{"objects", yarns_}, {"vertices", vertices_}, {"triangles", triangles_}});
  }

 private:
  SurfaceOptions options_;
  TextBuffer text_;
  std::size_t vertices_ = 0, triangles_ = 0, yarns_ = 0;
};

class MaterialWriter final : public BodyWriter {
 public:
  MaterialWriter(OutputFile& output, const SurfaceOptions& /*options*/) : text_(output) {
    text_ << "# Selvage " SELVAGE_VERSION "\n";
  }

  Status add(const yarn::Body& body) override {
    const std::string name = material_of(body);
    if (!names_.insert(name).second) return {};
    constexpr double most = 255;
    const yarn::Color& c = body.color;
    text_ << "newmtl " << name << "\nKd " << c.red / most << ' ' << c.green / most << ' ' << c.blue / most
          << '\n';
    return {};
  }

  Result<WriteFacts> finish() override { return finished(text_, {{"materials", names_.size()}}); }

 private:
  TextBuffer text_;
  std::set<std::string> names_;
};

}  // namespace

const Descriptor& material_descriptor() {
  static const Descriptor self = {.name = "mtl",
                                  .title = "Colours of an OBJ file, which it comes with",
                                  .extensions = {".mtl"},
                                  .open_bodies = open_by<MaterialWriter>,
                                  .carries_surfaces = false,
                                  .is_companion = true};
  return self;
}

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "obj",
      .title = "Wavefront OBJ, triangles of yarns as named objects, colours beside",
      .extensions = {".obj"},
      .open_bodies = open_by<Writer>,
      .companion = {.format = material_descriptor}};
  return self;
}

}  // namespace selvage::formats::obj
