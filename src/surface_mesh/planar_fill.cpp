#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "fem/edge_key.h"
#include "surface_mesh/triangle_mesh.h"

namespace selvage::fem {

namespace {

// Points come in from the borders, a row a round, which divides most evenly; what they have not reached by
// then, the middle of a long yarn, is divided all at once.
constexpr int front_rounds = 60, most_rounds = 120;
constexpr std::size_t most_triangles = 50'000'000;
constexpr double too_long = 1.45;  // an edge, over the wanted length
constexpr double too_near = 0.65;  // new points to each other, likewise
constexpr double beside_fixed = 0.8;

// Points that are not too near to each other, in cells of the largest wanted length.
class Spread {
 public:
  explicit Spread(double cell) : cell_(cell) {}

  [[nodiscard]] bool has_room(const Vec2& place, double distance) const {
    const auto [i, j] = cell_of(place);
    for (std::int64_t di = -1; di <= 1; ++di)
      for (std::int64_t dj = -1; dj <= 1; ++dj) {
        const auto found = cells_.find(hash(i + di, j + dj));
        if (found == cells_.end()) continue;
        for (const Vec2& other : found->second)
          if ((other - place).norm() < distance) return false;
      }
    return true;
  }

  void add(const Vec2& place) {
    const auto [i, j] = cell_of(place);
    cells_[hash(i, j)].push_back(place);
  }

 private:
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> cell_of(const Vec2& place) const {
    return {static_cast<std::int64_t>(std::floor(place.x() / cell_)),
            static_cast<std::int64_t>(std::floor(place.y() / cell_))};
  }
  static std::uint64_t hash(std::int64_t i, std::int64_t j) {
    return static_cast<std::uint64_t>(i) << 32U ^ (static_cast<std::uint64_t>(j) & 0xffffffffU);
  }
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<Vec2>> cells_;
};

struct LongEdge {
  double excess;  // length over the wanted one
  double wanted;
  std::uint32_t a, b;
};

class Filler {
 public:
  Filler(const PlanarRegion& region, const Support& support, const SizeField& field)
      : region_(region), support_(support), field_(field) {
    for (const PlanarRegion::Place& place : region.places) {
      mesh_.points.push_back(region.nodes[place.node].point);
      mesh_.parameters.push_back(place.parameters);
      chart_.push_back(place.parameters.cwiseProduct(region.scale));
      wanted_.push_back(field.at(mesh_.points.back()));
    }
    fixed_lengths_.assign(mesh_.points.size(), 0);
    for (const solid::PlanarSegment& s : region.segments) {
      segments_.push_back(edge_key(s.from, s.to));
      const double length = (mesh_.points[s.from] - mesh_.points[s.to]).norm();
      for (const std::uint32_t end : {s.from, s.to})
        fixed_lengths_[end] = std::max(fixed_lengths_[end], length);
    }
    std::sort(segments_.begin(), segments_.end());
  }

  Result<TriangleMesh> run() {
    for (int round = 0;; ++round) {
      Result<solid::PlanarTriangles> made = solid::triangulate(chart_, region_.segments);
      if (!made) return placed(std::move(made.error()));
      mesh_.triangles = std::move(made->triangles);
      mesh_.domains = std::move(made->domains);
      if (mesh_.triangles.size() > most_triangles)
        return error(Kind::limit, fmt::format("the surfaces need more than {} triangles; choose a coarser "
                                              "--size",
                                              most_triangles));
      if (round == most_rounds || !add_points(round >= front_rounds)) return joined();
    }
  }

 private:
  // In space, not in the chart.
  [[nodiscard]] Message placed(Message message) const {
    if (message.at) message.at = support_.point(Vec2(message.at->head<2>()).cwiseQuotient(region_.scale));
    return message;
  }

