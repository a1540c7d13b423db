#include "fuzz/targets.h"

#include <fmt/format.h>

#include "construction/build.h"
#include "construction/settle_cell.h"
#include "contact/contact.h"
#include "core/findings.h"
#include "core/text_report.h"
#include "fabric/from_cad.h"
#include "formats/registry.h"
#include "formats/step/inspect.h"
#include "fuzz/expression_text.h"
#include "fuzz/fabric_text.h"
#include "fuzz/field_mesh.h"
#include "fuzz/reports.h"
#include "fuzz/several_files.h"
#include "structured/voxel.h"
#include "surface_mesh/skin.h"

namespace selvage::fuzz {

namespace {

using fabric::Fabric;
using formats::Descriptor;

// What one execution may cost: chance soon finds fabrics of a million loops, and each is only slow.
constexpr std::size_t most_yarns = 6;
constexpr std::size_t most_points = 150;    // control points of a yarn
constexpr std::size_t most_together = 500;  // of all yarns
constexpr std::uint64_t most_data_points = 400;
constexpr double coarse = 0.05;  // tolerance, of the smallest section

Source named(std::string_view bytes, const Descriptor& format) {
  return Source::from_memory(std::string(bytes), "input" + std::string(format.extensions.front()));
}

std::optional<Fabric> read(const Descriptor& format, const Source& source, Diagnostics& diagnostics) {
  if (format.read_fabric != nullptr) return format.read_fabric(source, diagnostics);
  if (format.read_points != nullptr) {
    const std::optional<fabric::Measured> points = format.read_points(source, diagnostics);
    if (!points) return std::nullopt;
    Fabric fabric = fabric::fabric_of(*points, source, diagnostics);
    return diagnostics.has_errors() ? std::nullopt : std::optional(std::move(fabric));
  }
  std::optional<cad::Model> model = format.read_model(source, diagnostics);
  if (!model) return std::nullopt;
  return fabric::fabric_of(std::move(*model), diagnostics);
}

void run_reader(const Descriptor& format, std::string_view bytes) {
  const Source source = named(bytes, format);
  const std::string_view head = source.bytes().substr(0, 4096);
  if (format.sniff != nullptr) static_cast<void>(format.sniff(head));
  if (format.part_mark != nullptr) static_cast<void>(format.part_mark(head));
  std::vector<Message> messages;
  // A rule of every reader: nothing comes back exactly when there was an error.
  const auto result_of = [&](const auto& read) {
    Diagnostics diagnostics;
    auto result = read(source, diagnostics);
    if (result.has_value() == diagnostics.has_errors()) std::abort();
    messages.insert(messages.end(), diagnostics.messages().begin(), diagnostics.messages().end());
    return result;
  };
  const auto reads = [&](auto* reader) {
    if (reader != nullptr) static_cast<void>(result_of(reader));
  };
  std::optional<fem::FieldMesh> mesh;
  if (format.read_mesh != nullptr) mesh = result_of(format.read_mesh);
  reads(format.read_fabric);
  reads(format.read_model);
  reads(format.read_points);
  reads(format.read_deck);
  if (mesh) evaluate(*mesh);
  // What takes as long as reading and is the same for most inputs: one in four has it done.
  if (bytes.size() % 4 != 0) return;
  for (const Message& message : messages) static_cast<void>(to_string(message));
  if (format.check_structure != nullptr) {
    Findings findings;
    format.check_structure(source, findings);
  }
}

// The fabric's yarns; none where there is something wrong with them or they are too large for a short run.
std::vector<yarn::Body> bodies_of(const Fabric& fabric, std::string_view bytes) {
  fabric::BuildOptions options;
  options.as_published = true;
  options.tolerance = coarse * fabric::smallest_section(fabric).value_or(0.0);
  options.max_control_points = most_points;
  options.work.points = most_data_points;
  Diagnostics diagnostics;
  const auto published = fabric::YarnBuilder::create(fabric, options, diagnostics);
  std::vector<yarn::Body> bodies;
  if (!published || published->count() > most_yarns) return bodies;
  // Resolving overlaps takes a second: one input in sixteen has it done as users have it, where it can be
  // built at all.
  const bool is_resolved = bytes.size() % 16 == 0;
  options.as_published = !is_resolved;
  const auto resolved =
      is_resolved ? fabric::YarnBuilder::create(fabric, options, diagnostics) : std::nullopt;
  if (is_resolved && (!resolved || resolved->count() > most_yarns)) return bodies;
  const fabric::YarnBuilder& builder = is_resolved ? *resolved : *published;
  std::size_t points = 0;
  for (std::size_t i = 0; i < builder.count(); ++i) {
    Result<yarn::Body> body = builder.build(i);
    if (!body) return {};
    points +=
        static_cast<std::size_t>(body->surface.count_u) * static_cast<std::size_t>(body->surface.count_v);
    if (points > most_together) return {};
    bodies.push_back(std::move(*body));
  }
  return bodies;
}

void check(const std::vector<yarn::Body>& bodies) {
  static_cast<void>(
      contact::find_contacts(bodies, {.reach = 0, .with_itself = true, .threads = 1, .progress = {}}));
}

// As the program does it: the format that recognises the bytes, the first of the list if none does.
void run_check(std::string_view bytes) {
  const Descriptor* chosen = nullptr;
  for (const Descriptor* format : formats::all_formats())
    if (format->is_readable() && format->sniff != nullptr && format->sniff(bytes.substr(0, 4096))) {
      chosen = format;
      break;
    }
  if (chosen == nullptr) chosen = formats::all_formats().front();
  Diagnostics diagnostics;
  const std::optional<Fabric> fabric = read(*chosen, named(bytes, *chosen), diagnostics);
  if (fabric) check(bodies_of(*fabric, bytes));
}

void run_mesh(std::string_view bytes) {
  const std::string text = fabric_text(bytes);
  const Descriptor& format = *formats::all_formats().front();
  Diagnostics diagnostics;
  std::optional<Fabric> fabric = read(format, named(text, format), diagnostics);
  if (!fabric) std::abort();                         // what is written by the grammar can be read
  fabric::settle_cell(*fabric, {}, 1, diagnostics);  // by its vectors
  const std::vector<yarn::Body> bodies = bodies_of(*fabric, bytes);
  // Each takes longer than to build the yarns, overlaps by far: an input has one of them done.
  const std::size_t chance = bytes.size() % 16;
  if (chance == 0)
    check({bodies.begin(),
           bodies.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, bodies.size()))});
  else if (chance % 2 == 0)
    for (const yarn::Body& body : bodies)
      static_cast<void>(fem::make_skin(body, 2.0 * yarn::narrowest_section(body)));
  else if (fabric->cell)
    static_cast<void>(fem::mesh_voxels(
        *fabric, bodies, {.count = 8, .periodic = {true, true, false}, .matrix = true, .threads = 1},
        diagnostics));
}

