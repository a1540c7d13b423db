// The names of the yarns to build: each stands for one.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <unordered_set>

#include "construction/build.h"
#include "fabric/yarn_spec.h"

namespace selvage::fabric {

std::optional<std::size_t> YarnBuilder::find(std::string_view name) const {
  std::call_once(names_->once, [this] {
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (entries_[i].part == 0) names_->first.emplace(name_of(entries_[i]), i);
  });
  const auto found = names_->first.find(std::string(name));
  return found == names_->first.end() ? std::nullopt : std::optional(found->second);
}

// Yarn blocks keep their names. A construction of whose names one is taken begins all of them anew.
void YarnBuilder::make_names_unique(Diagnostics& diagnostics) {
  std::unordered_set<std::string> taken;
  for (const Entry& entry : entries_)
    if (entry.yarn != nullptr) taken.insert(entry.yarn->name);
  for (const Entry& entry : entries_)
    if (!taken.empty() && entry.placed != nullptr && taken.contains(name_of(entry)))
      diagnostics.add(
          error(Kind::geometry, fmt::format("a yarn of this file has the name '{}' of a yarn that is "
                                            "used here: 'as' gives these other names",
                                            name_of(entry)))
              .placed(entry.placed->place, fabric_->file));
  if (taken.empty() && constructions_.size() < 2) return;
  std::map<std::string_view, int> numbers;  // of constructions of a kind
  for (const auto& made : constructions_) {
    const Construction& construction = *made->construction;
    const auto name_of_yarn = [&](std::size_t i) { return made->prefix + construction.name(i); };
    const auto is_taken = [&] {
      for (std::size_t i = 0; i < construction.count(); ++i)
        if (taken.contains(name_of_yarn(i))) return true;
      return false;
    };
    for (int number = ++numbers[made->kind]; is_taken(); ++number)
      made->prefix = fmt::format("{}{}_", made->kind, number);
    if (!made->prefix.empty())
      diagnostics.add(
          warning(Kind::geometry, fmt::format("other yarns of this file have names of this {}'s: its own "
                                              "begin with '{}', as in '{}'",
                                              made->kind, made->prefix, name_of_yarn(0)))
              .placed(made->place, fabric_->file));
    for (std::size_t i = 0; i < construction.count(); ++i) taken.insert(name_of_yarn(i));
  }
}

// A yarn block that is named as a ply or a filament of another yarn.
void YarnBuilder::check_part_names(Diagnostics& diagnostics) const {
  for (const Entry& entry : entries_) {
    if (entry.yarn == nullptr || entry.part != 0) continue;
    const std::string& name = entry.yarn->name;
    for (const std::string_view mark : {".ply", ".f"}) {
      const std::size_t end = name.find(mark);
      const std::optional<std::size_t> whole =
          end == name.npos ? std::nullopt : find(std::string_view(name).substr(0, end));
      if (!whole || entries_[*whole].parts == 1 || entries_[*whole].placed != nullptr) continue;
      const Entry& other = entries_[*whole];
      const Thread thread = other.yarn != nullptr ? resolved_thread(*fabric_, *other.yarn)
                                                  : other.made->construction->thread(other.index);
      for (std::size_t part = 0; part < other.parts; ++part)
        if (part_name(name_of(other), thread, options_.detail, part) == name)
          diagnostics.add(
              error(Kind::geometry, fmt::format("yarn '{}' has the name of a part of yarn '{}': give it "
                                                "another one",
                                                name, name_of(other)))
                  .placed(entry.yarn->place, fabric_->file));
    }
  }
}

void YarnBuilder::check_edited_names(Diagnostics& diagnostics) const {
  std::vector<std::string_view> names;
  for (const Edit& edit : fabric_->edits) {
    if (diagnostics.is_full()) return;
    if (const std::optional<std::size_t> found = find(edit.yarn)) {
      if (entries_[*found].placed != nullptr)
        diagnostics.add(
            error(Kind::geometry, fmt::format("yarn '{}' is one of a block: what edits it stands in that "
                                              "block, with its name there",
                                              edit.yarn))
                .placed(edit.place, fabric_->file));
      continue;
    }
    if (names.empty()) {
      for (const auto& [name, entry] : names_->first) names.push_back(name);
      std::sort(names.begin(), names.end());
    }
    const std::string_view near = nearest_word(edit.yarn, names);
    diagnostics.add(
        error(Kind::geometry,
              fmt::format("there is no yarn '{}' to edit{}", edit.yarn,
                          near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)))
            .placed(edit.place, fabric_->file));
  }
}

}  // namespace selvage::fabric
