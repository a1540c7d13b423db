#include "formats/txt/writer.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text_buffer.h"
#include "core/text_report.h"
#include "fabric/as_grid.h"
#include "formats/txt/pitch.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

using fabric::Thread;

// Lines of statements on their way to the file. The first failure stays; what follows it is dropped.
class Lines {
 public:
  explicit Lines(OutputFile& output) : text_(output) {}

  // Begins a line of a statement.
  Lines& line(int depth, std::string_view word) {
    if (begun_) raw("\n");
    begun_ = true;
    for (int i = -blocks_; i < depth; ++i) raw("  ");
    return raw(word);
  }
  // Lines between stand in a block of the fabric.
  void open_block(std::string_view block_name) {
    blank_line();
    line(0, "block").name(block_name);
    ++blocks_;
  }
  void close_block() {
    --blocks_;
    line(0, "end");
  }
  // Before a block of the file.
  void blank_line() {
    if (begun_) raw("\n");
    begun_ = false;
    raw("\n");
  }
  // A row's first number has no blank before it but the indentation.
  Lines& row(int depth, double first) { return line(depth, "").number(first); }

  Lines& word(std::string_view word) { return raw(" ").raw(word); }
  Lines& value(double value) { return raw(" ").number(value); }
  Lines& value(int value) { return text_ << ' ' << value, *this; }
  Lines& values(const Vec3& vector) { return value(vector.x()).value(vector.y()).value(vector.z()); }
  Lines& name(std::string_view name) { return raw(" ").bare_name(name); }
  Lines& bare_name(std::string_view name) {
    if (is_plain_name(name)) return raw(name);
    if (name.empty()) fail("a name is empty");
    return quoted_text(name);
  }
  Lines& quoted_text(std::string_view text) {
    if (text.find('"') != text.npos || text_prefix(text) != text.size())
      fail(fmt::format("{} cannot be written: no double quotes, no control characters, UTF-8 only",
                       in_quotes(text)));
    return raw("\"").raw(text).raw("\"");
  }
  Lines& number(double value) {
    if (!std::isfinite(value)) fail("a number of the fabric is not finite");
    return text_ << value, *this;
  }
  Lines& raw(std::string_view text) { return text_ << text, *this; }
  void fail(std::string text) { text_.fail(selvage::error(Kind::malformed, std::move(text))); }
  Status finish() {
    if (begun_) raw("\n");
    return text_.finish();
  }

  // The fabric and the blocks that are open, the innermost one last.
  std::vector<const fabric::Fabric*> inside;

 private:
  TextBuffer text_;
  bool begun_ = false;
  int blocks_ = 0;
};

// --- threads and materials
// ------------------------------------------------------------------------------------------

void write_section(Lines& out, int depth, const yarn::Section& section) {
  out.line(depth, "section").word(section_words[section.index()].text);
  const auto write = [&](const auto& shape) {
    if constexpr (requires { shape.corners; }) {
      for (const Vec2& corner : shape.corners) out.row(depth + 1, corner.x()).value(corner.y());
      out.line(depth, "end");
    } else if constexpr (requires { shape.diameter; }) {
      if (shape.diameter != 0.0) out.value(shape.diameter);
    } else {
      out.value(shape.width).value(shape.height);
      if constexpr (requires { shape.exponent; }) out.value(shape.exponent);
    }
  };
  std::visit(write, section);
}

void write_thread_statements(Lines& out, int depth, const Thread& thread) {
  if (thread.linear_density)
    out.line(depth, word_of(density_words, thread.linear_density->measure))
        .value(thread.linear_density->value);
  if (thread.density) out.line(depth, "density").value(*thread.density);
  if (thread.packing) out.line(depth, "packing").value(*thread.packing);
  if (thread.diameter) out.line(depth, "diameter").value(*thread.diameter);
  if (thread.section) write_section(out, depth, *thread.section);
  if (thread.twist) {
    out.line(depth, "twist").value(thread.twist->turns).word(word_of(hand_words, thread.twist->hand));
    if (thread.twist->rotates) out.word("rotate");
  }
  if (thread.plies)
    out.line(depth, "plies")
        .value(thread.plies->count)
        .value(thread.plies->turns)
        .word(word_of(hand_words, thread.plies->hand));
  if (thread.filaments) out.line(depth, "filaments").value(*thread.filaments);
  if (thread.color)
    out.line(depth, "color").value(thread.color->red).value(thread.color->green).value(thread.color->blue);
  if (thread.material) out.line(depth, "material").name(*thread.material);
}

