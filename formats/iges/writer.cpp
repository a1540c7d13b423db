#include "formats/iges/writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "core/clock.h"
#include "formats/iges/entities.h"
#include "formats/iges/header.h"
#include "formats/iges/options.h"
#include "formats/iges/part.h"
#include "formats/iges/piece.h"
#include "formats/iges/solid.h"

namespace selvage::formats::iges {

namespace {

using yarn::EndStyle;

std::span<const double> numbers_of(const std::vector<Vec3>& points) {
  return {points.empty() ? nullptr : points.data()->data(), 3 * points.size()};
}

// The largest magnitude; nothing where a value is not finite. Magnitudes order like their bits, and what is
// not finite is above all others.
std::optional<double> largest_of(std::span<const double> values) {
  constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
  std::uint64_t largest = 0;
  for (const double value : values) largest = std::max(largest, std::bit_cast<std::uint64_t>(value) & ~sign);
  const double magnitude = std::bit_cast<double>(largest);
  return std::isfinite(magnitude) ? std::optional(magnitude) : std::nullopt;
}

// FNV-1a over whole doubles.
void take_digest(const std::vector<Vec3>& points, std::uint64_t& digest) {
  for (const double value : numbers_of(points))
    digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001B3;
}

// The mean thickness of the yarn's first section: the length of its control polygon over pi.
double size_of(const nurbs::Surface& surface) {
  double length = 0;
  for (int i = 1; i < surface.count_u; ++i) length += (surface.point(i, 0) - surface.point(i - 1, 0)).norm();
  return length / std::numbers::pi;
}

class Writer final : public FileWriter, private ColorSource {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options, Header header, Records::Limits limits)
      : output_(&output),
        options_(options),
        is_solid_(options.own.has(option::solid) || options.yarns_are_solids),
        header_(std::move(header)),
        records_(output, header_text(header_).bytes.size(), limits) {}

  Status add(const yarn::Body& body) override;
  Status add_instance(const yarn::Body& body, const Instance& instance) override;
  Status add_group(std::span<const Item> parts) override;
  Status add_piece(const fabric::PieceShape& piece) override;
  Status add_part(const cad::Part& part) override;
  Status add_curve(const cad::NamedCurve& curve) override;
  Result<WriteFacts> finish() override;

  std::int64_t lines_of(const yarn::Body& body) override;
  [[nodiscard]] bool is_empty() const override { return bodies_ == 0; }
  [[nodiscard]] const Header& header() const override { return header_; }
  [[nodiscard]] std::uint64_t digest() const override { return extremes_.digest; }

 private:
  struct Shared {
    std::vector<std::pair<yarn::Color, int>> colors;        // and their 314
    std::array<bool, yarn::all_roles.size() + 1> levels{};  // by role, and that of pieces
    std::map<std::size_t, int> definitions;                 // of shapes that have copies: their 308
  };

  // What fails leaves no trace.
  template <class Work>
  Status whole_or_nothing(Work work) {
    const Extremes before = extremes_;
    Status status = work();
    if (!status.ok()) extremes_ = before;
    return status;
  }
  Status check(const yarn::Body& body);
  Status check(const fabric::PieceShape& piece);
  // `values`: an upper bound of the lines that `write` writes; `what`: "yarn warp1".
  Status check_room(std::int64_t values, const std::string& what, const std::function<void()>& write);
  Records::Lines measured(const std::function<void()>& write);
  Status add_checked(const std::string& name, const std::string& what, std::int64_t values,
                     const std::function<void()>& write, std::uint64_t bodies = 1);
  int write(const yarn::Body& body);
  int write(const yarn::Body& body, const Instance& instance);
  int definition_of(const Instance& instance);
  Status check(const yarn::Body& body, const Instance& instance);
  std::int64_t most_values_of(const yarn::Body& body, const Instance* instance) const;
  void write_group_of(std::span<const Item> parts);
  void warn_of_name(const std::string& name, const std::string& what);
  void write(const fabric::PieceShape& piece);
  std::vector<int> write_faces(const Common& common, const yarn::Body& body);
  int color(const yarn::Color& color);
  int pointer(const std::optional<cad::Color>& of) override { return of ? color(*of) : 0; }
  void take_size(const std::vector<Vec3>& points);
  Status close_group();
  int level(std::size_t index, std::string_view name);
  [[nodiscard]] int entities_of_end(const yarn::EndFace& end) const;

