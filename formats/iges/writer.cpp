#include "formats/iges/writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/clock.h"
#include "formats/iges/entities.h"
#include "formats/iges/header.h"
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

// The mean thickness of the yarn's first section: the length of its control polygon over pi.
double size_of(const nurbs::Surface& surface) {
  double length = 0;
  for (int i = 1; i < surface.count_u; ++i) length += (surface.point(i, 0) - surface.point(i - 1, 0)).norm();
  return length / std::numbers::pi;
}

class Writer final : public BodyWriter {
 public:
  Writer(OutputFile& output, const SurfaceOptions& options, Header header, Records::Limits limits)
      : output_(&output),
        options_(options),
        header_(std::move(header)),
        records_(output, header_text(header_).bytes.size(), limits) {}

  Status add(const yarn::Body& body) override;
  Status add_piece(const fabric::PieceShape& piece) override;
  Result<WriteFacts> finish() override;

 private:
  struct Shared {
    std::vector<std::pair<yarn::Color, int>> colors;        // and their 314
    std::array<bool, yarn::all_roles.size() + 1> levels{};  // by role, and that of pieces
  };

  Status check(const yarn::Body& body);
  Status check(const fabric::PieceShape& piece);
  // `values`: an upper bound of the lines that `write` writes; `what`: "yarn warp1".
  Status check_room(std::int64_t values, const std::string& what, const std::function<void()>& write);
  Status add_checked(const std::string& name, const std::string& what, std::int64_t values,
                     const std::function<void()>& write);
  void write(const yarn::Body& body);
  void write(const fabric::PieceShape& piece);
  int write_surfaces(const Common& common, const yarn::Body& body);
  Status close_group();
  int color(const yarn::Color& color);
  int level(std::size_t index, std::string_view name);
  [[nodiscard]] int entities_of_end(const yarn::EndFace& end) const;

  OutputFile* output_;
  SurfaceOptions options_;
  Header header_;
  Records records_;
  Shared shared_;
  std::string name_;  // of the present yarn or piece, in ASCII
  int last_ = 0;      // directory pointer of the yarn written last: of its group or solid
  // The yarn whose plies or filaments come at present, what they share, and theirs so far.
  std::string group_;
  Common group_common_;
  std::vector<int> members_;
  std::uint64_t bodies_ = 0;
  double largest_ = 0;
  double smallest_size_ = std::numeric_limits<double>::infinity();
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
  }
  for (const yarn::EndFace* end : {&body.start, &body.end}) {
    if (body.closed_along) break;
    if (options_.iges_solid && end->style == EndStyle::none)
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
  largest_ = std::max(largest_, largest);
  smallest_size_ = std::min(smallest_size_, size_of(body.surface));
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
    smallest_size_ = std::min(smallest_size_, length);
  }
  const nurbs::Surface plane = plane_of(piece);
  largest_ = std::max(largest_, largest_of(numbers_of(plane.points)).value_or(0));
  return {};
}

