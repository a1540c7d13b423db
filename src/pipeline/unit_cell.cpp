#include "pipeline/unit_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <variant>
#include <vector>

#include "cell/cut.h"
#include "cell_problem/cell_kind.h"
#include "construction/settle_cell.h"
#include "contact/contact.h"
#include "core/number_text.h"
#include "core/text_report.h"
#include "fabric/repeat.h"
#include "fem/fibre.h"
#include "nurbs/divided.h"
#include "nurbs/samples.h"
#include "pipeline/overlaps.h"
#include "surface_mesh/cell_size.h"
#include "yarn/in_axes.h"

namespace selvage::pipeline {

Message at_cell(const fabric::Fabric& fabric, Message message) {
  message.file = fabric.file;
  if (message.place.line == 0) message.place = fabric.cell->place;
  return message;
}

namespace {

// Of a yarn's thickness: nearer than that, tetrahedra between two yarns become as flat as the gap.
constexpr double least_gap_share = 0.01;
constexpr double tolerance_share = 0.02;  // of the thinnest yarn: how far copies of yarns by hand may be off
constexpr double infinity = std::numeric_limits<double>::infinity();

// In the cell's own coordinates.
Box3 box_of(const fabric::Fabric& fabric) {
  return fabric.cell->shape().box;
}

// Of places in the cell's own coordinates.
Vec3 in_space(const fabric::Fabric& fabric, const Vec3& own) {
  return fabric.cell->axes.place(own);
}

std::string_view name_of_axis(int axis) {
  constexpr std::array<std::string_view, 3> names = {"x", "y", "z"};
  return names[static_cast<std::size_t>(axis)];
}

Message cell_error(const fabric::Fabric& fabric, std::string text, const std::optional<Vec3>& at = {},
                   const std::string& yarn = {}) {
  return at_cell(fabric, error(Kind::geometry, std::move(text), {.yarn = yarn, .at = at}));
}

// Of a surface, dense enough to see where it reaches to within a thousandth of its thickness.
nurbs::Samples samples_of(const nurbs::Surface& surface) {
  constexpr int round_a_span = 4, along_a_span = 8;
  return {surface, nurbs::divided(surface.knots_u, surface.degree_u, round_a_span),
          nurbs::divided(surface.knots_v, surface.degree_v, along_a_span)};
}

// A translation that may be written down: as many digits as a cell needs that is to be a whole number of
// repeats of this length.
std::string written_length(double value, double repeat) {
  constexpr double near = 1e-6;                      // of a repeat
  if (std::abs(value) <= 1e-9 * repeat) return "0";  // of vectors, by rounding
  std::string text;
  for (int digits = 6; digits <= 17; ++digits) {
    text = fmt::format("{:.{}g}", value, digits);
    if (std::abs(std::strtod(text.c_str(), nullptr) - value) <= near * repeat) break;
  }
  return text;
}

std::string length_text(double value, double repeat, Unit units) {
  return fmt::format("{} {}", written_length(value, repeat), name_of(units));
}

}  // namespace

double gap_of_constructions(const Options& options, const fabric::Fabric& fabric) {
  const bool is_cut = options.command == Command::convert && options.cut;
  const bool is_meshed = options.command == Command::mesh && options.wants_cell();
  // Voxels need no gap: they take the cloth as it comes.
  if (!is_cut && !(is_meshed && (options.voxels == 0 || options.relaxing.gap))) return 0;
  if (options.relaxing.gap) return *options.relaxing.gap;
  return fabric::meshed_gap(fabric);
}

bool set_matrix_material(Job& job, fabric::Fabric& fabric) {
  const std::string& given = job.options.matrix_material;
  if (given.empty() || !fabric.cell) return true;
  if (fabric.find_material(given) != nullptr) {
    fabric.cell->matrix = given;
    return true;
  }
  const std::size_t comma = given.find(',');
  const std::optional<double> modulus = read_number(std::string_view(given).substr(0, comma));
  const std::optional<double> poisson =
      comma == std::string::npos ? std::nullopt : read_number(std::string_view(given).substr(comma + 1));
  if (!modulus || !poisson || !(*modulus > 0) || !(*poisson > -1 && *poisson < 0.5)) {
    std::string names;
    for (const fabric::Material& material : fabric.materials) names += fmt::format(" '{}'", material.name);
    job.fail(error(
        Kind::usage,
        fmt::format("--matrix-material {} is no material of this input ({}); write a Young's modulus above "
                    "0 in MPa and a Poisson's ratio from -1 to 0.5, as --matrix-material 3400,0.35",
                    in_quotes(given), names.empty() ? "it has none" : names.substr(1))));
    return false;
  }
  fabric::Material matrix;
  matrix.name = "given_matrix";
  matrix.elastic = fabric::IsotropicElastic{*modulus, *poisson};
  fabric.cell->matrix = matrix.name;
  fabric.materials.push_back(std::move(matrix));
  return true;
}

bool check_cell_text(Job& job, const fabric::Fabric& fabric, bool with_matrix) {
  if (!fabric.cell)
    return job.fail(
        error(Kind::usage,
              "there is no unit cell in this input: `cell X Y Z  X Y Z ... end` says its opposite "
              "corners, `cell vectors ...` the edges of one that is no rectangle"));
  if (with_matrix && fabric.cell->matrix.empty())
    return job.fail(cell_error(
        fabric,
        fmt::format(
            "this cell names no matrix: add the line `matrix NAME` with one of the file's materials{}, or "
            "--matrix-material E,NU (MPa, as 3400,0.35), or mesh the yarns alone, without --matrix",
            fabric.materials.empty() ? std::string(" (there is none yet)")
                                     : fmt::format(", such as '{}'", fabric.materials.back().name))));
  return true;
}

std::vector<yarn::Body> yarns_in_cell(Job& job, const fabric::Fabric& fabric,
                                      std::vector<yarn::Body> bodies) {
  const Box3 box = box_of(fabric);
  Box3 all;
  std::erase_if(bodies, [&](const yarn::Body& body) {
    all.extend(yarn::bounds(body));
    const yarn::BodiesInAxes own({&body, 1}, fabric.cell->axes);
    return !box.intersects(yarn::bounds(own.list().front()));
  });
  if (bodies.empty())
    job.say(cell_error(
        fabric, fmt::format("no yarn enters this cell: the yarns lie within ({:.6g}, {:.6g}, {:.6g}) and "
                            "({:.6g}, {:.6g}, {:.6g})",
                            all.min().x(), all.min().y(), all.min().z(), all.max().x(), all.max().y(),
                            all.max().z())));
  return bodies;
}

namespace {

// Is this length a whole number of repeats?
bool is_whole(double length, double repeat) {
  constexpr double near = 1e-6;  // what a text rounds to
  if (repeat == 0.0) return true;
  const double share = length / repeat;
  return std::round(share) >= 1.0 && std::abs(share - std::round(share)) <= near * share;
}

Message not_whole(const fabric::Fabric& fabric, int axis, double length, double repeat) {
  const double times = std::max(1.0, std::round(length / repeat));
  return cell_error(
      fabric, fmt::format("this cell is {} long along {}, which is no whole number of repeats: its yarns "
                          "repeat after {}; a periodic cell is {} long, or `periodic` goes without {}",
                          length_text(length, repeat, fabric.units), name_of_axis(axis),
                          length_text(repeat, repeat, fabric.units),
                          length_text(times * repeat, repeat, fabric.units), name_of_axis(axis)));
}

}  // namespace

void snap_cell(Job& job, fabric::Fabric& fabric, const fabric::YarnBuilder& builder) {
  constexpr double most = 1e-3;  // of a repeat
  const std::optional<fabric::Repeat> repeat = builder.repeat();
  if (!fabric.cell || !repeat || !fabric.cell->axes.are_of_space()) return;
  fabric::Cell& cell = *fabric.cell;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double own = (*repeat)[k].value_or(0.0), length = cell.high[axis] - cell.low[axis];
    if (own == 0.0 || (cell.names_axes() && !cell.periodic[k]) || is_whole(length, own)) continue;
    const double whole = std::round(length / own) * own;
    if (whole == 0.0 || std::abs(length - whole) > most * own) continue;
    cell.high[axis] = cell.low[axis] + whole;
    job.say(at_cell(
        fabric,
        warning(Kind::geometry,
                fmt::format("this cell is {:.6g} {} long along {}, nearly {} repeat{} of its "
                            "yarns: it is made {} long, its high face lies at {} = {}",
                            length, name_of(fabric.units), name_of_axis(axis), std::round(length / own),
                            whole == own ? "" : "s", length_text(whole, own, fabric.units),
                            name_of_axis(axis), length_text(cell.high[axis], own, fabric.units)))));
  }
}