void write_thread(Lines& out, const Thread& thread) {
  out.blank_line();
  out.line(0, "thread").name(thread.name);
  write_thread_statements(out, 1, thread);
  out.line(0, "end");
}

void write_transport(Lines& out, std::string_view word, const std::optional<fabric::Transport>& transport) {
  if (!transport) return;
  out.line(1, word).value(transport->along);
  if (transport->across != transport->along) out.value(transport->across);
}

void write_interface(Lines& out, const fabric::Interface& interface) {
  const auto write = [&](std::string_view word, const std::optional<fabric::Interface::Pair>& pair) {
    if (pair) out.line(2, word).value(pair->normal).value(pair->shear);
  };
  out.line(1, "interface");
  write("stiffness", interface.stiffness);
  write("strength", interface.strength);
  write("energy", interface.energy);
  out.line(1, "end");
}

void write_strength(Lines& out, const fabric::Material& material) {
  if (const auto* same = std::get_if<fabric::IsotropicStrength>(&material.strength)) {
    out.line(1, "strength isotropic").value(same->tension).value(same->compression);
    if (same->shear) out.value(*same->shear);
  }
  if (const auto* two = std::get_if<fabric::TransverseStrength>(&material.strength)) {
    out.line(1, "strength transverse").value(two->tension).value(two->compression);
    if (const auto& a = two->across) out.value(a->tension).value(a->compression).value(a->s12).value(a->s23);
  }
}

void write_material(Lines& out, const fabric::Material& material) {
  out.blank_line();
  out.line(0, "material").name(material.name);
  if (material.density) out.line(1, "density").value(*material.density);
  if (material.packing) out.line(1, "packing").value(*material.packing);
  if (const auto* isotropic = std::get_if<fabric::IsotropicElastic>(&material.elastic))
    out.line(1, "elastic isotropic").value(isotropic->modulus).value(isotropic->poisson);
  if (const auto* e = std::get_if<fabric::TransverseElastic>(&material.elastic))
    out.line(1, "elastic transverse").value(e->e1).value(e->e2).value(e->nu12).value(e->g12).value(e->nu23);
  write_strength(out, material);
  if (material.expansion)
    out.line(1, "expansion").value(material.expansion->along).value(material.expansion->across);
  write_transport(out, "conductivity", material.conductivity);
  write_transport(out, "diffusivity", material.diffusivity);
  write_transport(out, "permittivity", material.permittivity);
  if (material.interface) write_interface(out, *material.interface);
  out.line(0, "end");
}

// --- yarns
// ----------------------------------------------------------------------------------------------------------

void write_outline(Lines& out, const fabric::Outline& outline) {
  out.blank_line();
  out.line(0, "outline").name(outline.name);
  for (const Vec2& point : outline.points) out.row(1, point.x()).value(point.y());
  out.line(0, "end");
}

void write_path(Lines& out, const fabric::Path& path) {
  out.line(1, "path").word(word_of(path_words, path.form));
  if (path.form == yarn::PathForm::smooth) out.value(path.error);
  if (!path.knots.empty()) out.line(2, "knots");
  for (const double knot : path.knots) out.value(knot);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const Vec3& point = path.points[i];
    out.row(2, point.x()).value(point.y()).value(point.z());
    if (!path.sizes.empty() && path.sizes[i]) {
      out.value(path.sizes[i]->width).value(path.sizes[i]->height);
      if (path.sizes[i]->angle) out.value(*path.sizes[i]->angle);
    }
    if (!path.outlines.empty() && path.outlines[i]) {
      const fabric::OutlineAt& at = *path.outlines[i];
      out.word(outline_word).name(at.from);
      if (!at.to.empty()) out.name(at.to).value(at.share);
      if (at.weight != 1.0) out.word("weight").value(at.weight);
    }
    if (!path.fixed.empty() && path.fixed[i]) out.word(fixed_word);
  }
  out.line(1, "end");
}

void write_knots(Lines& out, std::string_view direction, const std::vector<double>& knots) {
  if (knots.empty()) return;
  out.line(2, "knots").word(direction);
  for (double knot : knots) out.value(knot);
}

