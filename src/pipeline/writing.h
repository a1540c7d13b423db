// The outputs of one input: opened together, committed together.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/output.h"
#include "formats/format.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

struct OpenOutput {
  const PlannedOutput* plan = nullptr;
  OutputFile file;
  std::deque<OutputFile> parts;    // files 2, 3, ... where one does not hold all
  std::deque<OutputFile> members;  // the other files of a folder (formats::Descriptor::folders)
  formats::WriteFacts facts;
  std::unique_ptr<formats::BodyWriter> writer;  // of surface formats; refers to `file`
};

// A deque, for its elements stay where they are.
using OpenOutputs = std::deque<OpenOutput>;

// Nothing when one cannot be opened (it was said why).
std::optional<OpenOutputs> open_outputs(Job& job);

// The name of the file that stands beside this one (formats::Companion); empty: there is none.
std::string companion_of(const OpenOutput& output, const OpenOutputs& outputs);

// On standard output; on standard error where that has a file; nowhere with --quiet. `text` ends its last
// line.
void tell(Job& job, const std::string& text);

// What outputs of `mesh` ask for: elements or beams, and fields on voxels.
struct Meshes {
  std::optional<fem::Mesh> mesh;
  std::optional<fem::BeamModel> beams;
  std::optional<fem::Raster> raster;
  std::optional<fem::Forming> forming;  // of the mesh, or the beams
};

// Writes to every output what it takes of them, and commits them; what goes wrong is said.
void write_meshes(Job& job, OpenOutputs& outputs, const Meshes& meshes);

// Opens the next file of an output, for its writer. Errors: io; usage: an input or another output has the
// name.
Result<OutputFile*> open_part(OpenOutput& output, int number);

// Opens another file of a folder, for its writer. Errors: io.
Result<OutputFile*> open_member(OpenOutput& output, std::string_view name);

// Takes the facts of one finished format; false when it failed (it was said why).
bool take_facts(Job& job, OpenOutput& output, Result<formats::WriteFacts> facts);

// Gives every output its name, and puts it into the report; does nothing when the job has failed.
void commit_all(Job& job, OpenOutputs& outputs);

}  // namespace selvage::pipeline
