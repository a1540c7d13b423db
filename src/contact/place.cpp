#include "contact/place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "contact/certify.h"
#include "contact/deep.h"
#include "contact/overlay.h"
#include "contact/spot.h"
#include "core/bounds.h"

namespace selvage::contact {

namespace {

constexpr int raster_lines = 48;
constexpr std::size_t max_peaks = 32;

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

// Deeper than this share of the thickness two facing sheets do not tell it all.
constexpr double deep_share = 0.3;

class Measurer {
 public:
  Measurer(const CellModel& model, const Cluster& cluster, double reach, double resolution)
      : model_(model),
        cluster_(cluster),
        reach_(reach),
        resolution_(resolution),
        body_a_(model.face_of(cell(cluster.front().a)).body),
        body_b_(model.face_of(cell(cluster.front().b)).body),
        thickness_(std::min(model.thickness(body_a_), model.thickness(body_b_))),
        touching_(std::max(model.touching(body_a_), model.touching(body_b_))) {}

  Measured run() {
    const Vec3 n = facing();
    if (n.squaredNorm() > 0.0) look_along(n);
    // Lines do not meet every least gap.
    if (!is_deep_ && !is_overlap()) look_at_nearest();
    if (!is_deep_) prove();
    // With all of their cells.
    if (is_deep_ && !(model_.is_whole(body_a_) && model_.is_whole(body_b_))) return {{}, 0.0, true};
    if (is_deep_) look_deep();
    if (contacts_.empty()) look_at_nearest();
    return {std::move(contacts_), unsettled_, is_deep_};
  }

 private:
  [[nodiscard]] bool is_overlap() const {
    return std::any_of(contacts_.begin(), contacts_.end(),
                       [](const Contact& contact) { return contact.is_overlap(); });
  }
  [[nodiscard]] const Cell& cell(std::uint32_t k) const { return model_.cells()[k]; }

  // From a to b, where they overlap or are nearest.
  [[nodiscard]] Vec3 facing() const {
    double nearest = infinity;
    for (const NearPair& pair : cluster_) nearest = std::min(nearest, pair.low);
    nearest = std::max(nearest, 0.0);
    Vec3 sum = Vec3::Zero();
    for (const NearPair& pair : cluster_) {
      const Cell &a = cell(pair.a), &b = cell(pair.b);
      const double opposed = std::max(0.0, -a.normal.dot(b.normal)),
                   farther = std::max(0.0, pair.low - nearest) / (0.02 * thickness_);
      sum += std::exp(-farther) * (1e-6 + opposed * opposed) * a.box.diagonal().squaredNorm() *
             b.box.diagonal().squaredNorm() * (a.normal - b.normal);
    }
    return unit_or_zero(sum);
  }

  // The same from the lines on which the two overlap; zero where there are none.
  [[nodiscard]] Vec3 facing(const Overlay& overlay, const std::vector<int>& region) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < region.size(); ++k)
      if (region[k] >= 0) sum += cell(overlay.on_a(k).cell).normal - cell(overlay.on_b(k).cell).normal;
    return unit_or_zero(sum);
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
          const std::uint32_t k = face.rows[j] + i;
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

  void look_along(const Vec3& n, int tries = 2) {
    std::size_t widest = 1;
    std::vector<Part> parts_a = window(true, widest), parts_b = window(false, widest);
    const int steps = static_cast<int>(std::clamp<std::size_t>(40 / widest, 2, 10));
    const Sheet a(model_, std::move(parts_a), steps), b(model_, std::move(parts_b), steps);
    const Axes axes(n, a.points);
    const Rectangle view = common_view(a, b, axes);
    if (view.isEmpty() || !(view.sizes().minCoeff() > 0.0)) return;
    const Overlay overlay(model_, a, b, axes, view, raster_lines);
    int regions = 0;
    const std::vector<int> region = overlay.regions(0.0, regions);
    const std::vector<std::size_t> peaks = peaks_of(overlay);
    if ((!peaks.empty() && overlay.depth(peaks.front()) > deep_share * thickness_) ||
        is_steep(overlay, region)) {
      // A better direction may show less.
      const Vec3 better = facing(overlay, region);
      if (tries > 0 && better.squaredNorm() > 0.0 && better.dot(n) < 0.995)
        return look_along(better, tries - 1);
      is_deep_ = true;
      return;
    }
    std::vector<std::size_t> unsettled;
    for (const std::size_t line : peaks)
      if (!settle(overlay, line)) unsettled.push_back(line);
    for (const std::size_t line : unsettled) settle_at_crease(overlay, line, region);
    gather(overlay, region, regions);
    known_.emplace(overlay, region);
  }

