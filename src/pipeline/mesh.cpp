// `selvage mesh`: elements in every yarn or in a unit cell, and decks of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fem/mesher.h"
#include "pipeline/mesh_facts.h"
#include "pipeline/meshing.h"
#include "pipeline/overlaps.h"
#include "pipeline/relaxing.h"
#include "pipeline/unit_cell.h"
#include "pipeline/writing.h"
#include "solid/check.h"

namespace selvage::pipeline {

namespace {

// Overlapping yarns cannot be meshed as what they are.
void add_remedy(const Options& options, Message& message) {
  if (options.allow_overlap) {
    message.severity = Severity::warning;
  } else {
    message.text +=
        options.relaxing.wanted
            ? "; thin one of them, or mesh them as they are with --allow-overlap"
            : "; --relax moves them apart where they have room, --allow-overlap meshes them as they are";
  }
}

}  // namespace

fem::MeshOptions mesh_options(Job& job) {
  const Options& given = job.options;
  fem::MeshOptions options;
  options.size = given.size;
  options.order = std::max(given.order, 1);
  if (given.min_dihedral > 0) options.min_dihedral = given.min_dihedral;
  constexpr double worker_share = 0.9;
  if (given.timeout > 0) options.timeout = worker_share * given.timeout;
  if (given.memory > 0) options.memory = given.memory;
  options.threads = static_cast<int>(job.threads);
  options.progress = [&job](const char* step, std::size_t done, std::size_t total) {
    job.progress(step, done, total);
  };
  return options;
}

namespace {

// Tetrahedra fill yarns; a garment piece is flat. False: it was said which piece is there.
bool has_only_yarns(Job& job, const fabric::Fabric& fabric) {
  const std::vector<const fabric::Piece*> pieces = fabric::pieces_of(fabric);
  if (pieces.empty()) return true;
  return job.fail(error(Kind::unsupported,
                        fmt::format("piece '{}' is a flat face, which has no volume to fill with tetrahedra: "
                                    "convert it to a CAD file, and mesh the face there",
                                    pieces.front()->name),
                        {.place = pieces.front()->place}));
}

std::optional<MadeMesh> mesh_of_yarns(Job& job, const fabric::Fabric& fabric,
                                      const fabric::YarnBuilder& builder, Diagnostics& diagnostics) {
  const std::optional<std::vector<yarn::Body>> bodies = job.build_all(builder);
  const auto finish = [&job](Message& message) { add_remedy(job.options, message); };
  if (!bodies || !check_overlaps(job, *bodies, finish)) return std::nullopt;
  return MadeMesh{fem::mesh_yarns(fabric, *bodies, fabric.units, mesh_options(job), diagnostics)};
}

// On the console: the cell's fractions, the worst volume.
void tell_volumes(Job& job, const fem::Mesh& mesh) {
  if (const std::string words = volumes_in_words(mesh); !words.empty())
    tell(job, fmt::format("{}: {}\n", job.input.path, words));
  if (std::optional<Message> message = wrong_volume(mesh)) job.say(std::move(*message));
}

}  // namespace

void mesh(Job& job) {
  const Options& options = job.options;
  const bool is_cell = options.wants_cell();
  std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric || !has_only_yarns(job, *fabric)) return;
  if (is_cell && !check_cell_text(job, *fabric, options.matrix)) return;
  fabric = relaxed(job, std::move(fabric));
  if (!fabric) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  const std::optional<fabric::YarnBuilder> builder = job.builder(*fabric);
  if (!builder) return;

  Diagnostics diagnostics;
  const std::optional<MadeMesh> made = is_cell ? mesh_of_cell(job, *fabric, *builder, diagnostics)
                                               : mesh_of_yarns(job, *fabric, *builder, diagnostics);
  if (!made) return;
  job.say_all(diagnostics.messages());
  if (!made->mesh) return job.say(made->mesh.error());
  job.report["mesh"] = mesh_json(*made->mesh, made->estimate);
  tell_volumes(job, *made->mesh);
  write_mesh(job, *outputs, *made->mesh);
}

}  // namespace selvage::pipeline
