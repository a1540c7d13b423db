// 308 and 408: definitions and their instances. Instances are flattened: what stands in the model stands
// for itself.
#include <fmt/format.h>

#include <array>

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

void stand_instance(Reading& reading, const DirectoryEntry& entry, Parameters& in, const Context& context) {
  const int pointer = in.pointer();
  const double x = in.real(), y = in.real(), z = in.real(), scale = in.real(1);
  const DirectoryEntry* const definition = reading.entry(pointer, 308, in);
  if (definition == nullptr) return;
  const double points = reading.extent(entry);
  if (!(scale > 0))
    in.fail(fmt::format("an instance at a scale of {}", scale));
  else if (points > static_cast<double>(Reading::most_points))
    in.fail(fmt::format("this instance stands for {:.2g} control points or more: at most {} are made", points,
                        Reading::most_points));
  if (!in.ok()) return;
  Parameters inside = reading.file().parameters(*definition);  // which were read once without a fault
  const std::vector<int> members = members_of_definition(reading, *definition, inside);
  Context inner = context;
  inner.placement = context.placement * Placement::of(scale * Eigen::Matrix3d::Identity(), {x, y, z}) *
                    reading.placement(*definition);
  const cad::Label own = reading.attributes(entry, in);
  if (!in.ok()) return;
  const std::size_t before = reading.model().parts.size();
  // Faces that are placed together are one part, as in a group.
  if (members.size() > 1 && reading.are_faces(members))
    reading.stand_together(own, members, inner, in);
  else
    for (const int member : members) {
      if (!in.ok()) break;
      reading.stand(member, inner, in);
    }
  if (reading.model().parts.size() == before + 1) take_over(own, reading.model().parts.back());
}

}  // namespace

std::span<const EntityType> subfigure_types() {
  static constexpr std::array<EntityType, 2> types = {
      {{.number = 308, .members = members_of_definition},
       {.number = 408, .stand = stand_instance, .members = definition_of_instance}}};
  return types;
}

}  // namespace selvage::formats::iges
