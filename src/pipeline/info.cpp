// `selvage info`: what is in a file.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <unordered_map>

#include "cad/measure.h"
#include "core/parallel.h"
#include "core/readable.h"
#include "core/words.h"
#include "nurbs/measure.h"
#include "nurbs/patch.h"
#include "pipeline/facts.h"
#include "pipeline/job.h"
#include "pipeline/pieces.h"
#include "pipeline/sheet_report.h"
#include "pipeline/table.h"

namespace selvage::pipeline {

namespace {

std::string_view kind_of(const fabric::Item& item) {
  constexpr std::array<std::string_view, 7> kinds = {"yarn",  "weave", "knit", "warpknit",
                                                     "braid", "piece", "use"};
  static_assert(kinds.size() == std::variant_size_v<fabric::Item>);
  return kinds[item.index()];
}

std::string heading(const Job& job, const fabric::Fabric& fabric) {
  std::string text = readable(job.input.path) + "\n";
  if (fabric.title) text += fmt::format("  title      {}\n", shortened(*fabric.title, 120));
  text +=
      fmt::format("  units      {}{}\n", name_of(fabric.units), fabric.units_given ? "" : " (the default)");
  // Grids are taken as they are and need none.
  const double tolerance = fabric::tolerance_of(fabric, job.build_options());
  if (tolerance > 0) text += fmt::format("  tolerance  {:.6g}\n", tolerance);
  const auto names = [&](std::string_view what, const auto& list) {
    if (list.empty()) return;
    NameList all;
    for (const auto& item : list) all.add(item.name);
    text += fmt::format("  {:<9} {}\n", what, all.text());
  };
  names("threads", fabric.threads);
  names("materials", fabric.materials);
  std::map<std::string_view, std::size_t> kinds;
  for (const fabric::Item& item : fabric.items) ++kinds[kind_of(item)];
  text += "  holds     ";
  for (const auto& [kind, count] : kinds) text += " " + counted(count, kind);
  if (!fabric.parts.empty()) text += " " + counted(fabric.parts.size(), "other part");
  if (!fabric.curves.empty()) text += " " + counted(fabric.curves.size(), "curve");
  return text + "\n";
}

// What a CAD file says of itself: "4 x 128, 1 x 314".
std::string numbers_of(const std::map<std::string, std::uint64_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{} x {}", text.empty() ? "" : ", ", count, name);
  return text;
}

std::string file_facts(const cad::Model& model) {
  std::string text;
  if (model.resolution > 0) text += fmt::format("  resolution {:.6g}\n", model.resolution);
  text += fmt::format("  entities   {}\n", numbers_of(model.entities));
  if (!model.unknown.empty()) text += fmt::format("  not understood  {}\n", numbers_of(model.unknown));
  return text;
}

constexpr std::array<std::string_view, 3> part_kinds = {"surfaces", "shell", "solid"};
constexpr std::size_t most_rows = 50;  // of parts, and of curves

std::string rest_of(std::size_t count, std::string_view what) {
  return count > most_rows ? fmt::format("  and {} (--json has all)\n", counted(count - most_rows, what))
                           : "";
}

std::ptrdiff_t trimmed_in(const cad::Part& part) {
  return std::ranges::count_if(part.faces, [](const cad::Face& face) { return !face.loops.empty(); });
}

// Parts that are neither yarns nor garment pieces, in mm.
Json parts_json(const fabric::Fabric& fabric, const std::vector<cad::PartMeasures>& measures,
                const std::map<int, std::string>& levels) {
  const double mm = millimetres_per(fabric.units);
  const auto vector = [&](const Vec3& p) { return Json{p.x() * mm, p.y() * mm, p.z() * mm}; };
  Json all = Json::array();
  for (std::size_t i = 0; i < fabric.parts.size(); ++i) {
    const cad::Part& part = fabric.parts[i];
    Json made = {{"kind", part_kinds[static_cast<std::size_t>(part.kind)]},
                 {"faces", part.faces.size()},
                 {"trimmed", trimmed_in(part)}};
    if (!part.name.empty()) made["name"] = part.name;
    if (!part.group.empty()) made["group"] = part.group;
    if (measures[i].area) made["area"] = *measures[i].area * mm * mm;
    if (measures[i].volume) made["volume"] = *measures[i].volume * mm * mm * mm;
    if (const Box3 box = cad::box_of(part); !box.isEmpty())
      made["box"] = {vector(box.min()), vector(box.max())};
    if (part.color)
      made["color"] =
          fmt::format("#{:02X}{:02X}{:02X}", part.color->red, part.color->green, part.color->blue);
    if (const auto name = levels.find(part.level); name != levels.end())
      made["layer"] = name->second;
    else if (part.level != 0)
      made["layer"] = std::to_string(part.level);
    if (!part.origin.entity.empty()) made["entity"] = part.origin.entity;
    all.push_back(std::move(made));
  }
  return all;
}

// What is neither a yarn nor a garment piece.
std::string other_tables(const Job& job, const fabric::Fabric& fabric,
                         const std::vector<cad::PartMeasures>& measures) {
  const Shown shown = job.shown();
  std::string text;
  if (!fabric.parts.empty()) {
    Table table({"part", "kind", "faces", "trimmed", "area", "volume", "extent", "entity"});
    for (std::size_t i = 0; i < std::min(most_rows, fabric.parts.size()); ++i) {
      const cad::Part& part = fabric.parts[i];
      const Box3 box = cad::box_of(part);
      table.add({part.name.empty() ? "-" : part.name,
                 std::string(part_kinds[static_cast<std::size_t>(part.kind)]),
                 std::to_string(part.faces.size()), std::to_string(trimmed_in(part)),
                 measures[i].area ? cell(shown.area(*measures[i].area)) : "-",
                 measures[i].volume ? cell(shown.volume(*measures[i].volume)) : "-",
                 box.isEmpty() ? "-" : cell(shown.length(box.diagonal().norm())), part.origin.entity});
    }
    text += table.text() + rest_of(fabric.parts.size(), "more part");
  }
  if (!fabric.curves.empty()) {
    Table table({"curve", "degree", "points", "length", "entity"});
    for (const cad::NamedCurve& curve :
         std::span(fabric.curves).first(std::min(most_rows, fabric.curves.size())))
      table.add({curve.name.empty() ? "-" : curve.name, std::to_string(curve.curve.degree),
                 std::to_string(curve.curve.points.size()),
                 cell(shown.length(nurbs::arc_length(curve.curve))), curve.origin.entity});
    text += table.text() + rest_of(fabric.curves.size(), "more curve");
  }
  return text;
}

// Of the body's faces: control points stand up to a half of the section off the surface.
Box3 box_of(const yarn::Body& body) {
  Box3 box;
  const double tolerance = 1e-9 * yarn::bounds(body).diagonal().norm();
  if (!std::isfinite(tolerance)) return box;
  nurbs::extend(box, body.surface, tolerance);
  for (const yarn::EndFace* end : {&body.start, &body.end})
    if (end->style != yarn::EndStyle::planar && !end->surface.is_empty())
      nurbs::extend(box, end->surface, tolerance);
  return box;
}

// The box of all bodies; one shape is looked at once.
class BoxOfBodies {
 public:
  // Of a body that stands `at` away from its place.
  void extend(const yarn::Body& body, const Vec3& at) {
    if (body.shape == 0) {
      box_.extend(box_of(body).translated(at));
      return;
    }
    const auto [known, is_new] = shapes_.try_emplace(body.shape);
    if (is_new) known->second = box_of(body).translated(Vec3(-body.at));
    if (!known->second.isEmpty()) box_.extend(known->second.translated(Vec3(body.at + at)));
  }
  [[nodiscard]] const Box3& box() const { return box_; }

