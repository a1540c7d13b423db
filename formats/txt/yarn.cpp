// The block `yarn`: a thread's statements, and what places the yarn in space.
#include <fmt/format.h>

#include "formats/txt/blocks.h"

namespace selvage::formats::txt {

namespace {

using fabric::Path;
using fabric::Yarn;

struct YarnReading {
  Yarn yarn;
  ShapeReading shape;
  std::optional<Spot> tangent, up, ends;  // where they are given
};

// A thread's statement as one of the yarn.
void read_own(Parser& p, YarnReading& reading, std::string_view word) {
  for (const auto& statement : thread_statements())
    if (statement.word == word) statement.read(p, reading.yarn.own, word);
}

void read_role(Parser& p, YarnReading& reading, std::string_view) {
  const auto role = p.choice("role", role_words);
  if (role && p.finish()) reading.yarn.role = *role;
}

void read_group(Parser& p, YarnReading& reading, std::string_view) {
  const auto group = p.name("the name of the group");
  if (group && p.finish()) reading.yarn.group = *group;
}

void read_closed(Parser& p, YarnReading& reading, std::string_view) {
  if (p.finish()) reading.yarn.closed = true;
}

void read_ends(Parser& p, YarnReading& reading, std::string_view) {
  reading.ends = p.statement();
  const auto start = p.choice("way to seal an end", end_words);
  const auto end = start && p.more() ? p.choice("way to seal an end", end_words) : start;
  if (end && p.finish()) reading.yarn.ends = std::array<yarn::EndStyle, 2>{*start, *end};
}

void read_up(Parser& p, YarnReading& reading, std::string_view) {
  reading.up = p.statement();
  reading.yarn.up_place = reading.up->place();
  const auto up = p.direction("the direction up");
  if (up && p.finish()) reading.yarn.up = *up;
}

void read_tangent(Parser& p, YarnReading& reading, std::string_view) {
  constexpr std::array<Word<bool>, 2> ends{{{"start", true}, {"end", false}}};
  const Spot spot = p.statement();
  const auto at_start = p.choice("end of the path", ends);
  if (!at_start) return;
  std::optional<Vec3>& tangent = *at_start ? reading.yarn.tangent_start : reading.yarn.tangent_end;
  if (tangent)
    return p.error(spot, fmt::format("the tangent at the {} is given twice", *at_start ? "start" : "end"));
  const auto direction = p.direction("the tangent");
  if (!direction || !p.finish()) return;
  tangent = *direction;
  if (!reading.tangent) reading.tangent = spot;
}

void read_shape(Parser& p, YarnReading& reading, std::string_view word) {
  reading.shape.spot = p.statement();
  if (same_word(word, "path"))
    reading.yarn.shape = read_path(p, reading.shape);
  else
    reading.yarn.shape = read_grid(p, reading.shape);
}

// A closed path goes on from its last row to its first.
void check_closed_path(Parser& p, const YarnReading& reading, const Path& path) {
  if (path.points.size() < 3)
    p.error(reading.shape.spot,
            fmt::format("a closed path has at least 3 rows; this one has {}", path.points.size()));
  else if (path.points.front() == path.points.back())
    p.error(reading.shape.last_row, "the last row of this closed path repeats its first: leave it out");
}

// What can be judged when all statements of the yarn are there.
void check_yarn(Parser& p, const YarnReading& reading) {
  const Yarn& yarn = reading.yarn;
  const auto* path = std::get_if<Path>(&yarn.shape);
  if (path != nullptr && yarn.closed && reading.shape.good) check_closed_path(p, reading, *path);
  if (reading.tangent && (path == nullptr || yarn.closed || path->form == yarn::PathForm::control ||
                          path->form == yarn::PathForm::polyline || path->form == yarn::PathForm::loop))
    p.report.warning(*reading.tangent,
                     "this tangent changes nothing: only open paths through data points have end tangents");
  if (reading.up && path == nullptr)
    p.report.warning(*reading.up, "this direction changes nothing: a grid has its sections as they are");
  const auto* grid = std::get_if<fabric::Grid>(&yarn.shape);
  if (reading.ends && (yarn.closed || (grid != nullptr && grid->closed_along)))
    p.report.warning(*reading.ends, "this changes nothing: a ring has no ends");
}

Table<YarnReading> make_yarn_table() {
  std::vector<Statement<YarnReading>> statements = {{"role", read_role},
                                                    {"path", read_shape, Times::once},
                                                    {"grid", read_shape, Times::once, "path"},
                                                    {"closed", read_closed},
                                                    {"group", read_group},
                                                    {"tangent", read_tangent, Times::any},
                                                    {"up", read_up},
                                                    {"ends", read_ends}};
  for (const auto& own : thread_statements())
    statements.push_back({own.word, read_own, own.times, own.instead_of});
  return Table<YarnReading>(std::move(statements));
}

}  // namespace

void read_yarn(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<YarnReading> table = make_yarn_table();
  YarnReading reading;
  Yarn& yarn = reading.yarn;
  const Spot opened = p.statement();
  yarn.place = opened.place();
  const auto name = p.new_name(p.yarns);
  p.report.set_yarn(name.value_or(""));
  yarn.name = name.value_or("");
  if (name && p.more()) {
    if (const auto thread = p.reference(p.threads)) {
      yarn.thread = *thread;
      yarn.thread_place = p.last().place();
      p.finish();
    }
  }
  if (p.read_block(word, yarn.name, opened, table, reading)) check_yarn(p, reading);
  p.report.set_yarn("");
  fabric.items.emplace_back(std::move(yarn));
}

}  // namespace selvage::formats::txt
