#include "fem/forming.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/materials.h"
#include "fem/sections.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

// Of `names`: what moves outwards along x, and along y.
enum Grip : std::size_t { x_low, x_high, y_low, y_high, grips };
constexpr std::array<std::string_view, 6> names = {"GripXLow",  "GripXHigh", "GripYLow",
                                                   "GripYHigh", "PlateLow",  "PlateHigh"};
constexpr std::array<std::string_view, grips> edges = {"x low", "x high", "y low", "y high"};

double smooth(double t) {
  return t * t * t * (10 + t * (-15 + 6 * t));
}

// `value` of the smooth step, which goes from 0 to 1.
template <class Value>
MotionCurve curve_of(std::string name, Value value, bool is_smooth_step = false) {
  constexpr int steps = 100;
  MotionCurve curve{std::move(name), is_smooth_step, {}};
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    curve.points.push_back({t, value(smooth(t))});
  }
  return curve;
}

Message refused(std::string text, const FormingOptions& options) {
  return error(Kind::unsupported, std::move(text)).placed({}, options.file);
}

Status check_densities(const Mesh& mesh, const FormingOptions& options) {
  for (const fabric::Material& material : mesh.materials)
    if (!material.density)
      return error(Kind::unsupported,
                   fmt::format("material '{}' has no density, which --deck explicit asks for: give its "
                               "`material` block a line `density V` (g/cm3)",
                               material.name))
          .placed(material.place, options.file);
  return {};
}

// The edge that an end looks at; `grips`: another way.
std::size_t edge_of(const Vec3& outward) {
  Eigen::Index axis = 0;
  outward.cwiseAbs().maxCoeff(&axis);
  return axis == 2 ? grips : static_cast<std::size_t>(2 * axis + (outward[axis] > 0 ? 1 : 0));
}

Vec3 outward_of(const Mesh& mesh, const Region& region, bool at_end) {
  if (mesh.shape == Mesh::Shape::beam)
    return at_end ? mesh.along[region.last_element - 1] : Vec3(-mesh.along[region.first_element]);
  Vec3 sum = Vec3::Zero();
  for (const ElementSide& side : at_end ? region.end_faces : region.start_faces)
    sum += area_vector(mesh, side);
  return sum;
}

using EdgeNodes = std::array<std::vector<std::size_t>, grips>;

EdgeNodes nodes_on_faces(const Mesh& mesh) {
  const Parallelepiped shape = mesh.cell->shape();
  EdgeNodes nodes;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    for (const int axis : {0, 1})
      if (const int side = shape.side_of(mesh.nodes[n], axis); side != 0)
        nodes[static_cast<std::size_t>(2 * axis + (side > 0 ? 1 : 0))].push_back(n);
  return nodes;
}

// `loose`: counts the ends that look along z.
EdgeNodes nodes_of_ends(const Mesh& mesh, std::size_t& loose) {
  EdgeNodes nodes;
  for (const Region& region : mesh.regions)
    for (const bool at_end : {false, true}) {
      const std::vector<std::size_t>& own = at_end ? region.end_nodes : region.start_nodes;
      if (own.empty()) continue;
      const std::size_t edge = edge_of(outward_of(mesh, region, at_end));
      if (edge == grips)
        ++loose;
      else
        nodes[edge].insert(nodes[edge].end(), own.begin(), own.end());
    }
  for (std::vector<std::size_t>& of_edge : nodes) std::sort(of_edge.begin(), of_edge.end());
  return nodes;
}

// The box of the yarns, with the radii of beams.
Box3 box_of(const Mesh& mesh, std::span<const double> radii) {
  Box3 box;
  for (const Vec3& node : mesh.nodes) box.extend(node);
  for (std::size_t i = 0; i < radii.size(); ++i)
    for (std::size_t n = mesh.regions[i].first_node; n < mesh.regions[i].last_node; ++n)
      for (const double radius : {radii[i], -radii[i]}) box.extend(mesh.nodes[n] + Vec3::Constant(radius));
  return box;
}