namespace {

// Weaves have the warps and wefts that the text counts, warp knits the guides; no others.
bool is_within_cloth(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, int axis,
                     double repeat, double thinnest) {
  const Box3 box = box_of(fabric);
  const double tolerance = tolerance_share * thinnest;
  for (const fabric::Item& item : fabric.items) {
    std::string counted;
    const bool goes_on = fabric.cell->periodic[static_cast<std::size_t>(axis)];  // weaves, beyond
    if (const auto* weave = std::get_if<fabric::Weave>(&item); weave != nullptr && axis < 2 && !goes_on) {
      const fabric::WeaveSystem& across = axis == 0 ? weave->weft : weave->warp;
      const double end = across.count * across.pitch, slack = 1e-9 * end;
      if (box.min()[axis] < -slack || box.max()[axis] > end + slack)
        counted = fmt::format("{} {}s lie within {} = 0 .. {:.6g}", across.count, axis == 0 ? "weft" : "warp",
                              name_of_axis(axis), end);
    }
    if (const auto* knit = std::get_if<fabric::Warpknit>(&item); knit != nullptr && axis == 0)
      if (fabric::find_missing_copy(bodies, box, axis, repeat, tolerance))
        counted = fmt::format("{} guides a bar do not reach all needles in it", knit->wales);
    if (counted.empty()) continue;
    return job.fail(
        cell_error(fabric, fmt::format("this cell reaches beyond the cloth, whose {}: more of them, or a "
                                       "cell inside, make it periodic",
                                       counted)));
  }
  const double length = box.sizes()[axis];  // whole repeats
  const auto missing =
      repeat > 0.0 ? fabric::find_missing_in_faces(bodies, box, axis, length, 0.25 * thinnest, tolerance)
                   : std::nullopt;
  if (!missing) return true;
  return job.fail(cell_error(
      fabric,
      fmt::format("this cell is not periodic along {}: yarn '{}' lies in one of its faces, and none in the "
                  "other: the fabric ends there; more of it, or a cell inside, make it periodic",
                  name_of_axis(axis), bodies[missing->body].name),
      missing->at));
}

Message loose_end_message(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                          const fabric::LooseEnd& loose, int axis, double tolerance) {
  const yarn::Body& body = bodies[loose.body];
  std::string text = fmt::format(
      "this cell is not periodic along {}: yarn '{}' runs through its {} face, and none comes in opposite",
      name_of_axis(axis), body.name, loose.high ? "high" : "low");
  const std::optional<double> repeat = fabric::repeat_of_lines(bodies, axis, tolerance);
  if (repeat && *repeat > 0.0)
    text += fmt::format("; its yarns repeat after {}", length_text(*repeat, *repeat, fabric.units));
  else
    text += fmt::format("; no repeat was found along {}: the fabric ends there", name_of_axis(axis));
  return cell_error(fabric, std::move(text), loose.at);
}

// Of an oblique cell that is no repeat: what would be one.
std::string true_vectors(Job& job, const fabric::Fabric& fabric) {
  const std::optional<std::array<Vec3, 2>> vectors =
      fabric::shortest_vectors(fabric, job.build_options(), static_cast<int>(job.threads));
  if (!vectors) return "";
  const auto text = [&](const Vec3& v) {
    const double size = v.norm();
    return fmt::format("{} {} 0", written_length(v.x(), size), written_length(v.y(), size));
  };
  return fmt::format(
      "; its yarns repeat after the vectors ({}) and ({}) {}, and whole sums of these make a "
      "periodic cell: `cell vectors {}  {}`",
      text((*vectors)[0]), text((*vectors)[1]), name_of(fabric.units), text((*vectors)[0]),
      text((*vectors)[1]));
}

// The same as periodic_axes() of an oblique cell, whose faces are compared in its own coordinates.
std::optional<std::array<bool, 3>> periodic_vectors(Job& job, const fabric::Fabric& fabric,
                                                    std::span<const yarn::Body> bodies, double thinnest) {
  const fabric::Cell& cell = *fabric.cell;
  if (!cell.periodic[0] || !cell.periodic[1])
    return job.fail(
        cell_error(fabric, "a cell with vectors is periodic along both of them: `periodic x y`, or `x y z`"));
  const yarn::BodiesInAxes own(bodies, cell.axes);
  const Box3 box = box_of(fabric);
  const double tolerance = tolerance_share * thinnest;
  for (int axis = 0; axis < 3; ++axis) {
    if (!cell.periodic[static_cast<std::size_t>(axis)]) continue;
    auto loose = fabric::find_loose_end(own.list(), box, axis, tolerance);
    const char* what = "runs through its {} face, and none comes in opposite";
    if (!loose) {
      loose =
          fabric::find_missing_in_faces(own.list(), box, axis, box.sizes()[axis], 0.25 * thinnest, tolerance);
      what = "lies in its {} face, and none in the other";
    }
    if (!loose) continue;
    return job.fail(cell_error(
        fabric,
        fmt::format("this cell is not periodic along its {} vector: yarn '{}' {}{}",
                    axis == 0   ? "first"
                    : axis == 1 ? "second"
                                : "third",
                    bodies[loose->body].name, fmt::format(fmt::runtime(what), loose->high ? "high" : "low"),
                    true_vectors(job, fabric)),
        in_space(fabric, loose->at)));
  }
  return cell.periodic;
}

// May a cell be periodic along these axes? Along one it is a beam, where that was said or the cloth has no
// other repeat (`is_meant`).
bool check_kind(Job& job, const fabric::Fabric& fabric, const std::array<bool, 3>& periodic, bool is_meant) {
  const std::optional<fem::CellKind> kind = fem::kind_of_cell(periodic);
  std::string axes;
  for (int axis = 0; axis < 3; ++axis)
    if (periodic[static_cast<std::size_t>(axis)])
      axes += fmt::format("{}{}", axes.empty() ? "" : " and ", name_of_axis(axis));
  if (kind == fem::CellKind::plate || kind == fem::CellKind::block) return true;
  if (kind == fem::CellKind::beam && is_meant) {
    if (job.options.physics == fem::Physics::elastic) return true;
    return job.fail(cell_error(
        fabric,
        fmt::format("this cell is periodic along {} only, a beam, of which stretch, twist and bending "
                    "are known, and nothing that it conducts: name more axes, or leave out --physics",
                    axes)));
  }
  return job.fail(cell_error(
      fabric,
      fmt::format("this cell is periodic along {}{}: it has to be along x and y (a plate), along x, y "
                  "and z (a block){}; without --periodic it is meshed as a piece cut out",
                  axes.empty() ? "no axis" : axes, axes.empty() ? "" : " only",
                  kind == fem::CellKind::beam
                      ? fmt::format(", or along one axis (a beam), which `periodic {}` says", axes)
                      : std::string(", or along one axis (a beam)"))));
}

}  // namespace

