#include "fabric/from_cad.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "cad/measure.h"
#include "cad/recognize.h"

namespace selvage::fabric {

namespace {

// Names of one kind: each given once.
class Names {
 public:
  explicit Names(std::string_view usual) : usual_(usual) {}

  // The name as it is, or with a number where another has it; the usual one where there is none. Quotes and
  // control characters, which no name of ours has, become '_'.
  std::string make(std::string_view wanted) {
    ++count_;
    std::string name(wanted);
    for (char& c : name)
      if (c == '"' || static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '_';
    if (name.empty()) name = fmt::format("{}_{}", usual_, count_);
    std::string unique = name;
    for (std::size_t& k = repeats_[name]; !given_.insert(unique).second;)
      unique = fmt::format("{}_{}", name, ++k + 1);
    return unique;
  }

 private:
  std::string_view usual_;
  std::size_t count_ = 0;
  std::unordered_set<std::string> given_;
  std::unordered_map<std::string, std::size_t> repeats_;
};

Piece piece_of(const cad::Outline& outline, Names& names) {
  Piece piece;
  piece.name = names.make(outline.name);
  piece.place = outline.origin.place;
  Names sides("side");
  for (const cad::Outline::Side& side : outline.sides) {
    PieceCurve curve;
    curve.name = sides.make(side.name);
    curve.place = piece.place;
    curve.is_line = side.curve.degree == 1;
    if (!curve.is_line) curve.shape = PieceCurve::Shape::control;
    if (!curve.is_line) {
      curve.weights = side.curve.weights;
      if (side.curve.points.size() > 4) curve.knots = side.curve.knots;
    }
    for (const Vec3& p : side.curve.points) curve.points.emplace_back(p.x(), p.y());
    piece.curves.push_back(std::move(curve));
  }
  return piece;
}

}  // namespace

Fabric fabric_of(cad::Model model, Diagnostics& diagnostics) {
  Fabric fabric;
  std::vector<cad::FoundYarn> yarns = cad::take_yarns(model, diagnostics);
  Names yarn_names("yarn"), piece_names("piece");
  // IGES: 186s. Our own STEP has yarns, which are solids there and groups of 128s in our IGES.
  const bool has_solids = model.entities.contains("186") || (model.entities.contains("MANIFOLD_SOLID_BREP") &&
                                                             !model.system.starts_with("selvage"));
  fabric.yarns_are_solids =
      !yarns.empty() && has_solids &&
      std::all_of(yarns.begin(), yarns.end(), [](const cad::FoundYarn& found) { return found.was_solid; });
  for (cad::FoundYarn& found : yarns) {
    found.body.name = yarn_names.make(found.body.name);
    Yarn yarn = yarn_like(found.body);
    yarn.own.color = found.body.color;
    yarn.closed = found.body.closed_along;
    yarn.shape = std::make_shared<const yarn::Body>(std::move(found.body));
    fabric.items.emplace_back(std::move(yarn));
  }
  for (const cad::Outline& outline : cad::take_outlines(model))
    fabric.items.emplace_back(piece_of(outline, piece_names));
  fabric.file = std::move(model.file);
  if (!model.title.empty()) fabric.title = std::move(model.title);
  fabric.units = model.units;
  fabric.units_given = true;
  fabric.date = std::move(model.date);
  fabric.file_name = std::move(model.file_name);
  // What the file calls one point may be far more than its edges need, and receivers bend edges by as much.
  if (model.resolution > 0)
    fabric.resolution = std::min(model.resolution, 2 * cad::looseness_of(model.parts));
  fabric.parts = std::move(model.parts);
  fabric.curves = std::move(model.curves);
  return fabric;
}

}  // namespace selvage::fabric
