// The block `yarn`: a thread's statements, and what places the yarn in space.
#include <fmt/format.h>

#include "formats/txt/blocks.h"
#include "formats/txt/count.h"

namespace selvage::formats::txt {

namespace {

using fabric::Path;
using fabric::Yarn;

// What a yarn's statements say, and where some of them stand.
struct YarnBlock : Yarn {
  ShapeReading rows;
  std::optional<Spot> tangent_spot, up_spot, ends_spot;
};

// A thread's statement as one of the yarn.
void read_own(Parser& p, YarnBlock& yarn, std::string_view word) {
  for (const auto& statement : thread_statements())
    if (statement.word == word) statement.read(p, yarn.own, word);
}

void read_closed(Parser& p, YarnBlock& yarn, std::string_view) {
  if (p.finish()) yarn.closed = true;
}

void read_ends(Parser& p, YarnBlock& yarn, std::string_view) {
  yarn.ends_spot = p.statement();
  const auto start = p.choice("way to seal an end", end_words);
  const auto end = p.more() ? p.choice("way to seal an end", end_words) : start;
  if (p.finish()) yarn.ends = std::array<yarn::EndStyle, 2>{*start, *end};
}

void read_up(Parser& p, YarnBlock& yarn, std::string_view) {
  yarn.up_spot = p.statement();
  yarn.up_place = p.statement().place();
  yarn.up = p.direction("the direction up");
  p.finish();
}

// `tangent`: its direction; `derivative`: its length counts, too.
void read_tangent(Parser& p, YarnBlock& yarn, std::string_view word) {
  constexpr std::array<Word<bool>, 2> ends{{{"start", true}, {"end", false}}};
  const Spot spot = p.statement();
  const auto at_start = p.choice("end of the path", ends);
  if (!at_start) return;
  std::optional<yarn::EndTangent>& tangent = *at_start ? yarn.tangent_start : yarn.tangent_end;
  if (tangent)
    return p.error(spot, fmt::format("the tangent at the {} is given twice", *at_start ? "start" : "end"));
  const auto direction = p.direction(fmt::format("the {}", word));
  if (!p.finish()) return;
  tangent = yarn::EndTangent(*direction, word == "derivative");
  if (!yarn.tangent_spot) yarn.tangent_spot = spot;
}

void read_shape(Parser& p, YarnBlock& yarn, std::string_view word) {
  yarn.rows.spot = p.statement();
  if (same_word(word, "path"))
    yarn.shape = read_path(p, yarn.rows);
  else if (same_word(word, "points"))
    yarn.shape = read_points_file(p);
  else if (same_word(word, "helix"))
    yarn.shape = read_helix(p);
  else
    yarn.shape = read_grid(p, yarn.rows);
}

// A closed path goes on from its last row to its first; one with knots comes back to it.
void check_closed_path(Parser& p, const ShapeReading& rows, const Path& path) {
  if (!path.knots.empty()) {
    if (path.points.front() != path.points.back())
      p.error(rows.last_row, "the last row of a closed path with knots is its first again");
    return;
  }
  if (path.points.size() < 3)
    p.error(rows.spot, fmt::format("a closed path has at least 3 rows; this one has {}", path.points.size()));
  else if (path.points.front() == path.points.back())
    p.error(rows.last_row, "the last row of this closed path repeats its first: leave it out");
}

// What can be judged when all statements of the yarn are there.
void check_yarn(Parser& p, const YarnBlock& yarn) {
  const auto* path = std::get_if<Path>(&yarn.shape);
  if (yarn.closed && std::holds_alternative<fabric::Helix>(yarn.shape))
    p.error(yarn.rows.spot, "a helix does not come back to its start: leave out 'closed'");
  if (path != nullptr && yarn.closed && yarn.rows.good) check_closed_path(p, yarn.rows, *path);
  if (yarn.tangent_spot && (path == nullptr || yarn.closed || path->form == yarn::PathForm::control ||
                            path->form == yarn::PathForm::polyline || path->form == yarn::PathForm::loop ||
                            path->form == yarn::PathForm::smooth))
    p.report.warning(*yarn.tangent_spot,
                     "this tangent changes nothing: only open paths through data points have end tangents");
  if (yarn.up_spot && std::holds_alternative<fabric::Grid>(yarn.shape))
    p.report.warning(*yarn.up_spot, "this direction changes nothing: a grid has its sections as they are");
  const auto* grid = std::get_if<fabric::Grid>(&yarn.shape);
  if (yarn.ends_spot && (yarn.closed || (grid != nullptr && grid->closed_along)))
    p.report.warning(*yarn.ends_spot, "this changes nothing: a ring has no ends");
}

Table<YarnBlock> make_yarn_table() {
  std::vector<Statement<YarnBlock>> statements = {
      {"role", into(&Yarn::role, one_of("role", role_words))},
      {"path", read_shape, Times::once},
      {"grid", read_shape, Times::once, "path"},
      {"points", read_shape, Times::once, "path"},
      {"helix", read_shape, Times::once, "path"},
      {"closed", read_closed},
      {"group", into(&Yarn::group, [](Parser& p) { return p.name("the name of the group"); })},
      {"tangent", read_tangent, Times::any},
      {"derivative", read_tangent, Times::any},
      {"up", read_up},
      {"ends", read_ends}};
  for (const auto& own : thread_statements())
    statements.push_back({own.word, read_own, own.times, own.instead_of});
  Table<YarnBlock> table(std::move(statements));
  table.word_of_line = system_of_count;
  return table;
}

}  // namespace

void read_yarn(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<YarnBlock> table = make_yarn_table();
  YarnBlock yarn;
  const Spot opened = p.statement();
  yarn.place = opened.place();
  const auto name = p.new_name(p.yarns);
  p.report.set_yarn(name.value_or(""));
  yarn.name = name.value_or("");
  if (p.more()) {
    yarn.thread = p.reference(p.threads).value_or("");
    yarn.thread_place = p.last().place();
    p.finish();
  }
  p.counted = {};
  if (p.read_block(word, yarn.name, opened, table, yarn)) check_yarn(p, yarn);
  p.report.set_yarn("");
  fabric.items.emplace_back(static_cast<Yarn&&>(yarn));
}

}  // namespace selvage::formats::txt