std::optional<std::array<bool, 3>> periodic_axes(Job& job, const fabric::Fabric& fabric,
                                                 const fabric::YarnBuilder& builder,
                                                 std::span<const yarn::Body> bodies) {
  const fabric::Cell& cell = *fabric.cell;
  const bool names_any = cell.names_axes();
  const std::optional<fabric::Repeat> repeat = builder.repeat();
  const Box3 box = box_of(fabric);
  const double thinnest = yarn::narrowest_section(bodies);
  if (!cell.axes.are_of_space()) return periodic_vectors(job, fabric, bodies, thinnest);
  const double tolerance = tolerance_share * thinnest;
  std::array<bool, 3> periodic{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    if (cell.names_axes() && !cell.periodic[k]) continue;
    const std::optional<double> own = repeat ? (*repeat)[k] : std::nullopt;
    if (!names_any && repeat && !own) continue;  // a cloth has no repeat through its thickness
    if (own && !is_whole(box.sizes()[axis], *own))
      return job.fail(not_whole(fabric, axis, box.sizes()[axis], *own));
    if (own && !is_within_cloth(job, fabric, bodies, axis, *own, thinnest)) return std::nullopt;
    if (const auto loose = fabric::find_loose_end(bodies, box, axis, tolerance)) {
      if (!names_any && !repeat) continue;
      return job.fail(loose_end_message(fabric, bodies, *loose, axis, tolerance));
    }
    periodic[k] = true;
  }
  return check_kind(job, fabric, periodic, names_any || repeat) ? std::optional(periodic) : std::nullopt;
}

