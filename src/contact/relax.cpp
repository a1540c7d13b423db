#include "contact/relax.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "contact/alike.h"
#include "contact/contact.h"
#include "contact/displacement_system.h"
#include "contact/near_skins.h"
#include "contact/section_shape.h"
#include "contact/strand.h"
#include "contact/ties.h"
#include "core/bounds.h"
#include "core/parallel.h"
#include "nurbs/divided.h"
#include "nurbs/measure.h"
#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::contact {

namespace {

// Of the smaller thickness: the gap that is made where none is asked for.
constexpr double default_gap = 0.01;
// Of the thinner yarn's thickness. Deeper in each other, two yarns do not tell which side is theirs.
constexpr double deepest = 0.55;
// Of the thickness: how far apart surfaces may be to be kept apart, and the longest step.
constexpr double reach_share = 0.04, step_share = 0.1;
// Steps without progress after which a cloth counts as jammed, and rounds of exact checks.
constexpr int patience = 20, most_verdicts = 12;

// Least and largest width of the sections' control polygons in their principal directions.
struct Extents {
  double least = infinity, most = 0;
};

Extents extents_of(const nurbs::Surface& s) {
  Extents extents;
  for (int j = 0; j < s.count_v; ++j) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i + 1 < s.count_u; ++i) centre += s.point(i, j) / (s.count_u - 1);
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (int i = 0; i + 1 < s.count_u; ++i)
      spread += (s.point(i, j) - centre) * (s.point(i, j) - centre).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    for (int axis = 1; axis < 3; ++axis) {
      double reach = 0.0;
      for (int i = 0; i + 1 < s.count_u; ++i)
        reach = std::max(reach, std::abs((s.point(i, j) - centre).dot(axes.eigenvectors().col(axis))));
      extents.least = std::min(extents.least, 2.0 * reach);
      extents.most = std::max(extents.most, 2.0 * reach);
    }
  }
  return extents;
}

// Convex, but so flat somewhere that bending it makes it concave.
bool has_flat_sides(const nurbs::Surface& s) {
  constexpr double flat = 2e-3;  // radians between neighbouring samples
  bool is_flat = false;
  for (const SectionShape& shape : section_shapes(s, nurbs::breakpoints(s.knots_v, s.degree_v)))
    is_flat = is_flat || (shape.least_turning > -turning_noise && shape.least_turning < flat);
  return is_flat;
}

// What the contacts say, as the state of a fabric.
RelaxState state_of(const Contacts& contacts) {
  RelaxState state;
  for (const Contact& contact : contacts.list) {
    if (!contact.is_overlap()) continue;
    ++state.overlaps;
    state.depth = std::max(state.depth, contact.depth());
  }
  state.min_gap = contacts.min_gap;
  return state;
}

// The body with another surface, and all that follows from it.
Result<yarn::Body> with_surface(const yarn::Body& before, const nurbs::Surface& surface) {
  yarn::Body body = before;
  body.surface = surface;
  body.axis = yarn::section_centres(body.surface);
  body.tight_bends.clear();
  if (Status done = yarn::finish(body, yarn::Sealings{{{before.start.style, {}}, {before.end.style, {}}}});
      !done)
    return done.error();
  return body;
}

// How far the section reaches inward in the tightest bend, in radii; 0 where the surface folds nowhere.
double tightness(const yarn::Body& body) {
  return body.tight_bends.empty() ? 0.0 : body.tight_bends.front().needed / body.tight_bends.front().radius;
}

class Relaxer {
 public:
  Relaxer(std::vector<yarn::Body> bodies, const RelaxOptions& options)
      : options_(options),
        originals_(std::move(bodies)),
        modes_(options.stiff_section ? translation_modes : all_modes) {
    const std::vector<std::size_t> first = yarn::first_of_shape(originals_);
    for (std::size_t y = 0; y < originals_.size(); ++y) {
      const nurbs::Surface& surface = originals_[y].surface;
      const bool is_new = first[y] == y;
      extents_.push_back(is_new ? extents_of(surface) : extents_[first[y]]);
      is_affine_.push_back(is_new ? (has_flat_sides(surface) ? 1 : 0) : is_affine_[first[y]]);
    }
    for (const Extents& extents : extents_) thinnest_ = std::min(thinnest_, extents.least);
  }

