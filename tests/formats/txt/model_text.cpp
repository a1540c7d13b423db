#include "formats/txt/model_text.h"

#include <fmt/format.h>

#include <cstring>

namespace selvage::test {

namespace {

using namespace fabric;

class Flat {
 public:
  std::vector<std::string> lines;

  void add(const std::string& path, double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    lines.push_back(fmt::format("{} = {} ({:016x})", path, value, bits));
  }
  void add(const std::string& path, int value) { lines.push_back(fmt::format("{} = {}", path, value)); }
  void add(const std::string& path, bool value) { lines.push_back(fmt::format("{} = {}", path, value)); }
  void add(const std::string& path, const std::string& value) {
    lines.push_back(fmt::format("{} = [{}]", path, value));
  }
  template <class E>
  requires std::is_enum_v<E>
  void add(const std::string& path, E value) { add(path, static_cast<int>(value)); }
  void add(const std::string& path, const Vec2& v) {
    add(path + ".x", v.x());
    add(path + ".y", v.y());
  }
  void add(const std::string& path, const Vec3& v) {
    add(path + ".x", v.x());
    add(path + ".y", v.y());
    add(path + ".z", v.z());
  }
  template <class T>
  void add(const std::string& path, const std::optional<T>& value) {
    if (value)
      add(path, *value);
    else
      lines.push_back(path + " is not given");
  }
  template <class T>
  void add(const std::string& path, const std::vector<T>& list) {
    lines.push_back(fmt::format("{}: {} elements", path, list.size()));
    for (std::size_t i = 0; i < list.size(); ++i) add(fmt::format("{}[{}]", path, i), list[i]);
  }
  template <class... T>
  void add(const std::string& path, const std::variant<T...>& value) {
    lines.push_back(fmt::format("{}: alternative {}", path, value.index()));
    std::visit([&](const auto& one) { add(path, one); }, value);
  }
  void add(const std::string&, const std::monostate&) {}
  void add(const std::string&, const std::shared_ptr<const yarn::Body>&) {}  // of no text