namespace {

// How far a yarn reaches along `axis` where it is between the faces across the others.
std::array<double, 2> reach_along(const yarn::Body& body, const Box3& box, int axis) {
  std::array<double, 2> reach = {infinity, -infinity};
  for (const Vec3& p : samples_of(body.surface).points) {
    Vec3 beside = p;
    beside[axis] = box.center()[axis];
    if (!box.contains(beside)) continue;
    reach = {std::min(reach[0], p[axis]), std::max(reach[1], p[axis])};
  }
  return reach;
}

// What a face across `axis` is called.
std::string name_of_free_face(int axis, bool high) {
  if (axis == 2) return high ? "top" : "bottom";
  return fmt::format("{} face", high ? "high" : "low");
}

}  // namespace

bool check_free_faces(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                      const std::array<bool, 3>& periodic) {
  const Box3 box = box_of(fabric);
  const bool is_piece = fem::kind_of_cell(periodic) == fem::CellKind::piece;
  const yarn::BodiesInAxes own(bodies, fabric.cell->axes);
  for (int axis = 2; axis >= 0; --axis) {
    if (periodic[static_cast<std::size_t>(axis)] || (is_piece && axis != 2)) continue;
    for (const yarn::Body& body : own.list()) {
      const double room = least_gap_share * yarn::narrowest_section(body);
      const std::array<double, 2> reaches = reach_along(body, box, axis);
      // What runs through is cut; what only touches would leave a sliver of itself, or of the matrix.
      for (const bool high : {true, false}) {
        const double reach = reaches[high ? 1 : 0], face = high ? box.max()[axis] : box.min()[axis];
        const bool touches = high ? reach > face - room : reach < face + room;
        if (!touches || std::abs(reach) == infinity) continue;
        // A plate and a beam have free faces; without periodic sides the cell is a piece that was cut out.
        const bool runs_through = fabric::runs_through(std::span(&body, 1), box, axis, high);
        if (runs_through && is_piece) continue;
        return job.fail(cell_error(
            fabric,
            fmt::format("yarn '{0}' {1} the {2} of this cell, {3} = {4:.6g}: it reaches to {3} = {5:.6g}; a "
                        "cell that holds it, with a tenth of its thickness beyond, ends at {3} = {6:.4g}",
                        body.name,
                        runs_through                     ? "runs through"
                        : std::abs(reach - face) <= room ? "touches"
                                                         : "goes beyond",
                        name_of_free_face(axis, high), name_of_axis(axis), face, reach,
                        reach + (high ? 0.1 : -0.1) * yarn::narrowest_section(body)),
            {}, body.name));
      }
    }
  }
  return true;
}

