#include <fmt/format.h>

#include <limits>

#include "core/little_endian.h"
#include "core/readable.h"
#include "core/spool.h"
#include "formats/registry.h"
#include "solid/tessellation.h"

namespace selvage::formats::ply {

namespace {

bool looks_like_ply(std::string_view head) {
  return head.starts_with("ply\n") || head.starts_with("ply\r");
}

// The file is its header, which counts, then all vertices, then all faces: each waits for those before it.
class Writer final : public BodyWriter {
 public:
  static Result<std::unique_ptr<BodyWriter>> open(OutputFile& output, const SurfaceOptions& options) {
    std::array<std::unique_ptr<Spool>, 3> spools;
    for (std::unique_ptr<Spool>& spool : spools) {
      Result<std::unique_ptr<Spool>> made = Spool::beside(output);
      if (!made) return made.error();
      spool = std::move(*made);
    }
    return std::unique_ptr<BodyWriter>(new Writer(output, options, std::move(spools)));
  }

  Status add(const yarn::Body& body) override {
    const Result<solid::Tessellation> skin = solid::tessellate(body, chord_height(options_, body));
    if (!skin) return skin.error();
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (vertices_ + skin->vertices.size() > most)
      return error(Kind::limit,
                   fmt::format("PLY numbers at most {} vertices, and these yarns have more: allow a larger "
                               "--chord, or write obj",
                               most));
    TextBuffer &names = spools_[0]->text(), &vertices = spools_[1]->text(), &faces = spools_[2]->text();
    names << "comment yarn " << yarns_ << ": " << readable(body.name) << '\n';
    const std::array<int, 3> color = {body.color.red, body.color.green, body.color.blue};
    for (const Vec3& p : skin->vertices) {
      for (const double x : p) append_little_endian(vertices, x + 0.0);
      for (const int c : color) append_little_endian(vertices, static_cast<std::uint8_t>(c));
      append_little_endian(vertices, static_cast<std::int32_t>(yarns_));
    }
    for (const auto& t : skin->triangles) {
      append_little_endian(faces, std::uint8_t{3});
      for (const std::uint32_t corner : t)
        append_little_endian(faces, static_cast<std::int32_t>(vertices_ + corner));
    }
    vertices_ += skin->vertices.size();
    triangles_ += skin->triangles.size();
    ++yarns_;
    return {};
  }

  Result<WriteFacts> finish() override {
    if (yarns_ == 0) return error(Kind::geometry, "there is no yarn to write");
    const std::string begin = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Selvage " SELVAGE_VERSION "\ncomment unit: {}\n",
        name_of(options_.units));
    const std::string end = fmt::format(
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nproperty int yarn\nelement face {}\nproperty list uchar "
        "int vertex_indices\n"
        "end_header\n",
        vertices_, triangles_);
    if (Status put = output_->write(begin); !put) return put.error();
    for (const std::unique_ptr<Spool>& spool : spools_) {
      if (Status put = spool->append_to(*output_); !put) return put.error();
      if (spool != spools_.front()) continue;
      if (Status put = output_->write(end); !put) return put.error();
    }
    return WriteFacts{.entities = {{"yarns", yarns_}, {"vertices", vertices_}, {"triangles", triangles_}}};
  }

 private:
  Writer(OutputFile& output, const SurfaceOptions& options, std::array<std::unique_ptr<Spool>, 3> spools)
      : output_(&output), options_(options), spools_(std::move(spools)) {}

  OutputFile* output_;
  SurfaceOptions options_;
  std::array<std::unique_ptr<Spool>, 3> spools_;  // names, vertices, faces
  std::size_t yarns_ = 0, vertices_ = 0, triangles_ = 0;
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "ply",
                                  .title = "PLY, triangles of yarns with colours",
                                  .extensions = {".ply"},
                                  .sniff = looks_like_ply,
                                  .open_bodies = Writer::open};
  return self;
}

}  // namespace selvage::formats::ply
