// 308, 408, 412 and 414: definitions, their instances, and arrays of instances. Instances are flattened: what
// stands in the model stands for itself.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

std::vector<int> members_of_definition(Reading& /*reading*/, const DirectoryEntry& /*entry*/,
                                       Parameters& in) {
  in.integer();  // how deep it nests
  in.text();     // its name
  std::vector<int> members(in.count("members"));
  for (int& member : members) member = in.pointer();
  return members;
}

std::vector<int> definition_of_instance(Reading& /*reading*/, const DirectoryEntry& /*entry*/,
                                        Parameters& in) {
  return {in.pointer()};
}

// What has no name of its own has the instance's.
void take_over(const cad::Label& own, cad::Part& part) {
  if (part.name.empty()) part.name = own.name;
  if (!part.color) part.color = own.color;
  for (cad::Face& face : part.faces)
    if (face.name.empty()) face.name = own.name;
}

// Once what a 308 holds, or any other entity, in its place: `context` has that already.
void stand_copy(Reading& reading, const DirectoryEntry& base, const cad::Label& own, const Context& context,
                Parameters& in) {
  const std::size_t before = reading.model().parts.size();
  if (base.type != 308) {
    reading.stand(base.pointer, context, in);
  } else {
    Parameters inside = reading.file().parameters(base);  // which were read once without a fault
    const std::vector<int> members = members_of_definition(reading, base, inside);
    const Context inner{context.placement * reading.placement(base), context.group};
    // Faces that are placed together are one part, as in a group.
    if (members.size() > 1 && reading.are_faces(members))
      reading.stand_together(own, members, inner, in);
    else
      for (const int member : members) {
        if (!in.ok()) break;
        reading.stand(member, inner, in);
      }
  }
  if (reading.model().parts.size() == before + 1) take_over(own, reading.model().parts.back());
}

// Copies of one entity: each scaled, not turned, and shifted.
struct Copies {
  int base = 0;
  double scale = 1;
  std::vector<Vec3> shifts;
};

void stand_copies(Reading& reading, const DirectoryEntry& entry, const DirectoryEntry* base,
                  const Copies& copies, Parameters& in, const Context& context) {
  if (base == nullptr || !in.ok()) return;
  const double points = reading.extent(*base) * static_cast<double>(copies.shifts.size());
  if (!(copies.scale > 0))
    in.fail(fmt::format("an instance at a scale of {}", copies.scale));
  else if (points > static_cast<double>(Reading::most_points))
    in.fail(fmt::format("this instance stands for {:.2g} control points or more: at most {} are made", points,
                        Reading::most_points));
  const cad::Label own = reading.attributes(entry, in);
  for (const Vec3& shift : copies.shifts) {
    if (!in.ok()) return;
    const Placement placement = Placement::of(copies.scale * Eigen::Matrix3d::Identity(), shift);
    stand_copy(reading, *base, own, {context.placement * placement, context.group}, in);
  }
}

void stand_instance(Reading& reading, const DirectoryEntry& entry, Parameters& in, const Context& context) {
  Copies copies;
  copies.base = in.pointer();
  const double x = in.real(), y = in.real(), z = in.real();
  copies.scale = in.real(1);
  copies.shifts = {{x, y, z}};
  stand_copies(reading, entry, reading.entry(copies.base, 308, in), copies, in, context);
}

// Which of the places 1 .. `count` of an array are taken: all, those that are listed, or the others.
std::vector<char> read_places(Parameters& in, std::int64_t count) {
  constexpr std::int64_t most = 1'000'000;
  if (in.ok() && (count < 1 || count > most))
    in.fail(fmt::format("an array of {} places: 1 to {} are read", count, most));
  const std::size_t listed = in.count("places");
  const bool are_left_out = in.integer() == 1;
  if (!in.ok()) return {};
  std::vector<char> taken(static_cast<std::size_t>(count), listed == 0 || are_left_out ? 1 : 0);
  for (std::size_t i = 0; i < listed && in.ok(); ++i) {
    const std::int64_t place = in.integer();
    if (in.ok() && (place < 1 || place > count))
      in.fail(fmt::format("there is no place {} in an array of {}", place, count));
    else if (in.ok())
      taken[static_cast<std::size_t>(place) - 1] = are_left_out ? 0 : 1;
  }
  return taken;
}

// A 412: places upwards in the first column, then in the one to its right; the array is turned about its
// corner.
Copies read_rectangular_array(Parameters& in) {
  Copies copies;
  copies.base = in.pointer();
  copies.scale = in.real(1);
  const double x = in.real(), y = in.real(), z = in.real();
  const std::int64_t columns = in.integer(), rows = in.integer();
  const double dx = in.real(), dy = in.real(), angle = in.real();
  const bool is_sane = columns >= 1 && rows >= 1 && columns < 1'000'000'000 && rows < 1'000'000'000;
  const std::vector<char> taken = read_places(in, is_sane ? columns * rows : 0);
  const Eigen::AngleAxisd turn(angle, Vec3::UnitZ());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const std::size_t column = i / static_cast<std::size_t>(rows), row = i % static_cast<std::size_t>(rows);
    const Vec3 place(static_cast<double>(column) * dx, static_cast<double>(row) * dy, 0);
    if (taken[i] != 0) copies.shifts.emplace_back(Vec3(x, y, z) + turn * place);
  }
  return copies;
}

// A 414: places round a circle, from a first angle on.
Copies read_circular_array(Parameters& in) {
  Copies copies;
  copies.base = in.pointer();
  const std::int64_t count = in.integer();
  const double x = in.real(), y = in.real(), z = in.real(), radius = in.real(), start = in.real(),
               step = in.real();
  const std::vector<char> taken = read_places(in, count);
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const double angle = start + step * static_cast<double>(i);
    if (taken[i] != 0)
      copies.shifts.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle), z);
  }
  return copies;
}

template <Copies (*read)(Parameters&)>
void stand_array(Reading& reading, const DirectoryEntry& entry, Parameters& in, const Context& context) {
  const Copies copies = read(in);
  if (in.ok()) stand_copies(reading, entry, reading.entry(copies.base, in), copies, in, context);
}

}  // namespace

std::span<const EntityType> subfigure_types() {
  static constexpr std::array<EntityType, 4> types = {
      {{.number = 308, .members = members_of_definition},
       {.number = 408, .stand = stand_instance, .members = definition_of_instance},
       {.number = 412, .stand = stand_array<read_rectangular_array>, .members = definition_of_instance},
       {.number = 414, .stand = stand_array<read_circular_array>, .members = definition_of_instance}}};
  return types;
}

}  // namespace selvage::formats::iges