namespace {

// Where a yarn's surface turns round beside the plane of a face (a summit, a hollow or a saddle of its
// distance from it), inside the rest of the box.
std::optional<Vec3> grazed_at(const nurbs::Samples& grid, const Box3& box, int axis, double plane,
                              double room) {
  const double flat = 1e-6 * room;  // rounding along what is parallel to the face
  const auto turns = [flat](double before, double here, double after) {
    const double left = here - before, right = after - here;
    return std::abs(left) <= flat || std::abs(right) <= flat || (left > 0) != (right > 0);
  };
  Box3 near(box.min().array() - room, box.max().array() + room);
  near.min()[axis] = plane - room;
  near.max()[axis] = plane + room;
  const std::size_t round = grid.us.size() - 1;  // the last one is the first
  for (std::size_t v = 1; v + 1 < grid.vs.size(); ++v)
    for (std::size_t u = 0; u < round; ++u) {
      const Vec3& here = grid.at(u, v);
      if (!near.contains(here)) continue;
      if (turns(grid.at((u + round - 1) % round, v)[axis], here[axis], grid.at(u + 1, v)[axis]) &&
          turns(grid.at(u, v - 1)[axis], here[axis], grid.at(u, v + 1)[axis]))
        return here;
    }
  return std::nullopt;
}

}  // namespace