  Result<Relaxation> run() {
    Result<Contacts> contacts = survey(originals_);
    if (!contacts) return contacts.error();
    out_.before = state_of(*contacts);
    if (is_hopeless(*contacts)) return give_up(*contacts);
    if (!options_.make_contact && !has_narrow_gap(*contacts)) return unchanged();
    if (Status alike = move_alike(); !alike) return alike.error();
    if (out_.solved) return std::move(out_);
    Stiffness stiffness;
    // A bound that was passed is held more stiffly in another run.
    for (int attempt = 0;; ++attempt) {
      if (Status moved = move_apart(stiffness); !moved) return moved.error();
      if (!out_.solved) return std::move(out_);
      const std::string broken = broken_bound();
      if (broken.empty()) return std::move(out_);
      out_.solved = false;
      out_.reason = broken;
      if (attempt == 2) {
        if (Status back = retreat(); !back) return back.error();
        return std::move(out_);
      }
      for (std::size_t y = 0; y < originals_.size(); ++y)
        if (out_.changes[y].turning < 0.0) is_affine_[y] = 1;
      stiffness.stretch *= 5.0;
      stiffness.bend *= 3.0;
      stiffness.shape_bend *= 3.0;
    }
  }

 private:
  [[nodiscard]] double wanted(std::size_t a, std::size_t b) const {
    return options_.gap.value_or(default_gap * std::min(extents_[a].least, extents_[b].least));
  }
  [[nodiscard]] double largest_wanted() const {
    if (options_.gap) return *options_.gap;
    double most = 0.0;
    for (const Extents& extents : extents_) most = std::max(most, extents.least);
    return default_gap * most;
  }

  // Surfaces that are so near are kept apart.
  [[nodiscard]] double reach() const { return reach_share * thinnest_ + std::max(0.0, largest_wanted()); }

  [[nodiscard]] Result<Contacts> survey(std::span<const yarn::Body> bodies) const {
    ContactOptions options;
    options.reach = std::max(0.0, largest_wanted());
    options.threads = options_.threads;
    return find_contacts(bodies, options);
  }

  // Yarns that no small displacement can part.
  bool is_hopeless(const Contacts& contacts) {
    const double gap = options_.gap.value_or(0.0);
    for (std::size_t y = 0; y < originals_.size(); ++y)
      if (gap > 0.5 * extents_[y].least) {
        out_.reason = fmt::format(
            "a gap of {:.4g} is more than half the thickness of yarn '{}', {:.4g}: its section would vanish",
            gap, originals_[y].name, extents_[y].least);
        return true;
      }
    for (const Contact& contact : contacts.list) {
      const double least = std::min(extents_[contact.a].least, extents_[contact.b].least);
      if (contact.depth() <= deepest * least) continue;
      out_.reason = fmt::format(
          "yarns '{}' and '{}' run through each other: they overlap {:.4g} deep, more than half of the "
          "thickness {:.4g}, so that neither side is the nearer one",
          originals_[contact.a].name, originals_[contact.b].name, contact.depth(), least);
      return true;
    }
    return false;
  }

  // Nearer than the exact search may find two yarns in the end.
  [[nodiscard]] bool is_too_near(const Contact& contact) const {
    return contact.gap < (1.0 - 1e-3) * wanted(contact.a, contact.b);
  }

  [[nodiscard]] bool has_narrow_gap(const Contacts& contacts) const {
    return std::any_of(contacts.list.begin(), contacts.list.end(),
                       [&](const Contact& c) { return c.gap < wanted(c.a, c.b); });
  }

  void go_back() {
    out_.after = out_.before;
    out_.bodies = originals_;
    out_.changes.assign(originals_.size(), {});
  }
  Relaxation unchanged() {
    go_back();
    out_.solved = true;
    return std::move(out_);
  }

  Relaxation give_up(const Contacts& contacts) {
    go_back();
    list_jams(contacts);
    return std::move(out_);
  }

  void list_jams(const Contacts& contacts) {
    out_.jams.clear();
    std::map<std::pair<std::size_t, std::size_t>, Jam> worst;
    for (const Contact& contact : contacts.list) {
      if (contact.gap >= wanted(contact.a, contact.b)) continue;
      const auto [found, is_new] =
          worst.try_emplace({contact.a, contact.b}, Jam{contact.a, contact.b, contact.gap, contact.at});
      if (!is_new && contact.gap < found->second.gap)
        found->second = {contact.a, contact.b, contact.gap, contact.at};
    }
    for (const auto& [pair, jam] : worst) out_.jams.push_back(jam);
    std::stable_sort(out_.jams.begin(), out_.jams.end(),
                     [](const Jam& x, const Jam& y) { return x.gap < y.gap; });
  }

