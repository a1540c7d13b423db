// dump_cad FILE.igs: what the reader makes of a file, as JSON for iges_agree.py, with every number as it is
// in memory and places evaluated by nurbs::evaluate. Messages go to standard error; exit status 1 when there
// is no model.
#include <cmath>
#include <cstdio>
#include <string>

#include "core/source.h"
#include "formats/registry.h"

namespace selvage::test {
namespace {

using cad::Face;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", c);
      out += code;
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

// "[" element "," element "]" of `write` on each of `items`.
template <class Items, class Write>
std::string array(const Items& items, Write write) {
  std::string out = "[";
  for (const auto& item : items) {
    if (out.size() > 1) out += ",";
    out += write(item);
  }
  return out + "]";
}

std::string numbers(const std::vector<double>& values) {
  return array(values, number);
}
std::string point(const Vec3& p) {
  return "[" + number(p.x()) + "," + number(p.y()) + "," + number(p.z()) + "]";
}

std::string look(const std::string& name, const std::optional<cad::Color>& color, int level,
                 const cad::Origin& origin) {
  return "\"name\":" + quoted(name) + ",\"level\":" + std::to_string(level) +
         ",\"entity\":" + quoted(origin.entity) + ",\"line\":" + std::to_string(origin.place.line) +
         ",\"color\":" +
         (color ? numbers({double(color->red), double(color->green), double(color->blue)}) : "null");
}

std::string curve_text(const nurbs::Curve& c) {
  if (c.points.empty()) return "null";
  std::string samples;
  for (const double a : {0.0, 0.25, 0.61, 1.0}) {
    const double t = std::lerp(c.first_parameter(), c.last_parameter(), a);
    const Vec3 p = nurbs::evaluate(c, t);
    samples += (samples.empty() ? "[" : ",") + numbers({t, p.x(), p.y(), p.z()});
  }
  return "{\"degree\":" + std::to_string(c.degree) + ",\"knots\":" + numbers(c.knots) +
         ",\"weights\":" + numbers(c.weights) + ",\"points\":" + array(c.points, point) +
         ",\"samples\":" + samples + "]}";
}

std::string surface_text(const nurbs::Surface& s) {
  std::string samples;
  for (const double a : {0.0, 0.13, 0.5, 0.77, 1.0})
    for (const double b : {0.0, 0.29, 0.6, 1.0}) {
      const double u = std::lerp(s.first_u(), s.last_u(), a), v = std::lerp(s.first_v(), s.last_v(), b);
      const nurbs::SurfaceJet jet = nurbs::evaluate_jet(s, u, v);
      const Vec3 p = jet.position, n = jet.du.cross(jet.dv);
      samples += (samples.empty() ? "[" : ",") + numbers({u, v, p.x(), p.y(), p.z(), n.x(), n.y(), n.z()});
    }
  return "{\"degrees\":[" + std::to_string(s.degree_u) + "," + std::to_string(s.degree_v) + "],\"counts\":[" +
         std::to_string(s.count_u) + "," + std::to_string(s.count_v) + "],\"knots_u\":" + numbers(s.knots_u) +
         ",\"knots_v\":" + numbers(s.knots_v) + ",\"weights\":" + numbers(s.weights) +
         ",\"points\":" + array(s.points, point) + ",\"samples\":" + samples + "]}";
}

std::string face_text(const Face& face) {
  const auto edge = [](const cad::Edge& e) {
    return "{\"id\":" + std::to_string(e.id) + ",\"curve\":" + curve_text(e.curve) +
           ",\"flat\":" + curve_text(e.flat) + "}";
  };
  return "{" + look(face.name, face.color, face.level, face.origin) +
         ",\"reversed\":" + (face.reversed ? "true" : "false") +
         ",\"surface\":" + surface_text(face.surface) +
         ",\"loops\":" + array(face.loops, [&](const cad::Loop& loop) { return array(loop.edges, edge); }) +
         "}\n";
}

std::string_view word_of(cad::Part::Kind kind) {
  switch (kind) {
    case cad::Part::Kind::surfaces:
      return "surfaces";
    case cad::Part::Kind::shell:
      return "shell";
    case cad::Part::Kind::solid:
      return "solid";
  }
  return "";
}

std::string counts(const std::map<std::string, std::uint64_t>& all) {
  std::string out = "{";
  for (const auto& [name, count] : all)
    out += (out.size() > 1 ? "," : "") + quoted(name) + ":" + std::to_string(count);
  return out + "}";
}

std::string text_of(const cad::Model& model) {
  return "{\"units\":" + quoted(std::string(name_of(model.units))) + ",\"title\":" + quoted(model.title) +
         ",\"date\":" + quoted(model.date) + ",\"resolution\":" + number(model.resolution) +
         ",\"entities\":" + counts(model.entities) + ",\"unknown\":" + counts(model.unknown) + ",\"parts\":" +
         array(model.parts,
               [](const cad::Part& part) {
                 return "{" + look(part.name, part.color, part.level, part.origin) + ",\"kind\":\"" +
                        std::string(word_of(part.kind)) + "\",\"group\":" + quoted(part.group) +
                        ",\"faces\":" + array(part.faces, face_text) + "}\n";
               }) +
         ",\"curves\":" +
         array(model.curves,
               [](const cad::NamedCurve& c) {
                 return "{" + look(c.name, c.color, c.level, c.origin) + ",\"curve\":" + curve_text(c.curve) +
                        "}\n";
               }) +
         "}\n";
}

int run(const char* path) {
  Result<Source> source = Source::open(path);
  if (!source) {
    std::fprintf(stderr, "%s\n", to_string(source.error()).c_str());
    return 1;
  }
  Diagnostics diagnostics;
  const std::optional<cad::Model> model = formats::iges::descriptor().read_model(*source, diagnostics);
  for (const Message& message : diagnostics.messages())
    std::fprintf(stderr, "%s\n", to_string(message).c_str());
  if (!model) return 1;
  std::fputs(text_of(*model).c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace selvage::test

int main(int count, char** arguments) {
  if (count != 2 || selvage::formats::iges::descriptor().read_model == nullptr) return 2;
  return selvage::test::run(arguments[1]);
}
