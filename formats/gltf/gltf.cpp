#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/little_endian.h"
#include "core/words.h"
#include "formats/gltf/buffer.h"
#include "formats/registry.h"
#include "solid/single_precision.h"
#include "yarn/color_text.h"

namespace selvage::formats::gltf {

namespace {

constexpr std::string_view magic = "glTF";
constexpr std::size_t chunk_header = 8, file_header = 12, text_begin = file_header + chunk_header;

bool looks_like_glb(std::string_view head) {
  return head.starts_with(magic);
}

// With its quotes; bytes that are no UTF-8 are replaced.
std::string json_text(std::string_view text) {
  return nlohmann::json(std::string(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// The numbers of accessors are bits of enumerations of OpenGL.
constexpr int float_type = 5126, unsigned_type = 5125, array_buffer = 34962, index_buffer = 34963;

// A share of sRGB's scale as the linear light that glTF has (IEC 61966-2-1).
float linear(int part) {
  const double share = part / 255.0;
  return static_cast<float>(share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4));
}

// The arrays of the JSON text, each of which grows with the yarns; the buffer comes before them in a .gltf.
struct Arrays {
  std::unique_ptr<Spool> nodes, meshes, accessors, views;
};

class Writer final : public BodyWriter {
 public:
  static Result<std::unique_ptr<BodyWriter>> open(OutputFile& output, const SurfaceOptions& options) {
    const bool is_embedded = same_word(output.target().extension().string(), ".gltf");
    Arrays arrays;
    std::unique_ptr<Spool> binary;
    for (std::unique_ptr<Spool>* spool :
         {&arrays.nodes, &arrays.meshes, &arrays.accessors, &arrays.views, &binary}) {
      if (spool == &binary && is_embedded) continue;
      Result<std::unique_ptr<Spool>> made = Spool::beside(output);
      if (!made) return made.error();
      *spool = std::move(*made);
    }
    return std::unique_ptr<BodyWriter>(new Writer(output, options, std::move(arrays), std::move(binary)));
  }

  Status add(const yarn::Body& body) override {
    if (Status made = put_mesh(body); !made) return made;
    put_node(body, meshes_ - 1, {});
    return {};
  }

  Status add_instance(const yarn::Body& body, const Instance& instance) override {
    const auto [mesh, is_new] = mesh_of_shape_.try_emplace(instance.shape, meshes_);
    if (is_new)
      if (Status made = put_mesh(*instance.body); !made) return made;
    put_node(body, mesh->second, instance.motion);
    return {};
  }

  Result<WriteFacts> finish() override {
    if (nodes_ == 0) return error(Kind::geometry, "there is no yarn to write");
    buffer_.close();
    if (buffer_.is_embedded()) text_ << "\",";
    text_ << "\"byteLength\":" << buffer_.size() << "}]";
    if (Status put = put_arrays(); !put) return put.error();
    if (!buffer_.is_embedded())
      if (Status put = put_chunks(); !put) return put.error();
    Result<WriteFacts> facts =
        finished(text_, {{"nodes", nodes_}, {"meshes", meshes_}, {"triangles", triangles_}});
    if (!facts) return facts;
    if (std::optional<Message> warning = precision_.warning("glTF", options_.units))
      facts->messages.push_back(std::move(*warning));
    return facts;
  }

 private:
  Writer(OutputFile& output, const SurfaceOptions& options, Arrays arrays, std::unique_ptr<Spool> binary)
      : output_(&output),
        options_(options),
        text_(output),
        arrays_(std::move(arrays)),
        buffer_(text_, std::move(binary)) {
    // Of a .glb lengths stand here in the end.
    if (!buffer_.is_embedded()) text_ << std::string(text_begin, '\0');
    text_ << R"({"asset":{"version":"2.0","generator":"Selvage )" SELVAGE_VERSION R"("},"buffers":[{)";
    if (buffer_.is_embedded()) text_ << R"("uri":"data:application/octet-stream;base64,)";
  }

  Status put_mesh(const yarn::Body& body) {
    const double chord = chord_height(options_, body);
    Result<solid::Tessellation> made = solid::tessellate(body, chord);
    if (!made) return made.error();
    const Result<solid::SingleSkin> skin = solid::in_single_precision(body, std::move(*made));
    if (!skin) return skin.error();
    precision_.look(body, skin->spacing, chord);
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : skin->vertices) box.extend(p);
    const std::size_t count = skin->vertices.size(), corners = 3 * skin->triangles.size();
    const std::uint64_t begin = buffer_.size();
    for (const Eigen::Vector3f& p : skin->vertices)
      for (const float x : p) append_little_endian(buffer_, x);
    put_view(begin, array_buffer);
    const std::uint64_t middle = buffer_.size();
    for (const auto& t : skin->triangles)
      for (const std::uint32_t corner : t) append_little_endian(buffer_, corner);
    put_view(middle, index_buffer);

    TextBuffer& accessors = next(arrays_.accessors, meshes_);
    accessors << R"({"bufferView":)" << 2 * meshes_ << R"(,"componentType":)" << float_type << R"(,"count":)"
              << count << R"(,"type":"VEC3","min":)";
    put_vector(accessors, box.min());
    accessors << R"(,"max":)";
    put_vector(accessors, box.max());
    accessors << R"(},{"bufferView":)" << 2 * meshes_ + 1 << R"(,"componentType":)" << unsigned_type
              << R"(,"count":)" << corners << R"(,"type":"SCALAR"})";
    next(arrays_.meshes, meshes_) << R"({"name":)" << json_text(body.name)
                                  << R"(,"primitives":[{"attributes":{"POSITION":)" << 2 * meshes_
                                  << R"(},"indices":)" << 2 * meshes_ + 1 << R"(,"material":)"
                                  << material_of(body.color) << "}]}";
    ++meshes_;
    triangles_ += skin->triangles.size();
    return {};
  }

  // The bytes of the buffer from `begin` on.
  void put_view(std::uint64_t begin, int target) {
    next(arrays_.views, views_++) << R"({"buffer":0,"byteOffset":)" << begin << R"(,"byteLength":)"
                                  << buffer_.size() - begin << R"(,"target":)" << target << '}';
  }

  void put_node(const yarn::Body& body, std::size_t mesh, const yarn::RigidMotion& motion) {
    TextBuffer& nodes = next(arrays_.nodes, nodes_++);
    nodes << R"({"name":)" << json_text(body.name) << R"(,"mesh":)" << mesh;
    if (!motion.is_translation()) {
      nodes << R"(,"matrix":[)";
      for (Eigen::Index column = 0; column < 3; ++column) {
        for (Eigen::Index row = 0; row < 3; ++row) nodes << motion.rotation(row, column) + 0.0 << ',';
        nodes << "0,";
      }
      for (const double x : motion.offset) nodes << x + 0.0 << ',';
      nodes << "1]";
    } else if (!motion.offset.isZero(0)) {
      nodes << R"(,"translation":)";
      put_vector(nodes, motion.offset);
    }
    nodes << R"(,"extras":{"role":")" << name_of(body.role) << "\"}}";
  }

