#include "formats/iges/types.h"

#include <array>
#include <unordered_map>

namespace selvage::formats::iges {

const EntityType* type_of(const DirectoryEntry& entry) {
  static const std::unordered_map<int, const EntityType*> all = [] {
    std::unordered_map<int, const EntityType*> table;
    for (const std::span<const EntityType> list :
         {bspline_types(), curve_types(), surface_types(), analytic_types(), offset_types(), trimming_types(),
          topology_types(), subfigure_types(), structure_types()})
      for (const EntityType& type : list) table.emplace(type.number, &type);
    return table;
  }();
  const auto found = all.find(entry.type);
  if (found == all.end()) return nullptr;
  const EntityType* const type = found->second;
  return type->has_form == nullptr || type->has_form(entry.form) ? type : nullptr;
}

}  // namespace selvage::formats::iges
