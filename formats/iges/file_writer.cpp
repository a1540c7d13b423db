#include "formats/iges/file_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numbers>

#include "core/clock.h"
#include "formats/iges/options.h"
#include "formats/iges/piece.h"
#include "formats/iges/solid.h"
#include "nurbs/divided.h"

namespace selvage::formats::iges {

namespace {

using yarn::EndStyle;

// FNV-1a over whole doubles.
void take_digest(const std::vector<Vec3>& points, std::uint64_t& digest) {
  for (const Vec3& p : points)
    for (const double value : p) digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001B3;
}

// The mean thickness of the yarn's first section: the length of its control polygon over pi.
double size_of(const nurbs::Surface& surface) {
  return nurbs::length_of(nurbs::boundary_row(surface, false).points) / std::numbers::pi;
}

int entities_of_end(const yarn::EndFace& end) {
  if (end.style == EndStyle::none) return 0;
  return end.style == EndStyle::planar ? entities_of_planar_end : 1;
}

std::int64_t most_values(const yarn::Body& body) {
  std::int64_t values = 1000;
  for (const nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface})
    values += static_cast<std::int64_t>(4 * surface->points.size() +
                                        4 * (surface->knots_u.size() + surface->knots_v.size()) +
                                        16 * static_cast<std::size_t>(surface->count_u + surface->count_v));
  return values;
}

}  // namespace

FileWriter::FileWriter(OutputFile& output, const SurfaceOptions& options, Records::Limits limits)
    : output_(&output),
      options_(options),
      is_solid_(options.own.has(option::solid) || options.yarns_are_solids),
      header_{.title = options.title,
              .file_name = options.file_name,
              .units = options.units,
              .time = options.date.empty() ? iges_timestamp() : options.date,
              .part = {}},
      records_(output, header_text(header_).bytes.size(), limits, options.threads),
      expected_(options.expected_bodies) {}

Status FileWriter::whole_or_nothing(const std::string& yarn, TextPlace place,
                                    const std::function<Status()>& work) {
  const Extremes before = extremes_;
  Status status = work();
  if (status.ok()) return status;
  extremes_ = before;
  Message& why = status.error();
  if (why.kind == Kind::io || !why.yarn.empty()) return status;
  why.yarn = yarn;
  why.place = place;
  return status;
}

// Every number that will be written, and whether the body can be what is asked for.
Status FileWriter::check(const yarn::Body& body) {
  const auto refused = [&](const std::string& why) {
    Message message = error(Kind::geometry, fmt::format("yarn {} {}", body.name, why));
    message.yarn = body.name;
    message.place = body.place;
    return message;
  };
  double largest = 0;
  for (const nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface}) {
    if (!is_finite(*surface)) return refused(std::string(not_finite));
    largest = std::max(largest, *largest_of(surface->points));
    take_digest(surface->points, extremes_.digest);
  }
  for (const yarn::EndFace* end : {&body.start, &body.end}) {
    if (body.closed_along) break;
    if (is_solid_ && end->style == EndStyle::none)
      return refused(
          "has open ends and cannot be written as a solid: seal it with --ends patch, fan or planar, or "
          "leave "
          "out --iges-solid");
    if (end->style != EndStyle::planar) continue;
    const yarn::EndPlane plane =
        yarn::end_plane(body, yarn::end_curve(body, end == &body.end), end == &body.end);
    const std::optional<double> corners = largest_of(plane.surface.points);
    if (!corners) return refused("has an end plane that is not finite");
    largest = std::max(largest, *corners);
  }
  extremes_.largest = std::max(extremes_.largest, largest);
  extremes_.smallest_size = std::min(extremes_.smallest_size, size_of(body.surface));
  return {};
}

// Far from the limit a rough bound is enough; near it the thing is written without being kept, and its lines
// counted.
Status FileWriter::check_room(std::int64_t values, const std::string& what,
                              const std::function<void()>& write) {
  const Records::Lines now = records_.lines();
  const std::int64_t most = records_.limits().lines;
  if (now.parameters + values <= most && now.directory + values <= most) return {};

  const Records::Lines needed = measured(write).lines;
  if (needed.parameters <= most && needed.directory <= most) return {};
  const bool parameters = needed.parameters > most;
  const std::int64_t count = parameters ? needed.parameters : needed.directory;
  const std::string_view section = parameters ? "parameter" : "directory";
  if (is_empty())
    return error(Kind::limit, fmt::format("{} alone needs {} {} lines of an IGES file, where lines are "
                                          "numbered to {} at most",
                                          what, count, section, most));
  return error(
      Kind::limit,
      fmt::format("with {} the IGES file would need {} {} lines, but lines are numbered to {} at most ({} {} "
                  "fit), and this output is one file: name a file with -o, and the fabric is split over "
                  "several",
                  what, count, section, most, bodies_,
                  what.starts_with("yarn") ? "yarns" : "yarns and pieces"));
}

