#include "solid/cgal/overlaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/parallel.h"
#include "solid/cgal/contact.h"
#include "solid/cgal/depth.h"

namespace selvage::solid {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class Search {
 public:
  Search(std::span<const Skinned> yarns, int threads) : yarns_(yarns), threads_(threads) {
    std::vector<std::optional<TriangleTree>> trees(yarns.size());
    for_each_index(yarns.size(), threads, [&](std::size_t i) { trees[i].emplace(*yarns[i].skin); });
    for (std::optional<TriangleTree>& tree : trees) trees_.push_back(std::move(*tree));
    for (std::size_t i = 0; i < yarns.size(); ++i)
      if (!trees_[i].is_empty()) order_.push_back(i);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t x, std::size_t y) { return low(x) < low(y); });
  }

  Neighbourhood run(const std::function<void()>& progress) {
    // First the pairs whose boxes meet (enlarged by what triangles can hide); they bound the least gap, and
    // only boxes nearer than that are looked at afterwards.
    sweep(-infinity, 0.0, progress);
    bound_gap();
    sweep(0.0, gap_, {});
    std::sort(found_.overlaps.begin(), found_.overlaps.end(), [](const Overlap& x, const Overlap& y) {
      if (x.depth != y.depth) return x.depth > y.depth;
      if (x.a != y.a || x.b != y.b) return std::pair(x.a, x.b) < std::pair(y.a, y.b);
      return std::lexicographical_compare(x.at.begin(), x.at.end(), y.at.begin(), y.at.end());
    });
    if (std::isfinite(gap_)) found_.min_gap = gap_;
    return std::move(found_);
  }

 private:
  [[nodiscard]] double low(std::size_t i) const { return trees_[i].box().min().x(); }
  [[nodiscard]] double chord(std::size_t i, std::size_t j) const { return yarns_[i].chord + yarns_[j].chord; }
  [[nodiscard]] double box_distance(std::size_t i, std::size_t j) const {
    return trees_[i].box().exteriorDistance(trees_[j].box());
  }

  // Looks at all pairs whose boxes, enlarged by the chord errors, are more than `low_gap` and at most
  // `high_gap` apart.
  void sweep(double low_gap, double high_gap, const std::function<void()>& progress) {
    double coarsest = 0.0;
    for (std::size_t i : order_) coarsest = std::max(coarsest, yarns_[i].chord);
    for_each_index(order_.size(), threads_, [&](std::size_t k) {
      const std::size_t i = order_[k];
      for (std::size_t m = k + 1; m < order_.size(); ++m) {
        const std::size_t j = order_[m];
        if (low(j) - trees_[i].box().max().x() > high_gap + 2.0 * coarsest) break;
        const double gap = box_distance(i, j) - chord(i, j);
        if (gap > low_gap && gap <= high_gap) look(std::min(i, j), std::max(i, j));
      }
      if (progress) progress();
    });
    if (progress)
      for (std::size_t i = order_.size(); i < yarns_.size(); ++i) progress();
  }

  // Neighbours in the order give a bound to sweep with.
  void bound_gap() {
    for (std::size_t k = 0; k + 1 < order_.size(); ++k) {
      const auto [i, j] = std::minmax(order_[k], order_[k + 1]);
      const double gap = box_distance(i, j) - chord(i, j);
      if (gap > 0.0 && gap < gap_) look(i, j);
    }
  }

  void look(std::size_t i, std::size_t j) {
    const std::vector<TriangleTree::Pair> pairs = TriangleTree::near_pairs(trees_[i], trees_[j], chord(i, j));
    std::vector<Overlap> overlaps;
    double gap = infinity;
    for (const Contact& contact : find_contacts(trees_[i], trees_[j], pairs)) {
      const Measure measured = measure(yarns_[i], yarns_[j], contact);
      if (measured.depth > touching(*yarns_[i].body, *yarns_[j].body)) {
        overlaps.push_back({i, j, measured.depth, measured.at, measured.direction});
      } else {
        gap = std::min(gap, std::max(0.0, -measured.depth));
      }
    }
    if (overlaps.empty() && pairs.empty()) gap = far_gap(i, j);
    const std::lock_guard lock(guard_);
    if (overlaps.empty()) gap_ = std::min(gap_, gap);
    found_.overlaps.insert(found_.overlaps.end(), overlaps.begin(), overlaps.end());
  }

  // The distance of two yarns whose triangles are not near, if it can be the least one.
  double far_gap(std::size_t i, std::size_t j) {
    double limit = infinity;
    {
      const std::lock_guard lock(guard_);
      limit = gap_ + chord(i, j);
    }
    TriangleTree::Pair nearest = TriangleTree::nearest_pair(trees_[i], trees_[j], limit);
    if (!std::isfinite(nearest.distance) || nearest.distance > 200.0 * chord(i, j)) return nearest.distance;
    // Any of the pairs that are nearly as near may be the nearest on the surfaces.
    double gap = infinity;
    for (const Contact& contact :
         find_contacts(trees_[i], trees_[j],
                       TriangleTree::near_pairs(trees_[i], trees_[j], nearest.distance + chord(i, j))))
      gap = std::min(gap, -measure(yarns_[i], yarns_[j], contact).depth);
    return std::max(gap, 0.0);
  }

  std::span<const Skinned> yarns_;
  int threads_;
  std::vector<TriangleTree> trees_;
  std::vector<std::size_t> order_;  // by the box's lowest x
  std::mutex guard_;
  double gap_ = infinity;
  Neighbourhood found_;
};

}  // namespace

Neighbourhood find_overlaps(std::span<const Skinned> yarns, int threads,
                            const std::function<void()>& progress) {
  return Search(yarns, threads).run(progress);
}

}  // namespace selvage::solid
