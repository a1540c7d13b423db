#include "contact/face.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "core/parallel.h"
#include "nurbs/divided.h"
#include "nurbs/patch.h"
#include "nurbs/samples.h"
#include "nurbs/sweep.h"

namespace selvage::contact {

namespace {

constexpr int round_samples = 24;

struct SectionSize {
  double width = 0, thickness = 0;
  Vec3 centre = Vec3::Zero();
};

// Extents of a section across its longer and its thinner principal direction.
SectionSize size_of_section(std::span<const Vec3> points) {
  SectionSize size;
  for (const Vec3& p : points) size.centre += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) spread += (p - size.centre) * (p - size.centre).transpose();
  // Eigenvalues increase: the section's normal, its thin direction, its long one.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(spread);
  const auto extent = [&](const Vec3& axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& p : points) {
      low = std::min(low, (p - size.centre).dot(axis));
      high = std::max(high, (p - size.centre).dot(axis));
    }
    return high - low;
  };
  size.width = extent(axes.eigenvectors().col(2));
  size.thickness = extent(axes.eigenvectors().col(1));
  return size;
}

// Straight lines from an end's outline to its centre.
nurbs::Surface flat_end(const yarn::Body& body, bool last) {
  const nurbs::Curve outline = yarn::end_curve(body, last);
  const Vec3& centre = last ? body.end.origin : body.start.origin;
  return nurbs::ruled(outline, std::vector<Vec3>(outline.points.size(), centre));
}

bool faces_against(const nurbs::Surface& face, const Vec3& normal) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 8; ++k) {
    const nurbs::SurfaceJet jet =
        nurbs::evaluate_jet(face, face.first_u() + (k + 0.5) / 8.0 * (face.last_u() - face.first_u()), 0.25);
    sum += jet.du.cross(jet.dv);
  }
  return sum.dot(normal) < 0.0;
}

// How often each span of u is cut so that no cell turns by more than about 30 degrees.
std::vector<int> cuts_round(const nurbs::Surface& s, const std::vector<double>& breaks) {
  std::vector<int> parts(breaks.size() - 1, 1);
  const double vs[3] = {s.first_v(), 0.5 * (s.first_v() + s.last_v()), s.last_v()};
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (const double v : vs) {
      const double step = 1e-6 * (breaks[k + 1] - breaks[k]);
      const Vec3 from = nurbs::evaluate_jet(s, breaks[k] + step, v).du,
                 to = nurbs::evaluate_jet(s, breaks[k + 1] - step, v).du;
      const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
      if (std::isfinite(angle))
        parts[k] = std::max(parts[k], static_cast<int>(std::ceil(angle / 0.55 - 1e-6)));
    }
  return parts;
}

// The cells of rows [first, last) of a face, to those of its body.
void add_cells(std::span<const double> us, std::span<const double> vs, std::uint32_t first,
               std::uint32_t last, std::uint32_t number, BodyCells& body) {
  Face& face = body.faces[number];
  for (std::uint32_t j = first; j < last; ++j) {
    face.rows[j] = static_cast<std::uint32_t>(body.cells.size());
    for (std::uint32_t i = 0; i < face.count_u; ++i) {
      Cell cell;
      cell.face = number;
      cell.i = i;
      cell.j = j;
      cell.low = {us[i], vs[j]};
      cell.high = {us[i + 1], vs[j + 1]};
      const nurbs::Patch patch = patch_of(*face.surface, cell.low, cell.high);
      for (const Vec3& p : patch.points) cell.box.extend(p);
      cell.normal = middle_normal(patch, face.inward);
      body.cells.push_back(cell);
    }
  }
}

void set_size(Face& face, std::size_t breaks_u, std::size_t breaks_v) {
  face.count_u = static_cast<std::uint32_t>(breaks_u - 1);
  face.count_v = static_cast<std::uint32_t>(breaks_v - 1);
  face.rows.assign(face.count_v, Face::no_cells);
}