  OutputFile* output_;
  SurfaceOptions options_;
  bool is_solid_;
  Header header_;
  Records records_;
  Shared shared_;
  std::string name_;  // of the present yarn or piece, in ASCII
  // The group whose parts come at present, and theirs so far.
  std::string group_;
  std::vector<int> members_;
  std::uint64_t bodies_ = 0;
  // Of all that was written.
  struct Extremes {
    double largest = 0;
    double smallest_size = std::numeric_limits<double>::infinity();
    std::uint64_t digest = 0xCBF29CE484222325;  // of control points
  } extremes_;
  std::vector<Message> messages_;
  bool renamed_ = false;
};

Message yarn_error(Kind kind, const yarn::Body& body, std::string text) {
  Message message = error(kind, std::move(text));
  message.yarn = body.name;
  message.place = body.place;
  return message;
}

// Every number that will be written, and whether the body can be what is asked for.
Status Writer::check(const yarn::Body& body) {
  double largest = 0;
  for (const nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface}) {
    const std::optional<double> coordinates = largest_of(numbers_of(surface->points));
    if (!coordinates || !largest_of(surface->weights) || !largest_of(surface->knots_u) ||
        !largest_of(surface->knots_v))
      return yarn_error(
          Kind::geometry, body,
          fmt::format("yarn {} has a coordinate, weight or knot that is not a finite number", body.name));
    largest = std::max(largest, *coordinates);
    take_digest(surface->points, extremes_.digest);
  }
  for (const yarn::EndFace* end : {&body.start, &body.end}) {
    if (body.closed_along) break;
    if (is_solid_ && end->style == EndStyle::none)
      return yarn_error(
          Kind::geometry, body,
          fmt::format("yarn {} has open ends and cannot be written as a solid: seal it with --ends "
                      "patch, fan or planar, or leave out --iges-solid",
                      body.name));
    if (end->style != EndStyle::planar) continue;
    const yarn::EndPlane plane =
        yarn::end_plane(body, yarn::end_curve(body, end == &body.end), end == &body.end);
    const std::optional<double> corners = largest_of(numbers_of(plane.surface.points));
    if (!corners)
      return yarn_error(Kind::geometry, body,
                        fmt::format("yarn {} has an end plane that is not finite", body.name));
    largest = std::max(largest, *corners);
  }
  extremes_.largest = std::max(extremes_.largest, largest);
  extremes_.smallest_size = std::min(extremes_.smallest_size, size_of(body.surface));
  return {};
}

std::int64_t most_values(const yarn::Body& body) {
  std::int64_t values = 1000;
  for (const nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface})
    values += static_cast<std::int64_t>(4 * surface->points.size() +
                                        4 * (surface->knots_u.size() + surface->knots_v.size()) +
                                        16 * static_cast<std::size_t>(surface->count_u + surface->count_v));
  return values;
}

std::int64_t most_values(const fabric::PieceShape& piece) {
  return 1000 + 150 * static_cast<std::int64_t>(piece.edges.size());
}

Status Writer::check(const fabric::PieceShape& piece) {
  for (const fabric::PieceEdge& edge : piece.edges) {
    const std::optional<double> coordinates = largest_of(numbers_of(edge.curve.points));
    if (!coordinates)
      return error(Kind::geometry,
                   fmt::format("piece {} has a coordinate that is not a finite number", piece.name));
    double length = 0;  // of the control polygon
    for (std::size_t i = 1; i < edge.curve.points.size(); ++i)
      length += (edge.curve.points[i] - edge.curve.points[i - 1]).norm();
    extremes_.smallest_size = std::min(extremes_.smallest_size, length);
  }
  const nurbs::Surface plane = plane_of(piece);
  extremes_.largest = std::max(extremes_.largest, largest_of(numbers_of(plane.points)).value_or(0));
  return {};
}

