#include "cad/things.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "cad/distance.h"
#include "cad/edges.h"
#include "cad/outline.h"
#include "cad/sampled_curve.h"
#include "core/box_tree.h"

namespace selvage::cad {

namespace {

void measure(Thing& thing) {
  Vec3 mean = Vec3::Zero();
  std::size_t count = 0;
  for (const nurbs::Surface* surface : thing.surfaces)
    for (const Vec3& p : surface->points) {
      mean += p;
      ++count;
    }
  // A face that one file trims is whole in another: of both the points count, not those that control them.
  for (std::size_t k = 0; k < thing.surfaces.size(); ++k)
    if (thing.kind == Thing::Kind::part && k < thing.faces.size())
      thing.box.extend(place_of(*thing.faces[k]).box);
    else
      thing.box.extend(box_of(thing.surfaces[k]->points));
  if (count == 0) return;
  mean /= static_cast<double>(count);
  double sum = 0;
  for (const nurbs::Surface* surface : thing.surfaces)
    for (const Vec3& p : surface->points) sum += (p - mean).squaredNorm();
  thing.spread = std::sqrt(sum / static_cast<double>(count));
}

// Where the faces of two models end. Some writers draw an outline a second time, as curves.
class Outlines {
 public:
  Outlines(const Model& model, const Model& other) {
    std::vector<Box3> boxes;
    Box3 all;
    const auto add = [&](const nurbs::Curve& curve) {
      if (curve.points.empty()) return;
      curves_.push_back(curve);
      all.extend(boxes.emplace_back(box_of(curve.points)));
    };
    for (const Model* of : {&model, &other})
      for (const Part& part : of->parts)
        for (const Face& face : part.faces) {
          for (const Edge& edge : edges_of(face)) add(edge.curve);
          if (face.loops.empty())
            for (const nurbs::Curve& side : sides_of(face.surface)) add(side);
        }
    if (!all.isEmpty()) near_ = 1e-7 * all.diagonal().norm();
    tree_ = BoxTree(std::move(boxes));
  }
  // All along one of them?
  [[nodiscard]] bool contain(const nurbs::Curve& curve) const {
    if (curves_.empty() || curve.points.empty()) return false;
    const std::vector<Vec3> points = SampledCurve(curve).points;
    const Vec3 &middle = points[points.size() / 2], around = Vec3::Constant(near_);
    bool is_there = false;
    tree_.meeting(Box3(middle - around, middle + around), [&](std::uint32_t i) {
      if (is_there) return;
      const SampledCurve sampled(curves_[i]);
      is_there = std::ranges::all_of(
          points, [&](const Vec3& p) { return sampled.nearest(p, near_).distance <= near_; });
    });
    return is_there;
  }

 private:
  double near_ = 0;
  std::vector<nurbs::Curve> curves_;
  BoxTree tree_{{}};
};

// What OpenCASCADE calls a product that has no name.
bool is_invented(std::string_view name) {
  return name.starts_with("Open CASCADE STEP translator");
}

using Indices = std::vector<std::size_t>;

// Things by the middles of their boxes.
class PlaceIndex {
 public:
  PlaceIndex(const std::vector<Thing>& things, const Indices& which) : things_(things), which_(which) {
    std::vector<Box3> middles;
    for (const std::size_t i : which) middles.emplace_back(things[i].box.center());
    tree_ = BoxTree(std::move(middles));
  }
  // The nearest one by its box's corners, at most `near` away; npos where there is none.
  [[nodiscard]] std::size_t nearest(const Thing& thing, double near, const std::vector<bool>& taken) const {
    std::size_t found = npos;
    const Vec3 middle = thing.box.center(), reach = Vec3::Constant(2 * near);
    tree_.meeting(Box3(middle - reach, middle + reach), [&](std::uint32_t k) {
      const std::size_t i = which_[k];
      const Thing& other = things_[i];
      if (taken[i] || (other.kind == Thing::Kind::curve) != (thing.kind == Thing::Kind::curve)) return;
      const double distance = std::max((other.box.min() - thing.box.min()).cwiseAbs().maxCoeff(),
                                       (other.box.max() - thing.box.max()).cwiseAbs().maxCoeff());
      if (distance > near || (distance == near && found != npos && i > found)) return;
      near = distance;
      found = i;
    });
    return found;
  }
  static constexpr std::size_t npos = std::numeric_limits<std::size_t>::max();

 private:
  const std::vector<Thing>& things_;
  const Indices& which_;
  BoxTree tree_{{}};
};

class Pairer {
 public:
  Pairer(const std::vector<Thing>& a, const std::vector<Thing>& b, double near)
      : a_(a), b_(b), near_(near), taken_a_(a.size()), taken_b_(b.size()) {}

  Pairing pair() {
    by_name();
    by_place(left(taken_a_), left(taken_b_));
    by_shape();
    by_neighbourhood();
    std::sort(pairing_.pairs.begin(), pairing_.pairs.end());
    pairing_.only_a = left(taken_a_);
    pairing_.only_b = left(taken_b_);
    return std::move(pairing_);
  }

 private:
  static Indices left(const std::vector<bool>& taken) {
    Indices out;
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i]) out.push_back(i);
    return out;
  }
  void take(std::size_t i, std::size_t j) {
    taken_a_[i] = taken_b_[j] = true;
    pairing_.pairs.emplace_back(i, j);
  }
  [[nodiscard]] bool same_sort(const Thing& a, const Thing& b) const {
    return (a.kind == Thing::Kind::curve) == (b.kind == Thing::Kind::curve);
  }