// The cells of rows [first, last) of a face as the body's next piece, if they are wanted.
void add_piece(Piece piece, std::span<const double> us, std::span<const double> vs, std::uint32_t first,
               std::uint32_t last, std::uint32_t number, const std::vector<bool>& wanted, BodyCells& body) {
  piece.count = (last - first) * body.faces[number].count_u;
  piece.first_cell = Face::no_cells;
  if (wanted.empty() || wanted[body.pieces.size()]) {
    piece.first_cell = static_cast<std::uint32_t>(body.cells.size());
    add_cells(us, vs, first, last, number, body);
    for (std::uint32_t k = 0; k < piece.count; ++k) piece.box.extend(body.cells[piece.first_cell + k].box);
  } else {
    body.is_whole = false;
  }
  body.pieces.push_back(piece);
}

}  // namespace

BodyCells cells_of(const yarn::Body& body, const std::vector<bool>& wanted) {
  BodyCells made;
  const nurbs::Surface& s = body.surface;
  if (s.is_empty()) return made;
  // Sections at the knots along the yarn.
  const std::vector<double> breaks = nurbs::breakpoints(s.knots_v, s.degree_v);
  std::vector<double> round;
  round.reserve(round_samples);
  for (int k = 0; k < round_samples; ++k)
    round.push_back(s.first_u() + (s.last_u() - s.first_u()) * k / round_samples);
  const nurbs::Samples samples(s, round, breaks);
  std::vector<SectionSize> sections;
  std::vector<double> along = {0.0};
  double widest = 0.0;
  for (std::size_t j = 0; j < breaks.size(); ++j) {
    sections.push_back(size_of_section(samples.row(j)));
    widest = std::max(widest, sections.back().width);
    if (j > 0) along.push_back(along[j - 1] + (sections[j].centre - sections[j - 1].centre).norm());
  }
  made.length = along.back();
  double largest = 0.0;
  for (const Vec3& p : s.points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  made.touching = 64.0 * std::max(16.0 * std::numeric_limits<double>::epsilon() * largest,
                                  std::min(body.resolution, 1e-8 * largest));
  made.thickness = widest;
  for (const SectionSize& section : sections)
    if (section.thickness > 1e-3 * widest) made.thickness = std::min(made.thickness, section.thickness);
  // Rows of cells: as long as the section is wide at most.
  std::vector<int> parts;
  for (std::size_t j = 0; j + 1 < breaks.size(); ++j) {
    const double wide = std::max({sections[j].width, sections[j + 1].width, 0.05 * widest});
    parts.push_back(nurbs::whole_parts((along[j + 1] - along[j]) / (0.8 * wide), 1, 10'000));
  }
  const std::vector<double> vs = nurbs::divided(breaks, parts);
  const std::vector<double> breaks_u = nurbs::breakpoints(s.knots_u, s.degree_u);
  const std::vector<double> us = nurbs::divided(breaks_u, cuts_round(s, breaks_u));
  Face side;
  side.surface = &s;
  side.inward = body.inward;
  side.round_u = true;
  side.round_v = body.closed_along;
  set_size(side, us.size(), vs.size());
  made.faces.push_back(side);
  // Pieces: rows together while they are short.
  std::uint32_t row = 0, first_row = 0;
  double begun = 0.0;
  Piece piece;
  for (std::size_t j = 0; j + 1 < breaks.size(); ++j)
    for (int k = 0; k < parts[j]; ++k, ++row) {
      const bool is_first = row == first_row;
      if (is_first) begun = along[j] + (along[j + 1] - along[j]) * k / parts[j];
      piece.width = std::max({piece.width, sections[j].width, sections[j + 1].width});
      const double thin = std::min(sections[j].thickness, sections[j + 1].thickness);
      piece.thickness = is_first ? thin : std::min(piece.thickness, thin);
      const double end = along[j] + (along[j + 1] - along[j]) * (k + 1) / parts[j];
      piece.place = 0.5 * (begun + end);
      if (end - begun < 0.3 * piece.width && row + 1 < side.count_v) continue;
      piece.first_v = vs[first_row];
      piece.last_v = vs[row + 1];
      add_piece(piece, us, vs, first_row, row + 1, 0, wanted, made);
      piece = Piece();
      first_row = row + 1;
    }
  if (body.closed_along) return made;
  const std::size_t sides = made.pieces.size();
  for (const bool last : {false, true}) {
    const yarn::EndFace& end = last ? body.end : body.start;
    if (end.style == yarn::EndStyle::none) continue;
    Face face;
    face.is_side = false;
    face.is_last = last;
    if (end.style == yarn::EndStyle::planar) {
      made.flat_ends.push_back(std::make_unique<const nurbs::Surface>(flat_end(body, last)));
      face.surface = made.flat_ends.back().get();
      face.inward = faces_against(*face.surface, end.normal);
    } else {
      face.surface = &end.surface;
      face.inward = end.inward;
    }
    const nurbs::Surface& surface = *face.surface;
    if (surface.is_empty()) continue;
    const std::vector<double> eu = nurbs::breakpoints(surface.knots_u, surface.degree_u),
                              ev = nurbs::breakpoints(surface.knots_v, surface.degree_v);
    face.round_u = end.style != yarn::EndStyle::patch;
    set_size(face, eu.size(), ev.size());
    made.faces.push_back(face);
    Piece whole = made.pieces[last ? sides - 1 : 0];
    whole.place = last ? made.length : 0.0;
    whole.first_v = whole.last_v = last ? s.last_v() : s.first_v();
    whole.box.setEmpty();
    add_piece(whole, eu, ev, 0, face.count_v, static_cast<std::uint32_t>(made.faces.size() - 1), wanted,
              made);
  }
  return made;
}

namespace {

std::vector<BodyCells> cells_of_all(std::span<const yarn::Body> bodies, int threads) {
  std::vector<BodyCells> made(bodies.size());
  for_each_index(bodies.size(), threads, [&](std::size_t i) { made[i] = cells_of(bodies[i]); });
  return made;
}

}  // namespace

CellModel::CellModel(std::span<const yarn::Body> bodies, int threads)
    : CellModel(bodies, cells_of_all(bodies, threads)) {}

CellModel::CellModel(std::span<const yarn::Body> bodies, std::vector<BodyCells> made) : bodies_(bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto first_face = static_cast<std::uint32_t>(faces_.size()),
               first_cell = static_cast<std::uint32_t>(cells_.size());
    sides_.push_back(first_face);
    first_pieces_.push_back(static_cast<std::uint32_t>(pieces_.size()));
    thickness_.push_back(made[b].thickness);
    length_.push_back(made[b].length);
    touching_.push_back(made[b].touching);
    is_whole_.push_back(made[b].is_whole);
    for (Face& face : made[b].faces) {
      face.body = static_cast<std::uint32_t>(b);
      for (std::uint32_t& row : face.rows)
        if (row != Face::no_cells) row += first_cell;
      faces_.push_back(face);
    }
    std::ranges::move(made[b].flat_ends, std::back_inserter(flat_ends_));
    for (Cell& cell : made[b].cells) {
      cell.face += first_face;
      cells_.push_back(cell);
    }
    piece_of_.resize(cells_.size());
    for (Piece& piece : made[b].pieces) {
      piece.body = static_cast<std::uint32_t>(b);
      if (piece.first_cell != Face::no_cells) {
        piece.first_cell += first_cell;
        for (std::uint32_t k = 0; k < piece.count; ++k)
          piece_of_[piece.first_cell + k] = static_cast<std::uint32_t>(pieces_.size());
      }
      pieces_.push_back(piece);
    }
    made[b] = {};
  }
}

std::optional<std::uint32_t> CellModel::end(std::size_t body, bool last) const {
  for (std::uint32_t k = sides_[body] + 1; k < faces_.size() && faces_[k].body == body; ++k)
    if (faces_[k].is_last == last) return k;
  return std::nullopt;
}

double CellModel::way_along(const Piece& a, const Piece& b) const {
  const double way = std::abs(a.place - b.place);
  return bodies_[a.body].closed_along ? std::min(way, length_[a.body] - way) : way;
}

}  // namespace selvage::contact