  // Of each yarn what else than shape and neighbours says how it moves: its places that do not.
  [[nodiscard]] std::vector<std::size_t> marks() const {
    std::vector<std::vector<double>> held(originals_.size());
    for (const FixedPoint& point : options_.fixed) held[point.yarn].push_back(point.parameter);
    std::map<std::vector<double>, std::size_t> numbers;
    std::vector<std::size_t> marks;
    marks.reserve(held.size());
    for (std::vector<double>& places : held)
      marks.push_back(numbers.try_emplace(std::move(places), numbers.size()).first->second);
    return marks;
  }

  // Where most yarns are copies with the same neighbours: moves a few for all. What comes of it is looked at
  // in the whole cloth; where anything is still too near nothing is done.
  Status move_alike() {
    if (!alike_.first.empty() || !options_.periods.empty()) return {};
    const Alike alike = find_alike(originals_, reach(), marks());
    if (3 * alike.few.size() > 2 * originals_.size()) return {};
    std::vector<std::size_t> places(originals_.size());  // of each yarn that stands for others, among the few
    std::vector<yarn::Body> bodies;
    RelaxOptions options = options_;
    options.fixed.clear();
    for (std::size_t k = 0; k < alike.few.size(); ++k) {
      places[alike.few[k]] = k;
      bodies.push_back(originals_[alike.few[k]]);
      for (FixedPoint point : options_.fixed)
        if (point.yarn == alike.few[k]) options.fixed.push_back({k, point.parameter});
    }
    Relaxer relaxer(std::move(bodies), options);
    for (const std::size_t y : alike.few) relaxer.alike_.first.push_back(places[alike.first[y]]);
    for (const auto& [pair, count] : alike.neighbours)
      relaxer.alike_.neighbours[{places[pair.first], places[pair.second]}] = count;
    Result<Relaxation> few = relaxer.run();
    if (!few || !few->solved) return {};
    std::vector<yarn::Body> moved;
    moved.reserve(originals_.size());
    for (std::size_t y = 0; y < originals_.size(); ++y) {
      const std::size_t first = alike.first[y], k = places[first];
      if (!few->bodies[k].messages.empty()) return {};  // it names the yarn
      moved.push_back(few->bodies[k]);
      static_cast<yarn::BodyLabel&>(moved[y]) = originals_[y];
      moved[y].shape = first + 1;
      if (y != first) yarn::move(moved[y], originals_[y].at - originals_[first].at, {});
      out_.changes.push_back(few->changes[k]);
    }
    out_.bodies = std::move(moved);
    Result<Contacts> contacts = survey(out_.bodies);
    if (!contacts) return contacts.error();
    out_.after = state_of(*contacts);
    out_.iterations = few->iterations;
    out_.solved = std::none_of(contacts->list.begin(), contacts->list.end(),
                               [&](const Contact& contact) { return is_too_near(contact); });
    if (!out_.solved) out_.iterations = 0;
    return {};
  }

  // Which bound the result does not keep; empty: it keeps them all.
  [[nodiscard]] std::string broken_bound() const {
    for (std::size_t y = 0; y < out_.changes.size(); ++y) {
      const YarnChange& change = out_.changes[y];
      const auto by = [&](std::string_view what, double value, double bound) {
        return fmt::format("{} of yarn '{}' would change by {:.3g} %, {:.3g} % are allowed", what,
                           originals_[y].name, 100.0 * value, 100.0 * bound);
      };
      if (std::abs(change.area) > area_bound) return by("a section's area", change.area, area_bound);
      if (std::abs(change.length) > length_bound) return by("the length", change.length, length_bound);
      if (std::abs(change.volume) > volume_bound) return by("the volume", change.volume, volume_bound);
      if (change.turning < 0.0)
        return fmt::format("a section of yarn '{}' that was convex would become concave", originals_[y].name);
      if (change.folding > folding_bound)
        return fmt::format("yarn '{}' would bend tighter than its section allows", originals_[y].name);
    }
    return {};
  }