  void by_name() {
    struct Group {
      Indices a, b;
    };
    std::map<std::pair<std::string, bool>, Group> groups;
    for (std::size_t i = 0; i < a_.size(); ++i)
      if (!a_[i].name.empty()) groups[{a_[i].name, a_[i].kind == Thing::Kind::curve}].a.push_back(i);
    for (std::size_t j = 0; j < b_.size(); ++j)
      if (!b_[j].name.empty()) groups[{b_[j].name, b_[j].kind == Thing::Kind::curve}].b.push_back(j);
    for (const auto& [name, group] : groups) {
      if (group.a.size() == 1 && group.b.size() == 1)
        take(group.a.front(), group.b.front());
      else if (!group.a.empty() && !group.b.empty())
        for (const double share : {0.0, 1e-3, 0.03}) by_place(group.a, group.b, share);
    }
  }

  // `share`: of a thing's size, which its box may be off by where parameters run in another way.
  void by_place(const Indices& from, const Indices& to, double share = 0) {
    if (from.empty() || to.empty()) return;
    const PlaceIndex index(b_, to);
    for (const std::size_t i : from) {
      if (taken_a_[i]) continue;
      const double near = std::max(near_, share * a_[i].box.diagonal().norm());
      if (const std::size_t j = index.nearest(a_[i], near, taken_b_); j != PlaceIndex::npos) take(i, j);
    }
  }

  // Equal in everything that a motion leaves.
  [[nodiscard]] bool same_shape(const Thing& a, const Thing& b) const {
    if (!same_sort(a, b) || a.surfaces.size() != b.surfaces.size()) return false;
    if (std::abs(a.spread - b.spread) > std::max(near_, 1e-9 * a.spread)) return false;
    for (std::size_t k = 0; k < a.surfaces.size(); ++k) {
      const nurbs::Surface &s = *a.surfaces[k], &t = *b.surfaces[k];
      if (s.points.size() != t.points.size() || s.degree_u + s.degree_v != t.degree_u + t.degree_v)
        return false;
    }
    return true;
  }

  template <class Fits>
  void nearest_that(const Fits& fits) {
    const Indices from = left(taken_a_), to = left(taken_b_);
    if (from.empty() || to.empty() || from.size() > most_pairs / to.size()) return;
    for (const std::size_t i : from) {
      double best = std::numeric_limits<double>::infinity();
      std::size_t found = PlaceIndex::npos;
      for (const std::size_t j : to) {
        if (taken_b_[j]) continue;
        const double distance = (a_[i].box.center() - b_[j].box.center()).squaredNorm();
        if (distance >= best || !fits(a_[i], b_[j])) continue;
        best = distance;
        found = j;
      }
      if (found != PlaceIndex::npos) take(i, found);
    }
  }
  void by_shape() {
    nearest_that([this](const Thing& a, const Thing& b) { return same_shape(a, b); });
  }
  void by_neighbourhood() {
    nearest_that([this](const Thing& a, const Thing& b) {
      const double reach = 0.25 * std::min(a.box.diagonal().norm(), b.box.diagonal().norm());
      return same_sort(a, b) && a.surfaces.size() == b.surfaces.size() &&
             (a.box.min() - b.box.min()).norm() <= reach && (a.box.max() - b.box.max()).norm() <= reach;
    });
  }

  static constexpr std::size_t most_pairs = 400'000'000;
  const std::vector<Thing>& a_;
  const std::vector<Thing>& b_;
  double near_;
  std::vector<bool> taken_a_, taken_b_;
  Pairing pairing_;
};

}  // namespace

std::string_view name_of(Thing::Kind kind) {
  return std::array<std::string_view, 3>{"yarn", "part", "curve"}[static_cast<std::size_t>(kind)];
}

Things things_of(const Subject& subject, const Subject& other) {
  Things things;
  for (std::size_t i = 0; i < subject.model.parts.size(); ++i) {
    const Part& part = subject.model.parts[i];
    if (part.faces.empty()) continue;
    Thing& thing = things.list.emplace_back();
    thing.kind = i < subject.yarns ? Thing::Kind::yarn : Thing::Kind::part;
    thing.name = part.name;
    if (is_invented(thing.name)) thing.name.clear();
    // What is seen: faces have colours of their own above that of the whole. Of several the first one.
    thing.color = std::ranges::all_of(part.faces, [](const Face& face) { return face.color.has_value(); })
                      ? part.faces.front().color
                      : part.color;
    for (const Face& face : part.faces) {
      if (thing.name.empty() && part.faces.size() == 1) thing.name = is_invented(face.name) ? "" : face.name;
      if (!thing.color) thing.color = face.color;
      thing.faces.push_back(&face);
      thing.surfaces.push_back(&face.surface);
    }
    measure(thing);
  }
  std::optional<Outlines> outlines;
  if (!subject.model.curves.empty()) outlines.emplace(subject.model, other.model);
  for (const NamedCurve& curve : subject.model.curves) {
    if (outlines->contain(curve.curve)) continue;
    Thing& thing = things.list.emplace_back();
    thing.kind = Thing::Kind::curve;
    thing.name = curve.name;
    thing.color = curve.color;
    thing.surfaces.push_back(&things.curves.emplace_back(as_surface(curve.curve)));
    measure(thing);
  }
  return things;
}

Pairing pair_things(const std::vector<Thing>& a, const std::vector<Thing>& b, double near) {
  return Pairer(a, b, near).pair();
}

}  // namespace selvage::cad