// A node may stand in a corner of the cell, and in one grip only.
void keep_apart(EdgeNodes& nodes) {
  for (const std::size_t later : {y_low, y_high})
    std::erase_if(nodes[later], [&](std::size_t node) {
      return std::binary_search(nodes[x_low].begin(), nodes[x_low].end(), node) ||
             std::binary_search(nodes[x_high].begin(), nodes[x_high].end(), node);
    });
}

// Grips of these edges, each in the middle of its nodes.
Result<std::vector<RigidPart>> grip(const Mesh& mesh, const std::vector<std::size_t>& wanted,
                                    const FormingOptions& options, Forming& forming) {
  if (mesh.cell && !mesh.cell->axes.are_of_space())
    return refused("grips stand on faces across x and y: an explicit deck needs a cell that is a box",
                   options);
  EdgeNodes nodes = mesh.cell ? nodes_on_faces(mesh) : nodes_of_ends(mesh, forming.loose_ends);
  if (wanted.size() == grips) keep_apart(nodes);
  std::vector<RigidPart> parts;
  for (const std::size_t edge : wanted) {
    if (nodes[edge].empty())
      return refused(fmt::format("--load {} holds the yarns at the edge {}, and none ends there: cut the "
                                 "cloth by a `cell` that its yarns cross (--cut)",
                                 name_of(options.load), edges[edge]),
                     options);
    RigidPart& part = parts.emplace_back();
    part.name = names[edge];
    part.grip = nodes[edge];
    Box3 box;
    for (const std::size_t node : part.grip) box.extend(mesh.nodes[node]);
    part.reference = box.center();
    part.size = std::max(box.diagonal().norm(), 1e-3);
  }
  return parts;
}

Status plan_biaxial(const Mesh& mesh, const FormingOptions& options, Forming& forming) {
  constexpr double strain = 0.01;
  Result<std::vector<RigidPart>> parts = grip(mesh, {x_low, x_high, y_low, y_high}, options, forming);
  if (!parts) return parts.error();
  for (const int axis : {0, 1}) {
    RigidPart &low = (*parts)[static_cast<std::size_t>(2 * axis)],
              &high = (*parts)[static_cast<std::size_t>(2 * axis + 1)];
    const double length = high.reference[axis] - low.reference[axis];
    double& stroke = forming.stroke[static_cast<std::size_t>(axis)];
    stroke = options.stroke.value_or(strain * length);
    low.motions = {{axis, 0, -stroke / 2}};
    high.motions = {{axis, 0, stroke / 2}};
  }
  forming.parts = std::move(*parts);
  return {};
}

// Yarns that run along the pull, or across it, are not sheared.
Status check_bias(const Mesh& mesh, int axis, const FormingOptions& options) {
  constexpr double least = 30, most = 60;  // degrees
  constexpr std::string_view remedy =
      "turn the cloth by 45 degrees (`use` it with `rotate 45`) and cut it by a `cell` that lies inside it "
      "(--cut)";
  if (!mesh.cell)
    return refused(
        fmt::format("--load bias pulls a cloth that is cut at 45 degrees to its yarns: {}", remedy), options);
  for (const Region& region : mesh.regions) {
    Vec3 along = Vec3::Zero();
    for (std::size_t e = region.first_element; e < region.last_element; ++e) along += mesh.along[e];
    const double angle =
        std::atan2(std::abs(along[1 - axis]), std::abs(along[axis])) * 180 / std::numbers::pi;
    if (angle < least || angle > most)
      return error(Kind::unsupported,
                   fmt::format("--load bias pulls along {}, at 45 degrees to the yarns, and this one runs at "
                               "{:.0f}: {}",
                               axis == 0 ? 'x' : 'y', angle, remedy))
          .of_yarn(region.name)
          .placed({}, options.file);
  }
  return {};
}

