#include "contact/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "contact/critical.h"
#include "contact/deep.h"
#include "contact/encounters.h"
#include "contact/face.h"
#include "contact/place.h"
#include "contact/repeated.h"
#include "core/bounds.h"
#include "core/groups.h"
#include "core/parallel.h"
#include "nurbs/patch.h"

namespace selvage::contact {

namespace {

// Gaps up to this share of the thinnest yarn are always measured: the least one is mostly among them.
constexpr double near_share = 0.02;
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

class Search {
 public:
  Search(std::span<const yarn::Body> bodies, const ContactOptions& options)
      : options_(options), bodies_(bodies), pieces_(bodies, options.threads), thinnest_(pieces_.thinnest()) {}

  Contacts run() {
    Contacts out;
    if (!std::isfinite(thinnest_)) return out;
    const double reach = std::max(options_.reach, near_share * thinnest_);
    const Looked looked =
        look(reach, [&](std::size_t a, std::size_t b) { return a != b || options_.with_itself; });
    std::vector<Contact> found;
    add(looked, found, [&](const Contact& contact) {
      return contact.is_overlap() || (options_.reach > 0.0 && contact.gap <= options_.reach);
    });
    double unsettled = looked.unsettled;
    if (reach > near_share * thinnest_) find_own_overlaps(found);
    add_contained(found);
    sort(found);
    drop_repeated(found);
    out.min_gap = least_gap(looked, overlapping(found), reach);
    out.list = std::move(found);
    out.resolution = std::max(resolution(), unsettled);
    return out;
  }

 private:
  using BodyPair = std::pair<std::size_t, std::size_t>;

  // What was found in the encounters of bodies: in each kind of them once.
  struct Looked {
    Encounters encounters;
    std::vector<Measured> found;  // of each kind
    double unsettled = 0;
  };

  template <class Wanted>
  Looked look(double reach, const Wanted& wanted) {
    Looked looked{pieces_.encounters(reach, true, wanted), {}, 0.0};
    need(looked.encounters.kinds);
    measure_kinds(looked, reach);
    part_deep(looked, reach);
    for (const Measured& found : looked.found) looked.unsettled = std::max(looked.unsettled, found.unsettled);
    return looked;
  }

  // Those that are not measured yet.
  void measure_kinds(Looked& looked, double reach) {
    const std::span<const Encounter> kinds = looked.encounters.kinds;
    const std::size_t first = looked.found.size();
    looked.found.resize(kinds.size());
    for_each_index(
        kinds.size() - first, options_.threads,
        [&](std::size_t k) {
          Measured& all = looked.found[first + k];
          for (const Cluster& place : clusters(kinds[first + k], reach)) {
            Measured here = measure(*model_, place, reach, resolution());
            all.unsettled = std::max(all.unsettled, here.unsettled);
            all.is_deep = all.is_deep || here.is_deep;
            std::ranges::move(here.contacts, std::back_inserter(all.contacts));
          }
        },
        options_.progress);
  }

  // Where more than what is near has to be looked at, only wholes that are the same are alike.
  void part_deep(Looked& looked, double reach) {
    const double quantum = 0.1 * resolution();
    std::vector<Encounter>& kinds = looked.encounters.kinds;
    using Kind = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, double,
                            double, double>;
    const auto key = [&](std::uint32_t kind, std::uint32_t a, std::uint32_t b, const PiecePair& first) {
      const Vec3 way = ((bodies_[b].at - bodies_[a].at) / quantum).array().round();
      return Kind(pieces_.shape_of(a), pieces_.shape_of(b), kind, first.a, first.b, way.x(), way.y(),
                  way.z());
    };
    std::map<Kind, std::uint32_t> known;
    for (std::uint32_t k = 0; k < looked.found.size(); ++k)
      if (looked.found[k].is_deep && model_->is_whole(kinds[k].a) && model_->is_whole(kinds[k].b))
        known.emplace(key(k, kinds[k].a, kinds[k].b, kinds[k].pairs.front()), k);
    for (EncounterPlace& place : looked.encounters.places) {
      if (!looked.found[place.kind].is_deep) continue;
      const auto [entry, is_new] = known.try_emplace(key(place.kind, place.a, place.b, place.first),
                                                     static_cast<std::uint32_t>(kinds.size()));
      if (is_new) kinds.push_back(pieces_.encounter_at(kinds[place.kind], place));
      place.kind = entry->second;
    }
    if (kinds.size() == looked.found.size()) return;
    std::vector<Encounter> whole;
    for (std::size_t k = looked.found.size(); k < kinds.size(); ++k)
      whole.push_back({kinds[k].a, kinds[k].b, {}});
    need(whole);
    measure_kinds(looked, reach);
  }

