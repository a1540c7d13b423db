#include "cad/recognize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>

#include "cad/lid.h"
#include "cad/sampled_curve.h"
#include "cad/tube.h"
#include "core/box_tree.h"
#include "nurbs/divided.h"
#include "nurbs/measure.h"
#include "nurbs/turn.h"
#include "yarn/ends.h"

namespace selvage::cad {

namespace {

constexpr std::size_t nothing = std::numeric_limits<std::size_t>::max();
// Of one face at a time: a file of many equal yarns in one place must not cost their square.
constexpr std::size_t most_trials = 64;
// Each leaves about a tenth of the equal yarns of one place.
constexpr int most_rounds = 8;

// A tube that is not complete by its part alone.
struct Tube {
  std::size_t part = 0, face = 0;
  std::size_t order = 0;  // of the face in the file
  TubeKind kind;
  yarn::Body body;
  std::array<std::size_t, 2> lids{nothing, nothing};
};
// Any other face of such parts.
struct Candidate {
  std::size_t part = 0, face = 0, order = 0;
  bool taken = false;
};
// A candidate that fits an end. Smaller is better.
struct Fit {
  std::size_t tube = 0, candidate = 0;
  bool last = false;
  bool other_part = false, other_name = false, inexact = false, other_look = false;
  std::size_t distance = 0;  // in the order of the file
  Lid lid;

  [[nodiscard]] auto rank() const {
    return std::tuple(other_part, other_name, inexact, other_look, distance, tube, last, candidate);
  }
};

bool has_patch(const yarn::Body& body) {
  return body.start.style == yarn::EndStyle::patch || body.end.style == yarn::EndStyle::patch;
}

// Brings a lid to its end. `other` counts the ends that are sealed by something that no end face can be.
void seal_end(yarn::Body& body, bool last, Lid& lid, std::array<bool, 2>& other) {
  if (lid.face.style == yarn::EndStyle::patch) {
    if (has_patch(body) && body.quarters != lid.quarters)
      lid.face = {};  // its corners do not stand where those of the other end do
    else
      body.quarters = lid.quarters;
  }
  other[last ? 1 : 0] = lid.face.style == yarn::EndStyle::none;
  (last ? body.end : body.start) = std::move(lid.face);
}

// Ends that are sealed by something else get a standard face: the first style that works.
bool replace_ends(yarn::Body& body, const std::array<bool, 2>& other) {
  if (!other[0] && !other[1]) return false;
  yarn::Body trial;
  trial.name = body.name;
  trial.surface = body.surface;
  trial.axis = body.axis;
  trial.quarters = body.quarters;
  for (const yarn::EndStyle style : {yarn::EndStyle::patch, yarn::EndStyle::fan}) {
    if (!yarn::seal(trial, style)) continue;
    if (other[0]) body.start = trial.start;
    if (other[1]) body.end = trial.end;
    break;
  }
  return true;
}

Box3 box_of_outline(const Polylines& outline) {
  Box3 box;
  for (const std::vector<Vec3>& line : outline) box.extend(cad::box_of(line));
  return box;
}

// Outlines by their places, among those of like size.
class Places {
 public:
  struct Outline {
    Box3 box;
    std::size_t id = 0;
  };
  explicit Places(const std::vector<Outline>& outlines) {
    std::map<int, std::vector<Box3>> middles;
    for (const Outline& outline : outlines) {
      middles[level_of(outline.box)].emplace_back(outline.box.center());
      levels_[level_of(outline.box)].ids.push_back(outline.id);
    }
    for (auto& [level, boxes] : middles) levels_[level].tree = BoxTree(std::move(boxes));
  }
  // The ids of those whose box may be this one: middles within a quarter of the diagonal, diagonals within a
  // factor of four; sorted.
  [[nodiscard]] std::vector<std::size_t> near(const Box3& box) const {
    const double reach = 0.25 * box.diagonal().norm();
    std::vector<std::size_t> ids;
    for (auto level = levels_.lower_bound(level_of(box) - 1);
         level != levels_.end() && level->first <= level_of(box) + 1; ++level)
      level->second.tree.near_point(box.center(), reach, [&](std::uint32_t k) {
        ids.push_back(level->second.ids[k]);
        return reach;
      });
    std::sort(ids.begin(), ids.end());
    return ids;
  }

