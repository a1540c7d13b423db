#include "contact/place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "contact/critical.h"
#include "contact/overlay.h"

namespace selvage::contact {

namespace {

constexpr int raster_lines = 48;
constexpr std::size_t max_peaks = 32;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The cells of a face's closed range of columns (or rows) that covers all used ones; round it goes the
// shorter way.
std::vector<std::uint32_t> covering_range(const std::set<std::uint32_t>& used, std::uint32_t count,
                                          bool round) {
  std::uint32_t first = *used.begin(), length = *used.rbegin() - first + 1;
  if (round) {
    std::uint32_t before = *used.begin(), widest = *used.begin() + count - *used.rbegin();
    for (const std::uint32_t k : used) {
      if (k - before > widest) {
        widest = k - before;
        first = k;
        length = count - widest + 1;
      }
      before = k;
    }
  }
  std::vector<std::uint32_t> range;
  for (std::uint32_t k = 0; k < length; ++k) range.push_back((first + k) % count);
  return range;
}

// A local minimum of the gap.
struct Spot {
  Vec3 p = Vec3::Zero(), q = Vec3::Zero(), normal = Vec3::Zero();
  std::optional<Vec2> site_a, site_b;
  double depth = 0;
};

class Measurer {
 public:
  Measurer(const CellModel& model, const Cluster& cluster, double reach)
      : model_(model),
        cluster_(cluster),
        reach_(reach),
        body_a_(model.face_of(cell(cluster.front().a)).body),
        body_b_(model.face_of(cell(cluster.front().b)).body),
        thickness_(std::min(model.thickness(body_a_), model.thickness(body_b_))),
        touching_(std::max(model.touching(body_a_), model.touching(body_b_))) {}

  std::vector<Contact> run() {
    const Vec3 n = facing();
    if (n.squaredNorm() > 0.0) look_along(n);
    if (contacts_.empty()) look_at_nearest();
    return std::move(contacts_);
  }

 private:
  [[nodiscard]] const Cell& cell(std::uint32_t k) const { return model_.cells()[k]; }

  // From a to b where they are nearest.
  [[nodiscard]] Vec3 facing() const {
    double nearest = infinity;
    for (const NearPair& pair : cluster_) nearest = std::min(nearest, pair.low);
    Vec3 sum = Vec3::Zero();
    for (const NearPair& pair : cluster_) {
      const Vec3 &na = cell(pair.a).normal, &nb = cell(pair.b).normal;
      const double weight =
          std::exp((nearest - pair.low) / (0.02 * thickness_)) * (1e-6 + std::max(0.0, -na.dot(nb)));
      sum += weight * (na - nb);
    }
    const double size = sum.norm();
    return size > 0.0 ? Vec3(sum / size) : Vec3::Zero();
  }

  // The cells on one side, and those between them.
  [[nodiscard]] std::vector<Part> window(bool of_a, std::size_t& widest) const {
    struct Used {
      std::set<std::uint32_t> columns, rows;
    };
    std::map<std::uint32_t, Used> faces;
    for (const NearPair& pair : cluster_) {
      const Cell& c = cell(of_a ? pair.a : pair.b);
      faces[c.face].columns.insert(c.i);
      faces[c.face].rows.insert(c.j);
    }
    std::vector<Part> parts;
    for (const auto& [index, used] : faces) {
      const Face& face = model_.faces()[index];
      const std::vector<std::uint32_t> columns = covering_range(used.columns, face.count_u, face.round_u),
                                       rows = covering_range(used.rows, face.count_v, face.round_v);
      widest = std::max({widest, columns.size(), rows.size()});
      for (const std::uint32_t j : rows)
        for (const std::uint32_t i : columns) {
          const std::uint32_t k = face.first_cell + j * face.count_u + i;
          parts.push_back({k, cell(k).low, cell(k).high});
        }
    }
    return parts;
  }

  // What both sides' near cells have in common as seen along the axes' n.
  [[nodiscard]] Rectangle common_view(const Sheet& a, const Sheet& b, const Axes& axes) const {
    std::set<std::uint32_t> near_a, near_b;
    for (const NearPair& pair : cluster_) {
      near_a.insert(pair.a);
      near_b.insert(pair.b);
    }
    const auto view = [&](const Sheet& sheet, const std::set<std::uint32_t>& near) {
      Rectangle box;
      for (std::size_t k = 0; k < sheet.parts.size(); ++k) {
        if (!near.contains(sheet.parts[k].cell)) continue;
        for (std::size_t m = k * sheet.points_a_part(); m < (k + 1) * sheet.points_a_part(); ++m)
          box.extend(Vec2(axes.seen(sheet.points[m]).head<2>()));
      }
      return box;
    };
    return view(a, near_a).intersection(view(b, near_b));
  }

