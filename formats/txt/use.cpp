// What places blocks: `use`; and a cell of repeats.
#include <fmt/format.h>

#include <cmath>

#include "formats/txt/blocks.h"

namespace selvage::formats::txt {

namespace {

using fabric::Move;
using fabric::Use;

constexpr double steepest_shear = 80.0;  // degrees; beyond it yarns would lie on each other

void read_place(Parser& p, Use& use, std::string_view) {
  Move move;
  move.by = p.point("the place").value_or(Vec3::Zero());
  if (p.finish()) use.moves.push_back(move);
}

// An axis, where one is named.
int read_axis(Parser& p, int usual) {
  const std::string_view word = p.peek_word();
  const bool is_axis = word.size() == 1 && is_letter(word.front()) && !p.scope().begins_with_param(word);
  return is_axis ? p.choice("axis", axis_words).value_or(usual) : usual;
}

void read_rotate(Parser& p, Use& use, std::string_view) {
  Move move{.form = Move::Form::rotate};
  move.axis = read_axis(p, move.axis);
  move.angle = p.number("the angle", Measure::angle).value_or(0.0);
  if (p.finish()) use.moves.push_back(move);
}

void read_mirror(Parser& p, Use& use, std::string_view) {
  Move move{.form = Move::Form::mirror};
  move.axis = p.choice("axis", axis_words).value_or(0);
  if (p.finish()) use.moves.push_back(move);
}

void read_shear(Parser& p, Use& use, std::string_view) {
  Move move{.form = Move::Form::shear, .axis = 0, .across = 1};
  const Spot spot = p.here();
  if (const std::string_view word = p.peek_word();
      word.size() == 1 && is_letter(word.front()) && !p.scope().begins_with_param(word)) {
    move.axis = p.choice("axis", axis_words).value_or(0);
    move.across = p.choice("axis", axis_words).value_or(1);
    if (!p.has_failed() && move.axis == move.across)
      return p.error(spot, "a shear moves along one axis, the more the farther along another one: x y, ...");
  }
  move.angle = p.number("the angle", Measure::angle).value_or(0.0);
  if (!p.has_failed() && !(std::abs(move.angle) <= steepest_shear))
    return p.error(p.last(), fmt::format("a shear is at most {:g} degrees", steepest_shear));
  if (p.finish()) use.moves.push_back(move);
}

void read_repeat(Parser& p, Use& use, std::string_view) {
  const auto along_x = p.count("the number of copies along x"), along_y = p.count("the number along y");
  std::optional<std::array<double, 2>> steps;
  if (p.more() && p.expect("step")) {
    const auto x = p.number("the step along x", Measure::pitch),
               y = p.number("the step along y", Measure::pitch);
    if (x && y) steps = {*x, *y};
    for (const auto& [count, step] : {std::pair(along_x, x), std::pair(along_y, y)})
      if (count.value_or(1) > 1 && step == 0.0) p.error(p.last(), "copies a step of 0 apart are one");
  }
  if (!p.finish()) return;
  use.repeats = {*along_x, *along_y};
  use.steps = steps;
}

}  // namespace

void read_use(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Use> table({{"place", read_place, Times::any},
                                 {"rotate", read_rotate, Times::any},
                                 {"mirror", read_mirror, Times::any},
                                 {"shear", read_shear, Times::any},
                                 {"repeat", read_repeat}});
  Use use;
  const Spot opened = p.statement();
  use.place = opened.place();
  if (same_word(p.peek_word(), "file")) {
    p.take_word();
    use.is_file = true;
    use.what = read_file_name(p, "the name of the file");
  } else {
    use.what = p.reference(p.blocks).value_or("");
  }
  if (p.more() && p.expect("as")) use.as = p.name("what the names of its yarns begin with").value_or("");
  p.finish();
  p.read_block(word, use.what, opened, table, use);
  fabric.items.emplace_back(std::move(use));
}

// Behind the word `cell`: repeat [NX x NY].
void read_repeats_of_cell(Parser& p, fabric::Cell& cell) {
  p.expect("repeat");
  fabric::CellOfRepeats repeats;
  if (p.more()) {
    if (p.peek_word().find_first_of("xX") == std::string_view::npos) {
      repeats.counts[0] = p.count("the number of repeats along x").value_or(1);
      p.expect("x");
      repeats.counts[1] = p.count("the number of repeats along y").value_or(1);
    } else {
      repeats.counts = p.pair("the numbers of repeats", 'x').value_or(repeats.counts);
    }
  }
  p.finish();
  cell.of_repeats = repeats;
}

// Behind the word `cell`: vectors A B [C] [at P].
void read_vectors_of_cell(Parser& p, fabric::Cell& cell, const Spot& opened) {
  p.expect("vectors");
  fabric::CellVectors vectors;
  const auto first = p.point("the first vector of the cell"),
             second = p.point("the second vector of the cell");
  if (!first || !second) return;
  vectors.first = *first;
  vectors.second = *second;
  const double area = first->cross(*second).z();
  if (first->z() != 0 || second->z() != 0)
    return p.error(opened, "the first two vectors of a cell lie in the plane of the cloth: their z is 0");
  if (std::abs(area) <= 1e-3 * first->norm() * second->norm())
    return p.error(opened, "the first two vectors of this cell are parallel: it has no volume");
  if (area < 0)
    return p.error(
        opened,
        "these vectors are left-handed: seen from above the second one is to the left of the first; "
        "exchange the two");
  if (p.more() && !same_word(p.peek_word(), "at")) {
    const auto third = p.point("the third vector of the cell");
    if (!third) return;
    if (third->x() != 0 || third->y() != 0 || !(third->z() > 0))
      return p.error(opened,
                     "the third vector of a cell points along z, `0 0 HEIGHT`: a cell whose sides lean over "
                     "cannot be meshed");
    vectors.height = third->z();
  }
  if (p.more() && p.expect("at")) {
    const auto at = p.point("the corner of the cell");
    if (!at) return;
    vectors.at = *at;
  }
  if (!p.finish()) return;
  cell.of_vectors = vectors;
}

void read_margin_of_cell(Parser& p, fabric::Cell& cell, std::string_view) {
  const Spot spot = p.statement();
  const auto margin = p.positive("the margin", Measure::length);
  if (!p.finish()) return;
  if (cell.of_vectors && !cell.of_vectors->height)
    cell.of_vectors->margin = *margin;
  else if (cell.of_repeats)
    cell.of_repeats->margin = *margin;
  else
    p.error(
        spot,
        "a margin goes with a cell that is as high as its yarns, 'cell repeat' or 'cell vectors' with two of "
        "them: here corners say it all");
}

}  // namespace selvage::formats::txt
