// `selvage check`: is every yarn a closed, valid solid within its tolerance, and do no two share space? Is
// the outline of every garment piece closed and simple, and its face valid?
#include "solid/check.h"
#include "core/words.h"

#include <fmt/format.h>

#include <cmath>

#include "core/readable.h"
#include "pipeline/cad_check.h"
#include "pipeline/facts.h"
#include "pipeline/overlaps.h"
#include "pipeline/pieces.h"
#include "pipeline/table.h"
#include "pipeline/writing.h"
#include "solid/brep.h"
#include "solid/gap_map.h"

namespace selvage::pipeline {

namespace {

// The solid's volume may differ from the B-spline's by what quadrature leaves on rational surfaces.
constexpr double volume_agreement = 1e-4;

struct Examined {
  std::vector<yarn::Body> bodies;
  solid::SolidCheck solids;
  std::vector<solid::BrepCheck> breps;
  PieceFindings pieces;
};

std::string_view yes_no(bool yes) {
  return yes ? "yes" : "no";
}

// What is wrong with yarn i, beside overlaps; empty: nothing.
std::vector<Message> defects_of(const Examined& found, std::size_t i, Unit units) {
  const yarn::Body& body = found.bodies[i];
  std::vector<Message> defects = found.solids.yarns[i].defects;
  const solid::BrepCheck& brep = found.breps[i];
  const auto say = [&](std::string text, const std::optional<Vec3>& at = {}) {
    defects.push_back(error(Kind::geometry, std::move(text), about(body, at)));
  };
  defects.insert(defects.end(), brep.defects.begin(), brep.defects.end());
  if (defects.empty() && std::abs(brep.volume - body.volume) > volume_agreement * std::abs(body.volume))
    say(fmt::format("yarn '{}': the solid's volume is {:.6g}, the B-spline's {:.6g} {}^3", body.name,
                    brep.volume, body.volume, name_of(units)));
  if (body.tube_error > body.tolerance)
    say(
        fmt::format("yarn '{}': the surface may be {:.3g} {} away from the exact tube, {:.3g} are allowed; "
                    "raise the file's tolerance or use --tolerance",
                    body.name, body.tube_error, name_of(units), body.tolerance));
  for (const yarn::TightBend& bend : body.tight_bends)
    say(fmt::format("yarn '{}' bends with a radius of {:.4g} {} where its section needs {:.4g}: its surface "
                    "folds over itself",
                    body.name, bend.radius, name_of(units), bend.needed),
        bend.at);
  return defects;
}

bool is_open_tube(const yarn::Body& body) {
  return !body.closed_along &&
         (body.start.style == yarn::EndStyle::none || body.end.style == yarn::EndStyle::none);
}

Message open_tube(const yarn::Body& body) {
  return warning(
      Kind::geometry,
      fmt::format("'{}' is an open tube, a surface and no solid; as a yarn, --ends patch seals it where "
                  "it is converted",
                  body.name),
      about(body));
}

std::string brep_word(const solid::BrepCheck& brep) {
  if (brep.valid && brep.free_edges == 0) return "valid";
  return brep.valid ? fmt::format("{} free edges", brep.free_edges) : "invalid";
}

std::string yarn_tables(const Examined& found, const Shown& shown) {
  const auto length = [&](double value) { return cell(shown.length(value)); };
  Table yarns({"yarn", "points", "length", "volume", "least bend radius", "tube error", "closed",
               "crosses itself", "B-rep", "defects"});
  for (std::size_t i = 0; i < found.bodies.size(); ++i) {
    const yarn::Body& body = found.bodies[i];
    const solid::YarnCheck& solid = found.solids.yarns[i];
    yarns.add({body.name, fmt::format("{}x{}", body.surface.count_u, body.surface.count_v),
               length(body.length), cell(shown.volume(body.volume)), length(body.min_bend_radius),
               length(body.tube_error), std::string(yes_no(solid.is_shut())),
               std::string(yes_no(solid.self_intersecting)), brep_word(found.breps[i]),
               std::to_string(defects_of(found, i, shown.file).size())});
  }
  std::string text = yarns.text();
  if (!found.solids.overlaps.empty()) {
    Table overlaps({"overlap of", "and", "depth", "area", "x", "y", "z"});
    for (const contact::Contact& overlap : found.solids.overlaps)
      overlaps.add({found.bodies[overlap.a].name,
                    overlap.a == overlap.b ? "itself" : found.bodies[overlap.b].name, length(overlap.depth()),
                    overlap.area > 0 ? cell(shown.area(overlap.area)) : "-", length(overlap.at.x()),
                    length(overlap.at.y()), length(overlap.at.z())});
    text += overlaps.text();
  }
  if (!found.solids.near_contacts.empty()) {
    Table near({"near contacts of", "and", "gap", "x", "y", "z"});
    for (const contact::Contact& contact : found.solids.near_contacts)
      near.add({found.bodies[contact.a].name,
                contact.a == contact.b ? "itself" : found.bodies[contact.b].name, length(contact.gap),
                length(contact.at.x()), length(contact.at.y()), length(contact.at.z())});
    text += near.text();
  }
  if (found.solids.min_gap)
    text += fmt::format("  smallest gap between yarns: {}\n", length(*found.solids.min_gap));
  return text;
}

void print_tables(const Job& job, const Examined& found, const CadCheck& cad, std::size_t defects) {
  const Shown shown = job.shown();
  std::string text = fmt::format("{}: lengths in {}\n", readable(job.input.path), name_of(shown.unit)), sound;
  if (cad.has_model()) {
    text += cad.table(shown) + cad.summary();
    sound = cad.sound(job.has_warned());
  }
  if (!found.bodies.empty()) {
    text += yarn_tables(found, shown);
    sound += fmt::format("{}every yarn is a closed valid solid, no two overlap", sound.empty() ? "" : "; ");
  }
  if (!found.pieces.shapes.empty()) {
    text += face_table(found.pieces, shown);
    sound += fmt::format("{}every piece is a valid face in a closed outline", sound.empty() ? "" : "; ");
  }
  text +=
      defects == 0 ? fmt::format("  sound: {}\n", sound) : fmt::format("  {}\n", counted(defects, "defect"));
  job.print(text);
}

std::optional<Examined> examine(Job& job, const fabric::Fabric& fabric) {
  const std::optional<fabric::YarnBuilder> builder = job.builder(fabric);
  if (!builder) return std::nullopt;
  std::optional<std::vector<yarn::Body>> bodies = job.build_all(*builder);
  if (!bodies) return std::nullopt;
  Examined found;
  found.bodies = std::move(*bodies);
  std::optional<PieceFindings> pieces = examine_pieces(job, fabric);
  if (!pieces) return std::nullopt;
  found.pieces = std::move(*pieces);
  if (found.bodies.empty()) return found;
  std::optional<solid::SolidCheck> solids = check_of(job, found.bodies);
  if (!solids) return std::nullopt;
  Result<std::vector<solid::BrepCheck>> breps = solid::check_breps(found.bodies);
  if (!breps) return job.fail(breps.error());
  found.solids = std::move(*solids);
  found.breps = std::move(*breps);
  return found;
}

// The yarns coloured by gap, in mm.
Result<formats::WriteFacts> write_gap_map(Job& job, const std::vector<yarn::Body>& bodies,
                                          OpenOutput& output) {
  if (bodies.empty()) return error(Kind::unsupported, "there is no yarn whose gaps could be shown");
  solid::GapMapOptions options;
  options.reach = job.options.reach;
  options.threads = static_cast<int>(job.threads);
  options.progress = job.progress_of("mapping gaps, block");
  Result<solid::GapMap> map = solid::gap_map(bodies, options);
  if (!map) return map.error();
  const double mm = millimetres_per(job.file_units());
  for (contact::SkinMesh& skin : map->skins)
    for (Vec3& p : skin.vertices) p *= mm;
  for (std::vector<double>& gaps : map->gaps)
    for (double& gap : gaps) gap *= mm;
  return output.plan->format->write_gap_map(*map, output.file);
}

}  // namespace

bool check(Job& job) {
  CadCheck cad(job.options.all);
  const std::optional<fabric::Fabric> fabric = job.read(cad.look());
  cad.say(job);
  if (!fabric) return false;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return false;
  const std::optional<Examined> found = examine(job, *fabric);
  if (!found) return false;
  // Without it, it has failed, and what was found is told all the same.
  for (OpenOutput& output : *outputs) take_facts(job, output, write_gap_map(job, found->bodies, output));
  if (!found->bodies.empty()) report_check(job, found->solids, found->bodies);
  if (cad.has_model() && found->bodies.empty())
    if (const std::optional<double> accuracy = cad::absolute_accuracy(*cad.measures()))
      job.report["creo_absolute_accuracy"] = *accuracy * millimetres_per(fabric->units);
  std::size_t defects = cad.defects() + found->solids.overlaps.size() + found->pieces.defects;
  for (std::size_t i = 0; i < found->bodies.size(); ++i) {
    // What a file of another program has as a surface without ends is just that.
    if (cad.is_foreign() && is_open_tube(found->bodies[i])) {
      job.say(open_tube(found->bodies[i]));
      continue;
    }
    for (Message& message : defects_of(*found, i, fabric->units)) {
      ++defects;
      job.say_defect(std::move(message));
    }
  }
  for (const contact::Contact& overlap : found->solids.overlaps)
    job.say_defect(overlap_message(overlap, found->bodies, fabric->units), overlap.depth());
  print_tables(job, *found, cad, defects);
  commit_all(job, *outputs);
  return defects > 0;
}

}  // namespace selvage::pipeline
