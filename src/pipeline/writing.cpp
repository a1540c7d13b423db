#include "pipeline/writing.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/sha256.h"
#include "pipeline/parts.h"

namespace selvage::pipeline {

std::optional<OpenOutputs> open_outputs(Job& job) {
  OpenOutputs outputs;
  for (const PlannedOutput& plan : job.outputs) {
    Result<OutputFile> file =
        plan.to_standard_output ? OutputFile::standard_output() : OutputFile::create(places_of(plan).front());
    if (!file) return job.fail(file.error());
    outputs.push_back({&plan, std::move(*file), {}, {}, {}, nullptr});
  }
  return outputs;
}

std::string companion_of(const OpenOutput& output, const OpenOutputs& outputs) {
  for (const OpenOutput& other : outputs)
    if (other.plan->as_companion == &output.plan->format->companion)
      return std::filesystem::path(other.plan->path).filename().string();
  return {};
}

Result<OutputFile*> open_part(OpenOutput& output, int number) {
  for (const int part : {1, number}) {
    const std::filesystem::path path = part_path(output.plan->path, part);
    const auto& taken = output.plan->taken;
    if (std::find(taken.begin(), taken.end(), path) == taken.end()) continue;
    return error(Kind::usage,
                 fmt::format("'{}' does not fit into one file, and its file {}, '{}', would replace "
                             "an input or another output; name another place with -o",
                             output.plan->path, part, path.string()));
  }
  Result<OutputFile> file = OutputFile::create(part_path(output.plan->path, number));
  if (!file) return file.error();
  return &output.parts.emplace_back(std::move(*file));
}

Result<OutputFile*> open_member(OpenOutput& output, std::string_view name) {
  Result<OutputFile> file = OutputFile::create(std::filesystem::path(output.plan->path) / name);
  if (!file) return file.error();
  return &output.members.emplace_back(std::move(*file));
}

namespace {

// Puts one output file into the list for the report; false when that failed (it was said why).
bool report_file(Job& job, const OpenOutput& output, const OutputFile& file,
                 const formats::EntityCounts& entities, Json& written) {
  const Result<std::string> digest = job.wants_report() ? sha256_of(file) : std::string();
  if (!digest) return job.fail(digest.error());
  written.push_back({{"path", output.plan->to_standard_output ? output.plan->path : file.target().string()},
                     {"format", output.plan->format->name},
                     {"bytes", file.size()},
                     {"sha256", *digest},
                     {"entities", if_true(!entities.empty(), entities)}});
  return true;
}

// All files of an output, named and for the report; false when that failed (it was said why).
bool report_files(Job& job, OpenOutput& output, Json& written) {
  const std::vector<formats::EntityCounts>& parts = output.facts.parts;
  if (!output.parts.empty()) {
    const std::filesystem::path first = part_path(output.plan->path, 1);
    if (Status status = output.file.set_target(first); !status.ok()) return job.fail(status.error());
    job.say(
        warning(Kind::limit, fmt::format("too long for one {} file: written as {} files, '{}' to '{}', each "
                                         "whole; '{}' stands for all of them",
                                         output.plan->format->name, parts.size(), first.string(),
                                         output.parts.back().target().string(), first.string())));
  }
  for (std::size_t k = 0; k <= output.parts.size(); ++k) {
    const OutputFile& file = k == 0 ? output.file : output.parts[k - 1];
    if (!report_file(job, output, file, parts.empty() ? output.facts.entities : parts[k], written))
      return false;
  }
  return std::ranges::all_of(output.members, [&](const OutputFile& member) {
    return report_file(job, output, member, {}, written);
  });
}

// All files together; what an earlier run left in their places goes last.
Status commit(OpenOutputs& outputs) {
  std::vector<OutputFile*> files;
  for (OpenOutput& output : outputs) {
    files.push_back(&output.file);
    for (auto* more : {&output.parts, &output.members})
      for (OutputFile& file : *more) files.push_back(&file);
  }
  if (Status status = OutputFile::commit(files); !status) return status;
  for (const OpenOutput& output : outputs) {
    if (output.plan->to_standard_output || output.plan->format->part_mark == nullptr) continue;
    const auto count = static_cast<int>(output.parts.size());
    Status removed = remove_stale_parts(output.plan->path, count > 0 ? count + 2 : 1, output.plan->taken);
    if (!removed) return removed;
  }
  return {};
}

}  // namespace

bool take_facts(Job& job, OpenOutput& output, Result<formats::WriteFacts> facts) {
  if (!facts) return job.fail(facts.error());
  output.facts = std::move(*facts);
  job.say_all(output.facts.messages);
  return true;
}

void commit_all(Job& job, OpenOutputs& outputs) {
  if (job.has_failed()) return;
  Json written = Json::array();
  for (OpenOutput& output : outputs)
    if (!report_files(job, output, written)) return;
  if (job.has_failed()) return;  // --strict
  if (Status status = commit(outputs); !status) return job.say(status.error());
  job.tell_files(written.size());
  for (const Json& output : written) {
    if (!job.options.verbose) continue;
    Message note;
    note.severity = Severity::note;
    note.text =
        fmt::format("wrote '{}', {} bytes", text_at(output, "path"), output["bytes"].get<std::uint64_t>());
    job.say(std::move(note));
  }
  if (!written.empty()) job.report["outputs"] = std::move(written);
}

void tell(Job& job, const std::string& text) {
  if (job.options.quiet) return;
  const bool to_standard_output = std::any_of(job.outputs.begin(), job.outputs.end(),
                                              [](const PlannedOutput& o) { return o.to_standard_output; });
  if (!to_standard_output)
    job.print(text);
  else  // standard output has the file
    job.channel().send(packet::message, text.substr(0, text.size() - 1));
}

void write_meshes(Job& job, OpenOutputs& outputs, const Meshes& meshes) {
  const std::optional<fem::Mesh>& mesh = meshes.mesh;
  if (!mesh || mesh->load_cases.empty())
    std::erase_if(outputs, [](const OpenOutput& output) {
      return output.plan->as_companion != nullptr && output.plan->as_companion->is_of_load_cases;
    });
  for (OpenOutput& output : outputs) {
    const formats::Descriptor& format = *output.plan->format;
    const formats::MeshFileOptions options = {
        companion_of(output, outputs), job.options.of_formats, meshes.forming ? &*meshes.forming : nullptr,
        [&output](std::string_view name) { return open_member(output, name); }};
    if (!take_facts(job, output,
                    format.write_raster != nullptr ? format.write_raster(*meshes.raster, output.file)
                    : meshes.beams                 ? format.write_beams(*meshes.beams, output.file, options)
                                                   : format.write_mesh(*mesh, output.file, options)))
      return;
  }
  commit_all(job, outputs);
}

}  // namespace selvage::pipeline