void write_grid(Lines& out, const fabric::Grid& grid) {
  out.line(1, "grid").value(grid.sections).value(grid.per_section);
  if (grid.degree_along) out.line(2, "degree").value(*grid.degree_along).word("along");
  if (grid.degree_round) out.line(2, "degree").value(*grid.degree_round).word("round");
  write_knots(out, "along", grid.knots_along);
  write_knots(out, "round", grid.knots_round);
  if (grid.open_round) out.line(2, "open round");
  if (grid.closed_along) out.line(2, "closed");
  if (grid.corners) {
    out.line(2, "corners");
    for (const double corner : *grid.corners) out.value(corner);
  }
  for (const std::size_t end : {0U, 1U})
    if (grid.fan_centres[end])
      out.line(2, end == 0 ? "centre start" : "centre end").values(*grid.fan_centres[end]);
  const auto per_section = static_cast<std::size_t>(grid.per_section);
  for (std::size_t i = 0; i < grid.points.size(); ++i) {
    if (i > 0 && per_section > 0 && i % per_section == 0) out.blank_line();
    const Vec3& point = grid.points[i];
    out.row(2, point.x()).value(point.y()).value(point.z());
    if (!grid.weights.empty()) out.value(grid.weights[i]);
  }
  out.line(1, "end");
}

void write_points_file(Lines& out, const fabric::PointsFile& points) {
  out.line(1, "points").raw(" ").quoted_text(points.file);
  if (!points.yarn.empty()) out.word("yarn").name(points.yarn);
  if (points.error) out.word("error").value(*points.error);
}

void write_helix(Lines& out, const fabric::Helix& helix) {
  out.line(1, "helix radius").value(helix.radius).word("pitch").value(helix.pitch);
  out.word("turns").value(helix.turns).word(helix.is_left ? "left" : "right");
  if (helix.start != 0.0 || std::signbit(helix.start)) out.word("start").value(helix.start);
}

void write_item(Lines& out, const fabric::Yarn& yarn) {
  out.line(0, "yarn").name(yarn.name);
  if (!yarn.thread.empty()) out.name(yarn.thread);
  if (yarn.role) out.line(1, "role").word(word_of(role_words, *yarn.role));
  if (!yarn.group.empty()) out.line(1, "group").name(yarn.group);
  write_thread_statements(out, 1, yarn.own);
  if (yarn.closed) out.line(1, "closed");
  if (yarn.ends) {
    const auto [start, end] = *yarn.ends;
    out.line(1, "ends").word(word_of(end_words, start));
    if (end != start) out.word(word_of(end_words, end));
  }
  for (const auto& [end, tangent] :
       {std::pair("start", &yarn.tangent_start), std::pair("end", &yarn.tangent_end)})
    if (*tangent)
      out.line(1, (*tangent)->is_derivative ? "derivative" : "tangent").word(end).values((*tangent)->vector);
  if (yarn.up) out.line(1, "up").values(*yarn.up);
  if (const auto* path = std::get_if<fabric::Path>(&yarn.shape))
    write_path(out, *path);
  else if (const auto* grid = std::get_if<fabric::Grid>(&yarn.shape))
    write_grid(out, *grid);
  else if (const auto* points = std::get_if<fabric::PointsFile>(&yarn.shape))
    write_points_file(out, *points);
  else if (const auto* helix = std::get_if<fabric::Helix>(&yarn.shape))
    write_helix(out, *helix);
  else
    out.fail(fmt::format("the yarn {} has no path and no grid", in_quotes(yarn.name)));
  out.line(0, "end");
}

// --- constructions
// --------------------------------------------------------------------------------------------------

// Used in turn.
void write_threads(Lines& out, std::string_view word, const std::vector<std::string>& threads) {
  out.line(1, word).raw(" ");
  for (std::size_t i = 0; i < threads.size(); ++i) out.raw(i > 0 ? "," : "").bare_name(threads[i]);
}

void write_system(Lines& out, std::string_view word, const fabric::WeaveSystem& system) {
  write_threads(out, word, system.threads);
  out.value(system.count).word("pitch").value(system.pitch);
  const double width = width_of_threads(out.inside, system.threads);
  if (width > 0.0 && system.pitch > max_pitch_in_widths * width) out.word("open");
}

