#include "cad/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "cad/border.h"
#include "cad/distance.h"
#include "cad/facing.h"
#include "cad/sampled_curve.h"
#include "core/box_tree.h"
#include "nurbs/measure.h"
#include "nurbs/samples.h"

namespace selvage::cad {

namespace {

constexpr double least_tolerance = 1e-6;  // of the part's size
constexpr double reach = 1e-2;            // of the part's size: edges farther apart are no neighbours
constexpr double rounding = 1e-12;        // of the part's size
constexpr double far_off = 1e-3;          // of the part's size: an edge that lies off its surface
constexpr double no_area = 1e-12;         // of the square of the part's size
constexpr double suspicious_area = 1e-4;  // of the same: counted more finely
constexpr double outside = 1e-6;          // of the range of parameters
// Up to which gaps are joined by kernels with tolerant edges (judge.h): mm, and of the model's size.
constexpr double sewn_mm = 0.02, sewn_share = 1e-4;

std::string who(const Face& face) {
  std::string name = face.origin.entity.empty() ? std::string("a face") : face.origin.entity;
  return face.name.empty() ? name : fmt::format("{} ('{}')", name, face.name);
}

// Where a face has no place of its own, its part's.
TextPlace place_of(const Part& part, const Face& face) {
  return face.origin.place.line > 0 ? face.origin.place : part.origin.place;
}

class Judge {
 public:
  Judge(const Model& model, Findings& findings) : model_(model), findings_(findings) {}

  Measures run() {
    Box3 all;
    for (const Part& part : model_.parts) all.extend(box_of(part));
    for (const NamedCurve& curve : model_.curves) all.extend(box_of(curve.curve.points));
    m_.size = all.isEmpty() ? 0 : all.sizes().maxCoeff();
    for (const Part& part : model_.parts) judge_part(part);
    m_.tolerance = std::max(model_.resolution, least_tolerance * m_.size);
    find_duplicates();
    return m_;
  }

 private:
  struct Owned {
    Border border;
    const Face* face;
  };

  // `badness`: as in core/tally.h.
  void find(Severity severity, const Part& part, const Face& face, std::string_view text,
            const std::optional<Vec3>& at = std::nullopt, double badness = 0) {
    Message made = error(Kind::geometry, fmt::format("{}: {}", who(face), text));
    made.severity = severity;
    made.place = place_of(part, face);
    made.at = at;
    findings_.add(std::move(made), badness);
  }

  void judge_part(const Part& part) {
    const Box3 box = box_of(part);
    bool sound = true;
    for (const Face& face : part.faces) sound = judge_spline(part, face) && sound;
    m_.faces += part.faces.size();
    if (!sound || box.isEmpty()) return;
    size_ = box.sizes().maxCoeff();
    tolerance_ = std::max(model_.resolution, least_tolerance * size_);
    sewn_ = std::max(tolerance_, std::min(sewn_mm / millimetres_per(model_.units), sewn_share * m_.size));
    std::vector<Owned> borders;
    std::vector<std::size_t> firsts;  // where the borders of each face begin
    for (const Face& face : part.faces) {
      firsts.push_back(borders.size());
      for (Border& border : borders_of(face)) borders.push_back({std::move(border), &face});
      judge_loops(part, face);
    }
    for (std::size_t i = 0; i < part.faces.size(); ++i)
      if (part.faces[i].loops.empty())
        judge_whole(part, part.faces[i], std::span(borders).subspan(firsts[i], 4));
    std::erase_if(borders, [&](const Owned& owned) { return owned.border.length() <= tolerance_; });
    m_.borders += borders.size();
    for (const Owned& owned : borders)
      if (m_.shortest_border == 0 || owned.border.length() < m_.shortest_border) {
        m_.shortest_border = owned.border.length();
        m_.shortest_entity = who(*owned.face);
        m_.shortest_place = place_of(part, *owned.face);
      }
    // A face by itself has a border by rights.
    if (part.kind != Part::Kind::solid && part.faces.size() == 1) return;
    std::vector<Box3> boxes;
    boxes.reserve(borders.size());
    for (const Owned& owned : borders) boxes.push_back(owned.border.box());
    const BoxTree tree(std::move(boxes));
    for (std::size_t i = 0; i < borders.size(); ++i) judge_border(part, borders, tree, i);
    if (part.kind != Part::Kind::solid) return;
    judge_outside(part);
    for (const std::size_t i : turned_faces(part, sewn_))
      find(Severity::error, part, part.faces[i],
           "it looks to the inside where the faces beside it look out: it is turned");
  }

