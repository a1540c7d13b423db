// `selvage view`: a picture or a page of each input.
#include "pipeline/view.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>

#include "core/source.h"
#include "core/text_report.h"
#include "pipeline/detect.h"
#include "pipeline/mesh_deck.h"
#include "pipeline/mesh_page.h"
#include "pipeline/mesh_picture.h"
#include "pipeline/page.h"
#include "pipeline/writing.h"
#include "results/solved_deck.h"
#include "view/scale_bar.h"

namespace selvage::pipeline {

namespace {

// From where a section is seen as it is; else the plan.
view::From usual_view(const Options& options) {
  constexpr std::array views = {view::From::side, view::From::front, view::From::plan};
  return options.section ? views[static_cast<std::size_t>(options.section->axis)] : view::From::plan;
}

}  // namespace

view::PictureOptions picture_options(Job& job, std::span<const yarn::Body> bodies) {
  const Options& given = job.options;
  view::PictureOptions options;
  options.width = given.picture_width;
  options.height = given.picture_height;
  options.eye.from = given.from.value_or(usual_view(given));
  options.eye.upright = view::upright_of(bodies);
  options.eye.zoom = given.zoom;
  if (given.azimuth || given.elevation)
    options.eye.angles = {given.azimuth.value_or(0.0), given.elevation.value_or(0.0)};
  options.section = given.section;
  options.background = given.background;
  options.flat = given.flat;
  options.threads = static_cast<int>(job.threads);
  options.progress = job.progress_of("drawing tile");
  return options;
}

Result<std::string> draw(const Job& job, std::span<const yarn::Body> bodies,
                         const view::PictureOptions& options) {
  view::PictureOptions above = options;
  const int rows = job.options.no_scale_bar ? 0 : view::scale_bar_rows(options.width, options.height);
  above.height -= rows;
  Result<view::Picture> picture = view::render(bodies, above);
  if (!picture) return picture.error();
  if (rows > 0) view::add_scale_bar(*picture, rows, job.file_units(), options.background);
  return view::png(*picture);
}

bool is_shown(const Options& options, const yarn::BodyLabel& yarn) {
  return is_shown(options, yarn.name, yarn.group);
}

bool is_shown(const Options& options, const std::string& name, const std::string& group) {
  const auto matches = [&](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0 ||
           (!group.empty() && ::fnmatch(pattern.c_str(), group.c_str(), 0) == 0);
  };
  return options.shown_yarns.empty() ||
         std::any_of(options.shown_yarns.begin(), options.shown_yarns.end(), matches);
}

Message none_shown(const Options& options) {
  return error(Kind::unsupported, fmt::format("no yarn has a name like {}; selvage info lists the names",
                                              in_quotes(options.shown_yarns.front())));
}

namespace {

void write_pictures(Job& job, const fabric::YarnBuilder& builder, OpenOutputs& outputs) {
  std::optional<std::vector<yarn::Body>> bodies = job.build_all(builder);
  if (!bodies || job.has_failed()) return;
  const view::PictureOptions options = picture_options(job, *bodies);
  std::erase_if(*bodies, [&](const yarn::Body& body) { return !is_shown(job.options, body); });
  if (bodies->empty()) return job.say(none_shown(job.options));
  const Result<std::string> picture = draw(job, *bodies, options);
  if (!picture) return job.say(picture.error());
  for (OpenOutput& output : outputs)
    if (Status status = output.file.write(*picture); !status.ok()) return job.say(status.error());
}

// The format of an input that is a mesh; null: it is none, or cannot be opened (which is told when it is
// read).
const formats::Descriptor* mesh_format(const Job& job) {
  if (job.input.path == "-") return nullptr;
  const Result<Source> source = Source::open(job.input.path);
  const formats::Descriptor* format = source ? format_of(*source) : nullptr;
  return format != nullptr && format->read_mesh != nullptr && !format->is_readable() ? format : nullptr;
}

std::optional<fem::FieldMesh> read_mesh(Job& job, const formats::Descriptor& format) {
  const Result<Source> source = Source::open(job.input.path);
  if (!source) return job.fail(source.error());
  Diagnostics diagnostics;
  std::optional<fem::FieldMesh> mesh = format.read_mesh(*source, diagnostics);
  job.say_all(diagnostics.messages());
  if (!mesh || job.has_failed() || !take_deck(job, *mesh)) return std::nullopt;
  fem::add_along_fibre(*mesh);
  return mesh;
}

Status write_mesh_page(Job& job, const fem::FieldMesh& mesh, OutputFile& output) {
  const Result<std::string> library = view::page::library();
  return library ? view::page::write(mesh_page(job, mesh), *library, output) : Status(library.error());
}

// What pictures of meshes have not, and what pages let choose for themselves.
std::optional<Message> not_of_a_mesh(const Options& given, bool is_page) {
  if (given.section)
    return error(Kind::unsupported, "--section is of yarns: a mesh is cut on its page (-o FILE.html)");
  if (is_page && (!given.field.empty() || given.step != 0 || given.deformed || given.shown_matrix))
    return error(
        Kind::unsupported,
        "--field, --step, --range, --deformed and --show-matrix are of pictures; on a page fields, steps and "
        "shapes are chosen under 'Fields'");
  return std::nullopt;
}

void view_mesh(Job& job, const formats::Descriptor& format) {
  const bool is_page = !job.outputs.empty() && job.outputs.front().format == &page_format();
  if (const auto refused = not_of_a_mesh(job.options, is_page)) return job.say(*refused);
  std::optional<fem::FieldMesh> mesh = read_mesh(job, format);
  if (!mesh) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  if (is_page) {
    if (const Status written = write_mesh_page(job, *mesh, outputs->front().file); !written)
      return job.say(written.error());
  } else {
    const std::optional<std::string> picture = draw_mesh(job, std::move(*mesh));
    if (!picture) return;
    for (OpenOutput& output : *outputs)
      if (const Status written = output.file.write(*picture); !written) return job.say(written.error());
  }
  commit_all(job, *outputs);
}

std::optional<Message> not_of_yarns(const Options& given) {
  if (given.field.empty() && given.step == 0 && !given.deformed && !given.shown_matrix && given.deck.empty())
    return std::nullopt;
  return error(Kind::unsupported,
               "--field, --step, --deformed, --show-matrix and --deck are of meshes and results (VTU, FRD, "
               "INP, MSH), and "
               "this is none");
}

}  // namespace

void view(Job& job) {
  if (job.options.section && !job.outputs.empty() && job.outputs.front().format == &page_format())
    return job.say(
        error(Kind::unsupported, "--section is of pictures; on a page sections are moved under 'Section'"));
  if (const formats::Descriptor* mesh = mesh_format(job)) return view_mesh(job, *mesh);
  if (const auto refused = not_of_yarns(job.options)) return job.say(*refused);
  const std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  const std::optional<fabric::YarnBuilder> builder = job.builder(*fabric);
  if (!builder) return;
  if (builder->count() == 0)
    return job.say(error(Kind::unsupported,
                         "there is no yarn to show; garment pieces are drawn by: selvage convert --to svg"));
  // All are of one format.
  if (!outputs->empty() && outputs->front().plan->format == &page_format())
    write_page(job, *fabric, *builder, outputs->front().file);
  else
    write_pictures(job, *builder, *outputs);
  commit_all(job, *outputs);
}

}  // namespace selvage::pipeline