  void look_along(const Vec3& n) {
    std::size_t widest = 1;
    std::vector<Part> parts_a = window(true, widest), parts_b = window(false, widest);
    const int steps = static_cast<int>(std::clamp<std::size_t>(40 / widest, 2, 10));
    const Sheet a(model_, std::move(parts_a), steps), b(model_, std::move(parts_b), steps);
    const Axes axes(n, a.points);
    const Rectangle view = common_view(a, b, axes);
    if (view.isEmpty() || !(view.sizes().minCoeff() > 0.0)) return;
    const Overlay overlay(model_, a, b, axes, view, raster_lines);
    const std::vector<std::size_t> peaks = peaks_of(overlay);
    std::vector<std::size_t> unsettled;
    for (const std::size_t line : peaks)
      if (!settle(overlay, line)) unsettled.push_back(line);
    int regions = 0;
    const std::vector<int> region = overlay.regions(0.0, regions);
    for (const std::size_t line : unsettled) settle_at_crease(overlay, line, region);
    gather(overlay, region, regions);
  }

  // Lines on which the two are deepest in each other, or nearest, the deepest first.
  [[nodiscard]] std::vector<std::size_t> peaks_of(const Overlay& overlay) const {
    std::vector<std::size_t> peaks;
    for (std::size_t k = 0; k < overlay.size(); ++k)
      if (overlay.is_met(k) && overlay.depth(k) > -(reach_ + slack()) && overlay.is_peak(k))
        peaks.push_back(k);
    std::stable_sort(peaks.begin(), peaks.end(),
                     [&](std::size_t x, std::size_t y) { return overlay.depth(x) > overlay.depth(y); });
    if (peaks.size() > max_peaks) peaks.resize(max_peaks);
    return peaks;
  }

  // What quads instead of the surface can change a depth by.
  [[nodiscard]] double slack() const { return 0.01 * thickness_; }

  [[nodiscard]] bool is_known(const Vec3& p, const Vec3& q) const {
    return std::any_of(spots_.begin(), spots_.end(), [&](const Spot& s) {
      return (s.p - p).norm() < 1e-3 * thickness_ && (s.q - q).norm() < 1e-3 * thickness_;
    });
  }

  // The critical pair that belongs to a peak.
  bool settle(const Overlay& overlay, std::size_t line) {
    const Overlay::Place a = overlay.on_a(line), b = overlay.on_b(line);
    const std::optional<Critical> found =
        find_critical(model_.face_of(cell(a.cell)), a.site, model_.face_of(cell(b.cell)), b.site);
    if (!found || found->normal.dot(overlay.axes().n) < 0.5) return false;
    const double start = overlay.depth(line);
    if (found->depth < start - slack() || found->depth > start + 0.1 * thickness_ + 0.3 * std::abs(start))
      return false;
    const Vec3 middle = 0.5 * (found->p + found->q);
    if ((middle - 0.5 * (a.point + b.point)).norm() > 0.5 * thickness_ + 6.0 * overlay.step().norm())
      return false;
    if (!is_known(found->p, found->q))
      spots_.push_back({found->p, found->q, found->normal, found->site_a, found->site_b, found->depth});
    return true;
  }

  // A peak on an edge, a rim or a border, by rasters that close in on it, along the same direction.
  void settle_at_crease(const Overlay& coarse, std::size_t first, const std::vector<int>& region) {
    const Vec2 place = coarse.centre(first);
    for (const Spot& s : spots_) {
      const Vec3 seen = coarse.axes().seen(0.5 * (s.p + s.q));
      const int line = coarse.line_at(seen.head<2>());
      const bool same_region =
          line >= 0 && region[first] >= 0 && region[static_cast<std::size_t>(line)] == region[first];
      const bool close = (Vec2(seen.head<2>()) - place).norm() < 4.0 * coarse.step().norm();
      if ((same_region || close) && s.depth > coarse.depth(first) - slack()) return;
    }
    std::vector<Part> pa = coarse.parts_about(first, 2, true), pb = coarse.parts_about(first, 2, false);
    Rectangle view(Vec2(place - 2.0 * coarse.step()), Vec2(place + 2.0 * coarse.step()));
    std::optional<Spot> best;
    for (int round = 0; round < 5; ++round) {
      const Sheet a(model_, std::move(pa), 8), b(model_, std::move(pb), 8);
      const Overlay overlay(model_, a, b, coarse.axes(), view, 24);
      std::optional<std::size_t> deepest;
      for (std::size_t k = 0; k < overlay.size(); ++k)
        if (overlay.is_met(k) && (!deepest || overlay.depth(k) > overlay.depth(*deepest))) deepest = k;
      if (!deepest) break;
      const Overlay::Place on_a = overlay.on_a(*deepest), on_b = overlay.on_b(*deepest);
      best = Spot{on_a.point, on_b.point, coarse.axes().n, site(on_a), site(on_b), overlay.depth(*deepest)};
      pa = overlay.parts_about(*deepest, 2, true);
      pb = overlay.parts_about(*deepest, 2, false);
      view = Rectangle(Vec2(overlay.centre(*deepest) - 2.0 * overlay.step()),
                       Vec2(overlay.centre(*deepest) + 2.0 * overlay.step()));
    }
    if (best && best->depth > touching_ && !is_known(best->p, best->q)) spots_.push_back(*best);
  }

