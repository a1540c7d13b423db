#include <fmt/format.h>

#include <limits>

#include "core/little_endian.h"
#include "core/readable.h"
#include "formats/registry.h"
#include "formats/stl/options.h"
#include "solid/single_precision.h"

namespace selvage::formats::stl {

namespace {

// Of a binary file only the name tells.
bool looks_like_text(std::string_view head) {
  return head.starts_with("solid ") && head.find("facet normal ") != std::string_view::npos;
}

// Three corners, counter-clockwise seen from outside.
using Facet = std::array<Eigen::Vector3f, 3>;

// Zero where the facet has no area.
Eigen::Vector3f normal_of(const Facet& facet) {
  const Vec3 a = facet[0].cast<double>(), b = facet[1].cast<double>(), c = facet[2].cast<double>();
  return unit_or_zero((b - a).cross(c - a)).cast<float>() + Eigen::Vector3f::Zero();
}

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options)
      : output_(&output), options_(options), is_text_(options.own.has(option::ascii)), text_(output) {
    if (!is_text_) put_header();
  }

  Status add(const yarn::Body& body) override {
    const double chord = chord_height(options_, body);
    Result<solid::Tessellation> made = solid::tessellate(body, chord);
    if (!made) return made.error();
    const Result<solid::SingleSkin> skin = solid::in_single_precision(body, std::move(*made));
    if (!skin) return skin.error();
    precision_.look(body, skin->spacing, chord);
    const std::string name = readable(body.name);
    if (is_text_) text_ << "solid " << name << '\n';
    for (const auto& t : skin->triangles) {
      const Facet facet = {skin->vertices[t[0]], skin->vertices[t[1]], skin->vertices[t[2]]};
      is_text_ ? put_text(facet) : put_binary(facet);
    }
    if (is_text_) text_ << "endsolid " << name << '\n';
    facets_ += skin->triangles.size();
    ++yarns_;
    return {};
  }

  Result<WriteFacts> finish() override {
    if (yarns_ == 0) return error(Kind::geometry, "there is no yarn to write");
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (!is_text_ && facets_ > most)
      return error(Kind::limit, fmt::format("binary STL holds at most {} triangles, and these yarns have {}: "
                                            "allow a larger --chord, or write text (--stl-ascii)",
                                            most, facets_));
    Result<WriteFacts> facts = finished(text_, {{"triangles", facets_}});
    if (!facts) return facts;
    if (!is_text_) {
      std::string count;
      append_little_endian(count, static_cast<std::uint32_t>(facets_));
      if (Status put = output_->write_at(header_size, count); !put) return put.error();
    }
    if (std::optional<Message> warning = precision_.warning("STL", options_.units))
      facts->messages.push_back(std::move(*warning));
    return facts;
  }

 private:
  static constexpr std::size_t header_size = 80;

  // The number of facets behind it is known at the end.
  void put_header() {
    std::string header =
        fmt::format("Selvage " SELVAGE_VERSION ", triangles of yarns, unit: {}", name_of(options_.units));
    header.resize(header_size, ' ');
    text_ << header;
    append_little_endian(text_, std::uint32_t{0});
  }

  void put_binary(const Facet& facet) {
    const auto put = [&](const Eigen::Vector3f& v) {
      for (const float x : v) append_little_endian(text_, x);
    };
    put(normal_of(facet));
    for (const Eigen::Vector3f& corner : facet) put(corner);
    append_little_endian(text_, std::uint16_t{0});  // bytes of attributes
  }

  void put_text(const Facet& facet) {
    const auto put = [&](std::string_view word, const Eigen::Vector3f& v) {
      text_ << word << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
    };
    put("facet normal ", normal_of(facet));
    text_ << "outer loop\n";
    for (const Eigen::Vector3f& corner : facet) put("vertex ", corner);
    text_ << "endloop\nendfacet\n";
  }

  OutputFile* output_;
  SurfaceOptions options_;
  bool is_text_;
  TextBuffer text_;
  solid::PrecisionWatch precision_;
  std::uint64_t facets_ = 0, yarns_ = 0;
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "stl",
                                  .title = "STL, closed triangles of yarns",
                                  .extensions = {".stl"},
                                  .sniff = looks_like_text,
                                  .open_bodies = open_by<Writer>,
                                  .options = option::all()};
  return self;
}

}  // namespace selvage::formats::stl