void write_pair(Lines& out, int a, std::string_view sign, int b) {
  out.raw(fmt::format(" {}{}{}", a, sign, b));
}

void write_draft(Lines& out, const fabric::Draft& draft) {
  out.line(1, "draft");
  if (draft.form == Draft::Form::rows) {
    for (const std::string& row : draft.rows) out.line(2, row);
    out.line(1, "end");
    return;
  }
  out.word(word_of(draft_words, draft.form));
  if (draft.form == Draft::Form::file)
    out.name(draft.file);
  else if (draft.form == Draft::Form::leno)
    out.word(word_of(leno_words, draft.full_turns));
  else if (draft.form == Draft::Form::satin && draft.b == 0)
    out.value(draft.a);
  else if (draft.has_pile())
    out.value(draft.a);
  else if (draft.form != Draft::Form::plain)
    write_pair(out, draft.a, "/", draft.b);
  for (const int count : draft.further) out.raw(fmt::format("/{}", count));
  if (draft.hand != Hand::z) out.word(word_of(hand_words, draft.hand));
  if (draft.warp_faced) out.word(word_of(face_words, draft.warp_faced));
}

void write_item(Lines& out, const fabric::Weave& weave) {
  out.line(0, "weave");
  write_system(out, "warp", weave.warp);
  write_system(out, "weft", weave.weft);
  if (weave.profile != Weave::Profile::straight && weave.columns.empty()) write_draft(out, weave.draft);
  if (weave.profile) out.line(1, "profile").word(word_of(profile_words, *weave.profile));
  if (weave.amplitude) out.value(*weave.amplitude);
  if (weave.crimp) out.line(1, "crimp").value(*weave.crimp);
  if (weave.spacing) out.line(1, "spacing").word(word_of(spacing_words, *weave.spacing));
  if (weave.state) out.line(1, "state").word(word_of(state_words, *weave.state));
  if (weave.pucker) {
    out.line(1, "pucker tight").value(weave.pucker->tight).word("slack").value(weave.pucker->slack);
    out.word("ratio").value(weave.pucker->ratio).word("every").value(weave.pucker->picks);
  }
  if (weave.thickness) out.line(1, "thickness").value(*weave.thickness);
  if (weave.fraction) out.line(1, "fraction").value(*weave.fraction);
  if (weave.pressure) out.line(1, "compact").value(*weave.pressure);
  if (weave.layers) out.line(1, "layers").value(*weave.layers);
  for (const fabric::Binder& binder : weave.binders) {
    out.line(1, "binder").name(binder.thread).word("every").value(binder.every);
    if (binder.first != 1) out.word("first").value(binder.first);
    out.word("levels");
    for (int level : binder.levels) out.value(level);
  }
  for (const fabric::WarpColumn& column : weave.columns) {
    out.line(1, "levels");
    for (std::size_t k = 0; k < column.size(); ++k) {
      if (k > 0) out.word(",");
      if (!column[k].thread.empty()) out.name(column[k].thread);
      for (const int level : column[k].levels) out.value(level);
    }
  }
  if (weave.pile) {
    out.line(1, "pile").value(weave.pile->height);
    if (!weave.pile->thread.empty()) out.name(weave.pile->thread);
    out.word("every").value(weave.pile->picks).word(word_of(pile_words, weave.pile->side));
    if (weave.pile->is_cut) out.word("cut");
  }
  out.line(0, "end");
}

void write_own_loop(Lines& out, const fabric::OwnLoop& loop) {
  for (const Vec3& point : loop.points) out.row(2, point.x()).value(point.y()).value(point.z());
  out.line(1, "end");
}

