// The block `piece`: the outline of a garment pattern.
#include <fmt/format.h>

#include "formats/txt/blocks.h"

namespace selvage::formats::txt {

namespace {

using fabric::Piece;
using fabric::PieceCurve;

struct PieceReading {
  Piece piece;
  Names curves{"curve"};
};

// Those behind the name of the curve.
void read_curve_words(Parser& p, PieceCurve& curve) {
  if (p.more() && !same_word(p.peek_word(), "by"))
    curve.shape = p.choice("shape of curve", curve_words).value_or(PieceCurve::Shape::found);
  if (!p.more()) return;
  if (p.expect("by")) curve.by = p.choice("way to place points on a curve", curve_method_words);
  if (curve.by && curve.shape == PieceCurve::Shape::control)
    p.error(p.last(), "a curve by its control points has no points to place: leave 'by' out");
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
  PointRows rows{"point", "a point of the curve", curve.shape == PieceCurve::Shape::control};
  const bool complete = read_points(p, word, curve.name, opened, rows);
  curve.points = std::move(rows.points);
  if (complete && curve.shape == PieceCurve::Shape::control && curve.points.size() != 4)
    p.error(p.last(),
            fmt::format("a curve by its control points has four; this one has {}", curve.points.size()));
  else if (complete && curve.points.size() < 3)
    p.error(p.last(), fmt::format("a curve has at least 3 points, two make a 'line'; this one has {}",
                                  curve.points.size()));
  reading.piece.curves.push_back(std::move(curve));
}

void read_line(Parser& p, PieceReading& reading, std::string_view) {
  PieceCurve line;
  line.place = p.statement().place();
  line.is_line = true;
  const auto name = p.new_name(reading.curves);
  std::array<double, 4> xy{};
  for (double& value : xy) value = p.number("a coordinate of the line (it has four: x y x y)").value_or(0.0);
  if (p.has_failed()) return;
  line.name = *name;
  line.points = {{xy[0], xy[1]}, {xy[2], xy[3]}};
  if (line.points[0] == line.points[1])
    p.error(p.statement(), "the line has no length: its ends are the same");
  p.finish();
  reading.piece.curves.push_back(std::move(line));
}

}  // namespace

void read_piece(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<PieceReading> table(
      {{"curve", read_curve, Times::any}, {"line", read_line, Times::any}});
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