  // What follows the buffer, to the end of the text. Node 0 holds all others: in metres, y up.
  Status put_arrays() {
    const double scale = millimetres_per(options_.units) / millimetres_per(Unit::m);
    text_ << R"(,"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":)"
          << json_text(options_.title.empty() ? "yarns" : options_.title) << R"(,"matrix":[)" << scale
          << ",0,0,0,0,0," << -scale << ",0,0," << scale << R"(,0,0,0,0,0,1],"children":[)";
    for (std::size_t k = 1; k <= nodes_; ++k) text_ << (k > 1 ? "," : "") << k;
    text_ << "]},";
    if (Status put = put_array(*arrays_.nodes, R"(],"meshes":[)"); !put) return put;
    if (Status put = put_array(*arrays_.meshes, R"(],"materials":[)"); !put) return put;
    for (std::size_t k = 0; k < materials_.size(); ++k) put_material(k);
    text_ << R"(],"accessors":[)";
    if (Status put = put_array(*arrays_.accessors, R"(],"bufferViews":[)"); !put) return put;
    return put_array(*arrays_.views, "]}");
  }

  Status put_array(Spool& array, std::string_view then) {
    if (Status whole = text_.finish(); !whole) return whole;
    if (Status put = array.append_to(*output_); !put) return put;
    text_ << then;
    return {};
  }

  void put_material(std::size_t k) {
    const yarn::Color& c = materials_[k];
    text_ << (k > 0 ? "," : "") << R"({"name":"color_)" << yarn::hex(c)
          << R"(","pbrMetallicRoughness":{"baseColorFactor":[)" << linear(c.red) << ',' << linear(c.green)
          << ',' << linear(c.blue) << R"(,1],"metallicFactor":0}})";
  }

  // Of a .glb: the chunk of text gets its padding and lengths, and that of the buffer follows.
  Status put_chunks() {
    if (Status whole = text_.finish(); !whole) return whole;
    const std::uint64_t text = output_->size() - text_begin, padding = (4 - text % 4) % 4;
    const std::uint64_t total = text_begin + text + padding + chunk_header + buffer_.size();
    if (total > std::numeric_limits<std::uint32_t>::max())
      return error(Kind::limit,
                   fmt::format("a .glb holds at most 4 GiB, and these yarns need {} bytes: allow a "
                               "larger --chord, or name a .gltf, obj or ply file",
                               total));
    const auto put_number = [](std::string& to, std::uint64_t value) {
      append_little_endian(to, static_cast<std::uint32_t>(value));
    };
    std::string begin(magic), middle(padding, ' ');
    put_number(begin, 2);  // version
    put_number(begin, total);
    put_number(begin, text + padding);
    begin += "JSON";
    put_number(middle, buffer_.size());
    middle += std::string("BIN") + '\0';
    if (Status put = output_->write_at(0, begin); !put) return put;
    if (Status put = output_->write(middle); !put) return put;
    return buffer_.append_to(*output_);
  }

  // The end of an array that has `count` elements.
  static TextBuffer& next(const std::unique_ptr<Spool>& array, std::size_t count) {
    return count > 0 ? array->text() << ',' : array->text();
  }

  template <class Vector>
  static void put_vector(TextBuffer& text, const Vector& v) {
    text << '[' << v.x() << ',' << v.y() << ',' << v.z() << ']';
  }

  std::size_t material_of(const yarn::Color& color) {
    const auto found = std::find(materials_.begin(), materials_.end(), color);
    if (found == materials_.end()) materials_.push_back(color);
    return static_cast<std::size_t>(std::find(materials_.begin(), materials_.end(), color) -
                                    materials_.begin());
  }

  OutputFile* output_;
  SurfaceOptions options_;
  TextBuffer text_;
  Arrays arrays_;
  Buffer buffer_;
  solid::PrecisionWatch precision_;
  std::map<std::size_t, std::size_t> mesh_of_shape_;
  std::vector<yarn::Color> materials_;
  std::size_t nodes_ = 0, meshes_ = 0, views_ = 0, triangles_ = 0;  // nodes but the first
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "gltf",
      .title = "glTF 2.0, triangles of yarns in one file: binary, or text as .gltf",
      .extensions = {".glb", ".gltf"},
      .sniff = looks_like_glb,
      .open_bodies = Writer::open};
  return self;
}

}  // namespace selvage::formats::gltf
