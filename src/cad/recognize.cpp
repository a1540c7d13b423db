#include "cad/recognize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include "cad/seal.h"
#include "cad/tube.h"
#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::cad {

namespace {

using yarn::EndStyle;

constexpr double sealing = 1e-4;  // of the end curve's extent: a border nearer than this seals

struct FaceId {
  std::size_t part = 0, face = 0;
};

struct Candidate {  // a tube
  FaceId id;
  Tube tube;
};

struct Lid {  // a face that may seal one
  FaceId id;
  Cap cap;
  bool used = false;
};

// Lids by the middle of their borders.
class LidIndex {
 public:
  explicit LidIndex(const std::vector<Lid>& lids) : lids_(lids) {
    std::vector<double> sizes;
    for (const Lid& lid : lids) sizes.push_back(lid.cap.size);
    if (!sizes.empty()) {
      std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2),
                       sizes.end());
      cell_ = std::max(0.1 * sizes[sizes.size() / 2], 1e-300);
    }
    for (std::size_t i = 0; i < lids.size(); ++i) cells_.emplace(key(cell_of(lids[i].cap.middle)), i);
  }

  // Those whose middle is within `reach` of p; where that is many cells, those of the neighbouring cells.
  [[nodiscard]] std::vector<std::size_t> near(const Vec3& p, double reach) const {
    std::vector<std::size_t> found;
    const auto rings = static_cast<std::int64_t>(std::clamp(std::ceil(reach / cell_), 1.0, 4.0));
    const Cell middle = cell_of(p);
    for (std::int64_t x = -rings; x <= rings; ++x)
      for (std::int64_t y = -rings; y <= rings; ++y)
        for (std::int64_t z = -rings; z <= rings; ++z) {
          const auto [from, to] = cells_.equal_range(key({middle[0] + x, middle[1] + y, middle[2] + z}));
          for (auto at = from; at != to; ++at)
            if ((lids_[at->second].cap.middle - p).norm() <= reach) found.push_back(at->second);
        }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell_of(const Vec3& p) const {
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k)
      cell[k] = static_cast<std::int64_t>(
          std::clamp(std::floor(p[static_cast<Eigen::Index>(k)] / cell_), -1e15, 1e15));
    return cell;
  }
  static std::uint64_t key(const Cell& cell) {
    std::uint64_t hash = 0;
    for (const std::int64_t part : cell)
      hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15ULL;
    return hash;
  }

  const std::vector<Lid>& lids_;
  double cell_ = 1;
  std::unordered_multimap<std::uint64_t, std::size_t> cells_;
};

// The line through the middles of the sections' control points.
nurbs::Curve centre_line(const nurbs::Surface& surface) {
  nurbs::Curve line;
  line.degree = surface.degree_v;
  line.knots = surface.knots_v;
  for (int j = 0; j < surface.count_v; ++j) {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i + 1 < surface.count_u; ++i) sum += surface.point(i, j);
    line.points.emplace_back(sum / (surface.count_u - 1));
  }
  return line;
}

class Recognizer {
 public:
  explicit Recognizer(std::vector<Part> parts) : parts_(std::move(parts)) {
    taken_.resize(parts_.size());
    for (std::size_t p = 0; p < parts_.size(); ++p) taken_[p].resize(parts_[p].faces.size());
  }

  Recognized run() {
    sort_faces();
    const LidIndex index(lids_);
    for (Candidate& candidate : tubes_) take(candidate, index);
    keep_rest();
    name_all();
    return std::move(out_);
  }

 private:
  void sort_faces() {
    for (std::size_t p = 0; p < parts_.size(); ++p)
      for (std::size_t f = 0; f < parts_[p].faces.size(); ++f) {
        const Face& face = parts_[p].faces[f];
        if (face.surface.is_empty()) continue;
        std::optional<Tube> tube;
        if (face.loops.empty()) tube = as_tube(face.surface);
        if (tube)
          tubes_.push_back({{p, f}, std::move(*tube)});
        else if (std::optional<Cap> cap = as_cap(face))
          lids_.push_back({{p, f}, std::move(*cap)});
      }
  }

  struct Sealed {
    std::size_t lid = 0;
    Fit fit;
  };
  // The best lid for one end.
  std::optional<Sealed> find_lid(const Candidate& candidate, const LidIndex& index,
                                 const nurbs::Curve& outline, std::optional<std::size_t> other) {
    const double size = extent(outline.points), tolerance = sealing * size;
    const Vec3 middle = middle_of({outline});
    std::optional<Sealed> best;
    double best_cost = 0;
    for (const std::size_t i : index.near(middle, 0.3 * size)) {
      const Lid& lid = lids_[i];
      if (lid.used || other == i) continue;
      const bool is_own = lid.id.part == candidate.id.part;
      // A solid's faces are its own.
      if (!is_own && (parts_[lid.id.part].kind == Part::Kind::solid ||
                      parts_[candidate.id.part].kind == Part::Kind::solid))
        continue;
      std::optional<Fit> fit = fit_cap(lid.cap, outline, tolerance);
      if (!fit) continue;
      const double cost =
          (lid.cap.middle - middle).norm() + (is_own ? 0.0 : size) + (fit->exact ? 0.0 : 0.1 * size);
      if (best && cost >= best_cost) continue;
      best_cost = cost;
      best = Sealed{i, std::move(*fit)};
    }
    return best;
  }