Status plan_bias(const Mesh& mesh, const FormingOptions& options, Forming& forming) {
  constexpr double strain = 0.1;
  const Vec3 sizes = mesh.cell ? Vec3(mesh.cell->high - mesh.cell->low) : Vec3(Vec3::Ones());
  const int axis = sizes.y() > sizes.x() ? 1 : 0;
  if (Status fit = check_bias(mesh, axis, options); !fit) return fit;
  const auto first = static_cast<std::size_t>(2 * axis);
  Result<std::vector<RigidPart>> parts = grip(mesh, {first, first + 1}, options, forming);
  if (!parts) return parts.error();
  forming.stroke[0] = options.stroke.value_or(strain * sizes[axis]);
  (*parts)[1].motions = {{axis, 0, forming.stroke[0]}};
  forming.parts = std::move(*parts);
  return {};
}

// Both axes turn towards each other by half of the shear angle, and every bar with its own: bars keep their
// lengths, and meet at corners that are hinges.
Status plan_frame(const Mesh& mesh, const FormingOptions& options, Forming& forming) {
  constexpr double usual = 30;  // degrees
  const double angle = options.stroke.value_or(usual);
  if (angle >= 90)
    return error(Kind::geometry,
                 fmt::format("a frame sheared by {:g} degrees is flat: --stroke of --load frame is its shear "
                             "angle, below 90 degrees",
                             angle))
        .placed({}, options.file);
  Result<std::vector<RigidPart>> parts = grip(mesh, {x_low, x_high, y_low, y_high}, options, forming);
  if (!parts) return parts.error();
  forming.stroke[0] = angle;
  const double half = angle / 2 * std::numbers::pi / 180;
  forming.curves = {curve_of("FrameCosine", [=](double s) { return std::cos(half * s) - 1; }),
                    curve_of("FrameSine", [=](double s) { return std::sin(half * s); }),
                    curve_of("FrameAngle", [=](double s) { return half * s; })};
  const Vec3 low((*parts)[x_low].reference.x(), (*parts)[y_low].reference.y(), 0),
      high((*parts)[x_high].reference.x(), (*parts)[y_high].reference.y(), 0);
  for (std::size_t edge = 0; edge < grips; ++edge) {
    RigidPart& part = (*parts)[edge];
    const int axis = edge < y_low ? 0 : 1;
    const double arm = (edge % 2 == 0 ? -1 : 1) * (high - low)[axis] / 2;
    part.reference[1 - axis] = (low + high)[1 - axis] / 2;  // the middle of the bar
    part.motions = {{axis, 0, arm}, {1 - axis, 1, arm}, {5, 2, axis == 0 ? -1.0 : 1.0}};
  }
  forming.parts = std::move(*parts);
  return {};
}

RigidPart plate(std::string name, const Box3& cloth, double z, bool looks_up) {
  constexpr double margin_share = 0.1;
  constexpr std::size_t along = 8;
  const double margin = margin_share * std::max(cloth.sizes().x(), cloth.sizes().y());
  const Vec3 low = cloth.min() - Vec3(margin, margin, 0),
             sizes = cloth.sizes() + Vec3(2 * margin, 2 * margin, 0);
  RigidPart part;
  part.name = std::move(name);
  part.reference = Vec3(cloth.center().x(), cloth.center().y(), z);
  part.size = sizes.norm();
  for (std::size_t j = 0; j <= along; ++j)
    for (std::size_t i = 0; i <= along; ++i)
      part.nodes.emplace_back(low.x() + sizes.x() * static_cast<double>(i) / along,
                              low.y() + sizes.y() * static_cast<double>(j) / along, z);
  for (std::size_t j = 0; j < along; ++j)
    for (std::size_t i = 0; i < along; ++i) {
      const std::size_t n = j * (along + 1) + i;
      if (looks_up)
        part.quads.push_back({n, n + 1, n + along + 2, n + along + 1});
      else
        part.quads.push_back({n, n + along + 1, n + along + 2, n + 1});
    }
  return part;
}

