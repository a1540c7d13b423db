#include "formats/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "core/number_text.h"
#include "core/readable.h"
#include "core/text_buffer.h"
#include "core/xml_text.h"
#include "nurbs/bezier.h"
#include "yarn/color_text.h"
#include "yarn/line_samples.h"

namespace selvage::formats::svg {

namespace {

using fabric::PieceEdge;
using fabric::PieceShape;

constexpr double margin = 5;         // of the page round the drawing, mm
constexpr double line_width = 0.25;  // mm

bool looks_like_svg(std::string_view head) {
  const std::size_t start = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return start != std::string_view::npos && head[start] == '<' && head.find("<svg") != std::string_view::npos;
}

// A coordinate without a negative zero.
double clean(double value) {
  return value + 0.0;
}

// y points up in the fabric and down in SVG: the sign is turned, which costs no bits.
void put_point(std::string& path, const Vec2& p) {
  path += number_text(clean(p.x())) + ' ' + number_text(clean(-p.y()));
}

void put_curve(std::string& path, const nurbs::Curve& curve, double tolerance) {
  for (const nurbs::Bezier& cubic : nurbs::cubics_of(curve, tolerance)) {
    path += 'C';
    for (std::size_t i = 1; i < cubic.size(); ++i) {
      if (i > 1) path += ' ';
      put_point(path, cubic[i]);
    }
  }
}

std::string path_data(const nurbs::Curve& curve, double tolerance) {
  std::string path = "M";
  put_point(path, curve.points.front().head<2>());
  put_curve(path, curve, tolerance);
  return path;
}

std::string path_data(const PieceShape& piece) {
  constexpr double rational_error = 1e-9;  // of the extent
  std::string path = "M";
  put_point(path, piece.edges.front().curve.points.front().head<2>());
  for (const PieceEdge& edge : piece.edges) {
    if (edge.is_line()) {
      path += 'L';
      put_point(path, edge.curve.points.back().head<2>());
    } else {
      put_curve(path, edge.curve, rational_error * piece.box.diagonal().norm());
    }
  }
  return path + "Z";
}

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options)
      : output_(&output), options_(options), mm_(millimetres_per(options.units)) {}

  Status add_piece(const PieceShape& piece) override {
    box_.extend(piece.box);
    ++pieces_;
    paths_ += "<path id=\"" + new_id(piece.name) + "\" d=\"" + path_data(piece) + "\"><title>" +
              xml_text(piece.name) + "</title><desc>";
    for (std::size_t i = 0; i < piece.edges.size(); ++i)
      paths_ += (i > 0 ? ", " : "") + xml_text(piece.edges[i].name);
    paths_ += "</desc></path>\n";
    return {};
  }

  Status add_line(const yarn::Body& body) override {
    const double tolerance = line_tolerance(options_, body);
    for (const yarn::LineSample& sample : sampler_.sample(body, tolerance))
      box_.extend(Vec2(sample.position.head<2>()));
    ++pieces_;
    paths_ += "<path id=\"" + new_id(body.name) + "\" stroke=\"#" + yarn::hex(body.color) + "\" d=\"" +
              path_data(body.axis, tolerance) + "\"><title>" + xml_text(body.name) + "</title></path>\n";
    return {};
  }

  Result<WriteFacts> finish() override {
    if (pieces_ == 0) return error(Kind::geometry, "there is nothing to draw: no garment piece and no yarn");
    const double edge = margin / mm_;
    const Vec2 size = box_.sizes() + Vec2(2 * edge, 2 * edge);
    TextBuffer text(*output_);
    text << R"(<?xml version="1.0" encoding="UTF-8"?>)"
         << "\n"
         << R"(<svg xmlns="http://www.w3.org/2000/svg" version="1.1" width=")" << size.x() * mm_
         << R"(mm" height=")" << size.y() * mm_ << R"(mm" viewBox=")" << clean(box_.min().x() - edge) << ' '
         << clean(-box_.max().y() - edge) << ' ' << size.x() << ' ' << size.y() << "\">\n";
    if (!options_.title.empty()) text << "<title>" << xml_text(options_.title) << "</title>\n";
    text << R"(<g fill="none" stroke="#000000" stroke-width=")" << line_width / mm_
         << R"(" stroke-linejoin="round">)"
         << "\n"
         << paths_ << "</g>\n</svg>\n";
    return finished(text, {{"path", pieces_}});
  }

 private:
  // An XML name like `name`, each one once in the file.
  std::string new_id(std::string_view name) {
    std::string id;
    for (const char c : name) {
      if (is_continuation(c)) continue;  // its character has its '_' already
      const bool keep = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
      id += keep && static_cast<unsigned char>(c) < 0x80 ? c : '_';
    }
    if (id.empty() || (std::isalpha(static_cast<unsigned char>(id[0])) == 0 && id[0] != '_'))
      id.insert(0, "_");
    std::string free = id;
    for (int number = 2; !ids_.insert(free).second; ++number) free = id + "_" + std::to_string(number);
    return free;
  }

  OutputFile* output_;
  SurfaceOptions options_;
  yarn::LineSampler sampler_;
  double mm_;
  nurbs::Box2 box_;
  std::string paths_;
  std::set<std::string> ids_;
  std::uint64_t pieces_ = 0;
};

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "svg",
      .title = "SVG 1.1, garment pieces and centre lines drawn at true scale",
      .extensions = {".svg"},
      .sniff = looks_like_svg,
      .open_bodies = open_by<Writer>,
      .carries_surfaces = false,
      .carries_curves = true,
      .carries_lines = true,
  };
  return self;
}

}  // namespace selvage::formats::svg