std::uint64_t FileWriter::Shared::entities() const {
  return colors.size() + static_cast<std::uint64_t>(std::count(levels.begin(), levels.end(), true));
}

// What the sections would have with it.
FileWriter::Needed FileWriter::measured(const std::function<void()>& write, Records::Measuring how) {
  const Shared before = shared_;
  records_.measure(how);
  write();
  const std::uint64_t shared = shared_.entities();
  shared_ = before;
  return {records_.measure(Records::Measuring::off), shared};
}

std::int64_t FileWriter::lines_of(const yarn::Body& body) {
  const Records::Lines now = records_.lines(), with = measured([&] { write(body); }).lines;
  return std::max(with.parameters - now.parameters, with.directory - now.directory);
}

// What is still to come is as what came.
void FileWriter::expect(std::uint64_t entities, std::uint64_t shared, std::uint64_t bodies) {
  if (expected_ > bodies) records_.expect(shared + (entities - shared) * expected_ / bodies);
}

// Large yarns fill the buffer before the first of them is whole: how many entities it has is counted before.
// Of so many that they will not fit into one file its lines, too: that they are `values` at most says little.
void FileWriter::expect_as_first(std::int64_t values, const std::function<void()>& write,
                                 std::uint64_t bodies) {
  constexpr std::int64_t values_a_line = 12;
  const std::int64_t most = records_.limits().lines,
                     all = static_cast<std::int64_t>(std::min<std::uint64_t>(expected_, most));
  if (all <= static_cast<std::int64_t>(bodies)) return;
  const bool is_set = values / values_a_line > most / all;
  const Needed needed = measured(write, is_set ? Records::Measuring::lines : Records::Measuring::entities);
  if (is_set)
    expected_ = std::min<std::uint64_t>(
        expected_,
        bodies * static_cast<std::uint64_t>(most / std::max<std::int64_t>(needed.lines.parameters, 1)));
  expect(static_cast<std::uint64_t>(needed.lines.directory / 2), needed.shared, bodies);
}

int FileWriter::color(const yarn::Color& color) {
  for (const auto& [known, pointer] : shared_.colors)
    if (known == color) return pointer;
  const int pointer = write_color(records_, color);
  shared_.colors.emplace_back(color, pointer);
  return pointer;
}

int FileWriter::level(std::size_t index, std::string_view name) {
  const int level = static_cast<int>(index) + 1;
  if (!shared_.levels[index]) {
    write_level_name(records_, level, name);
    shared_.levels[index] = true;
  }
  return level;
}

Common FileWriter::common_of(const yarn::Body& body, std::string_view label) {
  return {.color = color(body.color),
          .level = level(static_cast<std::size_t>(body.role), yarn::name_of(body.role)),
          .label = label};
}

int FileWriter::named(Common common, int entities, const std::function<int(const Common&)>& write) {
  common.name = records_.next() + 2 * entities;
  const int pointer = write(common);
  write_name(records_, common);
  return pointer;
}

// The faces of a yarn that is no solid.
std::vector<int> FileWriter::write_faces(const Common& common, const yarn::Body& body) {
  std::vector<int> faces = {write_surface(records_, common.entity(128), body.surface, common.name)};
  for (const yarn::EndFace* end : {&body.start, &body.end}) {
    if (body.closed_along || end->style == EndStyle::none) continue;
    faces.push_back(end->style == EndStyle::planar
                        ? write_planar_end(records_, common, body, end == &body.end)
                        : write_surface(records_, common.entity(128), end->surface, common.name));
  }
  // Whoever sews the group takes the direction of the shell from its first member. Gmsh makes one solid of
  // all shells of a file and then splits it, which fails where two of them point outward: so a face that
  // points inward leads.
  if (faces.size() > 1 && !body.inward) std::swap(faces[0], faces[1]);
  return faces;
}