 private:
  Box3 box_;
  std::unordered_map<std::uint64_t, Box3> shapes_;
};

std::string yarn_table(Job& job, const fabric::YarnBuilder& builder) {
  const Shown shown = job.shown();
  const auto length = [&](double value) { return shown.length(value); };
  Table table({"yarn", "role", "points", "length", "volume", "least bend radius", "tube error", "ends"});
  double total_length = 0, total_volume = 0, largest_miss = 0;
  BoxOfBodies boxes;
  std::map<std::string, int> groups;  // yarns of plies or filaments
  job.for_each_shape(builder, "building yarn", [&](const fabric::YarnBuilder::Shaped& yarn) {
    const yarn::Body& body = *yarn.body;
    const double volume = shown.volume(body.volume);
    table.add({yarn.label.name, std::string(yarn::name_of(yarn.label.role)),
               fmt::format("{}x{}", body.surface.count_u, body.surface.count_v), cell(length(body.length)),
               cell(volume), cell(length(body.min_bend_radius)), cell(length(body.tube_error)),
               body.closed_along ? "ring" : std::string(yarn::name_of(body.start.style))});
    if (!yarn.label.group.empty()) ++groups[yarn.label.group];
    total_length += length(body.length);
    total_volume += volume;
    largest_miss = std::max(largest_miss, length(body.path_miss));
    boxes.extend(body, yarn.at);
  });
  std::string text = fmt::format("  lengths in {}\n{}", name_of(shown.unit), table.text());
  if (!groups.empty()) {
    NameList all;
    for (const auto& [yarn, parts] : groups)
      all.add(fmt::format("{} ({} parts)", shortened(yarn, 30), parts));
    text += fmt::format("  taken apart{}\n", all.text());
  }
  text += fmt::format("  together: length {}, volume {}\n", cell(total_length), cell(total_volume));
  if (largest_miss > 0)
    text += fmt::format("  loop paths miss their points by up to {}\n", cell(largest_miss));
  if (const Box3& box = boxes.box(); !box.isEmpty()) {
    const Vec3 low = box.min().unaryExpr(length), high = box.max().unaryExpr(length);
    text += fmt::format("  within ({:.6g}, {:.6g}, {:.6g}) and ({:.6g}, {:.6g}, {:.6g})\n", low.x(), low.y(),
                        low.z(), high.x(), high.y(), high.z());
  }
  return text;
}

// What the cloths of the text are, by the numbers of the trade.
std::string data_sheets(Job& job, const fabric::YarnBuilder& builder) {
  const fabric::SheetResult result =
      fabric::sheets_of(builder, job.build_options(), static_cast<int>(job.threads));
  job.say_all(result.missing);
  job.report["sheets"] = if_true(!result.sheets.empty(), sheets_json(result.sheets));
  std::string text;
  for (const fabric::Sheet& sheet : result.sheets) text += sheet_text(sheet, job.input.path);
  return text;
}

std::string piece_tables(Job& job, const fabric::Fabric& fabric) {
  std::vector<fabric::PieceShape> shapes;
  for (const fabric::Piece* piece : fabric::pieces_of(fabric))
    if (std::optional<fabric::PieceShape> shape = job.build_piece(fabric, *piece))
      shapes.push_back(std::move(*shape));
  if (shapes.empty()) return {};
  std::string text = piece_table(shapes, job.shown());
  if (job.options.table)
    for (const fabric::PieceShape& shape : shapes) text += curve_tables(shape, job.shown());
  return text;
}

}  // namespace

void info(Job& job) {
  std::string of_file;
  std::map<int, std::string> levels;
  CadLook look;
  look.model = [&](const cad::Model& model, const formats::Descriptor&) {
    of_file = file_facts(model);
    levels = model.levels;
    job.report["entities"] = if_true(!model.entities.empty(), model.entities);
    job.report["not_understood"] = if_true(!model.unknown.empty(), model.unknown);
  };
  const std::optional<fabric::Fabric> fabric = job.read(look);
  if (!fabric) return;
  std::vector<cad::PartMeasures> measures(fabric->parts.size());
  for_each_index(measures.size(), static_cast<int>(job.threads),
                 [&](std::size_t i) { measures[i] = cad::measures_of(fabric->parts[i]); });
  if (job.wants_report() && !fabric->parts.empty())
    job.report["parts"] = parts_json(*fabric, measures, levels);
  const std::string head = heading(job, *fabric) + of_file;
  const std::optional<fabric::YarnBuilder> builder = job.builder(*fabric);
  std::string tables;
  if (builder && builder->count() > 0) tables = data_sheets(job, *builder) + yarn_table(job, *builder);
  if (builder) tables += piece_tables(job, *fabric) + other_tables(job, *fabric, measures);
  if (!job.options.json) job.print(head + tables);
}

}  // namespace selvage::pipeline