  [[nodiscard]] std::optional<Vec2> site(const Overlay::Place& place) const {
    if (!model_.face_of(cell(place.cell)).is_side) return std::nullopt;
    return place.site;
  }

  [[nodiscard]] Contact contact_of(const Spot& spot) const {
    Contact contact;
    contact.a = body_a_;
    contact.b = body_b_;
    contact.site_a = spot.site_a;
    contact.site_b = spot.site_b;
    contact.on_a = spot.p;
    contact.on_b = spot.q;
    contact.at = 0.5 * (spot.p + spot.q);
    contact.direction = spot.normal;
    contact.gap = spot.depth > touching_ ? -spot.depth : std::max(0.0, -spot.depth);
    contact.spots.push_back(minimum_of(spot));
    return contact;
  }

  [[nodiscard]] static Minimum minimum_of(const Spot& spot) {
    return {spot.site_a, spot.site_b, spot.p, spot.q, spot.normal, -spot.depth};
  }

  // Spots of one connected region make one contact.
  void gather(const Overlay& overlay, const std::vector<int>& region, int regions) {
    std::stable_sort(spots_.begin(), spots_.end(),
                     [](const Spot& x, const Spot& y) { return x.depth > y.depth; });
    std::vector<std::optional<std::size_t>> contact_of_region(static_cast<std::size_t>(regions));
    for (const Spot& spot : spots_) {
      if (spot.depth < -reach_) continue;
      const Vec3 seen = overlay.axes().seen(0.5 * (spot.p + spot.q));
      const int line = overlay.line_at(seen.head<2>());
      const int here = line < 0 ? -1 : region[static_cast<std::size_t>(line)];
      if (here >= 0 && contact_of_region[static_cast<std::size_t>(here)]) {
        contacts_[*contact_of_region[static_cast<std::size_t>(here)]].spots.push_back(minimum_of(spot));
        continue;
      }
      if (here >= 0) contact_of_region[static_cast<std::size_t>(here)] = contacts_.size();
      contacts_.push_back(contact_of(spot));
      contacts_.back().area = area(overlay, region, here, spot);
    }
  }

  // Of a's surface on the region's lines.
  [[nodiscard]] double area(const Overlay& overlay, const std::vector<int>& region, int which,
                            const Spot& spot) const {
    if (which < 0) return 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      if (region[k] != which) continue;
      const double tilt = cell(overlay.on_a(k).cell).normal.dot(overlay.axes().n);
      sum += overlay.step().prod() / std::max(tilt, 0.2);
    }
    (void)spot;
    return sum;
  }

  // Where the surfaces do not face each other: the nearest points of any two cells.
  void look_at_nearest() {
    double best = reach_;
    std::optional<Spot> nearest;
    Cluster pairs = cluster_;
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const NearPair& x, const NearPair& y) { return x.low < y.low; });
    for (const NearPair& pair : pairs) {
      if (pair.low > best) break;
      const Cell &ca = cell(pair.a), &cb = cell(pair.b);
      const Face &fa = model_.face_of(ca), &fb = model_.face_of(cb);
      const Nearest found = find_nearest(fa, ca, 0.5 * (ca.low + ca.high), fb, cb, 0.5 * (cb.low + cb.high));
      const double distance = (found.p - found.q).norm();
      if (distance > best) continue;
      best = distance;
      Spot spot{found.p, found.q, Vec3::Zero(), std::nullopt, std::nullopt, -distance};
      if (distance > 0.0) spot.normal = (found.q - found.p) / distance;
      if (fa.is_side) spot.site_a = found.site_a;
      if (fb.is_side) spot.site_b = found.site_b;
      nearest = spot;
    }
    if (nearest) contacts_.push_back(contact_of(*nearest));
  }

  const CellModel& model_;
  const Cluster& cluster_;
  double reach_;
  std::uint32_t body_a_, body_b_;
  double thickness_, touching_;
  std::vector<Spot> spots_;
  std::vector<Contact> contacts_;
};

}  // namespace

std::vector<Contact> measure(const CellModel& model, const Cluster& cluster, double reach) {
  return Measurer(model, cluster, reach).run();
}

}  // namespace selvage::contact