  // The cells that are looked at where these are measured.
  void need(std::span<const Encounter> encounters) {
    std::vector<std::vector<bool>> wanted = has_cells_;
    wanted.resize(bodies_.size());
    for (const Encounter& encounter : encounters) pieces_.add_needed(encounter, wanted);
    if (model_ && wanted == has_cells_) return;
    model_.emplace(bodies_, pieces_.take_cells(wanted));
    has_cells_ = std::move(wanted);
  }

  // The contacts that are wanted, in all places.
  template <class Wanted>
  void add(const Looked& looked, std::vector<Contact>& list, const Wanted& wanted) const {
    for (const EncounterPlace& place : looked.encounters.places)
      for (const Contact& contact : looked.found[place.kind].contacts)
        if (wanted(contact))
          list.push_back(pieces_.placed(contact, looked.encounters.kinds[place.kind], place));
  }

  // Of yarns with themselves, as they are found by looking no farther: from farther away stretches of one
  // yarn hang together that are no contact.
  void find_own_overlaps(std::vector<Contact>& found) {
    const auto is_own_overlap = [](const Contact& contact) {
      return contact.a == contact.b && contact.is_overlap();
    };
    if (std::erase_if(found, is_own_overlap) == 0) return;
    add(look(near_share * thinnest_, [](std::size_t a, std::size_t b) { return a == b; }), found,
        is_own_overlap);
  }

  // What is proved: a millionth of the thinnest yarn.
  [[nodiscard]] double resolution() const { return 1e-6 * thinnest_; }

  static void sort(std::vector<Contact>& list) {
    std::stable_sort(list.begin(), list.end(), [](const Contact& x, const Contact& y) {
      return std::tuple(x.gap, x.a, x.b, x.at.x(), x.at.y(), x.at.z()) <
             std::tuple(y.gap, y.a, y.b, y.at.x(), y.at.y(), y.at.z());
    });
  }

  // The cells of a piece that are near a box, with their control points.
  struct Candidate {
    std::uint32_t cell;
    nurbs::Patch patch;
  };
  void candidates(const Piece& piece, const Box3& box, double reach, std::vector<Candidate>& out) const {
    out.clear();
    for (std::uint32_t k = piece.first_cell; k < piece.first_cell + piece.count; ++k) {
      const Cell& cell = model_->cells()[k];
      if (cell.box.squaredExteriorDistance(box) <= reach * reach)
        out.push_back({k, patch_of(*model_->face_of(cell).surface, cell.low, cell.high)});
    }
  }

  void cell_pairs(const Encounter& of, const PiecePair& pair, double reach,
                  std::vector<NearPair>& out) const {
    const Piece &a = piece(of.a, pair.a), &b = piece(of.b, pair.b);
    thread_local std::vector<Candidate> of_a, of_b;
    candidates(a, b.box, reach, of_a);
    if (of_a.empty()) return;
    candidates(b, a.box, reach, of_b);
    for (const Candidate& x : of_a) {
      const Cell& ca = model_->cells()[x.cell];
      for (const Candidate& y : of_b) {
        const Cell& cb = model_->cells()[y.cell];
        if (ca.box.squaredExteriorDistance(cb.box) > reach * reach) continue;
        const double low = slab_gap(x.patch, ca.normal, y.patch, cb.normal);
        if (low <= reach) out.push_back({x.cell, y.cell, low});
      }
    }
  }

  [[nodiscard]] const Piece& piece(std::size_t body, std::uint32_t number) const {
    return model_->pieces()[model_->first_piece(body) + number];
  }