  // Goes back toward the originals as far as the bounds ask for, and tells what is too near there.
  Status retreat() {
    const std::vector<nurbs::Surface> far = present();
    const auto between = [&](double share) {
      std::vector<nurbs::Surface> surfaces = first_;
      for (std::size_t y = 0; y < far.size(); ++y)
        for (std::size_t k = 0; k < far[y].points.size(); ++k)
          surfaces[y].points[k] += share * (far[y].points[k] - first_[y].points[k]);
      return surfaces;
    };
    double kept = 0.0, broken = 1.0;
    for (int k = 0; k < 6; ++k) {
      const double middle = 0.5 * (kept + broken);
      if (Status done = finish_bodies(between(middle)); !done) return done;
      (broken_bound().empty() ? kept : broken) = middle;
    }
    if (Status done = finish_bodies(between(kept)); !done) return done;
    return take_stock();
  }

  // What is too near where the bodies are now.
  Status take_stock() {
    Result<Contacts> contacts = survey(out_.bodies);
    if (!contacts) return contacts.error();
    out_.after = state_of(*contacts);
    list_jams(*contacts);
    return {};
  }

  // Steps from the originals on until every gap is wide enough, or nothing improves.
  Status move_apart(const Stiffness& stiffness) {
    strands_.clear();
    best_.clear();
    for (std::size_t y = 0; y < originals_.size(); ++y) {
      strands_.emplace_back(originals_[y], 0.6 * std::sqrt(extents_[y].least * extents_[y].most));
      if (is_affine_[y] != 0) strands_.back().allowed_fields = affine_fields;
    }
    first_ = present();
    DisplacementSystem system(strands_, lattices(), stiffness, modes_);
    NearSkins skins(strands_, [&](std::size_t a, std::size_t b) {
      return alike_.first.empty() || alike_.neighbours.contains(std::minmax(a, b));
    });
    for (const FixedPoint& point : options_.fixed) system.hold(point.yarn, point.parameter);
    double least_missing = infinity;
    int best = 0, verdicts = 0;
    for (int step = 0;; ++step, ++out_.iterations) {
      std::vector<Facing> facings = find(skins);
      double missing = -infinity;
      for (const Facing& f : facings) missing = std::max(missing, missing_in(f));
      if (options_.progress && !options_.progress(out_.iterations, missing))
        return stop("it was interrupted");
      if (missing <= 0.0) {
        Result<std::vector<Facing>> left = verdict();
        if (!left) return left.error();
        if (left->empty()) return {};
        if (++verdicts == most_verdicts) return stop("what is left between the yarns does not get wider");
        // What the samples overlooked joins this step; the next one finds it as it is then.
        facings.insert(facings.end(), left->begin(), left->end());
      } else if (missing < 0.9 * least_missing) {
        least_missing = missing;
        best = step;
        best_ = present();
      } else if (step - best > patience) {
        return stop("the yarns are jammed: no step brings them farther apart");
      }
      if (step == options_.max_iterations)
        return stop(fmt::format("{} steps were not enough", options_.max_iterations));
      make_step(system, facings, std::min(0.5, 0.15 + 0.03 * step));
    }
  }

  Lattices lattices() {
    if (alike_.first.empty()) return {tie_strands(strands_, options_.periods), {}};
    Lattices lattices;
    std::size_t count = 0;
    for (std::size_t y = 0; y < alike_.first.size(); ++y) {
      const std::size_t first = alike_.first[y];
      lattices.of.push_back(first == y ? count++ : lattices.of[first]);
      lattices.weights.push_back(first == y ? weight(y, y) : 0.0);
    }
    return lattices;
  }

  // How many pairs of neighbours two strands stand for.
  [[nodiscard]] double weight(std::size_t a, std::size_t b) const {
    if (alike_.first.empty()) return 1.0;
    return static_cast<double>(alike_.neighbours.at(std::minmax(a, b)));
  }

  void make_step(DisplacementSystem& system, const std::vector<Facing>& facings, double aim) {
    system.update(options_.threads);
    const Eigen::VectorXd x = system.solve(demands_of(facings, aim), options_.threads);
    std::vector<double> moves(strands_.size());
    const auto part = [&](std::size_t y) { return x.segment(system.offset(y), system.length(y)); };
    for_each_index(strands_.size(), options_.threads, [&](std::size_t y) {
      moves[y] = strands_[y].largest_move(part(y), modes_) / strands_[y].thickness();
    });
    const double largest = moves.empty() ? 0.0 : *std::max_element(moves.begin(), moves.end());
    const double factor = largest > step_share ? step_share / largest : 1.0;
    for_each_index(strands_.size(), options_.threads,
                   [&](std::size_t y) { strands_[y].move(part(y), modes_, factor); });
  }