  void add(const std::string& path, const LinearDensity& v) {
    add(path + ".value", v.value);
    add(path + ".measure", v.measure);
  }
  void add(const std::string& path, const yarn::EndTangent& v) {
    add(path + ".vector", v.vector);
    add(path + ".is_derivative", v.is_derivative);
  }
  void add(const std::string& path, const Twist& v) {
    add(path + ".turns", v.turns);
    add(path + ".hand", v.hand);
    add(path + ".rotates", v.rotates);
  }
  void add(const std::string& path, const Plies& v) {
    add(path + ".count", v.count);
    add(path + ".turns", v.turns);
    add(path + ".hand", v.hand);
  }
  void add(const std::string& path, const Color& v) {
    add(path + ".red", v.red);
    add(path + ".green", v.green);
    add(path + ".blue", v.blue);
  }
  void add(const std::string& path, const yarn::Circle& v) { add(path + ".diameter", v.diameter); }
  void add(const std::string& path, const yarn::Loop7& v) { add(path + ".diameter", v.diameter); }
  void add(const std::string& path, const yarn::Ellipse& v) { add_size(path, v.width, v.height); }
  void add(const std::string& path, const yarn::Lenticular& v) { add_size(path, v.width, v.height); }
  void add(const std::string& path, const yarn::Racetrack& v) { add_size(path, v.width, v.height); }
  void add(const std::string& path, const yarn::Power& v) {
    add_size(path, v.width, v.height);
    add(path + ".exponent", v.exponent);
  }
  void add(const std::string& path, const yarn::Polygon& v) { add(path + ".corners", v.corners); }
  void add_size(const std::string& path, double width, double height) {
    add(path + ".width", width);
    add(path + ".height", height);
  }
  void add(const std::string& path, const Thread& v) {
    add(path + ".name", v.name);
    add(path + ".linear_density", v.linear_density);
    add(path + ".density", v.density);
    add(path + ".packing", v.packing);
    add(path + ".diameter", v.diameter);
    add(path + ".section", v.section);
    add(path + ".twist", v.twist);
    add(path + ".plies", v.plies);
    add(path + ".filaments", v.filaments);
    add(path + ".color", v.color);
    add(path + ".material", v.material);
  }
  void add(const std::string& path, const IsotropicElastic& v) {
    add(path + ".modulus", v.modulus);
    add(path + ".poisson", v.poisson);
  }
  void add(const std::string& path, const TransverseElastic& v) {
    add(path + ".e1", v.e1);
    add(path + ".e2", v.e2);
    add(path + ".nu12", v.nu12);
    add(path + ".g12", v.g12);
    add(path + ".nu23", v.nu23);
  }
  void add(const std::string& path, const IsotropicStrength& v) {
    add(path + ".tension", v.tension);
    add(path + ".compression", v.compression);
    add(path + ".shear", v.shear);
  }
  void add(const std::string& path, const TransverseStrength::Across& v) {
    add(path + ".tension", v.tension);
    add(path + ".compression", v.compression);
    add(path + ".s12", v.s12);
    add(path + ".s23", v.s23);
  }
  void add(const std::string& path, const TransverseStrength& v) {
    add(path + ".tension", v.tension);
    add(path + ".compression", v.compression);
    add(path + ".across", v.across);
  }
  void add(const std::string& path, const Expansion& v) {
    add(path + ".along", v.along);
    add(path + ".across", v.across);
  }
  void add(const std::string& path, const Transport& v) {
    add(path + ".along", v.along);
    add(path + ".across", v.across);
  }
  void add(const std::string& path, const Interface::Pair& v) {
    add(path + ".normal", v.normal);
    add(path + ".shear", v.shear);
  }
  void add(const std::string& path, const Interface& v) {
    add(path + ".stiffness", v.stiffness);
    add(path + ".strength", v.strength);
    add(path + ".energy", v.energy);
  }
  void add(const std::string& path, const Material& v) {
    add(path + ".name", v.name);
    add(path + ".density", v.density);
    add(path + ".packing", v.packing);
    add(path + ".elastic", v.elastic);
    add(path + ".strength", v.strength);
    add(path + ".expansion", v.expansion);
    add(path + ".conductivity", v.conductivity);
    add(path + ".diffusivity", v.diffusivity);
    add(path + ".permittivity", v.permittivity);
    add(path + ".interface", v.interface);
  }
  void add(const std::string& path, const SizeAt& v) {
    add_size(path, v.width, v.height);
    add(path + ".angle", v.angle);
  }
  void add(const std::string& path, const Outline& v) {
    add(path + ".name", v.name);
    add(path + ".points", v.points);
  }
  void add(const std::string& path, const OutlineAt& v) {
    add(path + ".from", v.from);
    add(path + ".to", v.to);
    add(path + ".share", v.share);
    add(path + ".weight", v.weight);
  }
  void add(const std::string& path, const Path& v) {
    add(path + ".form", v.form);
    add(path + ".points", v.points);
    add(path + ".sizes", v.sizes);
    add(path + ".outlines", v.outlines);
    add(path + ".error", v.error);
    add(path + ".knots", v.knots);
    for (std::size_t i = 0; i < v.fixed.size(); ++i) add(path + ".fixed", static_cast<int>(v.fixed[i]));
  }
  void add(const std::string& path, const PointsFile& v) {
    add(path + ".file", v.file);
    add(path + ".yarn", v.yarn);
    add(path + ".error", v.error);
  }
  void add(const std::string& path, const Helix& v) {
    add(path + ".radius", v.radius);
    add(path + ".pitch", v.pitch);
    add(path + ".turns", v.turns);
    add(path + ".is_left", v.is_left);
    add(path + ".start", v.start);
  }
  void add(const std::string& path, const Grid& v) {
    add(path + ".sections", v.sections);
    add(path + ".per_section", v.per_section);
    add(path + ".degree_along", v.degree_along);
    add(path + ".degree_round", v.degree_round);
    add(path + ".knots_along", v.knots_along);
    add(path + ".knots_round", v.knots_round);
    add(path + ".open_round", v.open_round);
    add(path + ".closed_along", v.closed_along);
    if (v.corners) add(path + ".corners", std::vector<double>(v.corners->begin(), v.corners->end()));
    add(path + ".points", v.points);
    add(path + ".weights", v.weights);
  }
  void add(const std::string& path, const Yarn& v) {
    add(path + ".name", v.name);
    add(path + ".thread", v.thread);
    add(path + ".own", v.own);
    add(path + ".role", v.role);
    add(path + ".group", v.group);
    add(path + ".tangent_start", v.tangent_start);
    add(path + ".tangent_end", v.tangent_end);
    add(path + ".up", v.up);
    add(path + ".closed", v.closed);
    add(path + ".shape", v.shape);
  }
  void add(const std::string& path, const WeaveSystem& v) {
    add(path + ".threads", v.threads);
    add(path + ".count", v.count);
    add(path + ".pitch", v.pitch);
  }
  void add(const std::string& path, const Draft& v) {
    add(path + ".form", v.form);
    add(path + ".rows", v.rows);
    add(path + ".a", v.a);
    add(path + ".b", v.b);
    add(path + ".further", v.further);
    add(path + ".hand", v.hand);
    add(path + ".warp_faced", v.warp_faced);
    add(path + ".full_turns", v.full_turns);
    add(path + ".file", v.file);
  }
  void add(const std::string& path, const Binder& v) {
    add(path + ".thread", v.thread);
    add(path + ".every", v.every);
    add(path + ".first", v.first);
    add(path + ".levels", v.levels);
  }
  void add(const std::string& path, const StackedWarp& v) {
    add(path + ".thread", v.thread);
    add(path + ".levels", v.levels);
  }
  void add(const std::string& path, const WarpPile& v) {
    add(path + ".height", v.height);
    add(path + ".thread", v.thread);
    add(path + ".picks", v.picks);
    add(path + ".side", v.side);
    add(path + ".is_cut", v.is_cut);
  }
  void add(const std::string& path, const Pucker& v) {
    add(path + ".tight", v.tight);
    add(path + ".slack", v.slack);
    add(path + ".ratio", v.ratio);
    add(path + ".picks", v.picks);
  }
  void add(const std::string& path, const MandrelRow& v) {
    add(path + ".axis", v.axis);
    add(path + ".radius", v.radius);
  }
  void add(const std::string& path, const Weave& v) {
    add(path + ".pucker", v.pucker);
    add(path + ".warp", v.warp);
    add(path + ".weft", v.weft);
    add(path + ".draft", v.draft);
    add(path + ".profile", v.profile);
    add(path + ".amplitude", v.amplitude);
    add(path + ".crimp", v.crimp);
    add(path + ".spacing", v.spacing);
    add(path + ".state", v.state);
    add(path + ".thickness", v.thickness);
    add(path + ".layers", v.layers);
    add(path + ".binders", v.binders);
    add(path + ".columns", v.columns);
    add(path + ".fraction", v.fraction);
    add(path + ".pressure", v.pressure);
    add(path + ".pile", v.pile);
  }
  void add(const std::string& path, const OwnLoop& v) {
    add(path + ".sign", std::string(1, v.sign));
    add(path + ".points", v.points);
  }
  void add(const std::string& path, const LoopMove& v) {
    add(path + ".row", v.row);
    add(path + ".wale", v.wale);
    add(path + ".right", v.right);
    add(path + ".is_dropped", v.is_dropped);
  }
  void add(const std::string& path, const Knit& v) {
    add(path + ".form", v.form);
    add(path + ".rib_a", v.rib_a);
    add(path + ".rib_b", v.rib_b);
    add(path + ".threads", v.threads);
    add(path + ".courses", v.courses);
    add(path + ".wales", v.wales);
    add(path + ".course_pitch", v.course_pitch);
    add(path + ".wale_pitch", v.wale_pitch);
    add(path + ".loop", v.loop);
    add(path + ".unit", v.unit);
    add(path + ".crossing", v.crossing);
    add(path + ".shape", v.shape);
    add(path + ".own_loops", v.own_loops);
    add(path + ".feeds", v.feeds);
    add(path + ".gating", v.gating);
    add(path + ".bed_distance", v.bed_distance);
    add(path + ".plating", v.plating);
    add(path + ".pile", v.pile);
    add(path + ".pile_is_cut", v.pile_is_cut);
    add(path + ".method", v.method);
    add(path + ".chart", v.chart);
    add(path + ".moves", v.moves);
  }
  void add(const std::string& path, const WarpknitBar& v) {
    add(path + ".thread", v.thread);
    add(path + ".lapping", v.lapping);
    add(path + ".fall_plate", v.fall_plate);
    add(path + ".own_loop", v.own_loop);
  }
  void add(const std::string& path, const WarpknitWeft& v) {
    add(path + ".threads", v.threads);
    add(path + ".every", v.every);
    add(path + ".first", v.first);
  }
  void add(const std::string& path, const Warpknit& v) {
    add(path + ".classic", v.classic);
    add(path + ".thread", v.thread);
    add(path + ".bars", v.bars);
    add(path + ".weft", v.weft);
    add(path + ".wales", v.wales);
    add(path + ".courses", v.courses);
    add(path + ".wale_pitch", v.wale_pitch);
    add(path + ".course_pitch", v.course_pitch);
    add(path + ".stitch", v.stitch);
    add(path + ".substrate", v.substrate);
  }
  void add(const std::string& path, const Braid& v) {
    add(path + ".thread", v.thread);
    add(path + ".carriers", v.carriers);
    add(path + ".over", v.over);
    add(path + ".under", v.under);
    add(path + ".flat", v.flat);
    add(path + ".planar", v.planar);
    add(path + ".radius", v.radius);
    add(path + ".mandrel", v.mandrel);
    add(path + ".width", v.width);
    add(path + ".angle", v.angle);
    add(path + ".length", v.length);
    add(path + ".axial_thread", v.axial_thread);
    add(path + ".axial_count", v.axial_count);
  }
  void add(const std::string& path, const PieceCurve& v) {
    add(path + ".name", v.name);
    add(path + ".is_line", v.is_line);
    add(path + ".shape", v.shape);
    add(path + ".by", v.by);
    add(path + ".method", v.method);
    add(path + ".points", v.points);
    add(path + ".weights", v.weights);
    add(path + ".knots", v.knots);
  }
  void add(const std::string& path, const Piece& v) {
    add(path + ".name", v.name);
    add(path + ".curves", v.curves);
    add(path + ".edits", v.edits);
  }
  void add(const std::string& path, const LengthOf& v) {
    add(path + ".piece", v.piece);
    add(path + ".curves", v.curves);
    add(path + ".ease", v.ease);
  }
  void add(const std::string& path, const Edit& v) {
    add(path + ".yarn", v.yarn);
    add(path + ".form", v.form);
    add(path + ".joint", v.joint);
    add(path + ".target", v.target);
    add(path + ".length", v.length);
    add(path + ".like", v.like);
    add(path + ".direction", v.direction);
  }
  void add(const std::string& path, const Move& v) {
    add(path + ".form", v.form);
    add(path + ".by", v.by);
    add(path + ".axis", v.axis);
    add(path + ".across", v.across);
    add(path + ".angle", v.angle);
  }
  void add(const std::string& path, const Use& v) {
    add(path + ".what", v.what);
    add(path + ".is_file", v.is_file);
    add(path + ".as", v.as);
    add(path + ".along_x", v.repeats[0]);
    add(path + ".along_y", v.repeats[1]);
    add(path + ".has_steps", v.steps.has_value());
    if (v.steps) {
      add(path + ".step_x", (*v.steps)[0]);
      add(path + ".step_y", (*v.steps)[1]);
    }
    add(path + ".moves", v.moves);
  }
  void add(const std::string& path, const NamedBlock& v) {
    add(path + ".name", v.name);
    for (const std::string& line : flattened(*v.fabric)) lines.push_back(path + "." + line);
  }
  void add(const std::string& path, const CellOfRepeats& v) {
    add(path + ".along_x", v.counts[0]);
    add(path + ".along_y", v.counts[1]);
    add(path + ".margin", v.margin);
  }
  void add(const std::string& path, const CellVectors& v) {
    add(path + ".first", v.first);
    add(path + ".second", v.second);
    add(path + ".height", v.height);
    add(path + ".at", v.at);
    add(path + ".margin", v.margin);
  }
  void add(const std::string& path, const Cell& v) {
    add(path + ".of_repeats", v.of_repeats);
    add(path + ".of_vectors", v.of_vectors);
    add(path + ".low", v.low);
    add(path + ".high", v.high);
    add(path + ".matrix", v.matrix);
    add(path + ".periodic_x", v.periodic[0]);
    add(path + ".periodic_y", v.periodic[1]);
    add(path + ".periodic_z", v.periodic[2]);
  }
};

}  // namespace

std::vector<std::string> flattened(const Fabric& fabric) {
  Flat flat;
  flat.add("title", fabric.title);
  flat.add("units", fabric.units);
  flat.add("units_given", fabric.units_given);
  flat.add("tolerance", fabric.tolerance);
  flat.add("threads", fabric.threads);
  flat.add("materials", fabric.materials);
  flat.add("outlines", fabric.outlines);
  flat.add("blocks", fabric.blocks);
  flat.add("items", fabric.items);
  flat.add("edits", fabric.edits);
  flat.add("cell", fabric.cell);
  return std::move(flat.lines);
}

std::string first_difference(const Fabric& a, const Fabric& b) {
  const std::vector<std::string> one = flattened(a), other = flattened(b);
  for (std::size_t i = 0; i < std::max(one.size(), other.size()); ++i) {
    const std::string left = i < one.size() ? one[i] : "(nothing)";
    const std::string right = i < other.size() ? other[i] : "(nothing)";
    if (left != right) return left + "   against   " + right;
  }
  return {};
}

}  // namespace selvage::test