  void describe(yarn::Body& body, const Candidate& candidate) const {
    const Part& part = parts_[candidate.id.part];
    const Face& face = part.faces[candidate.id.face];
    body.name = !part.name.empty() ? part.name : face.name;
    body.is_named = !body.name.empty();
    body.is_colored = face.color || part.color;
    body.group = part.group;
    body.place = part.origin.place.line != 0 ? part.origin.place : face.origin.place;
    if (face.color || part.color) body.color = face.color ? *face.color : *part.color;
    const int level = part.level != 0 ? part.level : face.level;
    if (level >= 1 && level <= static_cast<int>(yarn::all_roles.size()))
      body.role = yarn::all_roles[static_cast<std::size_t>(level - 1)];
  }

  void warn(const yarn::Body& body, std::string text) {
    Message message = warning(Kind::geometry, std::move(text));
    message.yarn = body.name;
    message.place = body.place;
    out_.messages.push_back(std::move(message));
  }

  void take(Candidate& candidate, const LidIndex& index) {
    yarn::Body body;
    describe(body, candidate);
    body.surface = std::move(candidate.tube.surface);
    body.closed_along = candidate.tube.closed_along;
    body.axis = centre_line(body.surface);
    std::array<std::optional<Sealed>, 2> ends;
    if (!body.closed_along) {
      ends[0] = find_lid(candidate, index, yarn::end_curve(body, false), std::nullopt);
      ends[1] = find_lid(candidate, index, yarn::end_curve(body, true),
                         ends[0] ? std::optional(ends[0]->lid) : std::nullopt);
    }
    if (!is_whole(candidate, ends)) return;
    if (!place(body, ends)) return;
    taken_[candidate.id.part][candidate.id.face] = true;
    for (const std::optional<Sealed>& end : ends) {
      if (!end) continue;
      Lid& lid = lids_[end->lid];
      lid.used = true;
      taken_[lid.id.part][lid.id.face] = true;
    }
    out_.yarns.push_back(std::move(body));
  }

  // A solid is a yarn as a whole or not at all.
  [[nodiscard]] bool is_whole(const Candidate& candidate,
                              const std::array<std::optional<Sealed>, 2>& ends) const {
    const Part& part = parts_[candidate.id.part];
    if (part.kind != Part::Kind::solid) return true;
    const auto faces = static_cast<std::size_t>(1 + (ends[0] ? 1 : 0) + (ends[1] ? 1 : 0));
    return faces == part.faces.size();
  }

  bool place(yarn::Body& body, std::array<std::optional<Sealed>, 2>& ends) {
    set_quarters(body, ends);
    bool anew = false;
    for (const bool last : {false, true}) {
      const std::optional<Sealed>& end = ends[last ? 1 : 0];
      if (!end) continue;
      const bool fits =
          end->fit.exact && (end->fit.face.style != EndStyle::patch || end->fit.quarters == body.quarters);
      anew = anew || !fits;
      (last ? body.end : body.start) = end->fit.face;
    }
    if (!anew) return yarn::finish_as_sealed(body).ok();
    const EndStyle style = ends[0] ? ends[0]->fit.face.style : ends[1]->fit.face.style;
    if (!yarn::finish(body, style).ok()) return false;
    if (!ends[0]) body.start = {};
    if (!ends[1]) body.end = {};
    warn(body,
         fmt::format("the end faces of yarn '{}' are made anew: their sides do not run as its end curves do",
                     body.name));
    return true;
  }

  static void set_quarters(yarn::Body& body, const std::array<std::optional<Sealed>, 2>& ends) {
    for (const std::optional<Sealed>& end : ends)
      if (end && end->fit.exact && end->fit.face.style == EndStyle::patch) {
        body.quarters = end->fit.quarters;
        return;
      }
    body.quarters = yarn::quarters_of(body.surface);
  }

  void keep_rest() {
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      Part& part = parts_[p];
      std::vector<Face> left;
      for (std::size_t f = 0; f < part.faces.size(); ++f)
        if (!taken_[p][f]) left.push_back(std::move(part.faces[f]));
      if (left.empty() && !part.faces.empty()) continue;
      part.faces = std::move(left);
      out_.rest.push_back(std::move(part));
    }
  }

  void name_all() {
    std::unordered_set<std::string> names;
    for (const yarn::Body& body : out_.yarns) names.insert(body.name);
    std::unordered_set<std::string> given;
    std::unordered_map<std::string, std::size_t> next;
    for (std::size_t i = 0; i < out_.yarns.size(); ++i) {
      std::string& name = out_.yarns[i].name;
      if (!name.empty() && given.insert(name).second) continue;
      const std::string stem = name.empty() ? "yarn_" : name + ".";
      std::size_t& number = next.try_emplace(stem, name.empty() ? i + 1 : 2).first->second;
      std::string made = stem + std::to_string(number);
      while (names.contains(made)) made = stem + std::to_string(++number);
      ++number;
      names.insert(made);
      given.insert(made);
      name = std::move(made);
    }
  }

  std::vector<Part> parts_;
  std::vector<std::vector<bool>> taken_;  // by part and face
  std::vector<Candidate> tubes_;
  std::vector<Lid> lids_;
  Recognized out_;
};

}  // namespace

Recognized recognize_yarns(std::vector<Part> parts) {
  return Recognizer(std::move(parts)).run();
}

}  // namespace selvage::cad