  // How much is missing to the wanted gap; with make_contact also how much the surfaces are too far apart.
  [[nodiscard]] double missing_in(const Facing& f) const {
    const double goal = wanted(f.a, f.b);
    if (f.is_pulled) return std::abs(f.gap - goal) - 0.02 * std::abs(goal);
    return goal - f.gap;
  }

  std::vector<Facing> find(NearSkins& skins) const {
    std::vector<Facing> facings = skins.find(reach(), options_.threads);
    // The places where two surfaces are nearest lie between samples: one for each small cube of space.
    const double cube = 0.25 * thinnest_;
    std::map<std::array<long long, 5>, std::size_t> places;
    for (std::size_t k = 0; k < facings.size(); ++k) {
      const Facing& f = facings[k];
      if (!options_.make_contact && f.gap > 3.0 * std::max(0.0, wanted(f.a, f.b)) + 0.01 * thinnest_)
        continue;
      const Vec3 middle = 0.5 * (f.on_a + f.on_b) / cube;
      const auto [a, b] = std::minmax(f.a, f.b);
      const std::array<long long, 5> key = {a, b, std::llround(middle.x()), std::llround(middle.y()),
                                            std::llround(middle.z())};
      const auto [found, is_new] = places.try_emplace(key, k);
      if (!is_new && f.gap < facings[found->second].gap) found->second = k;
    }
    std::vector<std::size_t> chosen;
    chosen.reserve(places.size());
    for (const auto& [key, k] : places) chosen.push_back(k);
    std::vector<std::optional<Facing>> nearest(chosen.size());
    for_each_index(chosen.size(), options_.threads,
                   [&](std::size_t k) { nearest[k] = settled(strands_, facings[chosen[k]]); });
    for (std::optional<Facing>& f : nearest) {
      if (!f) continue;
      f->is_pulled = options_.make_contact && f->gap < 0.05 * thinnest_;
      facings.push_back(*f);
    }
    return facings;
  }

  [[nodiscard]] Demand::Side side(std::uint32_t y, const Vec2& site, const Vec3& point,
                                  const Vec3& direction) const {
    Demand::Side side;
    side.strand = y;
    const Stencil stencil = strands_[y].stencil(strands_[y].arc_of(site.y()));
    side.first = stencil.first;
    displacement_form(strands_[y].frame_at(site.y()), stencil, point, direction, modes_,
                      strands_[y].allowed_fields, side.form);
    return side;
  }

  [[nodiscard]] std::vector<Demand> demands_of(const std::vector<Facing>& facings, double aim) const {
    std::vector<Demand> demands(facings.size());
    for_each_index(facings.size(), options_.threads, [&](std::size_t k) {
      const Facing& f = facings[k];
      Demand& demand = demands[k];
      demand.plus = side(f.b, f.site_b, f.on_b, f.normal);
      demand.minus = side(f.a, f.site_a, f.on_a, f.normal);
      demand.is_equal = f.is_pulled;
      const double goal = wanted(f.a, f.b);
      demand.missing = goal + (f.is_pulled ? 0.0 : aim * std::abs(goal)) - f.gap;
      const double scale = std::sqrt(weight(f.a, f.b));
      demand.plus.form *= scale;
      demand.minus.form *= scale;
      demand.missing *= scale;
    });
    return demands;
  }

  // The place of a contact's point for the equations: one on an end face moves with the end.
  [[nodiscard]] Vec2 site_of(std::size_t y, const std::optional<Vec2>& site, const Vec3& point) const {
    if (site) return *site;
    const nurbs::Surface& s = strands_[y].body().surface;
    const double to_first = (point - strands_[y].row_frame(0).centre).norm();
    const double to_last = (point - strands_[y].row_frame(strands_[y].rows() - 1).centre).norm();
    return {s.first_u(), to_first < to_last ? s.first_v() : s.last_v()};
  }