  // Where no face is trimmed the volume is known, and its sign.
  void judge_outside(const Part& part) {
    double volume = 0;
    for (const Face& face : part.faces) {
      if (!face.loops.empty()) return;
      volume += (face.reversed ? -1 : 1) *
                nurbs::volume_flux(face.surface, part.faces.front().surface.points.front());
    }
    if (volume < -least_tolerance * size_ * size_ * size_)
      find(Severity::error, part, part.faces.front(),
           fmt::format("its solid is inside out: the volume is {:.6g} {}3", volume, name_of(model_.units)));
  }

  // Knots and weights; false: it cannot be evaluated.
  bool judge_spline(const Part& part, const Face& face) {
    const nurbs::Surface& s = face.surface;
    m_.largest_degree = std::max({m_.largest_degree, s.degree_u, s.degree_v});
    bool sound = !s.is_empty();
    for (const bool in_u : {true, false}) {
      const std::vector<double>& knots = in_u ? s.knots_u : s.knots_v;
      const int degree = in_u ? s.degree_u : s.degree_v;
      if (!std::is_sorted(knots.begin(), knots.end())) {
        find(Severity::error, part, face, fmt::format("its knots in {} are out of order", in_u ? "u" : "v"));
        sound = false;
        continue;
      }
      for (std::size_t i = 0; i < knots.size();) {
        std::size_t next = i;
        while (next < knots.size() && knots[next] == knots[i]) ++next;
        const bool is_end = i == 0 || next == knots.size();
        if (next - i > static_cast<std::size_t>(degree) + (is_end ? 1 : 0))
          find(Severity::error, part, face,
               fmt::format("the knot {} in {} is there {} times, at degree {}", knots[i], in_u ? "u" : "v",
                           next - i, degree));
        i = next;
      }
    }
    if (!s.weights.empty()) {
      const double least = *std::min_element(s.weights.begin(), s.weights.end());
      m_.least_weight = std::min(m_.least_weight, least);
      if (!(least > 0)) {
        find(Severity::error, part, face, fmt::format("a weight of {}", least));
        sound = false;
      }
    }
    return sound;
  }

  void judge_loops(const Part& part, const Face& face) {
    std::optional<SurfaceSet> surface;  // of the face, where it is asked for the nearest point
    for (const Loop& loop : face.loops) {
      for (std::size_t i = 0; i < loop.edges.size(); ++i) {
        const Vec3 end = end_of(face, loop.edges[i], true),
                   next = end_of(face, loop.edges[(i + 1) % loop.edges.size()], false);
        const double gap = (end - next).norm();
        if (gap > tolerance_)
          find(gap > sewn_ ? Severity::error : Severity::warning, part, face,
               fmt::format("its boundary is not closed: {:.3g} {} between two of its edges", gap,
                           name_of(model_.units)),
               end, gap);
      }
      for (const Edge& edge : loop.edges) judge_edge(part, face, edge, surface);
    }
  }

  static Vec3 end_of(const Face& face, const Edge& edge, bool last) {
    const nurbs::Curve& c = edge.curve.points.empty() ? edge.flat : edge.curve;
    if (c.points.empty()) return face.surface.points.front();
    return &c == &edge.curve ? at_share(c, last ? 1 : 0) : at_share(face.surface, c, last ? 1 : 0);
  }

  void judge_edge(const Part& part, const Face& face, const Edge& edge, std::optional<SurfaceSet>& surface) {
    const nurbs::Surface& s = face.surface;
    double leaves = 0, off = 0;
    std::optional<Vec3> leaves_at, off_at;
    for (const double share : {0.0, 0.21, 0.5, 0.77, 1.0}) {
      std::optional<Vec2> start;
      if (!edge.flat.points.empty()) {
        start = at_share(edge.flat, share).head<2>();
        double beyond = bring_inside(s, *start);
        const Vec3 inside = beyond > 0 ? nurbs::evaluate(s, start->x(), start->y()) : Vec3::Zero();
        // Who goes by the curve in space, or stops at the border, is not led astray.
        if (!edge.curve.points.empty() && beyond > 0)
          beyond = std::min(beyond, (inside - at_share(edge.curve, share)).norm());
        if (beyond > leaves) {
          leaves = beyond;
          leaves_at = inside;
        }
      }
      if (edge.curve.points.empty()) continue;
      const Vec3 p = at_share(edge.curve, share);
      double distance = start ? (nurbs::evaluate(s, start->x(), start->y()) - p).norm() : 0;
      if (!start || distance > tolerance_) {
        if (!surface) surface.emplace(std::vector{&s});
        const SurfaceSet::Foot foot = surface->near(p);
        distance = foot.distance;
        // The foot may be that of another place of the surface: only what is proven is told.
        if (distance > 10 * tolerance_ && distance > off) distance = surface->least_distance(p, foot);
      }
      if (distance > off) {
        off = distance;
        off_at = p;
      }
    }
    if (leaves > 0)
      find(leaves > sewn_ ? Severity::error : Severity::warning, part, face,
           fmt::format("its boundary leaves the range of its surface by {:.3g} {}", leaves,
                       name_of(model_.units)),
           leaves_at, leaves);
    if (off > 10 * tolerance_)
      find(off > std::max(sewn_, far_off * size_) ? Severity::error : Severity::warning, part, face,
           fmt::format("an edge lies {:.3g} {} off its surface", off, name_of(model_.units)), off_at, off);
  }

