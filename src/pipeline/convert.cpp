// `selvage convert` and `selvage relax`: each yarn and each piece is built once, handed to every surface
// format, and forgotten.
#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "core/words.h"
#include "formats/registry.h"
#include "pipeline/cell_cad.h"
#include "pipeline/facts.h"
#include "pipeline/instances.h"
#include "pipeline/relaxing.h"
#include "pipeline/scaling.h"
#include "pipeline/unit_cell.h"
#include "pipeline/writing.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;

namespace {

formats::SurfaceOptions surface_options(const Job& job, const fabric::Fabric& fabric,
                                        const PlannedOutput& output, std::uint64_t count) {
  formats::SurfaceOptions surface;
  surface.title = fabric.title.value_or("");
  surface.file_name = fs::path(output.to_standard_output ? job.input.stem : output.path).filename().string();
  // A file that is read and written again stays the same to the byte, under whatever name.
  for (const std::string_view extension : output.format->extensions)
    if (fabric.file_name.ends_with(extension)) surface.file_name = fabric.file_name;
  if (!job.options.file_name.empty()) surface.file_name = job.options.file_name;
  surface.units = job.shown().unit;
  surface.expected_bodies = count;
  surface.date = fabric.date;
  surface.tolerance =
      converted(fabric::tolerance_of(fabric, job.build_options()), fabric.units, surface.units);
  surface.chord = converted(job.options.chord, fabric.units, surface.units);
  surface.yarns_are_solids = fabric.yarns_are_solids;
  if (!fabric.parts.empty()) surface.resolution = converted(fabric.resolution, fabric.units, surface.units);
  surface.has_others = job.options.lines || !fabric::pieces_of(fabric).empty() || !fabric.parts.empty() ||
                       !fabric.curves.empty();
  surface.own = job.options.of_formats;
  surface.threads = static_cast<int>(job.threads);
  return surface;
}

bool open_writers(Job& job, const fabric::Fabric& fabric, std::size_t count, OpenOutputs& outputs) {
  for (OpenOutput& output : outputs) {
    if (output.plan->format->write_fabric != nullptr) continue;
    formats::SurfaceOptions options = surface_options(job, fabric, *output.plan, count);
    options.companion = companion_of(output, outputs);
    if (!output.plan->to_standard_output)
      options.next_part = [&output](int number) { return open_part(output, number); };
    Result<std::unique_ptr<formats::BodyWriter>> writer =
        output.plan->format->open_bodies(output.file, options);
    if (!writer) return job.fail(writer.error());
    output.writer = std::move(*writer);
  }
  return true;
}

std::string formats_with(bool formats::Descriptor::*what) {
  std::vector<std::string_view> names;
  for (const formats::Descriptor* format : formats::all_formats())
    if (format->open_bodies != nullptr && format->*what) names.push_back(format->name);
  return alternatives(names);
}

// False: a writer failed, which was said. What has many `points` is written to all outputs at once.
bool add_to_all(Job& job, OpenOutputs& outputs, const std::function<Status(OpenOutput&)>& add,
                std::size_t points = 0) {
  constexpr std::size_t many = 4000;
  std::vector<Status> made(outputs.size());
  for_each_index(outputs.size(), points < many ? 1 : static_cast<int>(job.threads), [&](std::size_t i) {
    if (outputs[i].writer) made[i] = add(outputs[i]);
  });
  for (const Status& status : made)
    if (!status) return job.fail(status.error());
  return true;
}

// What this output gets of a yarn: its centre line, where that is asked for or nothing else is held.
bool takes_lines(const Job& job, const formats::Descriptor& format) {
  return format.carries_lines && (job.options.lines || (!format.carries_surfaces && !format.carries_curves));
}

// What a format cannot hold is said before anything is written: yarns in a drawing, pieces where none can be.
bool can_carry(Job& job, const fabric::Fabric& fabric, std::size_t yarns, const OpenOutputs& outputs) {
  const std::vector<const fabric::Piece*> pieces = fabric::pieces_of(fabric);
  for (const OpenOutput& output : outputs) {
    const formats::Descriptor& format = *output.plan->format;
    if (format.open_bodies == nullptr || format.write_fabric != nullptr ||
        output.plan->as_companion != nullptr)
      continue;
    if (yarns > 0 && !format.carries_surfaces && !takes_lines(job, format))
      job.say(
          error(Kind::unsupported, fmt::format("{} holds garment pieces (`piece`) only, and this input has "
                                               "{}: write it as {}, or their centre lines by --lines",
                                               format.name, counted(yarns, "yarn"),
                                               formats_with(&formats::Descriptor::carries_surfaces))));
    if (!pieces.empty() && !format.carries_curves)
      job.say(error(Kind::unsupported,
                    fmt::format("{} holds no garment pieces, such as '{}': write it as {}", format.name,
                                pieces.front()->name, formats_with(&formats::Descriptor::carries_curves)),
                    {.place = pieces.front()->place}));
    const auto refuse = [&](std::size_t count, std::string_view what, std::string_view first,
                            bool formats::Descriptor::*needed) {
      if (count > 0 && !(format.*needed))
        job.say(error(Kind::unsupported,
                      fmt::format("{} holds no free {}s, and this input has {}, such as '{}': write {}",
                                  format.name, what, counted(count, what), first, formats_with(needed))));
    };
    refuse(fabric.parts.size(), "surface", fabric.parts.empty() ? "" : fabric.parts.front().name,
           &formats::Descriptor::carries_parts);
    refuse(fabric.curves.size(), "curve", fabric.curves.empty() ? "" : fabric.curves.front().name,
           &formats::Descriptor::carries_lines);
  }
  return !job.has_failed();
}

void write_others(Job& job, const fabric::Fabric& fabric, OpenOutputs& outputs) {
  const Unit units = job.shown().unit;
  for (const fabric::Piece* piece : fabric::pieces_of(fabric)) {
    std::optional<fabric::PieceShape> shape = job.build_piece(fabric, *piece);
    if (!shape || job.has_failed()) continue;  // the others are tried, so that every error is told
    convert_lengths(*shape, fabric.units, units);
    add_to_all(job, outputs, [&](OpenOutput& output) { return output.writer->add_piece(*shape); });
  }
  for (cad::Part part : fabric.parts) {
    if (job.has_failed()) return;
    convert_lengths(part, fabric.units, units);
    add_to_all(job, outputs, [&](OpenOutput& output) { return output.writer->add_part(part); });
  }
  for (cad::NamedCurve curve : fabric.curves) {
    if (job.has_failed()) return;
    convert_lengths(curve, fabric.units, units);
    add_to_all(job, outputs, [&](OpenOutput& output) { return output.writer->add_curve(curve); });
  }
}

// What a surface format is given of a unit cell: solids.
void write_cell(Job& job, fabric::Fabric& fabric, OpenOutputs& outputs) {
  const std::optional<fabric::YarnBuilder> builder = job.builder(fabric);
  if (!builder) return;
  if (fabric.cell && fabric.cell->names_axes()) snap_cell(job, fabric, *builder);
  std::optional<std::vector<cad::Part>> parts = cell_solids(job, fabric, *builder);
  if (!parts || !open_writers(job, fabric, parts->size(), outputs)) return;
  for (std::size_t i = 0; i < parts->size(); ++i) {
    cad::Part& part = (*parts)[i];
    job.progress("writing solid", i + 1, parts->size());
    convert_lengths(part, fabric.units, job.shown().unit);
    if (!add_to_all(job, outputs, [&](OpenOutput& output) { return output.writer->add_part(part); })) return;
  }
  for (OpenOutput& output : outputs)
    if (!take_facts(job, output, output.writer->finish())) return;
}

// Solids are what is cut: a format holds them, or is refused before anything is built.
bool holds_solids(Job& job, const OpenOutputs& outputs) {
  for (const OpenOutput& output : outputs) {
    const formats::Descriptor& format = *output.plan->format;
    if (output.plan->as_companion != nullptr ||
        (format.write_fabric == nullptr && format.open_bodies != nullptr && format.carries_parts))
      continue;
    job.say(error(Kind::usage, fmt::format("{} holds no solids, which {} makes: write {}", format.name,
                                           job.options.matrix ? "--matrix" : "--cut",
                                           formats_with(&formats::Descriptor::carries_parts))));
  }
  return !job.has_failed();
}

// So are centre lines, where they are asked for.
bool holds_lines(Job& job, const OpenOutputs& outputs) {
  if (!job.options.lines) return true;
  for (const OpenOutput& output : outputs)
    if (!output.plan->format->carries_lines && output.plan->as_companion == nullptr)
      job.say(error(Kind::usage, fmt::format("{} holds no centre lines, which --lines makes: write {}",
                                             output.plan->format->name,
                                             formats_with(&formats::Descriptor::carries_lines))));
  return !job.has_failed();
}

// The first of two passes; what fails here is told in the second one.
std::optional<InstanceFinder> find_instances(Job& job, const fabric::Fabric& fabric,
                                             const fabric::YarnBuilder& builder) {
  if (!job.options.instances) return std::nullopt;
  const Unit units = job.shown().unit;
  InstanceFinder finder(converted(fabric::tolerance_of(fabric, job.build_options()), fabric.units, units));
  job.build_each(builder, "comparing yarn", [&](std::size_t /*index*/, Result<yarn::Body>&& body) {
    if (!body) return true;
    convert_lengths(*body, fabric.units, units);
    finder.count(*body);
    return true;
  });
  return finder;
}

void report_instances(Job& job, const InstanceFinder& finder, Unit units) {
  const InstanceFinder::Found& found = finder.found();
  job.report["instances"] = {{"shapes", found.shapes},
                             {"copies", found.copies},
                             {"largest_deviation", found.largest_deviation * millimetres_per(units)}};
}

void write_surfaces(Job& job, const fabric::Fabric& fabric, OpenOutputs& outputs) {
  const std::optional<fabric::YarnBuilder> builder = job.builder(fabric);
  if (!builder || !can_carry(job, fabric, builder->count(), outputs) ||
      !open_writers(
          job, fabric,
          builder->count() + fabric::pieces_of(fabric).size() + fabric.parts.size() + fabric.curves.size(),
          outputs))
    return;
  const Unit units = job.shown().unit;
  std::optional<InstanceFinder> finder = find_instances(job, fabric, *builder);
  std::optional<double> thinnest;
  bool is_written = true;
  job.for_each_yarn(*builder, "writing yarn", [&](yarn::Body&& body) {
    if (job.wants_report()) {
      const double own = yarn::narrowest_section(body);
      thinnest = std::min(thinnest.value_or(own), own);
    }
    convert_lengths(body, fabric.units, units);
    if (job.has_failed()) return true;
    const std::optional<formats::Instance> instance = finder ? finder->place(body) : std::nullopt;
    return is_written = add_to_all(
               job, outputs,
               [&](OpenOutput& output) {
                 if (takes_lines(job, *output.plan->format)) return output.writer->add_line(body);
                 return instance ? output.writer->add_instance(body, *instance) : output.writer->add(body);
               },
               body.surface.points.size());
  });
  if (!is_written) return;
  write_others(job, fabric, outputs);
  if (job.has_failed()) return;
  for (OpenOutput& output : outputs)
    if (output.writer && !take_facts(job, output, output.writer->finish())) return;
  if (finder) report_instances(job, *finder, units);
  if (thinnest)
    job.report["creo_absolute_accuracy"] =
        if_known(creo_accuracy(*thinnest * millimetres_per(fabric.units), {}));
}

// A text is written without its yarns being built; what is wrong with those that were moved is said all the
// same.
void look_at_yarns(Job& job, const fabric::Fabric& fabric) {
  if (const std::optional<fabric::YarnBuilder> builder = job.builder(fabric))
    job.for_each_yarn(*builder, "looking at yarn", [](yarn::Body&& /*body*/) { return true; });
}

}  // namespace

void convert(Job& job) {
  std::optional<fabric::Fabric> fabric = job.read();
  fabric = relaxed(job, std::move(fabric));
  if (!fabric) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  if (job.options.cut) {
    if (holds_solids(job, *outputs)) write_cell(job, *fabric, *outputs);
    return commit_all(job, *outputs);
  }
  if (!holds_lines(job, *outputs)) return;
  bool has_surfaces = false;
  for (OpenOutput& output : *outputs) {
    if (output.plan->format->write_fabric == nullptr)
      has_surfaces = true;
    else if (!take_facts(job, output, output.plan->format->write_fabric(*fabric, output.file)))
      return;
  }
  if (has_surfaces)
    write_surfaces(job, *fabric, *outputs);
  else if (job.options.relaxing.wanted)
    look_at_yarns(job, *fabric);
  commit_all(job, *outputs);
}

}  // namespace selvage::pipeline
