// The block `piece`: the outline of a garment pattern.
#include <fmt/format.h>

#include "formats/txt/blocks.h"

namespace selvage::formats::txt {

namespace {

using fabric::Piece;
using fabric::PieceCurve;

struct CurveRows {
  PieceCurve& curve;
  bool good = true;
};

void read_curve_row(Parser& p, CurveRows& rows) {
  const Spot spot = p.statement();
  std::array<double, 2> xy{};
  const int count = p.row(xy.data(), 2, "a point of the curve");
  std::vector<Vec2>& points = rows.curve.points;
  if (count == 0 || count == 1) p.error(p.here(), "a point of the curve has two coordinates: x y");
  rows.good = rows.good && count == 2;
  if (count != 2) return;
  const Vec2 point(xy[0], xy[1]);
  if (!points.empty() && points.back() == point && rows.curve.shape != PieceCurve::Shape::control) {
    p.error(spot, "this point equals the one before it");
    rows.good = false;
  }
  points.push_back(point);
}

struct PieceReading {
  Piece piece;
  Names curves{"curve"};
};

void read_curve(Parser& p, PieceReading& reading, std::string_view word) {
  static const Table<CurveRows> table({}, read_curve_row);
  PieceCurve curve;
  const Spot opened = p.statement();
  curve.place = opened.place();
  const auto name = p.new_name(reading.curves);
  curve.name = name.value_or("");
  if (name && p.more())
    curve.shape = p.choice("shape of curve", curve_words).value_or(PieceCurve::Shape::found);
  if (name) p.finish();
  CurveRows rows{curve};
  const bool complete = p.read_block(word, curve.name, opened, table, rows) && rows.good;
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
  if (!name) return;
  line.name = *name;
  std::array<double, 4> xy{};
  for (double& value : xy) {
    const auto number = p.number("a coordinate of the line (it has four: x y x y)");
    if (!number) return;
    value = *number;
  }
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
  if (name) p.finish();
  reading.piece.name = name.value_or("");
  const int errors = p.report.errors();
  if (p.read_block(word, reading.piece.name, opened, table, reading) && p.report.errors() == errors &&
      reading.piece.curves.empty())
    p.error(p.last(), "the piece has no outline: no 'curve' and no 'line'");
  fabric.items.emplace_back(std::move(reading.piece));
}

}  // namespace selvage::formats::txt