  // Parameters that leave the surface's range are brought into it: by a period where the surface is closed in
  // that direction, else onto its border. Gives about how far they were beyond it, in space; 0: not more than
  // rounding.
  [[nodiscard]] double bring_inside(const nurbs::Surface& s, Vec2& at) const {
    const Vec2 low(s.first_u(), s.first_v()), high(s.last_u(), s.last_v()), slack = outside * (high - low);
    Vec2 beyond = Vec2::Zero();
    for (const int k : {0, 1}) {
      if (at[k] >= low[k] - slack[k] && at[k] <= high[k] + slack[k]) continue;
      if (is_closed(s, k == 0)) {
        at[k] = low[k] + std::remainder(at[k] - low[k], high[k] - low[k]);
        if (at[k] < low[k]) at[k] += high[k] - low[k];
        continue;
      }
      const double inside = std::clamp(at[k], low[k], high[k]);
      beyond[k] = at[k] - inside;
      at[k] = inside;
    }
    if (beyond.isZero(0)) return 0;
    const nurbs::SurfaceJet jet =
        nurbs::evaluate_jet(s, std::clamp(at.x(), low.x(), high.x()), std::clamp(at.y(), low.y(), high.y()));
    return std::hypot(beyond.x() * jet.du.norm(), beyond.y() * jet.dv.norm());
  }

  // Are the two borders of this direction one, within the tolerance?
  [[nodiscard]] bool is_closed(const nurbs::Surface& s, bool in_u) const {
    for (const double share : {0.0, 0.3, 0.5, 0.8, 1.0}) {
      const Vec3 a = in_u ? at_shares(s, 0, share) : at_shares(s, share, 0),
                 b = in_u ? at_shares(s, 1, share) : at_shares(s, share, 1);
      if ((a - b).norm() > tolerance_) return false;
    }
    return true;
  }

  // An untrimmed face: poles, area, and whether it nearly closes.
  // `borders` are its four sides in order.
  void judge_whole(const Part& part, const Face& face, std::span<const Owned> borders) {
    std::array<const Border*, 4> sides{};
    for (std::size_t i = 0; i < sides.size(); ++i) sides[i] = &borders[i].border;
    double area = area_of(face.surface, 12, 12);
    // Few steps may meet a helix in the same place of every turn.
    if (area <= suspicious_area * size_ * size_)
      area = area_of(face.surface, 3 * face.surface.count_u, 3 * face.surface.count_v);
    if (area <= no_area * size_ * size_) return find(Severity::error, part, face, "a face without area");
    if (!m_.least_area || area < *m_.least_area) {
      m_.least_area = area;
      m_.least_area_entity = who(face);
      m_.least_area_place = place_of(part, face);
    }
    m_.largest_area = std::max(m_.largest_area.value_or(0), area);
    for (std::size_t i = 0; i < 4; ++i)
      if (sides[i]->length() <= tolerance_) {
        if (m_.poles++ == 0) m_.first_pole = face.origin;
        find(Severity::note, part, face,
             fmt::format("its border {} is one point, a pole", std::array{"u0", "u1", "v0", "v1"}[i]),
             sides[i]->points().front());
      }
    for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
      if (sides[i]->length() <= tolerance_) continue;
      double gap = 0;
      for (std::size_t k = 0; k < sides[i]->points().size(); ++k)
        gap = std::max(gap, (sides[i]->points()[k] - sides[i + 1]->points()[k]).norm());
      if (gap > rounding * size_ && gap <= tolerance_)
        find(Severity::warning, part, face,
             fmt::format("it is open in {} by {:.3g} {}, less than the tolerance: systems differ in "
                         "whether they close it; let its first and last control points be equal",
                         i == 0 ? "u" : "v", gap, name_of(model_.units)),
             sides[i]->points().front());
    }
  }

