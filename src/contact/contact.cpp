#include "contact/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "contact/critical.h"
#include "contact/deep.h"
#include "contact/face.h"
#include "contact/place.h"
#include "contact/repeated.h"
#include "core/box_tree.h"
#include "core/groups.h"
#include "core/parallel.h"
#include "nurbs/patch.h"

namespace selvage::contact {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Gaps up to this share of the thinnest yarn are always measured: the least one is mostly among them.
constexpr double near_share = 0.02;
// Places of one yarn that are nearer along it than this many widths are no contact.
constexpr double self_distance = 1.5;
// And by how much the way along it is longer than the straight one: where a yarn turned less (an arc of 130
// degrees), it does not face itself, however far one looks.
constexpr double turned = 1.25;

std::optional<Message> find_fault(std::span<const yarn::Body> bodies) {
  for (const yarn::Body& body : bodies) {
    if (body.surface.is_empty()) continue;
    for (const nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
      for (const Vec3& p : s->points)
        if (!p.allFinite())
          return error(Kind::geometry,
                       "the surface of yarn '" + body.name + "' has a point that is not finite")
              .of_yarn(body.name, body.place);
  }
  return std::nullopt;
}

Contact moved(Contact contact, const Vec3& by) {
  for (Vec3* p : {&contact.on_a, &contact.on_b, &contact.at}) *p += by;
  for (Minimum& spot : contact.spots) {
    spot.on_a += by;
    spot.on_b += by;
  }
  return contact;
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
    double unsettled = 0.0;
    std::vector<Contact> found = contacts_within(reach, unsettled);
    if (reach > near_share * thinnest_) find_own_overlaps(found);
    add_contained(found);
    sort(found);
    drop_repeated(found);
    out.min_gap = least_gap(found, reach);
    for (Contact& contact : found)
      if (contact.is_overlap() || (options_.reach > 0.0 && contact.gap <= options_.reach))
        out.list.push_back(std::move(contact));
    out.resolution = std::max(resolution(), unsettled);
    return out;
  }

 private:
  [[nodiscard]] std::vector<Box3> boxes() const {
    std::vector<Box3> all;
    for (const Piece& piece : model_.pieces()) all.push_back(piece.box);
    return all;
  }

  // Of yarns with themselves, as they are found by looking no farther: from farther away stretches of one
  // yarn hang together that are no contact.
  void find_own_overlaps(std::vector<Contact>& found) const {
    const auto is_own_overlap = [](const Contact& contact) {
      return contact.a == contact.b && contact.is_overlap();
    };
    if (std::erase_if(found, is_own_overlap) == 0) return;
    double unsettled = 0.0;
    for (Contact& contact : contacts_within(near_share * thinnest_, unsettled))
      if (is_own_overlap(contact)) found.push_back(std::move(contact));
  }

  // What is proved: a millionth of the thinnest yarn.
  [[nodiscard]] double resolution() const { return 1e-6 * thinnest_; }

  static void sort(std::vector<Contact>& list) {
    std::stable_sort(list.begin(), list.end(), [](const Contact& x, const Contact& y) {
      return std::tuple(x.gap, x.a, x.b, x.at.x(), x.at.y(), x.at.z()) <
             std::tuple(y.gap, y.a, y.b, y.at.x(), y.at.y(), y.at.z());
    });
  }

  [[nodiscard]] bool is_wanted(const Piece& a, const Piece& b) const {
    if (a.body != b.body) return true;
    if (!options_.with_itself) return false;
    const double way = model_.way_along(a, b);
    return way > self_distance * std::max(a.width, b.width) &&
           way > turned * (a.box.center() - b.box.center()).norm();
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
    nurbs::Patch patch;
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

  using BodyPair = std::pair<std::size_t, std::size_t>;

  // Pairs of bodies that are two shapes in one position to each other, by the first of them: one is looked
  // at.
  using Alike = std::map<BodyPair, std::vector<BodyPair>>;

  // Leaves the pairs of pieces of bodies that are the first of their kind.
  [[nodiscard]] Alike drop_copies(std::vector<PiecePair>& pairs) const {
    const auto bodies_of = [&](const PiecePair& pair) {
      return BodyPair(model_.pieces()[pair.a].body, model_.pieces()[pair.b].body);
    };
    const double quantum = 0.1 * resolution();
    using Kind = std::tuple<std::uint64_t, std::uint64_t, double, double, double>;
    std::map<Kind, BodyPair> first;
    std::map<BodyPair, bool> is_first;
    Alike alike;
    std::erase_if(pairs, [&](const PiecePair& pair) {
      const BodyPair bodies = bodies_of(pair);
      const auto [known, is_new] = is_first.try_emplace(bodies, true);
      if (!is_new) return !known->second;
      const yarn::Body &a = model_.bodies()[bodies.first], &b = model_.bodies()[bodies.second];
      if (a.shape == 0 || b.shape == 0) return false;
      const Vec3 way = ((b.at - a.at) / quantum).array().round();
      const auto [found, is_new_kind] =
          first.try_emplace(Kind(a.shape, b.shape, way.x(), way.y(), way.z()), bodies);
      if (is_new_kind) return false;
      alike[found->second].push_back(bodies);
      known->second = false;
      return true;
    });
    return alike;
  }

  void add_copies(const Alike& alike, std::vector<Contact>& list) const {
    const std::size_t count = list.size();
    for (std::size_t k = 0; k < count; ++k) {
      const auto copies = alike.find({list[k].a, list[k].b});
      if (copies == alike.end()) continue;
      for (const BodyPair& copy : copies->second) {
        Contact contact = moved(list[k], model_.bodies()[copy.first].at - model_.bodies()[list[k].a].at);
        std::tie(contact.a, contact.b) = copy;
        list.push_back(std::move(contact));
      }
    }
  }

  // Near pairs by bodies, in a fixed order.
  [[nodiscard]] std::vector<Cluster> clusters(double reach, Alike& alike) const {
    std::vector<PiecePair> pieces = piece_pairs(reach);
    alike = drop_copies(pieces);
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
    Groups groups(pairs.size());
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
        if (pairs[k].a == pairs[k - 1].a) groups.join(k, k - 1);
        const std::uint32_t here = by_b[k - begin], before = by_b[k - begin - 1];
        if (pairs[here].b == pairs[before].b) groups.join(here, before);
      }
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t group = groups.of(k);
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

  [[nodiscard]] std::vector<Contact> contacts_within(double reach, double& unsettled) const {
    Alike alike;
    const std::vector<Cluster> places = clusters(reach, alike);
    std::vector<Measured> found(places.size());
    for_each_index(
        places.size(), options_.threads,
        [&](std::size_t k) { found[k] = measure(model_, places[k], reach, resolution()); },
        options_.progress);
    std::vector<Contact> all;
    for (Measured& part : found) {
      unsettled = std::max(unsettled, part.unsettled);
      for (Contact& contact : part.contacts) all.push_back(std::move(contact));
    }
    add_copies(alike, all);
    return all;
  }

  [[nodiscard]] static std::vector<BodyPair> overlapping(const std::vector<Contact>& list) {
    std::vector<BodyPair> pairs;
    for (const Contact& contact : list)
      if (contact.is_overlap()) pairs.emplace_back(contact.a, contact.b);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

  // Yarns wholly inside another: no surface is near the other one there.
  void add_contained(std::vector<Contact>& found) const {
    const std::vector<BodyPair> known = overlapping(found);
    const std::span<const yarn::Body> bodies = model_.bodies();
    std::vector<Box3> around(bodies.size());
    std::vector<PieceRange> ranges(bodies.size());
    for (std::uint32_t k = 0; k < model_.pieces().size(); ++k) {
      const std::uint32_t body = model_.pieces()[k].body;
      around[body].extend(model_.pieces()[k].box);
      if (ranges[body].last == 0) ranges[body].first = k;
      ranges[body].last = k + 1;
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> candidates;  // inner, outer
    for (std::uint32_t inner = 0; inner < bodies.size(); ++inner) {
      if (around[inner].isEmpty()) continue;
      for (const std::uint32_t outer : bodies_around(ranges[inner].first))
        if (outer != inner && around[outer].contains(around[inner]) &&
            !std::binary_search(known.begin(), known.end(), BodyPair(std::minmax<std::size_t>(inner, outer))))
          candidates.emplace_back(inner, outer);
    }
    for (const auto& [inner, outer] : candidates) {
      const std::optional<std::uint32_t> piece = nearest_side(ranges[outer], ranges[inner].first);
      if (!piece) continue;
      const auto [a, b] = std::minmax(inner, outer);
      const auto whole = [&](std::uint32_t k) {
        return Stretch{bodies[k].surface.first_v(), bodies[k].surface.last_v()};
      };
      const Piece& part = model_.pieces()[*piece];
      Stretch local{model_.cells()[part.first_cell].low.y(),
                    model_.cells()[part.first_cell + part.count - 1].high.y()};
      const std::vector<Contact> deep =
          measure_deep(model_, a, a == outer ? local : whole(a), b, b == outer ? local : whole(b),
                       around[inner], std::max(model_.touching(a), model_.touching(b)));
      found.insert(found.end(), deep.begin(), deep.end());
    }
  }

  // The pieces of a body.
  struct PieceRange {
    std::uint32_t first = 0, last = 0;
  };

  // Three points on a piece.
  [[nodiscard]] std::array<Vec3, 3> sites_of(const Piece& piece) const {
    constexpr std::array<double, 3> shares = {0.2137, 0.5371, 0.8113};
    std::array<Vec3, 3> sites;
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const Cell& cell =
          model_.cells()[piece.first_cell + static_cast<std::uint32_t>(shares[k] * piece.count)];
      const Vec2 site = cell.low + 0.37 * (cell.high - cell.low);
      sites[k] = nurbs::evaluate(*model_.face_of(cell).surface, site.x(), site.y());
    }
    return sites;
  }

  // The bodies in which a piece lies, or beside whose surface it does: those of whose surface the rays from
  // two of three points on it pass an odd number of times. One ray asks all bodies at once.
  [[nodiscard]] std::vector<std::uint32_t> bodies_around(std::uint32_t piece) const {
    std::map<std::uint32_t, int> votes;
    for (const Vec3& point : sites_of(model_.pieces()[piece])) {
      std::set<std::uint32_t> odd;
      tree_.along_ray(point, [&](std::uint32_t k) {
        const std::uint32_t body = model_.pieces()[k].body;
        if (passages(model_.pieces()[k], point) % 2 == 1 && !odd.insert(body).second) odd.erase(body);
      });
      for (const std::uint32_t body : odd) ++votes[body];
    }
    std::vector<std::uint32_t> around;
    for (const auto& [body, count] : votes)
      if (count >= 2) around.push_back(body);
    return around;
  }

  // Of a body's side the piece that is nearest to another body's piece.
  [[nodiscard]] std::optional<std::uint32_t> nearest_side(const PieceRange& range,
                                                          std::uint32_t piece) const {
    std::optional<std::uint32_t> nearest;
    double least = infinity;
    const Vec3 point = sites_of(model_.pieces()[piece]).back();
    for (std::uint32_t k = range.first; k < range.last; ++k) {
      const Piece& other = model_.pieces()[k];
      if (other.body != model_.pieces()[range.first].body ||
          !model_.face_of(model_.cells()[other.first_cell]).is_side)
        continue;
      const double distance = (other.box.center() - point).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      nearest = k;
    }
    return nearest;
  }

  // How often the ray from the point along +x passes through the piece.
  [[nodiscard]] int passages(const Piece& piece, const Vec3& point) const {
    constexpr int steps = 6, row = steps + 1;
    std::vector<Vec3> p;
    int count = 0;
    for (std::uint32_t k = piece.first_cell; k < piece.first_cell + piece.count; ++k) {
      const Cell& cell = model_.cells()[k];
      if (cell.box.min().y() > point.y() || cell.box.max().y() < point.y() ||
          cell.box.min().z() > point.z() || cell.box.max().z() < point.z())
        continue;
      sample(patch_of(*model_.face_of(cell).surface, cell.low, cell.high), steps, steps, p);
      for (std::size_t j = 0; j < steps; ++j)
        for (std::size_t i = 0; i < steps; ++i) {
          const std::size_t c = j * row + i;
          count += ray_meets(point, p[c], p[c + 1], p[c + row + 1]) ? 1 : 0;
          count += ray_meets(point, p[c], p[c + row + 1], p[c + row]) ? 1 : 0;
        }
    }
    return count;
  }

  // Of the pairs of yarns that do not overlap. Where nothing was near, the reach grows until something is.
  [[nodiscard]] std::optional<double> least_gap(const std::vector<Contact>& near, double reach) const {
    const std::vector<BodyPair> parted = overlapping(near);
    const auto counts = [&](std::size_t a, std::size_t b) {
      return !std::binary_search(parted.begin(), parted.end(), BodyPair(a, b));
    };
    double least = infinity;
    for (const Contact& contact : near)
      if (counts(contact.a, contact.b)) least = std::min(least, std::max(0.0, contact.gap));
    if (std::isfinite(least)) return least;
    std::size_t present = 0, pairs = 0;
    for (std::size_t k = 0; k < model_.bodies().size(); ++k) present += model_.thickness(k) > 0.0 ? 1 : 0;
    for (const BodyPair& pair : parted) pairs += pair.first != pair.second ? 1 : 0;
    if (2 * pairs == present * (present - 1)) return std::nullopt;
    Box3 all;
    for (const Piece& piece : model_.pieces()) all.extend(piece.box);
    // No two pieces are farther apart than that.
    const double farthest = all.diagonal().norm();
    for (double limit = 4.0 * reach; !std::isfinite(least); limit *= 4.0) {
      least = nearest_within(std::min(limit, farthest), counts);
      if (limit >= farthest) break;
    }
    if (!std::isfinite(least)) return std::nullopt;
    return least;
  }

  // The least distance of two different yarns that count, up to `limit`; infinite: none is so near.
  template <class Counts>
  [[nodiscard]] double nearest_within(double limit, const Counts& counts) const {
    std::vector<PiecePair> pairs;
    tree_.near_pairs(limit, [&](std::uint32_t i, std::uint32_t j) {
      const std::size_t a = model_.pieces()[i].body, b = model_.pieces()[j].body;
      if (a != b && counts(a, b)) pairs.push_back({i, j});
    });
    const auto distance = [&](const PiecePair& pair) {
      return model_.pieces()[pair.a].box.squaredExteriorDistance(model_.pieces()[pair.b].box);
    };
    std::sort(pairs.begin(), pairs.end(), [&](const PiecePair& x, const PiecePair& y) {
      return std::tuple(distance(x), x.a, x.b) < std::tuple(distance(y), y.a, y.b);
    });
    double best = limit;
    bool any = false;
    std::vector<NearPair> cells;
    for (const PiecePair& pair : pairs) {
      if (distance(pair) > best * best) break;
      cells.clear();
      cell_pairs(pair, best, cells);
      std::sort(cells.begin(), cells.end(), [](const NearPair& x, const NearPair& y) {
        return std::tuple(x.low, x.a, x.b) < std::tuple(y.low, y.a, y.b);
      });
      for (const NearPair& near : cells) {
        if (near.low > best) break;
        const Cell &a = model_.cells()[near.a], &b = model_.cells()[near.b];
        const NearestPoints found = find_nearest(model_.face_of(a), a, 0.5 * (a.low + a.high),
                                                 model_.face_of(b), b, 0.5 * (b.low + b.high));
        const double here = (found.p - found.q).norm();
        if (here > best) continue;
        best = here;
        any = true;
      }
    }
    return any ? best : infinity;
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
