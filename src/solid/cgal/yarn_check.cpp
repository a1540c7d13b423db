#include "solid/cgal/yarn_check.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/module.h"
#include "solid/cgal/verdict.h"

namespace selvage::solid {

namespace {

void add_defect(const yarn::Body& body, YarnCheck& check, std::string text,
                const std::optional<Vec3>& at = {}) {
  check.defects.push_back(error(Kind::geometry, std::move(text), about(body, at)));
}

const char* side_of(bool last) {
  return last ? "end" : "start";
}

// What an end's edge may be away from the body: rounding; for a trimmed plane also the flatness that the
// builder asks of an outline (1e-9 of the coordinates).
double allowed_gap(const yarn::Body& body, bool last) {
  const double gap = sewing_gap(body);
  const bool planar = (last ? body.end : body.start).style == yarn::EndStyle::planar;
  return planar ? std::max(gap, gap / (16.0 * std::numeric_limits<double>::epsilon()) * 2e-9) : gap;
}

// The middle of an edge that only one triangle has.
std::optional<Vec3> find_border(const Tessellation& skin) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : skin.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  for (const auto& [edge, count] : uses)
    if (count == 1) return 0.5 * (skin.vertices[edge.first] + skin.vertices[edge.second]);
  return std::nullopt;
}

// True when a gap or a missing face was named.
bool name_gaps(const yarn::Body& body, YarnCheck& check) {
  bool named = false;
  if (body.closed_along) return named;
  for (bool last : {false, true}) {
    const yarn::EndFace& face = last ? body.end : body.start;
    if (face.style == yarn::EndStyle::none) {
      add_defect(body, check,
                 fmt::format("open: yarn '{}' has no face at its {}; seal it with --ends patch", body.name,
                             side_of(last)),
                 nurbs::evaluate(body.surface, body.surface.first_u(),
                                 last ? body.surface.last_v() : body.surface.first_v()));
      named = true;
      continue;
    }
    const double gap = yarn::end_gap(body, last);
    check.end_gap = std::max(check.end_gap, gap);
    if (gap <= allowed_gap(body, last)) continue;
    add_defect(
        body, check,
        fmt::format("open: the edge of the {} face of yarn '{}' is {:.3g} away from the body (rounding "
                    "allows {:.1g}); "
                    "build the face from the body's own end curve, or seal the yarn anew with --ends patch",
                    side_of(last), body.name, gap, allowed_gap(body, last)),
        face.origin);
    named = true;
  }
  return named;
}

void compare_volumes(const yarn::Body& body, const Tessellation& skin, double chord, YarnCheck& check) {
  // Between the triangles and the surface lies at most a layer as thick as the chord error.
  const double allowed = area(skin) * chord + 1e-12 * std::abs(check.volume);
  if (std::abs(check.volume - body.volume) <= allowed) return;
  add_defect(
      body, check,
      fmt::format(
          "the skin of yarn '{}' encloses {:.6g}, the surfaces say {:.6g} (a difference of {:.2g} at most "
          "comes from the triangles): body and end faces do not belong together, or the yarn overlaps itself",
          body.name, check.volume, body.volume, allowed));
}

void judge_skin(const yarn::Body& body, double chord, const Tessellation& skin, YarnCheck& check) {
  const bool gaps_named = name_gaps(body, check);
  const Verdict verdict = judge(skin);
  check.volume = volume(skin);
  check.closed = verdict.closed && !gaps_named;
  check.self_intersecting = verdict.self_intersecting;
  check.bounds_volume = verdict.bounds_volume && check.closed;
  check.outward = verdict.outward;
  check.self_intersection_at = verdict.crossing;
  if (!verdict.consistent)
    add_defect(
        body, check,
        fmt::format(
            "the faces of yarn '{}' do not all face outward, or more than two meet in an edge; the grid's "
            "sections must run the same way round, and each end face outward",
            body.name));
  if (verdict.consistent && !verdict.closed && !gaps_named)
    add_defect(body, check, fmt::format("open: the skin of yarn '{}' has a border", body.name),
               find_border(skin));
  if (verdict.self_intersecting) {
    std::string text = fmt::format("the surface of yarn '{}' crosses itself", body.name);
    text += body.tight_bends.empty() ? "; move its path or its sections apart there"
                                     : fmt::format(
                                           ": its path bends on a radius of {:.3g} where the section reaches "
                                           "{:.3g} inward; make the bend "
                                           "wider or the yarn thinner",
                                           body.tight_bends.front().radius, body.tight_bends.front().needed);
    add_defect(body, check, std::move(text), verdict.crossing);
  }
  if (verdict.closed && !verdict.outward)
    add_defect(
        body, check,
        fmt::format("the faces of yarn '{}' face inward: reverse the order of the points in its sections",
                    body.name));
  if (verdict.closed && !verdict.self_intersecting && !verdict.bounds_volume)
    add_defect(body, check, fmt::format("the skin of yarn '{}' does not bound a volume", body.name));
  if (verdict.closed && verdict.outward) compare_volumes(body, skin, chord, check);
}

YarnCheck check_tessellated(const yarn::Body& body, double chord) {
  YarnCheck check;
  const Result<Tessellation> skin = tessellate(body, chord);
  if (!skin) {
    check.defects.push_back(skin.error());
    return check;
  }
  const Status judged =
      guarded_by_module(fmt::format("CGAL cannot judge yarn '{}'", body.name), [&]() -> Status {
        judge_skin(body, chord, *skin, check);
        return {};
      });
  if (!judged) check.defects.push_back(error(judged.error().kind, judged.error().text, about(body)));
  return check;
}

}  // namespace

YarnCheck check_yarn(const yarn::Body& body, const CheckOptions& options) {
  constexpr double coarse = 1.0 / 50, fine = 1.0 / 200;
  if (options.chord > 0.0 || body.surface.is_empty()) return check_tessellated(body, options.chord);
  const double width = yarn::narrowest_section(body);
  const bool is_swept = body.tube_error > 0.0;
  if (is_swept)
    if (YarnCheck check = check_tessellated(body, coarse * width); check.defects.empty()) return check;
  return check_tessellated(body, fine * width);
}

}  // namespace selvage::solid