  [[nodiscard]] std::vector<LongEdge> long_edges(bool goes_round) const {
    std::vector<std::uint64_t> keys;
    for (const auto& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) keys.push_back(edge_key(t[k], t[(k + 1) % 3]));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    std::vector<LongEdge> result;
    for (const std::uint64_t key : keys) {
      if (std::binary_search(segments_.begin(), segments_.end(), key)) continue;
      const auto a = static_cast<std::uint32_t>(key >> 32U), b = static_cast<std::uint32_t>(key);
      const Vec2 middle = (mesh_.parameters[a] + mesh_.parameters[b]) / 2;
      const double enough = too_long * std::min(wanted_[a], wanted_[b]);
      double length = (mesh_.points[a] - mesh_.points[b]).norm();
      // Both sides of a cut are one place in space: an edge from one to the other goes all the way round.
      if (goes_round && length < enough && (chart_[a] - chart_[b]).norm() > enough) {
        const Vec3 between = support_.point(middle);
        length = (mesh_.points[a] - between).norm() + (between - mesh_.points[b]).norm();
      }
      // Beside a fixed edge that is too long itself there is no end to it.
      if (length < enough || length < beside_fixed * std::max(fixed_length(a), fixed_length(b))) continue;
      const double wanted = field_.at(support_.point(middle));
      if (length > too_long * wanted) result.push_back({length / wanted, wanted, a, b});
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const LongEdge& x, const LongEdge& y) { return x.excess > y.excess; });
    return result;
  }

  // Places of one node become one point: fixed ones, the others, and those that were put in.
  [[nodiscard]] TriangleMesh joined() {
    TriangleMesh mesh;
    std::vector<bool> used(region_.nodes.size(), false);
    for (const PlanarRegion::Place& place : region_.places) used[place.node] = true;
    std::vector<std::uint32_t> number(region_.nodes.size());
    for (const bool fixed : {true, false}) {
      for (std::size_t k = 0; k < region_.nodes.size(); ++k) {
        const PlanarRegion::Node& node = region_.nodes[k];
        if (node.is_fixed != fixed || !used[k]) continue;
        number[k] = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(node.point);
        mesh.parameters.push_back(node.parameters);
        if (fixed) mesh.known.push_back(node.known);
      }
      if (fixed) mesh.fixed_points = mesh.points.size();
    }
    const auto places = static_cast<std::uint32_t>(region_.places.size()),
               shared = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), mesh_.points.begin() + places, mesh_.points.end());
    mesh.parameters.insert(mesh.parameters.end(), mesh_.parameters.begin() + places, mesh_.parameters.end());
    const auto number_of = [&](std::uint32_t k) {
      return k < places ? number[region_.places[k].node] : shared + (k - places);
    };
    for (const auto& [a, b, c] : mesh_.triangles)
      mesh.triangles.push_back({number_of(a), number_of(b), number_of(c)});
    for (const solid::PlanarSegment& s : region_.segments)
      if (const std::uint32_t a = number_of(s.from), b = number_of(s.to);
          a < mesh.fixed_points && b < mesh.fixed_points)
        mesh.fixed_edges.push_back({a, b});
    mesh.domains = std::move(mesh_.domains);
    return mesh;
  }

  // Of the longest fixed edge at a point.
  [[nodiscard]] double fixed_length(std::uint32_t k) const {
    return k < fixed_lengths_.size() ? fixed_lengths_[k] : 0;
  }

  bool add_points(bool goes_round) {
    const std::vector<LongEdge> edges = long_edges(goes_round);
    const std::size_t before = chart_.size();
    Spread spread(too_near * field_.largest());
    for (const LongEdge& edge : edges) {
      const Vec2 middle = (chart_[edge.a] + chart_[edge.b]) / 2;
      const double distance = too_near * edge.wanted;
      if (!spread.has_room(middle, distance)) continue;
      spread.add(middle);
      chart_.push_back(middle);
      mesh_.parameters.push_back(middle.cwiseQuotient(region_.scale));
      mesh_.points.push_back(support_.point(mesh_.parameters.back()));
      wanted_.push_back(field_.at(mesh_.points.back()));
    }
    return chart_.size() > before;
  }

  const PlanarRegion& region_;
  const Support& support_;
  const SizeField& field_;
  TriangleMesh mesh_;  // of places
  std::vector<Vec2> chart_;
  std::vector<double> wanted_, fixed_lengths_;
  std::vector<std::uint64_t> segments_;
};

}  // namespace

Result<TriangleMesh> fill(const PlanarRegion& region, const Support& support, const SizeField& field) {
  Result<TriangleMesh> mesh = Filler(region, support, field).run();
  if (mesh) remesh(*mesh, support, field);
  return mesh;
}

}  // namespace selvage::fem
