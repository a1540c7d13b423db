// `selvage mesh`: elements in every yarn or in a unit cell, and decks of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "fem/fibre.h"
#include "pipeline/mesh_facts.h"
#include "pipeline/meshing.h"
#include "pipeline/overlaps.h"
#include "pipeline/relaxing.h"
#include "pipeline/writing.h"
#include "solid/check.h"
#include "structured/beams.h"
#include "structured/swept.h"
#include "tetrahedra/mesher.h"

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
  if (const double seconds = given.timeout > 0 ? given.timeout : job.seconds; seconds > 0)
    options.timeout = worker_share * seconds;
  if (given.memory > 0) options.memory = given.memory;
  options.threads = static_cast<int>(job.threads);
  options.progress = [&job](const char* step, std::size_t done, std::size_t total) {
    job.progress(step, done, total);
  };
  return options;
}

std::optional<std::vector<yarn::Body>> bodies_to_mesh(Job& job, const fabric::YarnBuilder& builder) {
  std::optional<std::vector<yarn::Body>> bodies = job.build_all(builder);
  if (bodies && job.options.ignores_twist)
    for (yarn::Body& body : *bodies) body.twist = 0;
  return bodies;
}

namespace {

// Elements fill yarns; a garment piece is flat. False: it was said which piece is there.
bool has_only_yarns(Job& job, const fabric::Fabric& fabric) {
  const std::vector<const fabric::Piece*> pieces = fabric::pieces_of(fabric);
  if (pieces.empty()) return true;
  return job.fail(error(Kind::unsupported,
                        fmt::format("piece '{}' is a flat face, which has no volume to fill with elements: "
                                    "convert it to a CAD file, and mesh the face there",
                                    pieces.front()->name),
                        {.place = pieces.front()->place}));
}

std::optional<MadeMesh> mesh_of_yarns(Job& job, const fabric::Fabric& fabric,
                                      const fabric::YarnBuilder& builder, Diagnostics& diagnostics) {
  const std::optional<std::vector<yarn::Body>> bodies = bodies_to_mesh(job, builder);
  const auto finish = [&job](Message& message) { add_remedy(job.options, message); };
  if (!bodies || !check_overlaps(job, *bodies, finish)) return std::nullopt;
  if (job.options.elements == Elements::hexahedra)
    return MadeMesh{fem::mesh_swept(fabric, *bodies, fabric.units,
                                    {.size = job.options.size,
                                     .threads = static_cast<int>(job.threads),
                                     .progress = job.progress_of("sweeping yarn")},
                                    diagnostics)};
  return MadeMesh{fem::mesh_yarns(fabric, *bodies, fabric.units, mesh_options(job), diagnostics)};
}

// On the console: the cell's fractions, the worst volume.
void tell_volumes(Job& job, const fem::Mesh& mesh) {
  if (const std::string words = volumes_in_words(mesh); !words.empty())
    tell(job, fmt::format("{}: {}\n", job.input.path, words));
  if (std::optional<Message> message = wrong_volume(mesh)) job.say(std::move(*message));
}

// Whether a fluid can go through at all.
void tell_passages(Job& job, const fem::Mesh& mesh) {
  const fem::Passages passages = fem::find_passages(mesh);
  job.report["mesh"]["passages"] = passages_json(passages);
  tell(job, fmt::format("{}: {}\n", job.input.path, passages_in_words(passages)));
  if (std::optional<Message> message = shut_pores(mesh, passages)) job.say(std::move(*message));
}

void take(Job& job, MadeMesh made, Meshes& all) {
  if (!made.mesh) return job.say(made.mesh.error());
  job.report["mesh"] = mesh_json(*made.mesh, made.estimate);
  if (job.options.elements == Elements::hexahedra)
    tell(job, fmt::format("{}: {}\n", job.input.path, hexahedra_in_words(*made.mesh)));
  else if (made.mesh->shape == fem::Mesh::Shape::tetrahedron)
    tell(job, fmt::format("{}: {}\n", job.input.path, tetrahedra_in_words(*made.mesh)));
  if (!made.mesh->interfaces.empty())
    tell(job, fmt::format("{}: {}\n", job.input.path, interfaces_in_words(*made.mesh)));
  if (!made.mesh->layers.wedges.empty())
    tell(job, fmt::format("{}: {}\n", job.input.path, layers_in_words(*made.mesh, job.file_units())));
  tell_volumes(job, *made.mesh);
  if (!made.mesh->patches.empty()) tell_passages(job, *made.mesh);
  all.mesh = std::move(*made.mesh);
}

// A beam has one modulus along it, which is that of straight fibres.
void warn_of_twist(Job& job, const fabric::Fabric& fabric, const std::vector<yarn::Body>& bodies) {
  double steepest = 0;
  const yarn::Body* worst = nullptr;
  for (const yarn::Body& body : bodies) {
    // Of a round section as large as the first one.
    const double radius = std::sqrt(fem::section_area(body, body.surface.first_v()) / std::numbers::pi);
    const double tangent = 2 * std::numbers::pi * std::abs(body.twist) * radius;
    if (tangent <= steepest) continue;
    steepest = tangent;
    worst = &body;
  }
  constexpr double least = 0.05;  // cos^4 is 0.995
  if (steepest < least) return;
  job.say(
      warning(
          Kind::geometry,
          fmt::format(
              "the fibres of yarn '{}' lie at {:.3g} degrees on its outside, and its beams are as stiff as "
              "if they ran along it: solid elements follow them, and --twist ignore leaves the twist out",
              worst->name, std::atan(steepest) * 180 / std::numbers::pi))
          .placed(worst->place, fabric.file));
}

// Beams of yarns that overlap are fine: they have no volume to share.
void make_beams(Job& job, const fabric::Fabric& fabric, const fabric::YarnBuilder& builder, Meshes& all) {
  const std::optional<std::vector<yarn::Body>> bodies = bodies_to_mesh(job, builder);
  if (!bodies) return;
  warn_of_twist(job, fabric, *bodies);
  Diagnostics diagnostics;
  Result<fem::BeamModel> beams = fem::make_beams(fabric, *bodies, fabric.units,
                                                 {.size = job.options.size,
                                                  .trusses = job.options.elements == Elements::trusses,
                                                  .threads = static_cast<int>(job.threads),
                                                  .progress = job.progress_of("beams of yarn")},
                                                 diagnostics);
  job.say_all(diagnostics.messages());
  if (!beams) return job.say(beams.error());
  job.report["mesh"] = beams_json(*beams);
  tell(job, fmt::format("{}: {}\n", job.input.path, beams_in_words(*beams)));
  all.beams = std::move(*beams);
}

void take(Job& job, Result<fem::Raster> raster, Meshes& all) {
  if (!raster) return job.say(raster.error());
  job.report["voxels"] = raster_json(*raster);
  tell(job, fmt::format("{}: {}\n", job.input.path, raster_in_words(*raster)));
  all.raster = std::move(*raster);
}

// The explicit step of what was meshed, and what it will cost.
void plan_forming(Job& job, Meshes& all) {
  if (!all.mesh && !all.beams) return;
  const FormingSettings& given = job.options.forming;
  const double scale = millimetres_per(job.file_units());
  const auto in_mm = [&](const std::optional<double>& length) {
    return length ? std::optional(*length * scale) : std::nullopt;
  };
  fem::FormingOptions options = {.load = given.load,
                                 .stroke = in_mm(given.stroke),
                                 .thickness = in_mm(given.thickness),
                                 .friction = given.friction,
                                 .duration = given.duration,
                                 .file = job.input.path};
  if (given.load == fem::FormingLoad::frame) options.stroke = given.stroke;  // an angle
  const std::span<const double> radii =
      all.beams ? std::span<const double>(all.beams->radii) : std::span<const double>();
  Result<fem::Forming> forming = fem::plan_forming(all.beams ? all.beams->mesh : *all.mesh, radii, options);
  if (!forming) return job.say(forming.error());
  job.report["mesh"]["explicit"] = forming_json(*forming);
  tell(job, fmt::format("{}: {}\n", job.input.path, forming_in_words(*forming)));
  all.forming = std::move(*forming);
}

// Of what the outputs ask for: empty where they ask for none, or it failed (it was said).
Meshes make(Job& job, fabric::Fabric& fabric, const fabric::YarnBuilder& builder, bool wants_mesh,
            bool wants_raster) {
  Meshes all;
  if (are_lines(job.options.elements)) {
    make_beams(job, fabric, builder, all);
    return all;
  }
  Diagnostics diagnostics;
  if (!job.options.wants_cell()) {
    std::optional<MadeMesh> made = mesh_of_yarns(job, fabric, builder, diagnostics);
    job.say_all(diagnostics.messages());
    if (made) take(job, std::move(*made), all);
    return all;
  }
  const std::optional<ReadyCell> ready = prepare_cell(job, fabric, builder);
  if (!ready) return all;
  std::optional<MadeMesh> mesh;
  std::optional<Result<fem::Raster>> raster;
  if (wants_mesh) mesh = mesh_of_cell(job, fabric, *ready, diagnostics);
  if (wants_raster) raster = raster_of_cell(job, fabric, *ready, diagnostics);
  job.say_all(diagnostics.messages());
  if (mesh) take(job, std::move(*mesh), all);
  if (raster) take(job, std::move(*raster), all);
  return all;
}

}  // namespace

void mesh(Job& job) {
  const Options& options = job.options;
  std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric || !has_only_yarns(job, *fabric)) return;
  if (!set_matrix_material(job, *fabric)) return;
  if (options.wants_cell() && !check_cell_text(job, *fabric, options.matrix && !options.pores)) return;
  fabric = relaxed(job, std::move(fabric));
  if (!fabric) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  const std::optional<fabric::YarnBuilder> builder = job.builder(*fabric);
  if (!builder) return;
  const auto is_wanted = [&](auto writes) {
    return std::ranges::any_of(
        job.outputs, [&](const PlannedOutput& output) { return output.format->*writes != nullptr; });
  };
  Meshes made = make(job, *fabric, *builder, is_wanted(&formats::Descriptor::write_mesh),
                     is_wanted(&formats::Descriptor::write_raster));
  if (options.forming.wanted && !job.has_failed()) plan_forming(job, made);
  if (!job.has_failed()) write_meshes(job, *outputs, made);
}

}  // namespace selvage::pipeline
