#include "contact/contact.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <tuple>

#include "contact/box_tree.h"
#include "contact/face.h"
#include "contact/patch.h"
#include "contact/place.h"
#include "core/parallel.h"

namespace selvage::contact {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Gaps up to this share of the thinnest yarn are always measured: the least one is mostly among them.
constexpr double near_share = 0.02;
// Places of one yarn that are nearer along it than this many widths are no contact.
constexpr double self_distance = 1.5;

std::optional<Message> find_fault(std::span<const yarn::Body> bodies) {
  for (const yarn::Body& body : bodies) {
    if (body.surface.is_empty()) continue;
    for (const nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
      for (const Vec3& p : s->points)
        if (!p.allFinite()) {
          Message message =
              error(Kind::geometry, "the surface of yarn '" + body.name + "' has a point that is not finite");
          message.yarn = body.name;
          message.place = body.place;
          return message;
        }
  }
  return std::nullopt;
}

class Search {
 public:
  Search(std::span<const yarn::Body> bodies, const ContactOptions& options)
      : options_(options), model_(bodies, options.threads), tree_(boxes()) {
    for (std::size_t k = 0; k < bodies.size(); ++k)
      if (model_.thickness(k) > 0.0) thinnest_ = std::min(thinnest_, model_.thickness(k));
  }

  Contacts run() {
    Contacts out;
    if (!std::isfinite(thinnest_)) return out;
    const double reach = std::max(options_.reach, near_share * thinnest_);
    std::vector<Contact> found = contacts_within(reach);
    for (Contact& contact : found)
      if (contact.is_overlap() || contact.gap <= options_.reach) out.list.push_back(std::move(contact));
    sort(out.list);
    out.resolution = 1e-6 * thinnest_;
    out.min_gap = least_gap(found);
    return out;
  }

 private:
  [[nodiscard]] std::vector<Box3> boxes() const {
    std::vector<Box3> all;
    for (const Piece& piece : model_.pieces()) all.push_back(piece.box);
    return all;
  }

  static void sort(std::vector<Contact>& list) {
    std::stable_sort(list.begin(), list.end(), [](const Contact& x, const Contact& y) {
      return std::tuple(x.gap, x.a, x.b, x.at.x(), x.at.y(), x.at.z()) <
             std::tuple(y.gap, y.a, y.b, y.at.x(), y.at.y(), y.at.z());
    });
  }

  [[nodiscard]] bool is_wanted(const Piece& a, const Piece& b) const {
    if (a.body != b.body) return true;
    if (!options_.with_itself) return false;
    return model_.way_along(a, b) > self_distance * std::max(a.width, b.width);
  }

  struct PiecePair {
    std::uint32_t a, b;
  };

  [[nodiscard]] std::vector<PiecePair> piece_pairs(double reach) const {
    std::vector<PiecePair> pairs;
    tree_.near_pairs(reach, [&](std::uint32_t i, std::uint32_t j) {
      const Piece &a = model_.pieces()[i], &b = model_.pieces()[j];
      if (is_wanted(a, b)) pairs.push_back({i, j});  // pieces are in the order of the bodies, and along them
    });
    std::sort(pairs.begin(), pairs.end(), [](const PiecePair& x, const PiecePair& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
    return pairs;
  }

  // The cells of a piece that are near a box, with their control points.
  struct Candidate {
    std::uint32_t cell;
    Patch patch;
  };
  void candidates(const Piece& piece, const Box3& box, double reach, std::vector<Candidate>& out) const {
    out.clear();
    for (std::uint32_t k = piece.first_cell; k < piece.first_cell + piece.count; ++k) {
      const Cell& cell = model_.cells()[k];
      if (cell.box.squaredExteriorDistance(box) <= reach * reach)
        out.push_back({k, patch_of(*model_.face_of(cell).surface, cell.low, cell.high)});
    }
  }

  void cell_pairs(const PiecePair& pair, double reach, std::vector<NearPair>& out) const {
    const Piece &a = model_.pieces()[pair.a], &b = model_.pieces()[pair.b];
    thread_local std::vector<Candidate> of_a, of_b;
    candidates(a, b.box, reach, of_a);
    if (of_a.empty()) return;
    candidates(b, a.box, reach, of_b);
    for (const Candidate& x : of_a) {
      const Cell& ca = model_.cells()[x.cell];
      for (const Candidate& y : of_b) {
        const Cell& cb = model_.cells()[y.cell];
        if (ca.box.squaredExteriorDistance(cb.box) > reach * reach) continue;
        const double low = slab_gap(x.patch, ca.normal, y.patch, cb.normal);
        if (low <= reach) out.push_back({x.cell, y.cell, low});
      }
    }
  }

  // Near pairs by bodies, in a fixed order.
  [[nodiscard]] std::vector<Cluster> clusters(double reach) const {
    const std::vector<PiecePair> pieces = piece_pairs(reach);
    constexpr std::size_t chunk = 64;
    std::vector<std::vector<NearPair>> found((pieces.size() + chunk - 1) / chunk);
    for_each_index(found.size(), options_.threads, [&](std::size_t c) {
      for (std::size_t k = c * chunk; k < std::min(pieces.size(), (c + 1) * chunk); ++k)
        cell_pairs(pieces[k], reach, found[c]);
    });
    std::vector<NearPair> all;
    for (std::vector<NearPair>& part : found) {
      all.insert(all.end(), part.begin(), part.end());
      part = {};
    }
    return cluster(std::move(all));
  }

  [[nodiscard]] std::uint32_t body_of(std::uint32_t cell) const {
    return model_.face_of(model_.cells()[cell]).body;
  }

  // Pairs that share a cell hang together.
  [[nodiscard]] std::vector<Cluster> cluster(std::vector<NearPair> pairs) const {
    std::stable_sort(pairs.begin(), pairs.end(), [&](const NearPair& x, const NearPair& y) {
      return std::tuple(body_of(x.a), body_of(x.b), x.a, x.b) <
             std::tuple(body_of(y.a), body_of(y.b), y.a, y.b);
    });
    std::vector<std::uint32_t> parent(pairs.size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t k) {
      while (parent[k] != k) k = parent[k] = parent[parent[k]];
      return k;
    };
    const auto unite = [&](std::uint32_t x, std::uint32_t y) {
      x = root(x);
      y = root(y);
      parent[std::max(x, y)] = std::min(x, y);
    };
    std::vector<Cluster> all;
    std::vector<std::uint32_t> by_b;
    std::vector<std::uint32_t> number(pairs.size());
    for (std::size_t begin = 0; begin < pairs.size();) {
      std::size_t end = begin;
      while (end < pairs.size() && body_of(pairs[end].a) == body_of(pairs[begin].a) &&
             body_of(pairs[end].b) == body_of(pairs[begin].b))
        ++end;
      by_b.resize(end - begin);
      std::iota(by_b.begin(), by_b.end(), static_cast<std::uint32_t>(begin));
      std::sort(by_b.begin(), by_b.end(), [&](std::uint32_t x, std::uint32_t y) {
        return std::pair(pairs[x].b, x) < std::pair(pairs[y].b, y);
      });
      for (std::size_t k = begin + 1; k < end; ++k) {
        if (pairs[k].a == pairs[k - 1].a)
          unite(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(k - 1));
        const std::uint32_t here = by_b[k - begin], before = by_b[k - begin - 1];
        if (pairs[here].b == pairs[before].b) unite(here, before);
      }
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t group = root(static_cast<std::uint32_t>(k));
        if (group == k) {
          number[k] = static_cast<std::uint32_t>(all.size());
          all.emplace_back();
        }
        all[number[group]].push_back(pairs[k]);
      }
      begin = end;
    }
    return all;
  }

  [[nodiscard]] std::vector<Contact> contacts_within(double reach) const {
    const std::vector<Cluster> places = clusters(reach);
    std::vector<std::vector<Contact>> found(places.size());
    std::size_t done = 0;
    std::mutex guard;
    for_each_index(places.size(), options_.threads, [&](std::size_t k) {
      found[k] = measure(model_, places[k], reach);
      if (!options_.progress) return;
      const std::lock_guard lock(guard);
      options_.progress(++done, places.size());
    });
    std::vector<Contact> all;
    for (std::vector<Contact>& part : found)
      for (Contact& contact : part) all.push_back(std::move(contact));
    return all;
  }

  // Of the pairs of yarns that do not overlap. Nothing was near: the reach grows until something is.
  [[nodiscard]] std::optional<double> least_gap(const std::vector<Contact>& near) const {
    std::vector<std::pair<std::size_t, std::size_t>> overlapping;
    for (const Contact& contact : near)
      if (contact.is_overlap()) overlapping.emplace_back(contact.a, contact.b);
    std::sort(overlapping.begin(), overlapping.end());
    double least = infinity;
    for (const Contact& contact : near)
      if (!std::binary_search(overlapping.begin(), overlapping.end(), std::pair(contact.a, contact.b)))
        least = std::min(least, std::max(0.0, contact.gap));
    if (std::isfinite(least)) return least;
    return std::nullopt;
  }

  const ContactOptions& options_;
  CellModel model_;
  BoxTree tree_;
  double thinnest_ = infinity;
};

}  // namespace

Result<Contacts> find_contacts(std::span<const yarn::Body> bodies, const ContactOptions& options) {
  if (std::optional<Message> fault = find_fault(bodies)) return *fault;
  return Search(bodies, options).run();
}

}  // namespace selvage::contact