  // Of a grid of so many triangles' pairs.
  static double area_of(const nurbs::Surface& s, int steps_u, int steps_v) {
    std::vector<double> us, vs;
    for (int i = 0; i <= steps_u; ++i)
      us.push_back(std::lerp(s.first_u(), s.last_u(), static_cast<double>(i) / steps_u));
    for (int j = 0; j <= steps_v; ++j)
      vs.push_back(std::lerp(s.first_v(), s.last_v(), static_cast<double>(j) / steps_v));
    const nurbs::Samples grid(s, us, vs);
    double area = 0;
    for (std::size_t j = 0; j + 1 < vs.size(); ++j)
      for (std::size_t i = 0; i + 1 < us.size(); ++i) {
        const Vec3 &a = grid.at(i, j), &b = grid.at(i + 1, j), &c = grid.at(i, j + 1),
                   &d = grid.at(i + 1, j + 1);
        area += 0.5 * ((b - a).cross(c - a).norm() + (b - d).cross(c - d).norm());
      }
    return area;
  }

  // Of one face, edges that follow each other meet at a corner and are no neighbours; the two sides of a seam
  // have both ends in common.
  [[nodiscard]] bool may_be_seam(const Border& a, const Border& b) const {
    if (a.side() >= 0) return a.side() / 2 == b.side() / 2;
    const auto near = [&](const Vec3& p, const Vec3& q) { return (p - q).norm() <= reach * size_; };
    const Vec3 &a0 = a.points().front(), &a1 = a.points().back(), &b0 = b.points().front(),
               &b1 = b.points().back();
    return (near(a0, b0) && near(a1, b1)) || (near(a0, b1) && near(a1, b0));
  }

  // Has this border a neighbour all along, and how far is it? `boxes` are those of the borders.
  void judge_border(const Part& part, const std::vector<Owned>& borders, const BoxTree& boxes,
                    std::size_t own) {
    const Border& border = borders[own].border;
    const double far = reach * size_, enough = rounding * size_;
    double gap = 0;
    Vec3 gap_at = border.points().front();
    const std::size_t count = border.points().size();
    for (std::size_t k = 0; k < count && gap <= far; ++k) {
      const Vec3& p = border.points()[k];
      double least = 2 * far;  // what is farther than `far` is no neighbour
      boxes.near_point(p, least, [&](std::size_t i) {
        const Owned& other = borders[i];
        if (i == own || least <= enough) return least;
        if (other.face == borders[own].face && !may_be_seam(border, other.border)) return least;
        ++m_.comparisons;
        least = std::min(least, other.border.distance(p, border.share(k), enough, least));
        return least;
      });
      if (least > gap) {
        gap = least;
        gap_at = p;
      }
    }
    const Face& face = *borders[own].face;
    const bool is_solid = part.kind == Part::Kind::solid;
    if (gap > far) {
      ++m_.open_borders;
      constexpr std::array<std::string_view, 3> kinds = {"group of surfaces", "shell", "solid"};
      return find(
          is_solid ? Severity::error : Severity::warning, part, face,
          fmt::format("an edge of length {:.3g} {} has no other face beside it: the {} is open",
                      border.length(), name_of(model_.units), kinds[static_cast<std::size_t>(part.kind)]),
          gap_at, border.length());
    }
    if (gap > m_.largest_gap) {
      m_.largest_gap = gap;
      m_.gap_at = gap_at;
      m_.gap_entity = who(face);
    }
    if (gap > tolerance_)
      find(is_solid && gap > sewn_ ? Severity::error : Severity::warning, part, face,
           fmt::format("an edge and its neighbour are up to {:.3g} {} apart; {:.3g} are within the "
                       "file's resolution",
                       gap, name_of(model_.units), tolerance_),
           gap_at, gap);
  }

  // Points that tell a face: of its surface's inside, or of its outer loop.
  struct Signature {
    const Part* part;
    const Face* face;
    Box3 box;
    std::vector<Vec3> points;
  };

  static Signature signature(const Part& part, const Face& face) {
    Signature made{&part, &face, {}, {}};
    if (face.loops.empty()) {
      for (const double a : {0.2, 0.5, 0.8})
        for (const double b : {0.2, 0.5, 0.8}) made.points.push_back(at_shares(face.surface, a, b));
    } else {
      for (const Edge& edge : face.loops.front().edges)
        if (!edge.curve.points.empty())
          for (const double a : {0.0, 0.5}) made.points.push_back(at_share(edge.curve, a));
      // Two half spheres have one outline: their insides differ.
      made.points.push_back(at_shares(face.surface, 0.5, 0.5));
    }
    made.box = box_of(made.points);
    return made;
  }