  // The finished bodies, their changes, and what the exact search still finds too near.
  Result<std::vector<Facing>> verdict() {
    if (Status done = finish_bodies(present()); !done) return done.error();
    Result<Contacts> contacts = survey(out_.bodies);
    if (!contacts) return contacts.error();
    std::vector<Facing> left;
    for (const Contact& contact : contacts->list) {
      if (!is_too_near(contact)) continue;
      Facing f;
      f.a = static_cast<std::uint32_t>(contact.a);
      f.b = static_cast<std::uint32_t>(contact.b);
      f.on_a = contact.on_a;
      f.on_b = contact.on_b;
      f.normal = contact.direction;
      f.gap = contact.gap;
      f.site_a = site_of(contact.a, contact.site_a, contact.on_a);
      f.site_b = site_of(contact.b, contact.site_b, contact.on_b);
      left.push_back(f);
    }
    out_.after = state_of(*contacts);
    out_.solved = left.empty();
    return left;
  }

  Status stop(std::string reason) {
    out_.solved = false;
    out_.reason = std::move(reason);
    if (best_.empty()) best_ = present();
    if (Status done = finish_bodies(best_); !done) {
      // The surfaces went so far astray that they are no yarns any more: nothing is said of their gaps.
      go_back();
      return {};
    }
    return take_stock();
  }

  [[nodiscard]] std::vector<nurbs::Surface> present() const {
    std::vector<nurbs::Surface> surfaces;
    for (const Strand& strand : strands_) surfaces.push_back(strand.body().surface);
    return surfaces;
  }

  Status finish_bodies(const std::vector<nurbs::Surface>& surfaces) {
    out_.bodies.assign(originals_.size(), {});
    out_.changes.assign(originals_.size(), {});
    std::vector<std::optional<Message>> faults(originals_.size());
    for_each_index(originals_.size(), options_.threads,
                   [&](std::size_t y) { faults[y] = finish_body(y, surfaces[y]); });
    for (const std::optional<Message>& fault : faults)
      if (fault) return *fault;
    return {};
  }

  std::optional<Message> finish_body(std::size_t y, const nurbs::Surface& surface) {
    const yarn::Body& before = originals_[y];
    Result<yarn::Body> moved = with_surface(before, surface);
    if (!moved) return moved.error();
    out_.bodies[y] = std::move(*moved);
    const yarn::Body& body = out_.bodies[y];
    YarnChange& change = out_.changes[y];
    const nurbs::Curve old = yarn::section_centres(before.surface);
    change.length = nurbs::arc_length(body.axis) / nurbs::arc_length(old) - 1.0;
    change.volume = body.volume / before.volume - 1.0;
    const std::vector<double> places = nurbs::divided(body.surface.knots_v, body.surface.degree_v, 2);
    const std::vector<SectionShape> shapes = section_shapes(body.surface, places),
                                    old_shapes = section_shapes(before.surface, places);
    for (std::size_t k = 0; k < places.size(); ++k) {
      change.move = std::max(
          change.move, (nurbs::evaluate(old, places[k]) - nurbs::evaluate(body.axis, places[k])).norm());
      const double area = shapes[k].area / old_shapes[k].area - 1.0;
      if (std::abs(area) > std::abs(change.area)) change.area = area;
      if (shapes[k].least_turning < -turning_noise && old_shapes[k].least_turning > -turning_noise)
        change.turning = std::min(change.turning, shapes[k].least_turning);
    }
    if (body.tight_bends.empty()) return std::nullopt;
    // Measured like the moved one: bends of the path are not quite those of the line through the sections.
    const Result<yarn::Body> unmoved = with_surface(before, before.surface);
    if (!unmoved) return unmoved.error();
    change.folding = tightness(body) / tightness(*unmoved) - 1.0;
    return std::nullopt;
  }

  RelaxOptions options_;
  std::vector<yarn::Body> originals_;
  Alike alike_;  // of the originals, where these are few that stand for many; else empty
  std::vector<Extents> extents_;
  std::vector<char> is_affine_;  // one a yarn: its sections change by affine fields only
  std::vector<Strand> strands_;
  std::vector<nurbs::Surface> first_;  // of the strands before they moved
  std::vector<nurbs::Surface> best_;   // of the step that came nearest to the wanted gaps
  int modes_;
  double thinnest_ = infinity;
  Relaxation out_;
};

}  // namespace

Result<Relaxation> relax(std::vector<yarn::Body> bodies, const RelaxOptions& options) {
  for (const yarn::Body& body : bodies)
    if (body.surface.is_empty() || body.surface.count_v < 2)
      return error(Kind::geometry, fmt::format("yarn '{}' has no surface to move", body.name))
          .of_yarn(body.name);
  return Relaxer(std::move(bodies), options).run();
}

}  // namespace selvage::contact
