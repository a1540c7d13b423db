// `selvage convert`: each yarn is built once, handed to every surface format, and forgotten.
#include <algorithm>

#include "pipeline/facts.h"
#include "pipeline/scaling.h"
#include "pipeline/writing.h"

namespace selvage::pipeline {

namespace {

formats::SurfaceOptions surface_options(const Job& job, const fabric::Fabric& fabric,
                                        const PlannedOutput& output, std::uint64_t count) {
  formats::SurfaceOptions surface;
  surface.title = fabric.title.value_or("");
  surface.file_name =
      output.to_standard_output ? job.input.stem.filename().string() : output.path.filename().string();
  surface.units = job.options.units.value_or(fabric.units);
  surface.expected_bodies = count;
  surface.tolerance =
      converted(fabric::tolerance_of(fabric, job.build_options()), fabric.units, surface.units);
  surface.iges_solid = job.options.iges_solid;
  surface.step_schema = job.options.step_schema;
  return surface;
}

bool open_writers(Job& job, const fabric::Fabric& fabric, std::size_t count, OpenOutputs& outputs) {
  for (OpenOutput& output : outputs) {
    if (output.plan->format->write_fabric != nullptr) continue;
    Result<std::unique_ptr<formats::BodyWriter>> writer =
        output.plan->format->open_bodies(output.file, surface_options(job, fabric, *output.plan, count));
    if (!writer) {
      job.say(writer.error());
      return false;
    }
    output.writer = std::move(*writer);
  }
  return true;
}

bool add_to_all(Job& job, const yarn::Body& body, OpenOutputs& outputs) {
  for (OpenOutput& output : outputs) {
    if (!output.writer) continue;
    if (Status status = output.writer->add(body); !status.ok()) {
      job.say(status.error());
      return false;
    }
  }
  return true;
}

void write_surfaces(Job& job, const fabric::Fabric& fabric, OpenOutputs& outputs) {
  const std::optional<fabric::YarnBuilder> builder = job.builder(fabric);
  if (!builder || !open_writers(job, fabric, builder->count(), outputs)) return;
  const Unit units = job.options.units.value_or(fabric.units);
  std::optional<double> thinnest;
  for (std::size_t i = 0; i < builder->count(); ++i) {
    job.progress("writing yarn", i + 1, builder->count());
    std::optional<yarn::Body> body = job.build(*builder, i);
    if (!body) continue;  // the others are tried, so that every error is told
    if (job.wants_report())
      thinnest = std::min(thinnest.value_or(thinnest_section(*body)), thinnest_section(*body));
    convert_lengths(*body, fabric.units, units);
    if (!job.has_failed() && !add_to_all(job, *body, outputs)) return;
  }
  if (job.has_failed()) return;
  for (OpenOutput& output : outputs)
    if (output.writer && !take_facts(job, output, output.writer->finish())) return;
  if (thinnest)
    job.report.creo_absolute_accuracy = creo_accuracy(*thinnest * millimetres_per(fabric.units), {});
}

}  // namespace

void convert(Job& job) {
  const std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  bool has_surfaces = false;
  for (OpenOutput& output : *outputs) {
    if (output.plan->format->write_fabric == nullptr)
      has_surfaces = true;
    else if (!take_facts(job, output, output.plan->format->write_fabric(*fabric, output.file)))
      return;
  }
  if (has_surfaces) write_surfaces(job, *fabric, *outputs);
  commit_all(job, *outputs);
}

}  // namespace selvage::pipeline
