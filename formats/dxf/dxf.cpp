#include "formats/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/words.h"
#include "formats/dxf/skeleton.h"

namespace selvage::formats::dxf {

namespace {

using fabric::PieceEdge;
using fabric::PieceShape;

constexpr double text_height =
    1.0 / 40;  // of the piece's smaller side, where the text is not too long for it

bool looks_like_dxf(std::string_view head) {
  const auto next_line = [&head] {
    const std::size_t end = std::min(head.find('\n'), head.size());
    std::string_view line = head.substr(0, end);
    head.remove_prefix(std::min(end + 1, head.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    return line;
  };
  return next_line() == "0" && next_line() == "SECTION";
}

// A name that a block may have: at most 255 characters, none that DXF reserves.
std::string block_name(std::string_view name) {
  std::string out = string_value(name);
  for (char& c : out)
    if (std::string_view("<>/\":;?*|,=`'").find(c) != std::string_view::npos) c = '_';
  // A backslash stands only where string_value put it.
  for (std::size_t at = out.find('\\'); at != std::string::npos; at = out.find('\\', at + 1))
    if (!out.substr(at).starts_with("\\U+")) out[at] = '_';
  if (out.size() > 200) out.resize(200);
  return out.empty() ? "_" : out;
}

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options) : output_(&output), options_(options) {}

  Status add_curve(const cad::NamedCurve& curve) override {
    Block block = new_block(curve.name, curve.origin.place, "centre line");
    put_spline(block, layer::boundary, curve.curve, false);
    for (const Vec3& p : curve.curve.points) box_.extend(Vec2(p.head<2>()));
    blocks_.push_back(std::move(block));
    return {};
  }

  Status add_piece(const PieceShape& piece) override {
    Block block = new_block(piece.name, piece.place, "piece");
    for (const PieceEdge& edge : piece.edges) put_edge(block, edge);
    for (const PieceEdge& edge : piece.edges) {
      put_point(block, layer::turn_points, edge.curve.points.front());
      if (edge.fit)
        for (std::size_t i = 1; i + 1 < edge.fit->points.size(); ++i)
          put_point(block, layer::curve_points,
                    Vec3(edge.fit->points[i].at.x(), edge.fit->points[i].at.y(), 0));
    }
    put_text(block, piece);
    box_.extend(piece.box);
    blocks_.push_back(std::move(block));
    return {};
  }

  Result<WriteFacts> finish() override {
    if (blocks_.empty())
      return error(Kind::geometry, "there is nothing to draw: no garment piece and no yarn");
    const Tags file = drawing(blocks_, box_, options_.units, next_);
    if (Status status = output_->write(file.bytes()); !status.ok()) return status.error();
    facts_.entities["BLOCK"] = blocks_.size();
    return std::move(facts_);
  }

 private:
  Tags& entity(Block& block, std::string_view name, std::string_view layer, std::string_view kind) {
    ++facts_.entities[std::string(name)];
    return block.entities.entity(name, next_++, block.record, layer, kind);
  }

  void put_edge(Block& block, const PieceEdge& edge) {
    const nurbs::Curve& curve = edge.curve;
    if (edge.is_line()) {
      entity(block, "LINE", layer::boundary, "AcDbLine")
          .point(10, curve.points[0])
          .point(11, curve.points[1]);
      return;
    }
    put_spline(block, layer::boundary, curve, true);
  }

  void put_spline(Block& block, std::string_view layer, const nurbs::Curve& curve, bool planar) {
    constexpr int rational = 4, in_a_plane = 8;
    Tags& tags = entity(block, "SPLINE", layer, "AcDbSpline");
    if (planar) tags.point(210, Vec3::UnitZ());
    tags.integer(70, (planar ? in_a_plane : 0) + (curve.weights.empty() ? 0 : rational));
    tags.integer(71, curve.degree);
    tags.integer(72, static_cast<long long>(curve.knots.size()));
    tags.integer(73, static_cast<long long>(curve.points.size())).integer(74, 0);
    tags.real(42, 1e-9).real(43, 1e-10);  // tolerances of knots and points: the usual ones
    for (const double knot : curve.knots) tags.real(40, knot);
    for (const double weight : curve.weights) tags.real(41, weight);
    for (const Vec3& p : curve.points) tags.point(10, p);
  }

  void put_point(Block& block, std::string_view layer, const Vec3& at) {
    entity(block, "POINT", layer, "AcDbPoint").point(10, at);
  }

  // The name in full, as the pattern trade's readers look for it.
  void put_text(Block& block, const PieceShape& piece) {
    const Vec3 centre(piece.box.center().x(), piece.box.center().y(), 0);
    const std::string text = string_value("Piece Name: " + piece.name);
    const Vec2 size = piece.box.sizes();
    entity(block, "TEXT", layer::boundary, "AcDbText")
        .point(10, centre)
        .real(40, std::min(text_height * size.minCoeff(), size.x() / static_cast<double>(text.size())))
        .text(1, text)
        .integer(72, 1)  // centred about the second point
        .point(11, centre)
        .text(100, "AcDbText")
        .integer(73, 2);
  }

  Block new_block(const std::string& name, TextPlace place, std::string_view kind) {
    Block block;
    block.name = new_name(name, place, kind);
    for (Handle* handle : {&block.record, &block.begin, &block.end, &block.insert}) *handle = next_++;
    return block;
  }

  std::string new_name(const std::string& given, TextPlace place, std::string_view kind) {
    const std::string wanted = block_name(given);
    std::string name = wanted;
    const auto folded = [](std::string text) {  // block names ignore case
      std::ranges::transform(text, text.begin(), lower);
      return text;
    };
    for (int number = 2; !names_.insert(folded(name)).second; ++number)
      name = fmt::format("{}_{}", wanted, number);
    if (name != string_value(given))
      facts_.messages.push_back(
          warning(Kind::unsupported,
                  fmt::format("DXF does not admit the name '{}': the block of this {} is named '{}'", given,
                              kind, name),
                  {.place = place}));
    return name;
  }

  OutputFile* output_;
  SurfaceOptions options_;
  std::vector<Block> blocks_;
  std::set<std::string> names_;
  nurbs::Box2 box_;
  Handle next_ = first_free_handle;
  WriteFacts facts_;
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "dxf",
      .title = "DXF of AutoCAD 2000, garment pieces and centre lines as blocks",
      .extensions = {".dxf"},
      .sniff = looks_like_dxf,
      .open_bodies = open_by<Writer>,
      .carries_surfaces = false,
      .carries_curves = true,
      .carries_lines = true,
  };
  return self;
}

}  // namespace selvage::formats::dxf