  // Where the lines say that the two overlap: what lies there is known.
  class Known {
   public:
    Known(const Overlay& overlay, const std::vector<int>& region)
        : axes_(overlay.axes()), raster_(overlay.raster()), shared_(region.size()) {
      for (std::size_t k = 0; k < region.size(); ++k) shared_[k] = region[k] >= 0;
    }
    void add(const Vec3& point) { points_.push_back(axes_.seen(point).head<2>()); }

    // The boxes' common view is next to a line that overlaps, or to a spot.
    [[nodiscard]] bool holds(const Box3& a, const Box3& b) const {
      const Rectangle view = seen(a).intersection(seen(b));
      if (view.isEmpty()) return false;
      const Rectangle wide(Vec2(view.min() - 1.5 * raster_.step), Vec2(view.max() + 1.5 * raster_.step));
      for (const Vec2& p : points_)
        if (wide.contains(p)) return true;
      const auto index = [&](const Vec2& p, Eigen::Index axis, double least, double most) {
        return static_cast<int>(
            std::clamp(std::round((p - raster_.place(0, 0))[axis] / raster_.step[axis]), least, most));
      };
      const double end = raster_.lines;
      const int last = index(wide.max(), 0, -1.0, end - 1.0);
      for (int j = index(wide.min(), 1, 0.0, end); j <= index(wide.max(), 1, -1.0, end - 1.0); ++j)
        for (int i = index(wide.min(), 0, 0.0, end); i <= last; ++i)
          if (shared_[raster_.number_of(i, j)]) return true;
      return false;
    }

   private:
    [[nodiscard]] Rectangle seen(const Box3& box) const {
      const Vec3 centre = axes_.seen(box.center()), half = 0.5 * box.sizes();
      const Vec2 reach(half.dot(axes_.x.cwiseAbs()), half.dot(axes_.y.cwiseAbs()));
      return {Vec2(centre.head<2>() - reach), Vec2(centre.head<2>() + reach)};
    }

    Axes axes_;
    Raster raster_;
    std::vector<bool> shared_;
    std::vector<Vec2> points_;
  };

  // What the lines have not shown is excluded, or looked at more closely.
  void prove() {
    if (known_)
      for (const Spot& spot : spots_)
        if (spot.depth > touching_) known_->add(0.5 * (spot.p + spot.q));
    constexpr int work = 20000;
    const Certificate certificate =
        certify(model_, cluster_, std::max(resolution_, touching_), 2e-3 * thickness_, work,
                [&](const Box3& a, const Box3& b) { return known_ && known_->holds(a, b); });
    unsettled_ = certificate.unsettled;
    std::size_t looked_at = 0;
    for (const OpenPair& pair : certificate.open) {
      // Next to one that was found there is no need to look again.
      if (++looked_at > 200) {
        unsettled_ = std::max(unsettled_, -pair.low);
        continue;
      }
      if (!look_at(pair)) is_deep_ = true;
      if (is_deep_) return;
    }
  }

  // An overlap that no line has met: a critical pair. False: there is none, and yet the surfaces meet.
  bool look_at(const OpenPair& pair) {
    const Face &fa = model_.face_of(cell(pair.a.cell)), &fb = model_.face_of(cell(pair.b.cell));
    const Vec2 site_a = 0.5 * (pair.a.low + pair.a.high), site_b = 0.5 * (pair.b.low + pair.b.high);
    const Vec3 start = nurbs::evaluate(*fa.surface, site_a.x(), site_a.y());
    const std::optional<Critical> found = find_critical(fa, site_a, fb, site_b);
    if (found && found->depth > touching_ && found->depth < 0.01 * thickness_ &&
        (found->p - start).norm() < 0.1 * thickness_) {
      if (is_known(found->p, found->q)) return true;
      spots_.push_back({*found, &fa, &fb});
      contacts_.push_back(contact_of({spots_.back()}));
      return true;
    }
    Cell ca = cell(pair.a.cell), cb = cell(pair.b.cell);
    ca.low = pair.a.low;
    ca.high = pair.a.high;
    cb.low = pair.b.low;
    cb.high = pair.b.high;
    const NearestPoints nearest = find_nearest(fa, ca, site_a, fb, cb, site_b);
    return (nearest.p - nearest.q).norm() > touching_;
  }