 private:
  // Diagonals of a level are at least 2^level long, and less than twice that.
  static int level_of(const Box3& box) { return std::clamp(std::ilogb(box.diagonal().norm()), -1100, 1100); }
  struct Level {
    BoxTree tree{{}};
    std::vector<std::size_t> ids;
  };
  std::map<int, Level> levels_;
};

class Recognizer {
 public:
  Recognizer(Model& model, Diagnostics& diagnostics) : model_(model), diagnostics_(diagnostics) {}

  std::vector<FoundYarn> take() {
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const std::size_t faces = model_.parts[p].faces.size();
      if (!take_part(p)) collect(p);
      order_ += faces;
    }
    match_loose();
    finish_loose();
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Ordered& a, const Ordered& b) { return a.order < b.order; });
    std::erase_if(model_.parts, [](const Part& part) { return part.faces.empty(); });
    warn();
    std::vector<FoundYarn> yarns;
    yarns.reserve(found_.size());
    for (Ordered& found : found_) yarns.push_back(std::move(found.yarn));
    return yarns;
  }

 private:
  struct Ordered {
    std::size_t order;
    FoundYarn yarn;
  };

  // The face, clamped.
  static const Face& clamped(const Face& face, std::optional<Face>& made) {
    const nurbs::Surface& s = face.surface;
    if (nurbs::is_clamped(s.knots_u, s.degree_u) && nurbs::is_clamped(s.knots_v, s.degree_v)) return face;
    made = face;
    made->surface = nurbs::clamped(s);
    return *made;
  }

  // A part that is one yarn and nothing else.
  bool take_part(std::size_t index) {
    Part& part = model_.parts[index];
    if (part.faces.size() != 1 && part.faces.size() != 3) return false;
    std::array<std::optional<Face>, 3> made;
    std::array<const Face*, 3> faces{};
    std::optional<TubeKind> kind;
    std::size_t tube = nothing;
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      faces[f] = &clamped(part.faces[f], made[f]);
      std::optional<TubeKind> found = tube_kind(*faces[f], model_.resolution);
      if (found && tube != nothing) return false;
      if (!found) continue;
      tube = f;
      kind = found;
    }
    if (tube == nothing || kind->is_ring != (part.faces.size() == 1)) return false;
    yarn::Body body = body_of(faces[tube]->surface, *kind);
    std::array<bool, 2> other{};
    if (!kind->is_ring) {
      const TubeEnd start(body, false, kind->tolerance), end(body, true, kind->tolerance);
      const std::size_t a = tube == 0 ? 1 : 0, b = tube == 2 ? 1 : 2;
      std::array<std::optional<Lid>, 2> lids = {lid_of(*faces[a], start), lid_of(*faces[b], end)};
      if (!lids[0] || !lids[1]) lids = {lid_of(*faces[b], start), lid_of(*faces[a], end)};
      if (!lids[0] || !lids[1]) return false;
      for (const bool last : {false, true}) seal_end(body, last, *lids[last ? 1 : 0], other);
    }
    add(std::move(body), other, part, part.faces[tube], order_ + tube);
    part.faces.clear();
    return true;
  }

  void add(yarn::Body body, const std::array<bool, 2>& other, const Part& part, const Face& side,
           std::size_t order) {
    body.name = !part.name.empty() ? part.name : side.name;
    body.group = part.group;
    body.color = part.color ? *part.color : side.color.value_or(yarn::Color{});
    body.is_named = !body.name.empty();
    body.resolution = model_.resolution;
    body.is_colored = part.color || side.color;
    body.role = role_of(part.level != 0 ? part.level : side.level);
    body.place = part.origin.place.line > 0 ? part.origin.place : side.origin.place;
    if (replace_ends(body, other) && replaced_++ == 0) first_replaced_ = body.name;
    found_.push_back({order, {std::move(body), part.kind == Part::Kind::solid}});
  }

  // As our files have it: levels by role, each with its name.
  [[nodiscard]] yarn::Role role_of(int level) const {
    const auto index = static_cast<std::size_t>(level) - 1;
    const auto name = model_.levels.find(level);
    if (level < 1 || index >= yarn::all_roles.size() || name == model_.levels.end() ||
        name->second != yarn::name_of(yarn::all_roles[index]))
      return yarn::Role::other;
    return yarn::all_roles[index];
  }

  // The faces of a part whose surfaces may belong to anything.
  void collect(std::size_t index) {
    const Part& part = model_.parts[index];
    if (part.kind != Part::Kind::surfaces) return;
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      std::optional<Face> made;
      const Face& face = clamped(part.faces[f], made);
      if (std::optional<TubeKind> kind = tube_kind(face, model_.resolution))
        tubes_.push_back({index, f, order_ + f, *kind, body_of(face.surface, *kind), {nothing, nothing}});
      else
        candidates_.push_back({index, f, order_ + f, false});
    }
  }

  void match_loose() {
    sealed_by_other_.resize(tubes_.size());
    if (tubes_.empty()) return;
    // Where more ends are in one place than are tried of a face, what is left over is tried again.
    for (int round = 0; round < most_rounds && match_free(); ++round) continue;
  }

  [[nodiscard]] bool is_free(std::size_t tube, bool last) const {
    return !tubes_[tube].kind.is_ring && tubes_[tube].lids[last ? 1 : 0] == nothing;
  }

  // Brings faces to the ends that have none yet. True where that may leave some that another call finds.
  bool match_free() {
    std::vector<Places::Outline> ends;
    for (std::size_t t = 0; t < tubes_.size(); ++t)
      for (const bool last : {false, true}) {
        if (!is_free(t, last)) continue;
        const nurbs::Curve outline = yarn::end_curve(tubes_[t].body, last);
        ends.push_back({box_of_outline({SampledCurve(outline).points}), 2 * t + (last ? 1 : 0)});
      }
    const Places places(ends);
    std::vector<Fit> fits;
    bool all_tried = true;
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (!candidates_[c].taken && !find_fits(places, c, fits)) all_tried = false;
    std::sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.rank() < b.rank(); });
    for (Fit& fit : fits) {
      if (!is_free(fit.tube, fit.last) || candidates_[fit.candidate].taken) continue;
      Tube& tube = tubes_[fit.tube];
      tube.lids[fit.last ? 1 : 0] = fit.candidate;
      candidates_[fit.candidate].taken = true;
      seal_end(tube.body, fit.last, fit.lid, sealed_by_other_[fit.tube]);
    }
    return !all_tried && !fits.empty();
  }

  // False where ends are near that were not tried.
  bool find_fits(const Places& places, std::size_t index, std::vector<Fit>& fits) {
    const Candidate& candidate = candidates_[index];
    const Part& part = model_.parts[candidate.part];
    std::optional<Face> made;
    const Face& face = clamped(part.faces[candidate.face], made);
    const Polylines border = border_of(face, 0);
    if (border.empty()) return true;
    std::vector<std::size_t> near = places.near(box_of_outline(border));
    const auto distance = [&](std::size_t end) {
      const std::size_t order = tubes_[end / 2].order;
      return order > candidate.order ? order - candidate.order : candidate.order - order;
    };
    std::stable_sort(near.begin(), near.end(),
                     [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    const bool all_tried = near.size() <= most_trials;
    if (!all_tried) near.resize(most_trials);
    for (const std::size_t end : near) {
      const Tube& tube = tubes_[end / 2];
      const bool last = end % 2 == 1;
      std::optional<Lid> lid = lid_of(face, TubeEnd(tube.body, last, tube.kind.tolerance));
      if (!lid) continue;
      const Part& home = model_.parts[tube.part];
      const Face& side = home.faces[tube.face];
      Fit fit;
      fit.tube = end / 2;
      fit.candidate = index;
      fit.last = last;
      fit.other_part = tube.part != candidate.part;
      fit.other_name = side.name.empty() || side.name != face.name;
      fit.inexact = lid->gap > 0;
      fit.other_look = side.level != face.level || side.color != face.color;
      fit.distance = distance(end);
      fit.lid = std::move(*lid);
      fits.push_back(std::move(fit));
    }
    return all_tried;
  }

  // The rings round faces that are no lids: each loop, or each closed side of a whole surface; and free ends
  // of tubes.
  void find_rings() {
    const auto add_rings = [&](const Face& face) {
      if (face.loops.empty()) {
        for (std::vector<Vec3>& line : border_of(face, 0)) rings_.push_back({{std::move(line)}, nothing});
        return;
      }
      Face one;
      one.surface = face.surface;
      for (const Loop& loop : face.loops) {
        one.loops = {loop};
        rings_.push_back({border_of(one, 0), nothing});
      }
    };
    for (const Candidate& candidate : candidates_) {
      if (candidate.taken) continue;
      std::optional<Face> made;
      add_rings(clamped(model_.parts[candidate.part].faces[candidate.face], made));
    }
    for (std::size_t t = 0; t < tubes_.size(); ++t)
      for (const bool last : {false, true})
        if (is_free(t, last))
          rings_.push_back({{SampledCurve(yarn::end_curve(tubes_[t].body, last)).points}, t});
    std::vector<Places::Outline> outlines;
    for (std::size_t k = 0; k < rings_.size(); ++k)
      if (!rings_[k].lines.empty()) outlines.push_back({box_of_outline(rings_[k].lines), k});
    places_of_rings_.emplace(outlines);
  }

  // Does another face go on from one of the tube's free ends, as the rim of a cup from its walls?
  [[nodiscard]] bool goes_on(std::size_t index) const {
    const Tube& tube = tubes_[index];
    for (const bool last : {false, true}) {
      if (!is_free(index, last)) continue;
      const TubeEnd end(tube.body, last, tube.kind.tolerance);
      const auto is_on_it = [&](const std::vector<Vec3>& line) {
        return std::ranges::all_of(
            line, [&](const Vec3& p) { return end.samples().nearest(p).distance <= tube.kind.tolerance; });
      };
      for (const std::size_t k : places_of_rings_->near(box_of_outline({end.samples().points}))) {
        if (rings_[k].tube == index) continue;
        double length = 0;
        for (const std::vector<Vec3>& line : rings_[k].lines)
          if (is_on_it(line)) length += nurbs::length_of(line);
        if (length > end.samples().length() / 2) return true;
      }
    }
    return false;
  }

  // Whether an open tube is a yarn: it is the one tube of a small group, and has the role of a yarn; or
  // nothing goes on from its free ends, and it has a face at one end and is longer than thick, or the file
  // has such tubes alone: among other surfaces, it is the side of a hole, of a pin or of a disc as a rule.
  [[nodiscard]] bool is_open_yarn(std::size_t index) const {
    const Tube& tube = tubes_[index];
    const Part& part = model_.parts[tube.part];
    if (part.faces.size() > 3 || tubes_of_part_.at(tube.part) != 1) return false;
    if (role_of(part.level != 0 ? part.level : part.faces[tube.face].level) != yarn::Role::other) return true;
    const bool has_lid = tube.lids[0] != nothing || tube.lids[1] != nothing;
    return ((has_lid && nurbs::arc_length(tube.body.axis) > tube.kind.size) || only_tubes_) &&
           !goes_on(index);
  }

  // Is there nothing but tubes, their end faces, and parts that are yarns?
  [[nodiscard]] bool has_only_tubes() const {
    return std::ranges::all_of(candidates_, &Candidate::taken) &&
           std::ranges::none_of(model_.parts, [](const Part& part) {
             return part.kind != Part::Kind::surfaces && !part.faces.empty();
           });
  }

  void finish_loose() {
    for (const Tube& tube : tubes_) ++tubes_of_part_[tube.part];
    only_tubes_ = has_only_tubes();
    bool has_free_end = false;
    for (std::size_t t = 0; t < tubes_.size(); ++t)
      has_free_end = has_free_end || is_free(t, false) || is_free(t, true);
    if (has_free_end) find_rings();
    std::vector<std::pair<std::size_t, std::size_t>> taken;  // part, face
    for (std::size_t t = 0; t < tubes_.size(); ++t) {
      Tube& tube = tubes_[t];
      const bool is_sealed = tube.kind.is_ring || (tube.lids[0] != nothing && tube.lids[1] != nothing);
      if (!is_sealed && !is_open_yarn(t)) continue;  // what it took belongs to no yarn
      const Part& part = model_.parts[tube.part];
      taken.emplace_back(tube.part, tube.face);
      std::size_t own = 1;
      for (const std::size_t lid : tube.lids) {
        if (lid == nothing) continue;
        taken.emplace_back(candidates_[lid].part, candidates_[lid].face);
        if (candidates_[lid].part == tube.part) ++own;
      }
      if (!is_sealed && own < part.faces.size() && misfits_++ == 0) first_misfit_ = part.name;
      if (!is_sealed && own == part.faces.size() && loose_++ == 0)
        first_loose_ = !part.name.empty() ? part.name : part.faces[tube.face].name;
      add(std::move(tube.body), sealed_by_other_[t], part, part.faces[tube.face], tube.order);
    }
    leftover_ = candidates_.size() + tubes_.size() - taken.size();
    std::sort(taken.begin(), taken.end(), std::greater<>());
    for (const auto& [part, face] : taken)
      model_.parts[part].faces.erase(model_.parts[part].faces.begin() + static_cast<std::ptrdiff_t>(face));
  }

  void warn() {
    const auto say = [&](std::string text) {
      Message message = warning(Kind::geometry, std::move(text));
      message.file = model_.file;
      diagnostics_.add(std::move(message));
    };
    const auto yarns = [](std::size_t count, const std::string& name) {
      return fmt::format("{} yarn{}{}", count, count == 1 ? "" : "s",
                         name.empty() ? "" : fmt::format(", such as '{}',", name));
    };
    const auto have = [](std::size_t count) { return count == 1 ? "has" : "have"; };
    if (replaced_ > 0)
      say(
          fmt::format("{} {} ends that are sealed by other faces than patches, fans and planes: these were "
                      "replaced",
                      yarns(replaced_, first_replaced_), have(replaced_)));
    if (misfits_ > 0)
      say(
          fmt::format("{} {} open ends: faces of the same group do not meet them, and are kept as free "
                      "surfaces",
                      yarns(misfits_, first_misfit_), have(misfits_)));
    if (loose_ > 0 && leftover_ > 0)
      say(fmt::format("{} {} open ends: no surface of the file meets them", yarns(loose_, first_loose_),
                      have(loose_)));
  }

  Model& model_;
  Diagnostics& diagnostics_;
  std::size_t order_ = 0;  // of the present part's first face
  std::vector<Ordered> found_;
  std::vector<Tube> tubes_;
  std::vector<Candidate> candidates_;
  std::vector<std::array<bool, 2>> sealed_by_other_;
  std::unordered_map<std::size_t, std::size_t> tubes_of_part_;
  bool only_tubes_ = false;
  struct Ring {
    Polylines lines;
    std::size_t tube = nothing;  // whose free end it is
  };
  std::vector<Ring> rings_;
  std::optional<Places> places_of_rings_;
  std::size_t replaced_ = 0, misfits_ = 0, loose_ = 0, leftover_ = 0;
  std::string first_replaced_, first_misfit_, first_loose_;
};

}  // namespace

std::vector<FoundYarn> take_yarns(Model& model, Diagnostics& diagnostics) {
  return Recognizer(model, diagnostics).take();
}

}  // namespace selvage::cad