// What is placed encloses what it did before, and closes; a cell of repeats is one or says why not.
void run_placing(std::string_view bytes) {
  const std::string text = placed_text(bytes);
  const Descriptor& format = *formats::all_formats().front();
  Diagnostics diagnostics;
  std::optional<Fabric> fabric = read(format, named(text, format), diagnostics);
  if (!fabric) std::abort();  // no circles are written, nor too many copies
  for (const yarn::Body& body : bodies_of(*fabric, bytes))
    if (!(body.volume > 0) || body.inward) std::abort();
  if (!fabric->cell || bytes.size() % 4 != 0) return;
  fabric::BuildOptions options;
  options.tolerance = coarse * fabric::smallest_section(*fabric).value_or(0.0);
  options.max_control_points = most_points;
  options.work.points = most_data_points;
  fabric::settle_cell(*fabric, options, 1, diagnostics);
  const fabric::Cell& cell = *fabric->cell;
  if (!diagnostics.has_errors() && (cell.low.array() >= cell.high.array()).any()) std::abort();
}

// Read as reckoned, to rounding.
void run_expressions(std::string_view bytes) {
  const ExpressionText text = expression_text(bytes);
  const Descriptor& format = *formats::all_formats().front();
  Diagnostics diagnostics;
  const std::optional<Fabric> fabric = read(format, named(text.text, format), diagnostics);
  if (!fabric) std::abort();
  const auto& path = std::get<fabric::Path>(std::get<fabric::Yarn>(fabric->items.front()).shape);
  double size = 1;
  for (const double number : text.numbers) size = std::max(size, std::abs(number));
  for (std::size_t i = 0; i < text.numbers.size(); ++i)
    if (std::abs(path.points[1 + i / 3][static_cast<Eigen::Index>(i % 3)] - text.numbers[i]) > 1e-6 * size)
      std::abort();
}

// The reader in the module is OpenCASCADE's, in a process of its own: what stands before it is ours.
void run_step(std::string_view bytes) {
  const Source source = Source::from_memory(std::string(bytes), "input.stp");
  TextReport report(source);
  const bool has_read = formats::step::inspect(source, report).has_value();
  Diagnostics diagnostics;
  report.hand_over(diagnostics);
  if (has_read == diagnostics.has_errors()) std::abort();
}

std::vector<Target> all_targets() {
  std::vector<Target> list;
  for (const Descriptor* format : formats::all_formats())
    if (format->is_readable() || format->read_mesh != nullptr || format->read_deck != nullptr)
      list.push_back({std::string(format->name), "reads", std::string(format->extensions.front()), 1024,
                      [format](std::string_view bytes) { run_reader(*format, bytes); }});
  for (Target& target : list) {
    // Files with several blocks of numbers, or in XML, are not that small.
    if (const std::string& name = target.name;
        name == "frd" || name == "inp" || name == "msh" || name == "vtu" || name == "tg3")
      target.most = 2048;
    if (target.name == "step") {
      target.does = "reads, up to the hand-over to OpenCASCADE";
      target.run = run_step;
      target.most = 16384;
    } else if (target.name == "iges") {
      target.mutated = mutated_iges;
      target.most = 4096;
    }
  }
  list.push_back(
      {"check", "reads any format, builds the yarns, finds where they overlap", ".txt", 2048, run_check});
  list.push_back({"mesh",
                  "writes a fabric by the grammar, reads and builds it, and finds its overlaps, or meshes "
                  "its surfaces or its cell",
                  "", 256, run_mesh});
  list.push_back({"placing", "writes blocks that are used at other places, reads, builds, settles the cell",
                  "", 256, run_placing});
  list.push_back({"expressions", "writes numbers with units, params and expressions, compares what is read",
                  "", 256, run_expressions});
  list.push_back(
      {"use", "reads a text with the files that it uses: texts, a draft, points", "", 2048, run_use});
  list.push_back({"results", "reads results (frd) with their deck (inp), evaluates their fields", "", 4096,
                  run_results});
  list.push_back({"report", "reads a JSON report, resumes from it, makes its page", "", 2048, run_report});
  list.push_back({"lists", "reads a list of inputs (@FILE)", "", 512, run_lists});
  return list;
}

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> list = all_targets();
  return list;
}

std::string target_lines() {
  std::string lines;
  for (const Target& target : targets())
    lines += fmt::format("{}\t{}\t{}\t{}\n", target.name, target.seeds, target.most, target.does);
  return lines;
}

const Target* target_named(std::string_view name) {
  for (const Target& target : targets())
    if (target.name == name) return &target;
  return nullptr;
}

}  // namespace selvage::fuzz