bool check_grazed_faces(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies) {
  if (job.options.force) return true;
  const Box3 box = box_of(fabric);
  const yarn::BodiesInAxes own(bodies, fabric.cell->axes);
  for (const yarn::Body& body : own.list()) {
    // Two yarns as near as they may be have a face between them.
    const double room = least_gap_share / 2.0 * yarn::narrowest_section(body);
    const nurbs::Samples grid = samples_of(body.surface);
    for (int face = 0; face < cell::face_count; ++face) {
      const int axis = cell::axis_of(face);
      const double plane = cell::plane_of(box, face);
      const std::optional<Vec3> at = grazed_at(grid, box, axis, plane, room);
      if (!at) continue;
      return job.fail(cell_error(
          fabric,
          fmt::format("yarn '{}' grazes the {} face of this cell{}: its surface runs along it, "
                      "{:.2g} {} away, and what lies between would be meshed as flat as that; move the "
                      "cell, or --force meshes it as it is",
                      body.name, cell::name_of_face(face),
                      fabric.cell->axes.are_of_space()
                          ? fmt::format(", {} = {:.6g}", name_of_axis(axis), plane)
                          : std::string(),
                      std::abs((*at)[axis] - plane), name_of(fabric.units)),
          in_space(fabric, *at), body.name));
    }
  }
  return true;
}

namespace {

// Is a place of a contact in the cell, or just beside it?
bool is_near(const contact::Contact& contact, const Parallelepiped& cell, double margin) {
  const Parallelepiped wide(Box3(cell.box.min().array() - margin, cell.box.max().array() + margin),
                            cell.axes);
  return wide.contains(contact.at) ||
         std::any_of(contact.spots.begin(), contact.spots.end(),
                     [&](const contact::Minimum& spot) { return wide.contains(spot.on_a); });
}

}  // namespace

bool check_cell_gaps(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                     double wanted) {
  double thickest = 0.0;
  for (const yarn::Body& body : bodies) thickest = std::max(thickest, yarn::narrowest_section(body));
  contact::ContactOptions options;
  options.reach = std::max(wanted, least_gap_share * thickest);
  options.threads = static_cast<int>(job.threads);
  options.progress = job.progress_of("looking for overlaps");
  const Result<contact::Contacts> contacts = contact::find_contacts(bodies, options);
  if (!contacts) return job.fail(contacts.error());
  const contact::Contact* nearest = nullptr;
  for (const contact::Contact& contact : contacts->list) {
    if (!is_near(contact, fabric.cell->shape(), options.reach)) continue;
    if (!contact.is_overlap()) {
      nearest = &contact;  // the list goes on with larger gaps
      break;
    }
    Message message = overlap_message(contact, bodies, fabric.units);
    message.text += job.options.relaxing.wanted
                        ? "; thin one of them"
                        : "; --relax moves them apart where they have room, else make one thinner";
    job.say(std::move(message));
  }
  if (job.has_failed() || nearest == nullptr) return !job.has_failed();
  job.report["min_gap"] = nearest->gap * millimetres_per(fabric.units);
  const std::string &a = bodies[nearest->a].name, &b = bodies[nearest->b].name;
  const std::string gap = fmt::format("{:.3g} {}", nearest->gap, name_of(fabric.units));
  const std::string who = nearest->a == nearest->b
                              ? fmt::format("yarn '{}' comes as near as {} to itself", a, gap)
                              : fmt::format("yarns '{}' and '{}' are {} apart", a, b, gap);
  const double thin =
      std::min(yarn::narrowest_section(bodies[nearest->a]), yarn::narrowest_section(bodies[nearest->b]));
  if (nearest->gap < least_gap_share * thin && !job.options.force)
    return job.fail(error(
        Kind::geometry,
        fmt::format(
            "{}, less than 1 % of their thickness: what lies between would be meshed as flat as that; "
            "--relax --gap {:.2g} moves them apart where they have room, --force meshes them as they are",
            who, fabric::meshed_gap_fraction * thin),
        {.at = nearest->at}));
  constexpr double rounding = 1e-3;
  if (nearest->gap < (1.0 - rounding) * wanted)
    job.say(warning(Kind::geometry,
                    fmt::format("{}, nearer than the gap of {:.3g} {} that is wanted", who, wanted,
                                name_of(fabric.units)),
                    {.at = nearest->at}));
  return !job.has_failed();
}