// Returns the directory pointer of its group, solid or 408.
int FileWriter::write(const yarn::Body& body, const Instance* instance) {
  const std::string name = ascii(body.name);
  if (instance != nullptr) {
    const int shape = definition_of(*instance);
    return named(common_of(body, name), entities_of_instance(instance->motion), [&](const Common& common) {
      return write_instance(records_, common, shape, instance->motion);
    });
  }
  int entities = 2;  // the first face and the group
  if (is_solid_)
    entities = entities_of_solid(body);
  else if (!body.closed_along)
    entities += entities_of_end(body.start) + entities_of_end(body.end);
  return named(common_of(body, name), entities, [&](const Common& common) {
    return is_solid_ ? write_solid(records_, common, body)
                     : write_group(records_, common, write_faces(common, body));
  });
}

// Returns the directory pointer of the 308, which comes before the first copy.
int FileWriter::definition_of(const Instance& instance) {
  const auto known = shared_.definitions.find(instance.shape);
  if (known != shared_.definitions.end()) return known->second;
  const yarn::Body& body = *instance.body;
  Common common = common_of(body, {});  // names are the copies'
  common.status = dependent;
  const std::vector<int> members =
      is_solid_ ? std::vector{write_solid(records_, common, body)} : write_faces(common, body);
  const int pointer = write_definition(records_, common, ascii(body.name), members);
  shared_.definitions.emplace(instance.shape, pointer);
  return pointer;
}

// A shape that is new to the file counts as well.
Status FileWriter::check(const yarn::Body& body, const Instance* instance) {
  Status status = check(body);
  if (status.ok() && instance != nullptr && !shared_.definitions.contains(instance->shape))
    status = check(*instance->body);
  return status;
}

std::int64_t FileWriter::most_values_of(const yarn::Body& body, const Instance* instance) const {
  if (instance == nullptr) return most_values(body);
  return 1000 + (shared_.definitions.contains(instance->shape) ? 0 : most_values(*instance->body));
}

Status FileWriter::add(const yarn::Body& body, const Instance* instance) {
  return whole_or_nothing(body.name, body.place, [&]() -> Status {
    if (Status status = check(body, instance); !status.ok()) return status;
    return add_checked(body.name, "yarn " + body.name, most_values_of(body, instance),
                       [&] { write(body, instance); });
  });
}

Status FileWriter::add_group(std::span<const Item> parts) {
  const yarn::Body& last = parts.back().body;
  const std::string name = ascii(last.group);
  const auto write_all = [&] {
    std::vector<int> members;
    for (const Item& part : parts) members.push_back(write(part.body, part.shape()));
    named(common_of(last, name), 1,
          [&](const Common& common) { return write_group(records_, common, members); });
  };
  return whole_or_nothing(last.group, last.place, [&]() -> Status {
    std::int64_t values = 1000 + 2 * static_cast<std::int64_t>(parts.size());
    for (const Item& part : parts) {
      if (Status status = check(part.body, part.shape()); !status.ok()) return status;
      values += most_values_of(part.body, part.shape());
    }
    for (const Item& part : parts) warn_of_name(part.body.name, "yarn " + part.body.name);
    return add_checked(last.group, "yarn " + last.group, values, write_all, parts.size());
  });
}

Status FileWriter::add_piece(const fabric::PieceShape& piece) {
  const std::string name = ascii(piece.name);
  const auto write_all = [&] {
    const Common common{
        .color = color(yarn::Color{}), .level = level(yarn::all_roles.size(), "piece"), .label = name};
    named(common, entities_of_piece(piece),
          [&](const Common& with_name) { return write_piece(records_, with_name, piece); });
  };
  return whole_or_nothing({}, piece.place, [&]() -> Status {
    for (const fabric::PieceEdge& edge : piece.edges) {
      if (!largest_of(edge.curve.points))
        return error(Kind::geometry,
                     fmt::format("piece {} has a coordinate that is not a finite number", piece.name));
      extremes_.smallest_size = std::min(extremes_.smallest_size, nurbs::length_of(edge.curve.points));
    }
    extremes_.largest = std::max(extremes_.largest, largest_of(plane_of(piece).points).value_or(0));
    const std::int64_t values = 1000 + 150 * static_cast<std::int64_t>(piece.edges.size());
    return add_checked(piece.name, "piece " + piece.name, values, write_all);
  });
}