// Far from the limit a rough bound is enough; near it the thing is written without being kept, and its lines
// counted.
Status Writer::check_room(std::int64_t values, const std::string& what, const std::function<void()>& write) {
  const Records::Lines now = records_.lines();
  const std::int64_t most = records_.limits().lines;
  if (now.parameters + values <= most && now.directory + values <= most) return {};

  const Shared before = shared_;
  records_.measure(true);
  write();
  const Records::Lines needed = records_.measure(false);
  shared_ = before;
  if (needed.parameters <= most && needed.directory <= most) return {};
  const bool parameters = needed.parameters > most;
  return error(
      Kind::limit,
      fmt::format("with {} the IGES file would need {} {} lines, but lines are numbered to {} at most ({} {} "
                  "fit): split the fabric over several files",
                  what, parameters ? needed.parameters : needed.directory,
                  parameters ? "parameter" : "directory", most, bodies_,
                  what.starts_with("yarn") ? "yarns" : "yarns and pieces"));
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

int Writer::write_surfaces(const Common& common, const yarn::Body& body) {
  std::array<int, 3> faces{};
  std::size_t count = 0;
  faces[count++] = write_surface(records_, common.entity(128), body.surface, common.name);
  for (const yarn::EndFace* end : {&body.start, &body.end}) {
    if (body.closed_along || end->style == EndStyle::none) continue;
    faces[count++] = end->style == EndStyle::planar
                         ? write_planar_end(records_, common, body, end == &body.end)
                         : write_surface(records_, common.entity(128), end->surface, common.name);
  }
  // Whoever sews the group takes the direction of the shell from its first member. Gmsh makes one solid of
  // all shells of a file and then splits it, which fails where two of them point outward: so a face that
  // points inward leads.
  if (count > 1 && !body.inward) std::swap(faces[0], faces[1]);
  return write_group(records_, common, {faces.data(), count});
}

void Writer::write(const yarn::Body& body) {
  Common common{.color = color(body.color),
                .level = level(static_cast<std::size_t>(body.role), yarn::name_of(body.role)),
                .label = name_};
  int entities = 2;  // the first face and the group
  if (options_.iges_solid)
    entities = entities_of_solid(body);
  else if (!body.closed_along)
    entities += entities_of_end(body.start) + entities_of_end(body.end);
  common.name = records_.next() + 2 * entities;
  if (options_.iges_solid)
    last_ = write_solid(records_, common, body);
  else
    last_ = write_surfaces(common, body);
  write_name(records_, common, name_);
}

void Writer::write(const fabric::PieceShape& piece) {
  Common common{
      .color = color(yarn::Color{}), .level = level(yarn::all_roles.size(), "piece"), .label = name_};
  common.name = records_.next() + 2 * entities_of_piece(piece);
  write_piece(records_, common, piece);
  write_name(records_, common, name_);
}

Status Writer::add(const yarn::Body& body) {
  if (Status status = check(body); !status.ok()) return status;
  if (body.group != group_)
    if (Status closed = close_group(); !closed.ok()) return closed;
  Status added = add_checked(body.name, "yarn " + body.name, most_values(body), [&] { write(body); });
  if (added.ok() && !body.group.empty()) {
    group_ = body.group;
    group_common_ = {.color = color(body.color), .level = static_cast<int>(body.role) + 1, .label = {}};
    members_.push_back(last_);
  }
  if (added.ok()) return added;
  if (added.error().kind == Kind::limit) {
    added.error().yarn = body.name;
    added.error().place = body.place;
  }
  return added;
}

// The plies and filaments of a yarn, one group with the yarn's name.
Status Writer::close_group() {
  if (members_.empty()) return {};
  const std::string name = ascii(group_);
  Common common = group_common_;
  common.label = name;
  const auto values = 1000 + 2 * static_cast<std::int64_t>(members_.size());
  const auto write = [&] {
    common.name = records_.next() + 2;
    write_group(records_, common, members_);
    write_name(records_, common, name);
  };
  if (Status status = check_room(values, "yarn " + group_, write); !status.ok()) return status;
  write();
  members_.clear();
  group_.clear();
  return records_.status();
}

Status Writer::add_piece(const fabric::PieceShape& piece) {
  Status status = check(piece);
  if (status.ok())
    status = add_checked(piece.name, "piece " + piece.name, most_values(piece), [&] { write(piece); });
  if (!status.ok() && status.error().kind != Kind::io) status.error().place = piece.place;
  return status;
}

Status Writer::add_checked(const std::string& name, const std::string& what, std::int64_t values,
                           const std::function<void()>& write) {
  name_ = ascii(name);
  if (Status status = check_room(values, what, write); !status.ok()) return status;
  if (name_ != name && !std::exchange(renamed_, true))
    messages_.push_back(warning(
        Kind::unsupported, fmt::format("IGES strings are ASCII: {} is named {} in the file", what, name_)));
  write();
  ++bodies_;
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

Result<WriteFacts> Writer::finish() {
  if (Status closed = close_group(); !closed.ok()) return closed.error();
  const Result<std::uint64_t> end = records_.finish();
  if (!end) return end.error();
  header_.largest = largest_;
  header_.resolution = resolution_for(bodies_ > 0 ? smallest_size_ : 0, largest_);
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

Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options,
                                                Records::Limits limits) {
  Header header{.title = options.title,
                .file_name = options.file_name,
                .units = options.units,
                .time = options.date.empty() ? iges_timestamp() : options.date};
  return std::unique_ptr<BodyWriter>(std::make_unique<Writer>(output, options, std::move(header), limits));
}

}  // namespace selvage::formats::iges