// Far from the limit a rough bound is enough; near it the thing is written without being kept, and its lines
// counted.
Status Writer::check_room(std::int64_t values, const std::string& what, const std::function<void()>& write) {
  const Records::Lines now = records_.lines();
  const std::int64_t most = records_.limits().lines;
  if (now.parameters + values <= most && now.directory + values <= most) return {};

  const Records::Lines needed = measured(write);
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

// What the sections would have with it.
Records::Lines Writer::measured(const std::function<void()>& write) {
  const Shared before = shared_;
  records_.measure(true);
  write();
  shared_ = before;
  return records_.measure(false);
}

std::int64_t Writer::lines_of(const yarn::Body& body) {
  const Records::Lines now = records_.lines(), with = measured([&] { write(body); });
  return std::max(with.parameters - now.parameters, with.directory - now.directory);
}

int Writer::color(const yarn::Color& color) {
  for (const auto& [known, pointer] : shared_.colors)
    if (known == color) return pointer;
  const int pointer = write_color(records_, color);
  shared_.colors.emplace_back(color, pointer);
  return pointer;
}

int Writer::level(std::size_t index, std::string_view name) {
  const int level = static_cast<int>(index) + 1;
  if (!shared_.levels[index]) {
    write_level_name(records_, level, name);
    shared_.levels[index] = true;
  }
  return level;
}

int Writer::entities_of_end(const yarn::EndFace& end) const {
  switch (end.style) {
    case EndStyle::none:
      return 0;
    case EndStyle::planar:
      return entities_of_planar_end;
    case EndStyle::patch:
    case EndStyle::fan:
      return 1;
  }
  return 0;
}

// The faces of a yarn that is no solid.
std::vector<int> Writer::write_faces(const Common& common, const yarn::Body& body) {
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

// Returns the directory pointer of its group or solid.
int Writer::write(const yarn::Body& body) {
  name_ = ascii(body.name);
  Common common{.color = color(body.color),
                .level = level(static_cast<std::size_t>(body.role), yarn::name_of(body.role)),
                .label = name_};
  int entities = 2;  // the first face and the group
  if (is_solid_)
    entities = entities_of_solid(body);
  else if (!body.closed_along)
    entities += entities_of_end(body.start) + entities_of_end(body.end);
  common.name = records_.next() + 2 * entities;
  const int pointer = is_solid_ ? write_solid(records_, common, body)
                                : write_group(records_, common, write_faces(common, body));
  write_name(records_, common, name_);
  return pointer;
}

// Returns the directory pointer of the 308, which comes before the first copy.
int Writer::definition_of(const Instance& instance) {
  const auto known = shared_.definitions.find(instance.shape);
  if (known != shared_.definitions.end()) return known->second;
  const yarn::Body& body = *instance.body;
  const std::string name = ascii(body.name);
  const Common common{.color = color(body.color),
                      .level = level(static_cast<std::size_t>(body.role), yarn::name_of(body.role)),
                      .label = {},  // names are the copies'
                      .status = dependent};
  const std::vector<int> members =
      is_solid_ ? std::vector{write_solid(records_, common, body)} : write_faces(common, body);
  const int pointer = write_definition(records_, common, name, members);
  shared_.definitions.emplace(instance.shape, pointer);
  return pointer;
}

int Writer::write(const yarn::Body& body, const Instance& instance) {
  const int definition = definition_of(instance);
  const std::string name = ascii(body.name);
  Common common{.color = color(body.color),
                .level = level(static_cast<std::size_t>(body.role), yarn::name_of(body.role)),
                .label = name};
  common.name = records_.next() + 2 * entities_of_instance(instance.motion);
  const int pointer = write_instance(records_, common, definition, instance.motion);
  write_name(records_, common, name);
  return pointer;
}

void Writer::write_group_of(std::span<const Item> parts) {
  std::vector<int> members;
  for (const Item& part : parts)
    members.push_back(part.instance ? write(part.body, *part.instance) : write(part.body));
  const yarn::Body& last = parts.back().body;
  const std::string name = ascii(last.group);
  Common common{.color = color(last.color), .level = static_cast<int>(last.role) + 1, .label = name};
  common.name = records_.next() + 2;
  write_group(records_, common, members);
  write_name(records_, common, name);
}

void Writer::write(const fabric::PieceShape& piece) {
  Common common{
      .color = color(yarn::Color{}), .level = level(yarn::all_roles.size(), "piece"), .label = name_};
  common.name = records_.next() + 2 * entities_of_piece(piece);
  write_piece(records_, common, piece);
  write_name(records_, common, name_);
}

// A limit is told of the yarn.
Status of_yarn(Status status, const std::string& name, TextPlace place) {
  if (status.ok() || status.error().kind != Kind::limit) return status;
  status.error().yarn = name;
  status.error().place = place;
  return status;
}

Status Writer::add(const yarn::Body& body) {
  return whole_or_nothing([&]() -> Status {
    if (Status status = check(body); !status.ok()) return status;
    return of_yarn(add_checked(body.name, "yarn " + body.name, most_values(body), [&] { write(body); }),
                   body.name, body.place);
  });
}

// A shape that is new to the file counts as well.
Status Writer::check(const yarn::Body& body, const Instance& instance) {
  Status status = check(body);
  if (status.ok() && !shared_.definitions.contains(instance.shape)) status = check(*instance.body);
  return status;
}

std::int64_t Writer::most_values_of(const yarn::Body& body, const Instance* instance) const {
  if (instance == nullptr) return most_values(body);
  return 1000 + (shared_.definitions.contains(instance->shape) ? 0 : most_values(*instance->body));
}

Status Writer::add_instance(const yarn::Body& body, const Instance& instance) {
  return whole_or_nothing([&]() -> Status {
    if (Status status = check(body, instance); !status.ok()) return status;
    return of_yarn(add_checked(body.name, "yarn " + body.name, most_values_of(body, &instance),
                               [&] { write(body, instance); }),
                   body.name, body.place);
  });
}

Status Writer::add_group(std::span<const Item> parts) {
  return whole_or_nothing([&]() -> Status {
    std::int64_t values = 1000 + 2 * static_cast<std::int64_t>(parts.size());
    for (const Item& part : parts) {
      if (Status status = part.instance ? check(part.body, *part.instance) : check(part.body); !status.ok())
        return status;
      values += most_values_of(part.body, part.instance ? &*part.instance : nullptr);
    }
    const yarn::Body& last = parts.back().body;
    for (const Item& part : parts) warn_of_name(part.body.name, "yarn " + part.body.name);
    return of_yarn(
        add_checked(
            last.group, "yarn " + last.group, values, [&] { write_group_of(parts); }, parts.size()),
        last.group, last.place);
  });
}

Status Writer::add_piece(const fabric::PieceShape& piece) {
  return whole_or_nothing([&] {
    Status status = check(piece);
    if (status.ok())
      status = add_checked(piece.name, "piece " + piece.name, most_values(piece), [&] { write(piece); });
    if (!status.ok() && status.error().kind != Kind::io) status.error().place = piece.place;
    return status;
  });
}

void Writer::take_size(const std::vector<Vec3>& points) {
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  extremes_.largest = std::max(extremes_.largest, largest_of(numbers_of(points)).value_or(0));
  extremes_.smallest_size = std::min(extremes_.smallest_size, box.sizes().norm());
  take_digest(points, extremes_.digest);
}

// What stands in a group of the file it comes from stands in one again, as the plies of a yarn do.
Status Writer::add_part(const cad::Part& part) {
  const std::string what = part.name.empty() ? "part " + part.origin.entity : "part " + part.name;
  Status added = whole_or_nothing([&]() -> Status {
    if (const std::string fault = fault_of(part); !fault.empty())
      return error(Kind::geometry, what + " " + fault);
    if (part.group != group_)
      if (Status closed = close_group(); !closed.ok()) return closed;
    for (const cad::Face& face : part.faces) take_size(face.surface.points);
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
  if (!added.ok() && added.error().kind != Kind::io) added.error().place = part.origin.place;
  return added;
}

Status Writer::close_group() {
  if (members_.empty()) return {};
  const std::string name = ascii(group_);
  const auto write = [&] {
    Common common{.label = name};
    common.name = records_.next() + 2;
    write_group(records_, common, members_);
    write_name(records_, common, name);
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

Status Writer::add_curve(const cad::NamedCurve& curve) {
  const std::string what = curve.name.empty() ? "curve " + curve.origin.entity : "curve " + curve.name;
  if (!largest_of(numbers_of(curve.curve.points)) || !largest_of(curve.curve.knots) ||
      !largest_of(curve.curve.weights))
    return error(Kind::geometry, what + " has a coordinate, weight or knot that is not a finite number");
  return whole_or_nothing([&] {
    take_size(curve.curve.points);
    const auto values =
        1000 + 5 * static_cast<std::int64_t>(curve.curve.points.size() + curve.curve.knots.size());
    return add_checked(curve.name, what, values, [&] { write_free_curve(records_, *this, curve); });
  });
}

Status Writer::add_checked(const std::string& name, const std::string& what, std::int64_t values,
                           const std::function<void()>& write, std::uint64_t bodies) {
  name_ = ascii(name);
  if (Status status = check_room(values, what, write); !status.ok()) return status;
  warn_of_name(name, what);
  write();
  bodies_ += bodies;
  // What is still to come is as what came.
  const auto entities = static_cast<std::uint64_t>(records_.lines().directory / 2);
  if (options_.expected_bodies > bodies_) {
    const std::uint64_t shared =
        shared_.colors.size() +
        static_cast<std::uint64_t>(std::count(shared_.levels.begin(), shared_.levels.end(), true));
    records_.expect(shared + (entities - shared) * options_.expected_bodies / bodies_);
  }
  return records_.status();
}

void Writer::warn_of_name(const std::string& name, const std::string& what) {
  const std::string written = ascii(name);
  if (written == name || std::exchange(renamed_, true)) return;
  messages_.push_back(warning(
      Kind::unsupported, fmt::format("IGES strings are ASCII: {} is named {} in the file", what, written)));
}

Result<WriteFacts> Writer::finish() {
  if (Status closed = close_group(); !closed.ok()) return closed.error();
  const Result<std::uint64_t> end = records_.finish();
  if (!end) return end.error();
  header_.largest = extremes_.largest;
  header_.resolution = resolution_for(bodies_ > 0 ? extremes_.smallest_size : 0, extremes_.largest);
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

}  // namespace

std::unique_ptr<FileWriter> open_file(OutputFile& output, const SurfaceOptions& options,
                                      Records::Limits limits) {
  Header header{.title = options.title,
                .file_name = options.file_name,
                .units = options.units,
                .time = options.date.empty() ? iges_timestamp() : options.date,
                .part = {}};
  return std::make_unique<Writer>(output, options, std::move(header), limits);
}

}  // namespace selvage::formats::iges
