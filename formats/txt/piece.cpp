// The block `piece`: the outline of a garment pattern.
#include <fmt/format.h>

#include <algorithm>

#include "formats/txt/blocks.h"

namespace selvage::formats::txt {

namespace {

using fabric::Piece;
using fabric::PieceCurve;

struct PieceReading {
  Piece piece;
  Names curves{"curve"};
};

// Knots of a clamped cubic over [0, 1].
void check_knots(Parser& p, const PieceCurve& curve) {
  const std::vector<double>& k = curve.knots;
  if (curve.shape != PieceCurve::Shape::control)
    return p.error(p.last(), "a spline has its knots at its points: leave 'knots' out");
  if (k.size() != curve.points.size() + 4)
    return p.error(p.last(), fmt::format("a cubic of {} control points has {} knots; this one has {}",
                                         curve.points.size(), curve.points.size() + 4, k.size()));
  bool good = std::ranges::is_sorted(k);
  for (std::size_t i = 0; i < 4; ++i) good = good && k[i] == 0.0 && k[k.size() - 1 - i] == 1.0;
  for (std::size_t i = 4; i + 4 < k.size(); ++i) good = good && k[i] > 0.0 && k[i] < 1.0 && k[i] < k[i + 2];
  if (!good)
    p.error(p.last(),
            "knots run from 0 to 1, both four times, without decreasing, none between more than twice");
}

// Those behind the name of the curve.
void read_curve_words(Parser& p, PieceCurve& curve) {
  if (p.more() && !same_word(p.peek_word(), "by"))
    curve.shape = p.choice("shape of curve", curve_words).value_or(PieceCurve::Shape::found);
  if (!p.more()) return;
  if (!p.expect("by")) return;
  if (curve.shape == PieceCurve::Shape::spline)
    curve.method = p.choice("way to place points on a spline", knit_method_words);
  else
    curve.by = p.choice("way to place points on a curve", curve_method_words);
  if (curve.by && curve.shape == PieceCurve::Shape::control)
    p.error(p.last(), "a curve by its control points has no points to place: leave 'by' out");
}

void check_count(Parser& p, const PieceCurve& curve) {
  const std::size_t count = curve.points.size();
  if (curve.shape == PieceCurve::Shape::control && count < 4)
    p.error(p.last(), fmt::format("a curve by its control points has at least four; this one has {}", count));
  else if (count < 3)
    p.error(p.last(),
            fmt::format("a curve has at least 3 points, two make a 'line'; this one has {}", count));
  else if (!curve.knots.empty())
    check_knots(p, curve);
}

void read_curve(Parser& p, PieceReading& reading, std::string_view word) {
  PieceCurve curve;
  const Spot opened = p.statement();
  curve.place = opened.place();
  const auto name = p.new_name(reading.curves);
  curve.name = name.value_or("");
  if (name) read_curve_words(p, curve);
  if (name) p.go_on();  // what stands behind a wrong shape is told, too
  p.finish();
  const bool by_control = curve.shape == PieceCurve::Shape::control;
  PointRows rows{"point", "a point of the curve", by_control,
                 by_control || curve.shape == PieceCurve::Shape::spline};
  const bool complete = read_points(p, word, curve.name, opened, rows);
  curve.points = std::move(rows.points);
  curve.weights = std::move(rows.weights);
  curve.knots = std::move(rows.knots);
  if (complete) check_count(p, curve);
  reading.piece.curves.push_back(std::move(curve));
}

void read_line(Parser& p, PieceReading& reading, std::string_view) {
  PieceCurve line;
  line.place = p.statement().place();
  line.is_line = true;
  const auto name = p.new_name(reading.curves);
  std::array<double, 4> xy{};
  for (double& value : xy)
    value = p.number("a coordinate of the line (it has four: x y x y)", Measure::length).value_or(0.0);
  if (p.has_failed()) return;
  line.name = *name;
  line.points = {{xy[0], xy[1]}, {xy[2], xy[3]}};
  if (line.points[0] == line.points[1])
    p.error(p.statement(), "the line has no length: its ends are the same");
  p.finish();
  reading.piece.curves.push_back(std::move(line));
}

// Two numbers, in z = 0.
Vec3 read_plane_vector(Parser& p, std::string_view what) {
  const double x = p.number(what, Measure::length).value_or(0.0),
               y = p.number(what, Measure::length).value_or(0.0);
  return {x, y, 0.0};
}

// `length L`, or `length of PIECE CURVE,.. [ease E]`.
void read_wanted_length(Parser& p, fabric::Edit& edit) {
  if (!same_word(p.peek_word(), "of")) {
    edit.length = p.positive("the length", Measure::length).value_or(0.0);
    return;
  }
  p.take_word();
  fabric::LengthOf like;
  like.piece = p.name("the name of the piece").value_or("");
  do {
    like.curves.emplace_back(p.name("the name of a curve").value_or(""));
  } while (p.comma());
  if (p.more() && same_word(p.peek_word(), "ease")) {
    p.take_word();
    like.ease = p.number("the ease", Measure::length).value_or(0.0);
  }
  edit.like = std::move(like);
}

void read_curve_edit(Parser& p, PieceReading& reading, std::string_view) {
  fabric::Edit edit;
  edit.place = p.statement().place();
  edit.yarn = p.name("the name of the curve").value_or("");
  edit.form = p.choice("edit", edit_words).value_or(fabric::Edit::Form::point);
  const bool is_length = edit.form == fabric::Edit::Form::length;
  if (is_length) {
    read_wanted_length(p, edit);
    p.expect("point");
  }
  edit.joint = p.count("the number of the joint").value_or(0);
  p.expect(is_length ? "along" : "to");
  const Spot spot = p.here();
  const Vec3 vector = read_plane_vector(p, is_length ? "the direction" : "the target");
  if (!p.finish()) return;
  if (is_length && vector == Vec3::Zero()) return p.error(spot, "the direction: 0 0 is no direction");
  (is_length ? edit.direction : edit.target) = vector;
  reading.piece.edits.push_back(std::move(edit));
}

}  // namespace

void read_piece(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<PieceReading> table({{"curve", read_curve, Times::any},
                                          {"line", read_line, Times::any},
                                          {"edit", read_curve_edit, Times::any}});
  PieceReading reading;
  const Spot opened = p.statement();
  reading.piece.place = opened.place();
  const auto name = p.new_name(p.pieces);
  p.finish();
  reading.piece.name = name.value_or("");
  const int errors = p.report.errors();
  if (p.read_block(word, reading.piece.name, opened, table, reading) && p.report.errors() == errors &&
      reading.piece.curves.empty())
    p.error(p.last(), "the piece has no outline: no 'curve' and no 'line'");
  fabric.items.emplace_back(std::move(reading.piece));
}

}  // namespace selvage::formats::txt