Status plan_compaction(const Box3& cloth, const FormingOptions& options, Forming& forming) {
  constexpr double usual_share = 0.2, clearance_share = 0.01;
  forming.thickness = cloth.sizes().z();
  forming.final_thickness = options.thickness.value_or(
      forming.thickness - options.stroke.value_or(usual_share * forming.thickness));
  if (forming.final_thickness <= 0 || forming.final_thickness >= forming.thickness)
    return error(Kind::geometry,
                 fmt::format("the cloth is {:.4g} mm thick, and the plates would end {:.4g} mm apart: they "
                             "have to end nearer than that, by --stroke or --thickness",
                             forming.thickness, forming.final_thickness))
        .placed({}, options.file);
  forming.stroke[0] = forming.thickness - forming.final_thickness;
  const double clearance = clearance_share * forming.thickness, way = forming.stroke[0] / 2 + clearance;
  forming.parts = {plate("PlateLow", cloth, cloth.min().z() - clearance, true),
                   plate("PlateHigh", cloth, cloth.max().z() + clearance, false)};
  forming.parts[0].motions = {{2, 0, way}};
  forming.parts[1].motions = {{2, 0, -way}};
  return {};
}

Status plan_load(const Mesh& mesh, std::span<const double> radii, const FormingOptions& options,
                 Forming& forming) {
  switch (options.load) {
    case FormingLoad::biaxial:
      return plan_biaxial(mesh, options, forming);
    case FormingLoad::bias:
      return plan_bias(mesh, options, forming);
    case FormingLoad::frame:
      return plan_frame(mesh, options, forming);
    case FormingLoad::compaction:
      break;
  }
  return plan_compaction(box_of(mesh, radii), options, forming);
}

// How far the part that moves farthest goes, mm.
double longest_way(const Forming& forming) {
  double longest = 0;
  for (const RigidPart& part : forming.parts) {
    Vec3 way = Vec3::Zero();
    for (const RigidPart::Motion& motion : part.motions)
      if (motion.direction < 3)
        way[motion.direction] += motion.factor * forming.curves[motion.curve].points.back()[1];
    longest = std::max(longest, way.norm());
  }
  return longest;
}

// Slow against waves, and against what cloth is formed with.
double usual_duration(const Mesh& mesh, const Forming& forming) {
  constexpr double passages = 20, speed = 5000;  // mm/s
  double wave = 0;
  for (const Region& region : mesh.regions) {
    Box3 box;
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      box.extend(mesh.nodes[mesh.elements[e][0]]);
    const double length = region.length > 0 ? region.length : box.diagonal().norm();
    wave = std::max(wave, length / wave_speed(mesh.materials[material_of(mesh, region)], true));
  }
  return std::max(passages * wave, longest_way(forming) / speed);
}

}  // namespace

std::string_view name_of(FormingLoad load) {
  constexpr std::array<std::string_view, 4> words = {"biaxial", "bias", "frame", "compaction"};
  return words[static_cast<std::size_t>(load)];
}

std::span<const std::string_view> names_of_rigid_parts() {
  return names;
}

Result<Forming> plan_forming(const Mesh& mesh, std::span<const double> radii, const FormingOptions& options) {
  if (Status known = check_densities(mesh, options); !known) return known.error();
  Forming forming;
  forming.load = options.load;
  forming.friction = options.friction;
  forming.curves = {curve_of(
      "Smooth", [](double s) { return s; }, true)};
  if (Status planned = plan_load(mesh, radii, options, forming); !planned) return planned.error();
  for (const Region& region : mesh.regions)
    forming.mass += region.volume * *orthotropic(mesh.materials[material_of(mesh, region)]).density;
  forming.duration = options.duration.value_or(usual_duration(mesh, forming));
  forming.stable = stable_increment(mesh);
  return forming;
}

}  // namespace selvage::fem
