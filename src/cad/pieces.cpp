#include <algorithm>
#include <bit>
#include <cstdint>
#include <unordered_map>

#include "cad/recognize.h"

namespace selvage::cad {

namespace {

using nurbs::Curve;

std::uint64_t key_of(const Curve& curve) {
  std::uint64_t key = curve.points.size();
  for (const Vec3* p : {&curve.points.front(), &curve.points.back()})
    for (const double x : *p) key = (key ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15U;
  return key;
}

// A line or a clamped cubic, without corners, over [0, 1] in z = 0.
bool is_side(const Curve& curve) {
  if (curve.degree != 1 && curve.degree != 3) return false;
  const auto order = static_cast<std::size_t>(curve.degree) + 1;
  if (curve.degree == 1 && (curve.is_rational() || curve.points.size() != order)) return false;
  const std::vector<double>& k = curve.knots;
  if (k.size() < 2 * order) return false;
  for (std::size_t i = 0; i < order; ++i)
    if (k[i] != 0 || k[k.size() - 1 - i] != 1) return false;
  for (std::size_t i = order; i + order < k.size(); ++i)
    if (!(k[i] > 0 && k[i] < 1 && k[i] < k[i + 2])) return false;
  return std::all_of(curve.points.begin(), curve.points.end(), [](const Vec3& p) { return p.z() == 0; });
}

bool is_outline(const Part& part) {
  if (part.faces.size() != 1 || part.faces.front().loops.size() != 1) return false;
  const Face& face = part.faces.front();
  if (face.surface.degree_u != 1 || face.surface.degree_v != 1 || face.surface.points.size() != 4)
    return false;
  if (!std::all_of(face.surface.points.begin(), face.surface.points.end(),
                   [](const Vec3& p) { return p.z() == 0; }))
    return false;
  const std::vector<Edge>& edges = face.loops.front().edges;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (!is_side(edges[i].curve) ||
        edges[i].curve.points.back() != edges[(i + 1) % edges.size()].curve.points.front())
      return false;
  return !edges.empty();
}

class Curves {
 public:
  explicit Curves(const std::vector<NamedCurve>& curves) : curves_(curves), used_(curves.size(), false) {
    for (std::size_t i = curves.size(); i-- > 0;)  // the first ones are taken first
      if (is_side(curves[i].curve)) places_[key_of(curves[i].curve)].push_back(i);
  }

  // The index of each side's free curve; nothing when one has none.
  std::optional<std::vector<std::size_t>> take(const Loop& loop) {
    std::vector<std::size_t> taken;
    for (const Edge& edge : loop.edges) {
      const std::optional<std::size_t> found = find(edge.curve);
      if (!found) {
        for (const std::size_t i : taken) used_[i] = false;
        return std::nullopt;
      }
      used_[*found] = true;
      taken.push_back(*found);
    }
    return taken;
  }
  [[nodiscard]] bool is_used(std::size_t index) const { return used_[index]; }

 private:
  std::optional<std::size_t> find(const Curve& curve) {
    const auto place = places_.find(key_of(curve));
    if (place == places_.end()) return std::nullopt;
    std::vector<std::size_t>& list = place->second;
    while (!list.empty() && used_[list.back()]) list.pop_back();
    for (auto i = list.rbegin(); i != list.rend(); ++i)
      if (!used_[*i] && curves_[*i].curve.points == curve.points &&
          curves_[*i].curve.weights == curve.weights && curves_[*i].curve.knots == curve.knots)
        return *i;
    return std::nullopt;
  }

  const std::vector<NamedCurve>& curves_;
  std::vector<bool> used_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> places_;
};

}  // namespace

std::vector<Outline> take_outlines(Model& model) {
  std::vector<Outline> outlines;
  if (model.curves.empty()) return outlines;
  Curves curves(model.curves);
  std::erase_if(model.parts, [&](const Part& part) {
    if (!is_outline(part)) return false;
    const Loop& loop = part.faces.front().loops.front();
    const auto taken = curves.take(loop);
    if (!taken) return false;
    Outline outline;
    outline.name = part.name;
    outline.origin = part.origin;
    for (std::size_t i = 0; i < taken->size(); ++i)
      outline.sides.push_back({model.curves[(*taken)[i]].name, loop.edges[i].curve});
    outlines.push_back(std::move(outline));
    return true;
  });
  std::size_t index = 0;
  std::erase_if(model.curves, [&](const NamedCurve&) { return curves.is_used(index++); });
  return outlines;
}

}  // namespace selvage::cad
