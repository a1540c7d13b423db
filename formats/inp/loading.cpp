#include <algorithm>
#include <cmath>

#include "fem/sides.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

constexpr double strain = 0.001;

Vec3 area_vector(const fem::Mesh& mesh, const std::vector<fem::ElementSide>& faces) {
  Vec3 sum = Vec3::Zero();
  for (const fem::ElementSide& face : faces) sum += fem::area_vector(mesh, face);
  return sum;
}

Vec3 middle(const fem::Mesh& mesh, const std::vector<std::size_t>& nodes) {
  Vec3 sum = Vec3::Zero();
  for (const std::size_t node : nodes) sum += mesh.nodes[node];
  return sum / static_cast<double>(nodes.size());
}

void choose_anchors(const fem::Mesh& mesh, Load& load) {
  auto distance = [&](const Vec3& from, std::size_t node) { return (mesh.nodes[node] - from).squaredNorm(); };
  const Vec3 centre = middle(mesh, load.start);
  load.anchor = *std::min_element(load.start.begin(), load.start.end(), [&](std::size_t a, std::size_t b) {
    return distance(centre, a) < distance(centre, b);
  });
  const Vec3 from = mesh.nodes[load.anchor];
  load.second = *std::max_element(load.start.begin(), load.start.end(), [&](std::size_t a, std::size_t b) {
    return distance(from, a) < distance(from, b);
  });
}

// A ring: the nodes nearest to both ends of its longest extent, at least a dozen of them each.
Load grip_ring(const fem::Mesh& mesh, const fem::Region& region) {
  Box3 box;
  for (std::size_t n = region.first_node; n < region.last_node; ++n) box.extend(mesh.nodes[n]);
  const double extent = box.sizes().maxCoeff();
  int axis = 0;  // the first of equal ones
  while (box.sizes()[axis] < 0.99 * extent) ++axis;
  Load load;
  for (double depth = 0.02 * extent; load.start.size() < 12 || load.end.size() < 12; depth *= 1.5) {
    load.start.clear();
    load.end.clear();
    for (std::size_t n = region.first_node; n < region.last_node; ++n) {
      if (mesh.nodes[n][axis] <= box.min()[axis] + depth) load.start.push_back(n);
      if (mesh.nodes[n][axis] >= box.max()[axis] - depth) load.end.push_back(n);
    }
    if (depth >= extent) break;  // fewer nodes than that in all
  }
  load.normal_end = Vec3::Unit(axis);
  load.normal_start = -load.normal_end;
  load.pull = strain * extent;
  return load;
}

Load grip_ends(const fem::Mesh& mesh, const fem::Region& region) {
  Load load;
  load.start = region.start_nodes;
  load.end = region.end_nodes;
  const Vec3 start = area_vector(mesh, region.start_faces), end = area_vector(mesh, region.end_faces);
  load.normal_start = start.normalized();
  load.normal_end = end.normalized();
  load.pull = strain * region.length;
  return load;
}

// The coordinate axis along which a unit vector runs; -1: none.
int axis_of(const Vec3& normal) {
  Eigen::Index axis = 0;
  return normal.cwiseAbs().maxCoeff(&axis) > 1 - 1e-12 ? static_cast<int>(axis) : -1;
}

// A direction in the start face from the anchor towards the second node: local axis 2.
Vec3 local_second(const fem::Mesh& mesh, const Load& load, const Vec3& normal) {
  const Vec3 between = mesh.nodes[load.second] - mesh.nodes[load.anchor];
  const Vec3 level = between - normal * normal.dot(between);
  return level.norm() > 1e-6 * between.norm() ? level.normalized() : normal.unitOrthogonal();
}

void write_transform(TextBuffer& text, const std::string& set, const Vec3& first, const Vec3& second) {
  text << "*TRANSFORM, NSET=" << set << ", TYPE=R\n";
  for (const Vec3* axis : {&first, &second})
    for (int i = 0; i < 3; ++i) text << real((*axis)[i]) << (axis == &second && i == 2 ? "\n" : ", ");
}

}  // namespace

std::vector<Load> plan_loads(const fem::Mesh& mesh, const fem::DeckNames& names) {
  std::vector<Load> loads;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const fem::Region& region = mesh.regions[i];
    const bool ring = region.start_nodes.empty();
    if (ring && region.first_node == region.last_node) continue;
    Load load = ring ? grip_ring(mesh, region) : grip_ends(mesh, region);
    load.start_set = names.of(i) + (ring ? "_Low" : "_Start");
    load.end_set = names.of(i) + (ring ? "_High" : "_End");
    choose_anchors(mesh, load);
    loads.push_back(std::move(load));
  }
  return loads;
}

void write_transforms(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads) {
  for (const Load& load : loads) {
    if (axis_of(load.normal_start) < 0)
      write_transform(text, load.start_set, load.normal_start, local_second(mesh, load, load.normal_start));
    if (axis_of(load.normal_end) < 0)
      write_transform(text, load.end_set, load.normal_end, load.normal_end.unitOrthogonal());
  }
}

void write_step(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads) {
  text << "** A small tension to begin with: every yarn is held at its start and pulled by a thousandth of "
          "its length at its\n"
          "** end, free to contract sideways. Two nodes of each start take the rigid motions that are left.\n"
          "*STEP\n*STATIC\n*BOUNDARY\n";
  for (const Load& load : loads) {
    const int start_axis = axis_of(load.normal_start), end_axis = axis_of(load.normal_end);
    const int along = start_axis < 0 ? 0 : start_axis;
    int sideways = (along + 1) % 3,
        turning = (along + 2) % 3;  // local axes 2 and 3 where there is a transform
    if (start_axis >= 0) {
      const Vec3 between = mesh.nodes[load.second] - mesh.nodes[load.anchor];
      // The second node is held across the longer part of its way from the anchor.
      if (std::abs(between[sideways]) < std::abs(between[turning])) std::swap(sideways, turning);
    }
    const int pulled = end_axis < 0 ? 0 : end_axis;
    const double pull = end_axis < 0 || load.normal_end[end_axis] > 0 ? load.pull : -load.pull;
    text << load.start_set << ", " << along + 1 << ", " << along + 1 << '\n';
    text << load.anchor + 1 << ", " << sideways + 1 << ", " << sideways + 1 << '\n';
    text << load.anchor + 1 << ", " << turning + 1 << ", " << turning + 1 << '\n';
    text << load.second + 1 << ", " << turning + 1 << ", " << turning + 1 << '\n';
    text << load.end_set << ", " << pulled + 1 << ", " << pulled + 1 << ", " << real(pull) << '\n';
  }
  for (const Load& load : loads)
    for (const std::string* set : {&load.start_set, &load.end_set})
      text << "*NODE PRINT, NSET=" << *set << ", TOTALS=YES\nRF\n";
  text << "*NODE FILE\nU, RF\n*EL FILE\nS, E\n*END STEP\n";
}

}  // namespace selvage::formats::inp
