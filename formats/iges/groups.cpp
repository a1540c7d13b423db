// 402: groups. And what is understood without a function of its own, since others look it up.
#include <array>

#include "formats/iges/standard.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

// 3: name of a level, 15: name. 1, definition of levels, is looked up, too.
bool is_known_property(int form) {
  return form == 1 || form == 3 || form == 15;
}

std::vector<int> members_of(Reading& /*reading*/, const DirectoryEntry& /*entry*/, Parameters& in) {
  return in.pointers("members");
}

// A group of faces is one part. What any other group holds stands alone, with the outermost group's name.
void stand_group(Reading& reading, const DirectoryEntry& entry, Parameters& in, const Context& context) {
  const std::vector<int> members = members_of(reading, entry, in);
  if (!in.ok() || members.empty()) return;
  const cad::Label own = reading.attributes(entry, in);
  if (!in.ok()) return;
  if (reading.are_faces(members)) {
    reading.stand_together(own, members, context, in);
    return;
  }
  Context inner = context;
  if (inner.group.empty()) inner.group = own.name.empty() ? entry.name() : own.name;
  for (const int member : members) {
    reading.stand(member, inner, in);
    if (!in.ok()) return;
  }
}

}  // namespace

std::span<const EntityType> structure_types() {
  static constexpr std::array<EntityType, 5> types = {
      {{.number = 0},
       {.number = 124},
       {.number = 314},
       {.number = 402, .stand = stand_group, .members = members_of, .has_form = is_group},
       {.number = 406, .has_form = is_known_property}}};
  return types;
}

}  // namespace selvage::formats::iges