  // Boxes with corners within a tolerance have keys within `most_of_key` of it. Other faces hardly ever do,
  // although those of a regular model have many coordinates in common.
  static constexpr double most_of_key = 6;
  static double sort_key(const Box3& box) {
    return Vec3(1.0, 0.61803, 0.41421).dot(box.min()) + Vec3(0.73205, 0.23607, 0.64575).dot(box.max());
  }

  void find_duplicates() {
    std::vector<Signature> all;
    for (const Part& part : model_.parts)
      for (const Face& face : part.faces)
        if (!face.surface.is_empty() &&
            std::is_sorted(face.surface.knots_u.begin(), face.surface.knots_u.end()) &&
            std::is_sorted(face.surface.knots_v.begin(), face.surface.knots_v.end()))
          all.push_back(signature(part, face));
    const auto line = [](const Signature& s) { return s.face->origin.place.line; };
    std::stable_sort(all.begin(), all.end(),
                     [&](const Signature& a, const Signature& b) { return line(a) < line(b); });
    std::vector<std::pair<double, const Signature*>> sorted;
    sorted.reserve(all.size());
    for (const Signature& s : all) sorted.emplace_back(sort_key(s.box), &s);
    std::sort(sorted.begin(), sorted.end());
    // Twice the same, not two that nearly touch.
    const double tolerance = std::min(m_.tolerance, 1e-6 * m_.size);
    std::vector<std::pair<const Signature*, const Signature*>> pairs;  // in file order
    std::map<std::pair<const Part*, const Part*>, std::size_t> shared;
    for (auto i = sorted.begin(); i != sorted.end(); ++i)
      for (auto k = i + 1; k != sorted.end() && k->first - i->first <= most_of_key * tolerance; ++k) {
        ++m_.comparisons;
        if (!is_same(*i->second, *k->second, tolerance)) continue;
        pairs.emplace_back(std::minmax(i->second, k->second));
        ++shared[std::minmax(i->second->part, k->second->part)];
        break;
      }
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [first, second] : pairs) {
      // Two parts that have one face in common touch there (a yarn that was cut); one that has all of its
      // faces in another is there twice.
      const std::size_t fewest = std::min(first->part->faces.size(), second->part->faces.size());
      if (first->part != second->part && shared[std::minmax(first->part, second->part)] < fewest) continue;
      if (is_read_twice(*first, *second)) {
        find(Severity::note, *second->part, *second->face, "it is read twice: two groups have it",
             second->points.front());
        continue;
      }
      find(Severity::error, *second->part, *second->face,
           fmt::format("the same face as {}, at the same place", who(*first->face)), second->points.front());
    }
  }

  // What stands in two groups, or in two representations of one shape: then a face without an entity of its
  // own is a further reading of one that has it.
  static bool is_read_twice(const Signature& first, const Signature& second) {
    const Origin &one = origin_of(first), &other = origin_of(second);
    if (!one.entity.empty() && one.entity == other.entity && one.place.line == other.place.line) return true;
    return first.part != second.part &&
           first.face->origin.entity.empty() != second.face->origin.entity.empty();
  }

  // Some faces are named by their part alone.
  static const Origin& origin_of(const Signature& s) {
    return s.face->origin.entity.empty() ? s.part->origin : s.face->origin;
  }

  static bool is_same(const Signature& a, const Signature& b, double tolerance) {
    if (a.points.size() != b.points.size() || a.face->loops.size() != b.face->loops.size()) return false;
    if ((a.box.min() - b.box.min()).cwiseAbs().maxCoeff() > tolerance ||
        (a.box.max() - b.box.max()).cwiseAbs().maxCoeff() > tolerance)
      return false;
    return std::all_of(a.points.begin(), a.points.end(), [&](const Vec3& p) {
      return std::any_of(b.points.begin(), b.points.end(),
                         [&](const Vec3& q) { return (p - q).norm() <= tolerance; });
    });
  }

  const Model& model_;
  Findings& findings_;
  Measures m_;
  double size_ = 0, tolerance_ = 0, sewn_ = 0;  // of the part at hand
};

}  // namespace

Measures judge(const Model& model, Findings& findings) {
  return Judge(model, findings).run();
}

}  // namespace selvage::cad