void write_item(Lines& out, const fabric::Knit& knit) {
  out.line(0, "knit");
  if (knit.form != Knit::Form::chart) out.word(word_of(knit_words, knit.form));
  if (knit.form == Knit::Form::rib) write_pair(out, knit.rib_a, "x", knit.rib_b);
  write_threads(out, "thread", knit.threads);
  const auto extent = [&](std::string_view what, int count, double pitch) {
    out.line(1, what).value(count);
    if (pitch > 0) out.word("pitch").value(pitch);
  };
  extent("courses", knit.courses, knit.course_pitch);
  extent("wales", knit.wales, knit.wale_pitch);
  if (knit.loop) out.line(1, "loop").value(*knit.loop);
  if (knit.unit) out.line(1, "unit").value(*knit.unit);
  if (knit.crossing) out.line(1, "crossing").values(*knit.crossing);
  if (knit.shape) out.line(1, "shape").word(word_of(knit_shape_words, *knit.shape));
  for (const fabric::OwnLoop& loop : knit.own_loops) {
    out.line(1, "points").word(word_of(stitch_signs, loop.sign));
    write_own_loop(out, loop);
  }
  if (knit.method) out.line(1, "method").word(word_of(knit_method_words, *knit.method));
  if (!knit.plating.empty()) out.line(1, "plating").name(knit.plating);
  if (knit.pile) out.line(1, "pile").value(*knit.pile);
  if (knit.pile_is_cut) out.word("cut");
  if (knit.feeds) out.line(1, "feeds").value(*knit.feeds);
  if (knit.gating) {
    out.line(1, "gating").word(word_of(gating_words, *knit.gating));
    if (knit.bed_distance) out.value(*knit.bed_distance);
  }
  if (knit.form == Knit::Form::chart || knit.form == Knit::Form::jacquard) {
    out.line(1, "chart");
    for (const std::string& row : knit.chart) out.line(2, row);
    out.line(1, "end");
  }
  for (const fabric::LoopMove& move : knit.moves) {
    out.line(1, move.is_dropped ? "drop" : "transfer").value(move.row).value(move.wale);
    if (!move.is_dropped) out.word(word_of(side_words, move.right < 0 ? -1 : 1)).value(std::abs(move.right));
  }
  out.line(0, "end");
}

void write_item(Lines& out, const fabric::Warpknit& warpknit) {
  out.line(0, "warpknit");
  if (!warpknit.classic.empty()) out.word(warpknit.classic);
  if (!warpknit.thread.empty()) out.line(1, "thread").name(warpknit.thread);
  for (const fabric::WarpknitBar& bar : warpknit.bars) {
    out.line(1, "bar").name(bar.thread).word(bar.lapping);
    if (bar.fall_plate) out.word("fall-plate");
    if (!bar.own_loop) continue;
    out.line(1, "points");
    write_own_loop(out, *bar.own_loop);
  }
  if (warpknit.weft) {
    write_threads(out, "weft", warpknit.weft->threads);
    out.word("every").value(warpknit.weft->every);
    if (warpknit.weft->first != 1) out.word("first").value(warpknit.weft->first);
  }
  out.line(1, "wales").value(warpknit.wales).word("pitch").value(warpknit.wale_pitch);
  out.line(1, "courses").value(warpknit.courses).word("pitch").value(warpknit.course_pitch);
  if (warpknit.stitch) out.line(1, "stitch").word(word_of(stitch_words, *warpknit.stitch));
  if (warpknit.substrate) out.line(1, "substrate").value(*warpknit.substrate);
  out.line(0, "end");
}

void write_item(Lines& out, const fabric::Braid& braid) {
  out.line(0, "braid");
  out.line(1, "thread").name(braid.thread);
  out.line(1, "carriers").value(braid.carriers);
  out.line(1, "pattern");
  write_pair(out, braid.over, "/", braid.under);
  if (!braid.mandrel.empty()) {
    out.line(1, "mandrel");
    for (const fabric::MandrelRow& row : braid.mandrel)
      out.row(2, row.axis.x()).value(row.axis.y()).value(row.axis.z()).value(row.radius);
    out.line(1, "end");
  } else if (braid.flat || braid.planar) {
    Lines& line = out.line(1, braid.flat ? "flat" : "planar");
    if (braid.width > 0.0) line.value(braid.width);
  } else {
    out.line(1, "radius").value(braid.radius);
  }
  out.line(1, "angle").value(braid.angle);
  if (braid.mandrel.empty()) out.line(1, "length").value(braid.length);
  if (!braid.axial_thread.empty()) out.line(1, "axial").name(braid.axial_thread).value(braid.axial_count);
  out.line(0, "end");
}