  // Most of what seems to be shared lies between surfaces that run along the lines.
  [[nodiscard]] bool is_steep(const Overlay& overlay, const std::vector<int>& region) const {
    std::size_t shared = 0, steep = 0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      if (region[k] < 0) continue;
      ++shared;
      if (cell(overlay.on_a(k).cell).normal.dot(overlay.axes().n) < 0.25 ||
          cell(overlay.on_b(k).cell).normal.dot(overlay.axes().n) > -0.25)
        ++steep;
    }
    return steep > 0 && 10 * steep > 3 * shared;
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
    const Face &fa = model_.face_of(cell(a.cell)), &fb = model_.face_of(cell(b.cell));
    const std::optional<Critical> found = find_critical(fa, a.site, fb, b.site);
    if (!found || found->normal.dot(overlay.axes().n) < 0.5) return false;
    // On the line they are deeper than along their normal, where that is inclined.
    const double start = overlay.depth(line), least = start * found->normal.dot(overlay.axes().n);
    if (found->depth < least - slack() || found->depth > start + 0.1 * thickness_ + 0.3 * std::abs(start))
      return false;
    const Vec3 middle = 0.5 * (found->p + found->q);
    if ((middle - 0.5 * (a.point + b.point)).norm() > 0.5 * thickness_ + 6.0 * overlay.step().norm())
      return false;
    // Where it says that they overlap, the lines have to say so too.
    if (found->depth > slack() && !agrees(overlay, middle, found->depth)) return false;
    if (!is_known(found->p, found->q)) spots_.push_back({*found, &fa, &fb});
    return true;
  }

