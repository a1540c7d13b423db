#include "pipeline/writing.h"

#include <fmt/format.h>

#include "core/sha256.h"

namespace selvage::pipeline {

std::optional<OpenOutputs> open_outputs(Job& job) {
  OpenOutputs outputs;
  for (const PlannedOutput& plan : job.outputs) {
    Result<OutputFile> file =
        plan.to_standard_output ? OutputFile::standard_output() : OutputFile::create(plan.path);
    if (!file) {
      job.say(file.error());
      return std::nullopt;
    }
    outputs.push_back({&plan, std::move(*file), {}, nullptr});
  }
  return outputs;
}

bool take_facts(Job& job, OpenOutput& output, Result<formats::WriteFacts> facts) {
  if (!facts) {
    job.say(facts.error());
    return false;
  }
  output.facts = std::move(*facts);
  job.say_all(output.facts.messages);
  return true;
}

void commit_all(Job& job, OpenOutputs& outputs) {
  if (job.has_failed()) return;
  std::vector<OutputReport> written;
  for (OpenOutput& output : outputs) {
    OutputReport facts{output.plan->path.string(),
                       std::string(output.plan->format->name),
                       {},
                       output.file.size(),
                       output.facts.entities};
    if (job.wants_report()) {
      Result<std::string> digest = sha256_of(output.file);
      if (!digest) return job.say(digest.error());
      facts.sha256 = *digest;
    }
    written.push_back(std::move(facts));
  }
  for (OpenOutput& output : outputs)
    if (Status status = output.file.commit(); !status.ok()) return job.say(status.error());
  for (const OutputReport& output : written) {
    if (!job.options.verbose) continue;
    Message note;
    note.severity = Severity::note;
    note.text = fmt::format("wrote '{}', {} bytes", output.path, output.bytes);
    job.say(std::move(note));
  }
  job.report.outputs = std::move(written);
}

}  // namespace selvage::pipeline