void write_curve_edit(Lines& out, const fabric::Edit& edit) {
  const bool is_length = edit.form == fabric::Edit::Form::length;
  out.line(1, "edit").name(edit.yarn).word(word_of(edit_words, edit.form));
  if (edit.like) {
    out.word("of").name(edit.like->piece);
    for (std::size_t i = 0; i < edit.like->curves.size(); ++i) {
      if (i > 0) out.raw(",");
      out.name(edit.like->curves[i]);
    }
    if (edit.like->ease != 0.0 || std::signbit(edit.like->ease)) out.word("ease").value(edit.like->ease);
  } else if (is_length) {
    out.value(edit.length);
  }
  if (is_length) out.word("point");
  const Vec3& vector = is_length ? edit.direction : edit.target;
  out.value(edit.joint).word(is_length ? "along" : "to").value(vector.x()).value(vector.y());
}

void write_item(Lines& out, const fabric::Piece& piece) {
  out.line(0, "piece").name(piece.name);
  for (const fabric::PieceCurve& curve : piece.curves) {
    out.line(1, curve.is_line ? "line" : "curve").name(curve.name);
    if (curve.is_line) {
      for (const Vec2& point : curve.points) out.value(point.x()).value(point.y());
      continue;
    }
    if (curve.shape != PieceCurve::Shape::found) out.word(word_of(curve_words, curve.shape));
    if (curve.by) out.word("by").word(word_of(curve_method_words, *curve.by));
    if (curve.method) out.word("by").word(word_of(knit_method_words, *curve.method));
    if (!curve.knots.empty()) {
      out.line(2, "knots");
      for (const double knot : curve.knots) out.value(knot);
    }
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      out.row(2, curve.points[i].x()).value(curve.points[i].y());
      if (!curve.weights.empty()) out.value(curve.weights[i]);
    }
    out.line(1, "end");
  }
  for (const fabric::Edit& edit : piece.edits) write_curve_edit(out, edit);
  out.line(0, "end");
}

// --- placing
// --------------------------------------------------------------------------------------------------------

void write_item(Lines& out, const fabric::Use& use) {
  out.line(0, "use");
  if (use.is_file) out.word("file");
  out.name(use.what);
  if (!use.as.empty()) out.word("as").name(use.as);
  if (use.repeats != std::array{1, 1} || use.steps) {
    out.line(1, "repeat").value(use.repeats[0]).value(use.repeats[1]);
    if (use.steps) out.word("step").value((*use.steps)[0]).value((*use.steps)[1]);
  }
  for (const fabric::Move& move : use.moves) {
    using Form = fabric::Move::Form;
    out.line(1, word_of(move_words, move.form));
    if (move.form == Form::place) {
      out.values(move.by);
      continue;
    }
    out.word(word_of(axis_words, move.axis));
    if (move.form == Form::shear) out.word(word_of(axis_words, move.across));
    if (move.form != Form::mirror) out.value(move.angle);
  }
  out.line(0, "end");
}

// --- file
// -----------------------------------------------------------------------------------------------------------

void write_edit(Lines& out, const fabric::Edit& edit) {
  const bool is_length = edit.form == fabric::Edit::Form::length;
  out.line(0, "edit").name(edit.yarn).word(word_of(edit_words, edit.form));
  if (is_length) out.value(edit.length).word("point");
  out.value(edit.joint).word(is_length ? "along" : "to").values(is_length ? edit.direction : edit.target);
}

void write_cell(Lines& out, const fabric::Cell& cell) {
  out.blank_line();
  if (cell.of_repeats) {
    out.line(0, "cell repeat").value(cell.of_repeats->counts[0]).word("x").value(cell.of_repeats->counts[1]);
    if (cell.of_repeats->margin) out.line(1, "margin").value(*cell.of_repeats->margin);
  } else if (cell.of_vectors) {
    const fabric::CellVectors& vectors = *cell.of_vectors;
    out.line(0, "cell vectors").values(vectors.first).raw(" ").values(vectors.second);
    if (vectors.height) out.raw(" ").values(Vec3(0, 0, *vectors.height));
    if (vectors.at) out.word("at").values(*vectors.at);
    if (vectors.margin) out.line(1, "margin").value(*vectors.margin);
  } else {
    out.line(0, "cell").values(cell.low).raw(" ").values(cell.high);
  }
  if (!cell.matrix.empty()) out.line(1, "matrix").name(cell.matrix);
  if (cell.names_axes()) out.line(1, "periodic");
  for (const std::size_t axis : {0U, 1U, 2U})
    if (cell.periodic[axis]) out.word(std::string_view("xyz").substr(axis, 1));
  out.line(0, "end");
}