namespace {

// Edges where nobody says how long they are. Tetrahedra of ten nodes follow more with fewer.
struct UsualEdges {
  double to_a_side = 4;  // of the square that is as large as a yarn's section
  double growth = fem::usual_growth;
};

constexpr UsualEdges usual_edges(int order) {
  return order == 2 ? UsualEdges{3, 0.6} : UsualEdges{};
}

// Edges on each yarn: of --size, or so long that --segments of them go round it, the shorter of both; without
// these a share of the side of the square that is as large as its section, at most its thickness.
std::vector<double> sizes_of(const Options& options, std::span<const yarn::Body> bodies, int order) {
  std::vector<double> sizes;
  for (const yarn::Body& body : bodies) {
    double size = options.size > 0.0 ? options.size : infinity;
    if (options.segments > 0) {
      const double middle = (body.surface.first_v() + body.surface.last_v()) / 2.0;
      size = std::min(size, fem::section_perimeter(body, middle) / options.segments);
    }
    if (size == infinity)
      size = std::min(std::sqrt(body.volume / body.length) / usual_edges(order).to_a_side,
                      yarn::narrowest_section(body));
    sizes.push_back(size);
  }
  return sizes;
}

// Edges on a yarn are at most as long as it is thick: longer ones would not follow its surface.
void keep_to_thickness(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                       std::vector<double>& sizes) {
  constexpr double rounding = 5e-3;  // what the tolerance of tubes leaves of a thickness
  std::size_t count = 0, worst = 0;
  double least = infinity;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double thickness = yarn::narrowest_section(bodies[b]);
    if (sizes[b] > (1.0 + rounding) * thickness) {
      ++count;
      if (thickness < least) worst = b;
      least = std::min(least, thickness);
    }
    sizes[b] = std::min(sizes[b], thickness);
  }
  if (count == 0) return;
  job.say(at_cell(fabric, warning(Kind::geometry,
                                  fmt::format("{} yarns are thinner than these edges are long: on them edges "
                                              "are as long as they are thick ('{}': {:.3g} {})",
                                              count, bodies[worst].name, least, name_of(fabric.units)))));
}

}  // namespace

std::optional<CellSize> check_cell_size(Job& job, const fabric::Fabric& fabric,
                                        std::span<const yarn::Body> bodies, int order, bool with_matrix) {
  constexpr double most = 1e8;
  constexpr double away =
      2;  // edges away from the yarns to those on them, where nobody says how long they are
  const bool is_usual = job.options.size == 0 && job.options.segments == 0;
  CellSize chosen{.sizes = sizes_of(job.options, bodies, order),
                  .coarsest = job.options.matrix_size,
                  .growth = is_usual ? usual_edges(order).growth : fem::usual_growth};
  keep_to_thickness(job, fabric, bodies, chosen.sizes);
  const auto [finest, coarsest] = std::minmax_element(chosen.sizes.begin(), chosen.sizes.end());
  if (job.options.matrix_size == 0 && is_usual) chosen.coarsest = away * *coarsest;
  if (job.options.matrix_size > 0 && job.options.matrix_size < *finest)
    return job.fail(
        error(Kind::usage,
              fmt::format("--matrix-size is {:.6g}, to which edges grow from those on the yarns, but these "
                          "are {:.6g} {} long: --size makes them finer",
                          job.options.matrix_size, *finest, name_of(fabric.units))));
  chosen.tetrahedra = fem::estimate_tetrahedra(bodies, fabric.cell->shape(), chosen.sizes, chosen.coarsest,
                                               chosen.growth, with_matrix, static_cast<int>(job.threads));
  const std::string lengths = *coarsest - *finest < 1e-3 * *coarsest
                                  ? fmt::format("{:.4g}", *finest)
                                  : fmt::format("{:.4g} to {:.4g}", *finest, *coarsest);
  const std::string estimate =
      fmt::format("edges of {} {} on the yarns make about {:.2g} tetrahedra in this cell", lengths,
                  name_of(fabric.units), chosen.tetrahedra);
  if (chosen.tetrahedra > most && !job.options.force)
    return job.fail(at_cell(
        fabric,
        error(Kind::limit, fmt::format("{}, more than {:.0g}: --size {:.3g} makes ten million, "
                                       "--force goes on all the same",
                                       estimate, most, *finest * std::cbrt(chosen.tetrahedra / 1e7)))));
  Message note = at_cell(fabric, error(Kind::limit, estimate));
  note.severity = Severity::note;
  job.say(std::move(note));
  job.progress(estimate);
  return chosen;
}

}  // namespace selvage::pipeline
