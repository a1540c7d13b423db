#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "fem/edge_key.h"
#include "fem/triangle_mesh.h"

namespace selvage::fem {

namespace {

constexpr int most_rounds = 60;
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
    mesh_.points = region.points;
    mesh_.parameters = region.parameters;
    mesh_.fixed_points = region.points.size();
    for (const Vec2& p : region.parameters) chart_.push_back(p.cwiseProduct(region.scale));
    for (const Vec3& p : region.points) wanted_.push_back(field.at(p));
    fixed_lengths_.assign(region.points.size(), 0);
    for (const solid::PlanarSegment& s : region.segments) {
      mesh_.fixed_edges.push_back({s.from, s.to});
      segments_.push_back(edge_key(s.from, s.to));
      const double length = (region.points[s.from] - region.points[s.to]).norm();
      for (const std::uint32_t end : {s.from, s.to})
        fixed_lengths_[end] = std::max(fixed_lengths_[end], length);
    }
    std::sort(segments_.begin(), segments_.end());
  }

  Result<TriangleMesh> run(std::size_t most) {
    for (int round = 0;; ++round) {
      Result<solid::PlanarTriangles> made = solid::triangulate(chart_, region_.segments);
      if (!made) return placed(std::move(made.error()));
      mesh_.triangles = std::move(made->triangles);
      mesh_.domains = std::move(made->domains);
      if (mesh_.triangles.size() > most)
        return error(Kind::limit, fmt::format("the surfaces need more than {} triangles; choose a coarser "
                                              "--size",
                                              most));
      if (round == most_rounds || !add_points()) return std::move(mesh_);
    }
  }

 private:
  // In space, not in the chart.
  [[nodiscard]] Message placed(Message message) const {
    if (message.at) message.at = support_.point(Vec2(message.at->head<2>()).cwiseQuotient(region_.scale));
    return message;
  }

  [[nodiscard]] std::vector<LongEdge> long_edges() const {
    std::vector<std::uint64_t> keys;
    for (const auto& t : mesh_.triangles)
      for (std::size_t k = 0; k < 3; ++k) keys.push_back(edge_key(t[k], t[(k + 1) % 3]));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    std::vector<LongEdge> result;
    for (const std::uint64_t key : keys) {
      if (std::binary_search(segments_.begin(), segments_.end(), key)) continue;
      const auto a = static_cast<std::uint32_t>(key >> 32U), b = static_cast<std::uint32_t>(key);
      const double length = (mesh_.points[a] - mesh_.points[b]).norm();
      // Beside a fixed edge that is too long itself there is no end to it.
      if (length < too_long * std::min(wanted_[a], wanted_[b]) ||
          length < beside_fixed * std::max(fixed_length(a), fixed_length(b)))
        continue;
      const Vec2 middle = (mesh_.parameters[a] + mesh_.parameters[b]) / 2;
      const double wanted = field_.at(support_.point(middle));
      if (length > too_long * wanted) result.push_back({length / wanted, wanted, a, b});
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const LongEdge& x, const LongEdge& y) { return x.excess > y.excess; });
    return result;
  }

  // Of the longest fixed edge at a point.
  [[nodiscard]] double fixed_length(std::uint32_t k) const {
    return k < fixed_lengths_.size() ? fixed_lengths_[k] : 0;
  }

  bool add_points() {
    const std::vector<LongEdge> edges = long_edges();
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
  TriangleMesh mesh_;
  std::vector<Vec2> chart_;
  std::vector<double> wanted_, fixed_lengths_;
  std::vector<std::uint64_t> segments_;
};

}  // namespace

Result<TriangleMesh> fill(const PlanarRegion& region, const Support& support, const SizeField& field,
                          std::size_t most) {
  return Filler(region, support, field).run(most);
}

}  // namespace selvage::fem