void FileWriter::take_size(const std::vector<Vec3>& points) {
  extremes_.largest = std::max(extremes_.largest, largest_of(points).value_or(0));
  extremes_.smallest_size = std::min(extremes_.smallest_size, cad::box_of(points).sizes().norm());
  take_digest(points, extremes_.digest);
}

// What stands in a group of the file it comes from stands in one again, as the plies of a yarn do.
Status FileWriter::add_part(const cad::Part& part) {
  const std::string what = "part " + (part.name.empty() ? part.origin.entity : part.name);
  return whole_or_nothing({}, part.origin.place, [&]() -> Status {
    if (const std::string_view fault = fault_of(part); !fault.empty())
      return error(Kind::geometry, fmt::format("{} {}", what, fault));
    if (part.group != group_)
      if (Status closed = close_group(); !closed.ok()) return closed;
    for (const cad::Face& face : part.faces) take_size(face.surface.points);
    if (part.kind == cad::Part::Kind::solid && !is_written_as_solid(part))
      messages_.push_back(warning(
          Kind::unsupported, fmt::format("{} is written as surfaces, not as a solid: {}; --to step keeps it",
                                         what, why_no_solid(part))));
    int last = 0;
    // Its group, too, has to find room at the end.
    const std::int64_t values =
        most_values_of_part(part) + 4 * static_cast<std::int64_t>(members_.size()) + 1000;
    Status status = add_checked(part.name, what, values, [&] { last = write_part(records_, *this, part); });
    if (status.ok() && !part.group.empty()) {
      group_ = part.group;
      members_.push_back(last);
    }
    return status;
  });
}

Status FileWriter::close_group() {
  if (members_.empty()) return {};
  const std::string name = ascii(group_);
  const auto write = [&] {
    named({.label = name}, 1, [&](const Common& common) { return write_group(records_, common, members_); });
  };
  if (Status status =
          check_room(1000 + 2 * static_cast<std::int64_t>(members_.size()), "group " + group_, write);
      !status.ok())
    return status;
  write();
  members_.clear();
  group_.clear();
  return records_.status();
}

Status FileWriter::add_curve(const cad::NamedCurve& curve) {
  const std::string what = "curve " + (curve.name.empty() ? curve.origin.entity : curve.name);
  return whole_or_nothing({}, {}, [&]() -> Status {
    if (!is_finite(curve.curve)) return error(Kind::geometry, fmt::format("{} {}", what, not_finite));
    take_size(curve.curve.points);
    const auto values =
        1000 + 5 * static_cast<std::int64_t>(curve.curve.points.size() + curve.curve.knots.size());
    return add_checked(curve.name, what, values, [&] { write_free_curve(records_, *this, curve); });
  });
}

Status FileWriter::add_checked(const std::string& name, const std::string& what, std::int64_t values,
                               const std::function<void()>& write, std::uint64_t bodies) {
  if (Status status = check_room(values, what, write); !status.ok()) return status;
  warn_of_name(name, what);
  if (bodies_ == 0 && bodies > 0) expect_as_first(values, write, bodies);
  write();
  bodies_ += bodies;
  if (bodies_ > 0)
    expect(static_cast<std::uint64_t>(records_.lines().directory / 2), shared_.entities(), bodies_);
  return records_.status();
}

void FileWriter::warn_of_name(const std::string& name, const std::string& what) {
  const std::string written = ascii(name);
  if (written == name || std::exchange(renamed_, true)) return;
  messages_.push_back(warning(
      Kind::unsupported, fmt::format("IGES strings are ASCII: {} is named {} in the file", what, written)));
}

Result<WriteFacts> FileWriter::finish() {
  if (Status closed = close_group(); !closed.ok()) return closed.error();
  const Result<std::uint64_t> end = records_.finish();
  if (!end) return end.error();
  header_.largest = extremes_.largest;
  header_.resolution =
      resolution_for(bodies_ > 0 ? extremes_.smallest_size : 0, extremes_.largest, options_.resolution);
  const HeaderText text = header_text(header_);
  const Records::Lines lines = records_.lines();
  if (Status status = output_->write_at(0, text.bytes); !status.ok()) return status.error();
  // At the end and by write(), so that whatever is appended later follows it.
  if (Status status = output_->write(terminate_text(text, lines.directory, lines.parameters)); !status.ok())
    return status.error();
  WriteFacts facts;
  for (const auto& [type, count] : records_.counts()) facts.entities[std::to_string(type)] = count;
  facts.messages = std::move(messages_);
  return facts;
}

}  // namespace selvage::formats::iges