// A yarn that has its surface already, as a grid.
struct EndsChanged {
  std::size_t yarns = 0;
  std::string first;
};
void write_body(Lines& out, const fabric::Fabric& fabric, const fabric::Yarn& yarn, EndsChanged& changed) {
  const fabric::GridYarn grid = fabric::as_grid(fabric, yarn);
  if (!grid.keeps_ends && changed.yarns++ == 0) changed.first = yarn.name;
  write_item(out, grid.yarn);
}

void warn_of_losses(const fabric::Fabric& fabric, const EndsChanged& changed, WriteFacts& facts) {
  const auto warn = [&](std::string text) {
    facts.messages.push_back(warning(Kind::unsupported, std::move(text)));
  };
  if (changed.yarns > 0)
    warn(fmt::format(
        "Fabric TXT says how a yarn is sealed, not with which surfaces: {}, such as '{}', will be "
        "sealed anew when the text is read",
        counted(changed.yarns, "yarn"), changed.first));
  if (!fabric.parts.empty())
    warn(fmt::format("Fabric TXT holds no free surfaces: {}, such as '{}', left out",
                     counted(fabric.parts.size(), "part"), fabric.parts.front().name));
  if (!fabric.curves.empty())
    warn(fmt::format("Fabric TXT holds no free curves: {}, such as '{}', left out",
                     counted(fabric.curves.size(), "curve"), fabric.curves.front().name));
}

// What a text and a block of it have alike.
void write_content(Lines& out, const fabric::Fabric& fabric, WriteFacts& facts, EndsChanged& changed) {
  out.inside.push_back(&fabric);
  if (fabric.tolerance) out.line(0, "tolerance").value(*fabric.tolerance);
  for (const fabric::Material& material : fabric.materials) write_material(out, material);
  for (const fabric::Outline& outline : fabric.outlines) write_outline(out, outline);
  for (const Thread& thread : fabric.threads) write_thread(out, thread);
  for (const fabric::NamedBlock& block : fabric.blocks) {
    out.open_block(block.name);
    WriteFacts of_block;  // its yarns are those of its uses
    write_content(out, *block.fabric, of_block, changed);
    out.close_block();
  }
  constexpr std::array<std::string_view, 7> kinds = {"yarn",  "weave", "knit", "warpknit",
                                                     "braid", "piece", "use"};
  static_assert(kinds.size() == std::variant_size_v<fabric::Item>);
  for (const fabric::Item& item : fabric.items) {
    out.blank_line();
    const auto* yarn = std::get_if<fabric::Yarn>(&item);
    if (yarn != nullptr && std::holds_alternative<fabric::ReadBody>(yarn->shape))
      write_body(out, fabric, *yarn, changed);
    else
      std::visit([&](const auto& one) { write_item(out, one); }, item);
    ++facts.entities[std::string(kinds[item.index()])];
  }
  if (!fabric.edits.empty()) out.blank_line();
  for (const fabric::Edit& edit : fabric.edits) write_edit(out, edit);
  out.inside.pop_back();
}

}  // namespace

Result<WriteFacts> write_fabric(const fabric::Fabric& fabric, OutputFile& output) {
  if (fabric.items.empty() && fabric.parts.size() + fabric.curves.size() > 0)
    return error(
        Kind::unsupported,
        fmt::format("there is no yarn and no piece in this input, and Fabric TXT holds nothing else: {} "
                    "and {} would be left out; --to iges,step writes them",
                    counted(fabric.parts.size(), "part"), counted(fabric.curves.size(), "curve")));
  Lines out(output);
  out.line(0, "fabric").value(1);
  if (fabric.title) out.line(0, "title").raw(" ").quoted_text(*fabric.title);
  if (fabric.units_given || fabric.units != Unit::mm)
    out.line(0, "units").word(word_of(unit_words, fabric.units));
  WriteFacts facts;
  EndsChanged changed;
  write_content(out, fabric, facts, changed);
  if (fabric.cell) write_cell(out, *fabric.cell);
  if (Status status = out.finish(); !status) return status.error();
  warn_of_losses(fabric, changed, facts);
  if (!fabric.threads.empty()) facts.entities["thread"] = fabric.threads.size();
  if (!fabric.materials.empty()) facts.entities["material"] = fabric.materials.size();
  return facts;
}

}  // namespace selvage::formats::txt