  // Near pairs of cells in a fixed order; those that share a cell hang together.
  [[nodiscard]] std::vector<Cluster> clusters(const Encounter& encounter, double reach) const {
    std::vector<NearPair> pairs;
    for (const PiecePair& pair : encounter.pairs) cell_pairs(encounter, pair, reach, pairs);
    std::stable_sort(pairs.begin(), pairs.end(), [](const NearPair& x, const NearPair& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
    std::vector<std::uint32_t> by_b(pairs.size());
    std::iota(by_b.begin(), by_b.end(), 0U);
    std::sort(by_b.begin(), by_b.end(), [&](std::uint32_t x, std::uint32_t y) {
      return std::pair(pairs[x].b, x) < std::pair(pairs[y].b, y);
    });
    Groups groups(pairs.size());
    for (std::size_t k = 1; k < pairs.size(); ++k) {
      if (pairs[k].a == pairs[k - 1].a) groups.join(k, k - 1);
      if (pairs[by_b[k]].b == pairs[by_b[k - 1]].b) groups.join(by_b[k], by_b[k - 1]);
    }
    std::vector<Cluster> all;
    std::vector<std::size_t> number(pairs.size());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const std::uint32_t group = groups.of(k);
      if (group == k) {
        number[k] = all.size();
        all.emplace_back();
      }
      all[number[group]].push_back(pairs[k]);
    }
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
  void add_contained(std::vector<Contact>& found) {
    const std::vector<BodyPair> known = overlapping(found);
    std::vector<Encounter> candidates;  // inner, outer
    for (const PiecePair& pair : pieces_.near_bodies(0.0)) {
      if (std::binary_search(known.begin(), known.end(), BodyPair(pair.a, pair.b))) continue;
      for (const auto& [inner, outer] : {std::pair(pair.a, pair.b), std::pair(pair.b, pair.a)})
        if (pieces_.box(outer).contains(pieces_.box(inner))) candidates.push_back({inner, outer, {}});
    }
    if (candidates.empty()) return;
    need(candidates);
    for (const auto& [inner, outer, pairs] : candidates) {
      if (!is_around(outer, inner)) continue;
      const Piece& part = nearest_side(outer, inner);
      const auto [a, b] = std::minmax(inner, outer);
      const auto whole = [&](std::uint32_t k) {
        return Stretch{bodies_[k].surface.first_v(), bodies_[k].surface.last_v()};
      };
      const Stretch local{part.first_v, part.last_v};
      const std::vector<Contact> deep =
          measure_deep(*model_, a, a == outer ? local : whole(a), b, b == outer ? local : whole(b),
                       pieces_.box(inner), std::max(model_->touching(a), model_->touching(b)));
      found.insert(found.end(), deep.begin(), deep.end());
    }
  }

  // Three points on a piece.
  [[nodiscard]] std::array<Vec3, 3> sites_of(const Piece& piece) const {
    constexpr std::array<double, 3> shares = {0.2137, 0.5371, 0.8113};
    std::array<Vec3, 3> sites;
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const Cell& cell =
          model_->cells()[piece.first_cell + static_cast<std::uint32_t>(shares[k] * piece.count)];
      const Vec2 site = cell.low + 0.37 * (cell.high - cell.low);
      sites[k] = nurbs::evaluate(*model_->face_of(cell).surface, site.x(), site.y());
    }
    return sites;
  }

  // The first piece of one body lies in the other, or beside its surface: the rays from two of three points
  // on it pass through that an odd number of times.
  [[nodiscard]] bool is_around(std::uint32_t outer, std::uint32_t inner) const {
    int votes = 0;
    for (const Vec3& point : sites_of(piece(inner, 0))) {
      int count = 0;
      pieces_.along_ray(outer, point, [&](std::uint32_t k) { count += passages(piece(outer, k), point); });
      votes += count % 2;
    }
    return votes >= 2;
  }

  // Of a body's side the piece that is nearest to another body's first one.
  [[nodiscard]] const Piece& nearest_side(std::uint32_t outer, std::uint32_t inner) const {
    const Vec3 point = sites_of(piece(inner, 0)).back();
    const Piece* nearest = &piece(outer, 0);
    for (std::uint32_t k = 1; k < pieces_.pieces(outer).size(); ++k) {
      const Piece& other = piece(outer, k);
      if (model_->face_of(model_->cells()[other.first_cell]).is_side &&
          (other.box.center() - point).squaredNorm() < (nearest->box.center() - point).squaredNorm())
        nearest = &other;
    }
    return *nearest;
  }

  // How often the ray from the point along +x passes through the piece.
  [[nodiscard]] int passages(const Piece& piece, const Vec3& point) const {
    constexpr int steps = 6, row = steps + 1;
    std::vector<Vec3> p;
    int count = 0;
    for (std::uint32_t k = piece.first_cell; k < piece.first_cell + piece.count; ++k) {
      const Cell& cell = model_->cells()[k];
      if (cell.box.min().y() > point.y() || cell.box.max().y() < point.y() ||
          cell.box.min().z() > point.z() || cell.box.max().z() < point.z())
        continue;
      sample(patch_of(*model_->face_of(cell).surface, cell.low, cell.high), steps, steps, p);
      for (std::size_t j = 0; j < steps; ++j)
        for (std::size_t i = 0; i < steps; ++i) {
          const std::size_t c = j * row + i;
          count += ray_meets(point, p[c], p[c + 1], p[c + row + 1]) ? 1 : 0;
          count += ray_meets(point, p[c], p[c + row + 1], p[c + row]) ? 1 : 0;
        }
    }
    return count;
  }

  // Of the pairs of yarns that do not overlap (`parted` do). Where nothing was near, the reach grows until
  // something is.
  [[nodiscard]] std::optional<double> least_gap(const Looked& near, const std::vector<BodyPair>& parted,
                                                double reach) {
    const auto counts = [&](std::size_t a, std::size_t b) {
      return !std::binary_search(parted.begin(), parted.end(), BodyPair(a, b));
    };
    std::vector<double> least_of_kind;
    for (const Measured& kind : near.found) {
      double least = infinity;
      for (const Contact& contact : kind.contacts)
        if (!contact.is_overlap()) least = std::min(least, contact.gap);
      least_of_kind.push_back(least);
    }
    double least = infinity;
    for (const EncounterPlace& place : near.encounters.places)
      if (least_of_kind[place.kind] < least && counts(place.a, place.b)) least = least_of_kind[place.kind];
    if (std::isfinite(least)) return least;
    std::size_t present = 0, pairs = 0;
    Box3 all;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (!(pieces_.thickness(k) > 0.0)) continue;
      ++present;
      all.extend(pieces_.box(k));
    }
    for (const BodyPair& pair : parted) pairs += pair.first != pair.second ? 1 : 0;
    if (2 * pairs == present * (present - 1)) return std::nullopt;
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
  [[nodiscard]] double nearest_within(double limit, const Counts& counts) {
    std::vector<Encounter> pairs =
        pieces_.encounters(limit, false, [&](std::size_t a, std::size_t b) { return a != b && counts(a, b); })
            .kinds;
    need(pairs);
    const auto distance = [&](const Encounter& pair) {
      return pieces_.box(pair.a, pair.pairs[0].a)
          .squaredExteriorDistance(pieces_.box(pair.b, pair.pairs[0].b));
    };
    std::stable_sort(pairs.begin(), pairs.end(),
                     [&](const Encounter& x, const Encounter& y) { return distance(x) < distance(y); });
    double best = limit;
    bool any = false;
    std::vector<NearPair> cells;
    for (const Encounter& pair : pairs) {
      if (distance(pair) > best * best) break;
      cells.clear();
      cell_pairs(pair, pair.pairs[0], best, cells);
      std::sort(cells.begin(), cells.end(), [](const NearPair& x, const NearPair& y) {
        return std::tuple(x.low, x.a, x.b) < std::tuple(y.low, y.a, y.b);
      });
      for (const NearPair& near : cells) {
        if (near.low > best) break;
        const Cell &a = model_->cells()[near.a], &b = model_->cells()[near.b];
        const NearestPoints found = find_nearest(model_->face_of(a), a, 0.5 * (a.low + a.high),
                                                 model_->face_of(b), b, 0.5 * (b.low + b.high));
        const double here = (found.p - found.q).norm();
        if (here > best) continue;
        best = here;
        any = true;
      }
    }
    return any ? best : infinity;
  }

  const ContactOptions& options_;
  std::span<const yarn::Body> bodies_;
  PieceModel pieces_;
  std::optional<CellModel> model_;            // of those bodies in which something is measured
  std::vector<std::vector<bool>> has_cells_;  // of each body its pieces
  double thinnest_;
};
}  // namespace

Result<Contacts> find_contacts(std::span<const yarn::Body> bodies, const ContactOptions& options) {
  if (std::optional<Message> fault = find_fault(bodies)) return *fault;
  return Search(bodies, options).run();
}

}  // namespace selvage::contact
