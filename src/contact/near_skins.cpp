#include "contact/near_skins.h"

#include <algorithm>
#include <cmath>

#include "contact/critical.h"
#include "core/parallel.h"
#include "nurbs/divided.h"

namespace selvage::contact {

namespace {

constexpr int least_round = 24;
constexpr std::size_t leaf_columns = 4;

// The body's side, for what is asked of single points of it.
Face side_of(const yarn::Body& body) {
  Face face;
  face.surface = &body.surface;
  face.inward = body.inward;
  face.round_u = true;
  face.round_v = body.closed_along;
  return face;
}

void fill(Facing& facing, const SurfacePoint& p, const SurfacePoint& q) {
  facing.on_a = p.jet.position;
  facing.on_b = q.jet.position;
  facing.normal = (p.normal - q.normal).normalized();
  facing.gap = (facing.on_b - facing.on_a).dot(facing.normal);
}

}  // namespace

NearSkins::NearSkins(std::span<const Strand> strands,
                     const std::function<bool(std::size_t, std::size_t)>& wanted)
    : strands_(strands), skins_(strands.size()), tree_({}) {
  for (std::size_t a = 0; a < strands.size(); ++a)
    for (std::size_t b = 0; b < strands.size(); ++b) wanted_.push_back(wanted(a, b) ? 1 : 0);
  for (std::size_t y = 0; y < strands.size(); ++y) {
    const Strand& strand = strands[y];
    const nurbs::Surface& s = strand.body().surface;
    Skin& skin = skins_[y];
    const int along = std::max(2, static_cast<int>(std::ceil(2.0 * strand.length() / strand.spacing())));
    std::vector<double> vs;
    for (int j = 0; j <= along; ++j) {
      skin.arcs.push_back(strand.length() * j / along);
      vs.push_back(j == along ? s.last_v() : strand.parameter_at(skin.arcs.back()));
    }
    skin.samples.us = nurbs::divided(s.knots_u, s.degree_u, 1, least_round);
    skin.samples.vs = std::move(vs);
    sample(y);
    const std::size_t round = skin.samples.us.size() - 1;
    for (std::size_t j = 0; j + 1 < skin.samples.vs.size(); ++j)
      for (std::size_t i = 0; i < round; i += leaf_columns)
        leaves_.push_back({static_cast<std::uint32_t>(y), j, i, std::min(leaf_columns, round - i)});
  }
  tree_ = BoxTree(boxes(), 1);
}

void NearSkins::sample(std::size_t strand) {
  const yarn::Body& body = strands_[strand].body();
  Skin& skin = skins_[strand];
  nurbs::Samples& samples = skin.samples;
  samples.points = nurbs::evaluate_grid(body.surface, samples.us, samples.vs);
  // Normals from the differences of samples: they only choose directions.
  skin.normals.resize(samples.points.size());
  const std::size_t round = samples.us.size() - 1, along = samples.vs.size() - 1;
  const bool cyclic = body.closed_along;
  for (std::size_t j = 0; j <= along; ++j)
    for (std::size_t i = 0; i <= round; ++i) {
      const std::size_t low = j > 0 ? j - 1 : (cyclic ? along - 1 : 0);
      const std::size_t high = j < along ? j + 1 : (cyclic ? 1 : along);
      const Vec3 du = samples.at(i == round ? 1 : i + 1, j) - samples.at(i == 0 ? round - 1 : i - 1, j);
      const Vec3 dv = samples.at(i, high) - samples.at(i, low);
      skin.normals[samples.index(i, j)] = (body.inward ? -1.0 : 1.0) * du.cross(dv).normalized();
    }
}

std::vector<Box3> NearSkins::boxes() const {
  std::vector<Box3> boxes(leaves_.size());
  for (std::size_t k = 0; k < leaves_.size(); ++k) {
    const Leaf& leaf = leaves_[k];
    for (std::size_t j = leaf.row; j <= leaf.row + 1; ++j)
      for (std::size_t i = leaf.column; i <= leaf.column + leaf.columns; ++i)
        boxes[k].extend(skins_[leaf.strand].samples.at(i, j));
  }
  return boxes;
}

bool NearSkins::are_neighbours(const Leaf& a, const Leaf& b) const {
  if (a.strand != b.strand) return false;
  const Strand& strand = strands_[a.strand];
  const Skin& skin = skins_[a.strand];
  double apart = std::abs(skin.arcs[a.row] - skin.arcs[b.row]);
  if (strand.is_cyclic()) apart = std::min(apart, strand.length() - apart);
  return apart < 1.5 * strand.width();
}

bool NearSkins::is_wanted(const Leaf& a, const Leaf& b) const {
  return wanted_[a.strand * strands_.size() + b.strand] != 0;
}

void NearSkins::cast(const Leaf& from, const Leaf& onto, const Box3& box, double reach,
                     std::vector<Facing>& found) const {
  const Skin& skin = skins_[from.strand];
  const nurbs::Samples& samples = skin.samples;
  const double inward =
      -0.45 * std::min(strands_[from.strand].thickness(), strands_[onto.strand].thickness());
  const std::size_t rows = from.row + 2 == samples.vs.size() && !strands_[from.strand].is_cyclic() ? 2 : 1;
  for (std::size_t row = from.row; row < from.row + rows; ++row)
    for (std::size_t column = from.column; column < from.column + from.columns; ++column) {
      const Ray ray{samples.at(column, row), skin.normals[samples.index(column, row)], inward, reach};
      Box3 way(ray.origin + inward * ray.direction);
      way.extend(ray.origin + reach * ray.direction);
      if (!way.intersects(box)) continue;
      for (const Vec2& hit : hits(onto, ray)) {
        Facing facing;
        facing.a = from.strand;
        facing.b = onto.strand;
        facing.site_a = {samples.us[column], samples.vs[row]};
        facing.site_b = hit;
        fill(facing, point_at(side_of(strands_[from.strand].body()), facing.site_a),
             point_at(side_of(strands_[onto.strand].body()), facing.site_b));
        if (facing.gap <= reach && facing.normal.allFinite()) found.push_back(facing);
      }
    }
}

// The places where the ray meets quads of the leaf that face it.
std::vector<Vec2> NearSkins::hits(const Leaf& leaf, const Ray& ray) const {
  const nurbs::Samples& samples = skins_[leaf.strand].samples;
  const std::size_t j = leaf.row;
  const double outward = strands_[leaf.strand].body().inward ? -1.0 : 1.0;
  std::vector<Vec2> sites;
  for (std::size_t i = leaf.column; i < leaf.column + leaf.columns; ++i) {
    const Vec3 &p = samples.at(i, j), &across = samples.at(i + 1, j + 1);
    for (int half = 0; half < 2; ++half) {
      const Vec3 e1 = (half == 0 ? samples.at(i + 1, j) : across) - p,
                 e2 = (half == 0 ? across : samples.at(i, j + 1)) - p;
      const Vec3 face = e1.cross(e2);
      const double facing = face.dot(ray.direction);
      if (outward * facing >= 0.0) continue;
      const Vec3 way = ray.origin - p;
      const double t = -face.dot(way) / facing;
      if (t < ray.from || t > ray.to) continue;
      const Vec3 hit = way + t * ray.direction;
      const double size = face.squaredNorm();
      const double s1 = hit.cross(e2).dot(face) / size, s2 = e1.cross(hit).dot(face) / size;
      constexpr double edge = -1e-3;
      if (s1 < edge || s2 < edge || s1 + s2 > 1.0 - edge) continue;
      // Of the quad: the first triangle has its corners at (0,0) (1,0) (1,1), the second at (0,0) (1,1)
      // (0,1).
      const Vec2 share = half == 0 ? Vec2(s1 + s2, s2) : Vec2(s1, s1 + s2);
      sites.emplace_back(samples.us[i] + share.x() * (samples.us[i + 1] - samples.us[i]),
                         samples.vs[j] + share.y() * (samples.vs[j + 1] - samples.vs[j]));
    }
  }
  return sites;
}

void NearSkins::look_from(std::uint32_t leaf, double reach, std::vector<Facing>& found) const {
  const Leaf& from = leaves_[leaf];
  const double margin = reach + 0.45 * strands_[from.strand].thickness();
  Box3 box = tree_.box(leaf);
  box.min().array() -= margin;
  box.max().array() += margin;
  tree_.meeting(box, [&](std::uint32_t other) {
    if (!are_neighbours(from, leaves_[other]) && is_wanted(from, leaves_[other]))
      cast(from, leaves_[other], tree_.box(other), reach, found);
  });
}

std::vector<Facing> NearSkins::find(double reach, int threads) {
  for_each_index(strands_.size(), threads, [&](std::size_t y) { sample(y); });
  tree_.refit(boxes());
  constexpr std::size_t block = 512;
  const std::size_t blocks = (leaves_.size() + block - 1) / block;
  std::vector<std::vector<Facing>> parts(blocks);
  for_each_index(blocks, threads, [&](std::size_t b) {
    for (std::size_t k = b * block; k < std::min(leaves_.size(), (b + 1) * block); ++k)
      look_from(static_cast<std::uint32_t>(k), reach, parts[b]);
  });
  std::vector<Facing> all;
  for (const std::vector<Facing>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::optional<Facing> settled(std::span<const Strand> strands, const Facing& facing) {
  const Face a = side_of(strands[facing.a].body()), b = side_of(strands[facing.b].body());
  const std::optional<Critical> found = find_critical(a, facing.site_a, b, facing.site_b, Vec3::Zero());
  if (!found || (found->p - facing.on_a).norm() > strands[facing.a].thickness()) return std::nullopt;
  Facing now = facing;
  now.site_a = found->site_a;
  now.site_b = found->site_b;
  now.on_a = found->p;
  now.on_b = found->q;
  now.normal = found->normal;
  now.gap = -found->depth;
  return now;
}

}  // namespace selvage::contact