  // Some line next to a point is about as deep.
  [[nodiscard]] bool agrees(const Overlay& overlay, const Vec3& point, double depth) const {
    const Vec3 seen = overlay.axes().seen(point);
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        const int line =
            overlay.line_at(Vec2(seen.head<2>()) + Vec2(di * overlay.step().x(), dj * overlay.step().y()));
        if (line < 0 || !overlay.is_met(static_cast<std::size_t>(line))) continue;
        const double there = overlay.depth(static_cast<std::size_t>(line));
        if (std::abs(there - depth) < 2.0 * slack() + 0.15 * depth) return true;
      }
    return false;
  }

  // A peak on an edge, a rim or a border, by rasters that close in on it, along the same direction.
  void settle_at_crease(const Overlay& coarse, std::size_t first, const std::vector<int>& region) {
    // A gap there is not along one line: see look_at_nearest().
    if (coarse.depth(first) < -slack() - coarse.step().maxCoeff()) return;
    const Vec2 place = coarse.centre(first);
    for (const Spot& s : spots_) {
      const Vec3 seen = coarse.axes().seen(0.5 * (s.p + s.q));
      const int line = coarse.line_at(seen.head<2>());
      const bool same_region =
          line >= 0 && region[first] >= 0 && region[static_cast<std::size_t>(line)] == region[first];
      const bool close = (Vec2(seen.head<2>()) - place).norm() < 4.0 * coarse.step().norm();
      if ((same_region || close) && s.depth > coarse.depth(first) - slack()) return;
    }
    const std::vector<Part> pa = coarse.parts_about(first, 2, true), pb = coarse.parts_about(first, 2, false);
    const Vec3 start = 0.5 * (coarse.on_a(first).point + coarse.on_b(first).point);
    const double reach = 2.0 * coarse.step().maxCoeff();
    Vec3 n = coarse.axes().n;
    std::optional<Deepest> found = close_in(model_, pa, pb, n, start, reach, 0.5 * slack());
    if (found && found->depth > touching_) {
      // Against a smooth surface an edge is parted along that surface's normal.
      Vec3 easier = found->smooth_a   ? normal_at(found->a)
                    : found->smooth_b ? normal_at(found->b)
                                      : easiest_direction(pa, pb, n, start, reach);
      if (easier.dot(n) < 0.0) easier = -easier;
      if (easier.squaredNorm() > 0.0)
        if (const std::optional<Deepest> again = close_in(model_, pa, pb, easier, start, reach)) {
          found = again;
          n = easier;
        }
    }
    if (!found || !(found->depth > touching_) || is_known(found->a.point, found->b.point)) return;
    const Face &fa = model_.face_of(cell(found->a.cell)), &fb = model_.face_of(cell(found->b.cell));
    // The raster's is about right, Newton's exact.
    const double near = 0.05 * thickness_;
    const std::optional<Spot> exact = crease_spot(fa, found->a.site, fb, found->b.site);
    if (exact && exact->normal.dot(n) > 0.7 && std::abs(exact->depth - found->depth) < 0.1 * found->depth &&
        (exact->p - found->a.point).norm() < near && (exact->q - found->b.point).norm() < near) {
      if (!is_known(exact->p, exact->q)) spots_.push_back(*exact);
      return;
    }
    spots_.push_back(
        {{found->a.site, found->b.site, found->a.point, found->b.point, n, found->depth}, &fa, &fb, false});
  }

  // Outward, zero where there is none.
  [[nodiscard]] Vec3 normal_at(const Overlay::Place& place) const {
    return point_at(model_.face_of(cell(place.cell)), place.site).normal;
  }

  // Edge across edge: the direction along which the deepest line is the shortest, by compass search.
  [[nodiscard]] Vec3 easiest_direction(const std::vector<Part>& pa, const std::vector<Part>& pb, Vec3 n,
                                       const Vec3& start, double reach) const {
    const auto cost = [&](const Vec3& direction) {
      const std::optional<Deepest> found = close_in(model_, pa, pb, direction, start, reach);
      return found && found->depth > 0.0 ? found->depth : infinity;
    };
    double best = cost(n);
    double step = 0.3;
    for (int round = 0; round < 8; ++round, step *= 0.5)
      for (int k = 0; k < 8; ++k) {
        const Vec3 other = turned(n, step, k);
        const double value = cost(other);
        if (value >= best) continue;
        best = value;
        n = other;
      }
    return n;
  }

  // The deepest comes first.
  [[nodiscard]] Contact contact_of(const std::vector<Spot>& spots) const {
    const Spot& spot = spots.front();
    Contact contact;
    contact.a = body_a_;
    contact.b = body_b_;
    for (const Spot& s : spots) contact.spots.push_back(minimum_of(s));
    contact.site_a = contact.spots.front().site_a;
    contact.site_b = contact.spots.front().site_b;
    contact.on_a = spot.p;
    contact.on_b = spot.q;
    contact.at = 0.5 * (spot.p + spot.q);
    contact.direction = spot.normal;
    contact.gap = spot.depth > touching_ ? -spot.depth : std::max(0.0, -spot.depth);
    if (contact.is_overlap() && spots.size() > 1) part_all(spots, contact);
    return contact;
  }

  void part_all(const std::vector<Spot>& spots, Contact& contact) const {
    const std::optional<Vec3> shift = parting_shift(spots, touching_);
    if (!shift || !(shift->norm() > touching_)) return;
    contact.gap = -shift->norm();
    contact.direction = shift->normalized();
  }

  // Spots of one connected region make one contact.
  void gather(const Overlay& overlay, const std::vector<int>& region, int regions) {
    std::stable_sort(spots_.begin(), spots_.end(),
                     [](const Spot& x, const Spot& y) { return x.depth > y.depth; });
    struct Group {
      int region;
      std::vector<Spot> spots;
    };
    std::vector<Group> groups;
    std::vector<std::optional<std::size_t>> group_of(static_cast<std::size_t>(regions));
    for (const Spot& spot : spots_) {
      if (spot.depth < -reach_) continue;
      const int line = overlay.line_at(overlay.axes().seen(0.5 * (spot.p + spot.q)).head<2>());
      const int here = line < 0 ? -1 : region[static_cast<std::size_t>(line)];
      if (here >= 0 && group_of[static_cast<std::size_t>(here)]) {
        groups[*group_of[static_cast<std::size_t>(here)]].spots.push_back(spot);
        continue;
      }
      if (here >= 0) group_of[static_cast<std::size_t>(here)] = groups.size();
      groups.push_back({here, {spot}});
    }
    for (const Group& group : groups) {
      contacts_.push_back(contact_of(group.spots));
      contacts_.back().area = area(overlay, region, group.region);
    }
  }

  // Of a's surface on the region's lines.
  [[nodiscard]] double area(const Overlay& overlay, const std::vector<int>& region, int which) const {
    if (which < 0) return 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      if (region[k] != which) continue;
      const double tilt = cell(overlay.on_a(k).cell).normal.dot(overlay.axes().n);
      sum += overlay.step().prod() / std::max(tilt, 0.2);
    }
    return sum;
  }

  // What is nearer than all that was found: the nearest points of two cells.
  void look_at_nearest() {
    double best = reach_;
    for (const Contact& contact : contacts_) best = std::min(best, contact.gap);
    std::optional<Spot> nearest;
    Cluster pairs = cluster_;
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const NearPair& x, const NearPair& y) { return x.low < y.low; });
    for (const NearPair& pair : pairs) {
      if (pair.low >= best) break;
      const Cell &ca = cell(pair.a), &cb = cell(pair.b);
      const Face &fa = model_.face_of(ca), &fb = model_.face_of(cb);
      const NearestPoints found =
          find_nearest(fa, ca, 0.5 * (ca.low + ca.high), fb, cb, 0.5 * (cb.low + cb.high));
      const double distance = (found.p - found.q).norm();
      if (distance > best * (1.0 - 1e-6)) continue;
      Spot spot{{found.site_a, found.site_b, found.p, found.q, Vec3::Zero(), -distance}, &fa, &fb, false};
      if (distance > 0.0) spot.normal = (found.q - found.p) / distance;
      is_deep_ = is_deep_ || distance <= touching_;
      if (body_a_ == body_b_ && distance > touching_ && !is_facing(ca, cb, spot.normal)) continue;
      best = distance;
      nearest = spot;
    }
    if (nearest) contacts_.push_back(contact_of({*nearest}));
  }

  // Both cells look at each other along n: a yarn is near itself in many places that do not.
  [[nodiscard]] static bool is_facing(const Cell& a, const Cell& b, const Vec3& n) {
    return a.normal.dot(n) > 0.3 && b.normal.dot(n) < -0.3;
  }

  // Looking farther than a yarn is thick, all of one that turns round hangs together, and what stands for
  // both sides shares all its space with itself.
  [[nodiscard]] bool is_itself() const {
    if (body_a_ != body_b_ || reach_ < thickness_) return false;
    std::set<std::uint32_t> rows;
    const auto row = [&](std::uint32_t k) { return cell(k).j; };
    for (const NearPair& pair : cluster_) rows.insert(row(pair.a));
    return std::any_of(cluster_.begin(), cluster_.end(),
                       [&](const NearPair& pair) { return rows.contains(row(pair.b)); });
  }

  void look_deep() {
    if (is_itself()) return;
    Box3 walls;
    for (const NearPair& pair : cluster_) walls.extend(cell(pair.a).box.merged(cell(pair.b).box));
    std::vector<Contact> deep =
        measure_deep(model_, body_a_, stretch(true), body_b_, stretch(false), walls, touching_);
    // Nothing is shared: they touch.
    if (!deep.empty() || contacts_.empty()) contacts_ = std::move(deep);
  }

  // The cluster's rows of the yarn, and half as much on both sides.
  [[nodiscard]] Stretch stretch(bool of_a) const {
    std::set<std::uint32_t> rows;
    const std::size_t body = of_a ? body_a_ : body_b_;
    const Face& side = model_.faces()[model_.side(body)];
    for (const NearPair& pair : cluster_) {
      const Cell& c = cell(of_a ? pair.a : pair.b);
      const Face& face = model_.face_of(c);
      rows.insert(face.is_side ? c.j : face.is_last ? side.count_v - 1 : 0U);
    }
    const std::vector<std::uint32_t> range = covering_range(rows, side.count_v, side.round_v);
    const auto row = [&](std::uint32_t j) -> const Cell& { return cell(side.rows[j]); };
    const nurbs::Surface& s = *side.surface;
    Stretch out{row(range.front()).low.y(), row(range.back()).high.y()};
    if (out.last <= out.first) out.last += s.last_v() - s.first_v();
    const double more = 0.5 * (out.last - out.first);
    out.first -= more;
    out.last += more;
    if (!side.round_v) {
      out.first = std::max(out.first, s.first_v());
      out.last = std::min(out.last, s.last_v());
    } else if (out.last - out.first > s.last_v() - s.first_v()) {
      out.last = out.first + (s.last_v() - s.first_v());
    }
    return out;
  }

  const CellModel& model_;
  const Cluster& cluster_;
  double reach_, resolution_;
  std::uint32_t body_a_, body_b_;
  double thickness_, touching_;
  std::vector<Spot> spots_;
  std::vector<Contact> contacts_;
  bool is_deep_ = false;
  std::optional<Known> known_;
  double unsettled_ = 0;
};

}  // namespace

Measured measure(const CellModel& model, const Cluster& cluster, double reach, double resolution) {
  return Measurer(model, cluster, reach, resolution).run();
}

}  // namespace selvage::contact
