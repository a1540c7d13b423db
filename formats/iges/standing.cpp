// What of an IGES file stands for itself, and how it comes into the model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/graph.h"
#include "formats/iges/reading.h"
#include "formats/iges/standard.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

constexpr std::size_t cost_of_instance = 300;  // in control points, so that nothing is free

// A flat curve (use 5) has no place in space; a definition (2) stands only where it is used.
bool may_stand(const DirectoryEntry& entry) {
  return !entry.is_physically_dependent() && entry.use != 2 && entry.use != 5;
}

}  // namespace

void Reading::stand(int pointer, const Context& context, Parameters& by) {
  const DirectoryEntry* const found = entry(pointer, by);
  if (found == nullptr || !spend(cost_of_instance, by)) return;
  if (active_[index(*found)] != 0) {
    by.fail(fmt::format("D{} is part of itself", pointer));
    return;
  }
  if (depth_ >= 64) {
    by.fail("groups and subfigures are nested too deep");
    return;
  }
  stand_entry(*found, context);
}

void Reading::stand_entry(const DirectoryEntry& entry, const Context& context) {
  const EntityType* const type = type_of(entry);
  if (type == nullptr || is_full() || report_.is_full()) return;
  Parameters parameters = file_.parameters(entry);
  if (type->face != nullptr || type->surface != nullptr) {
    stand_face(entry, context, parameters);
    return;
  }
  if (type->stand == nullptr && type->part == nullptr && type->curve == nullptr) return;
  active_[index(entry)] = 1;
  ++depth_;
  const Context inner{context.placement * placement(entry), context.group};
  if (!parameters.ok())
    finish(entry, parameters);
  else if (type->stand != nullptr)
    type->stand(*this, entry, parameters, inner);
  else if (type->part != nullptr)
    stand_part(entry, inner, parameters, type->part(*this, entry, parameters));
  else if (std::optional<nurbs::Curve> curve = type->curve(*this, entry, parameters))
    stand_curves(entry, inner, parameters, {std::move(*curve)});
  finish(entry, parameters);
  --depth_;
  active_[index(entry)] = 0;
}

void Reading::stand_face(const DirectoryEntry& entry, const Context& context, Parameters& parameters) {
  std::optional<cad::Face> face = read_face(entry, parameters);
  if (!face) return;
  context.placement.apply(*face);
  cad::Part part;
  part.label() = face->label();
  part.group = context.group;
  part.faces.push_back(std::move(*face));
  face_pointers_.push_back(entry.pointer);
  model_.parts.push_back(std::move(part));
}

void Reading::stand_part(const DirectoryEntry& entry, const Context& context, Parameters& parameters,
                         std::optional<cad::Part> part) {
  if (!part) return;
  std::size_t points = 0;
  for (const cad::Face& face : part->faces) points += face.surface.points.size();
  spend(points, parameters);
  part->label() = attributes(entry, parameters);
  if (!parameters.ok()) return;
  part->group = context.group;
  context.placement.apply(*part);
  face_pointers_.insert(face_pointers_.end(), part->faces.size(), 0);
  model_.parts.push_back(std::move(*part));
}

void Reading::stand_curves(const DirectoryEntry& entry, const Context& context, Parameters& parameters,
                           std::vector<nurbs::Curve> curves) {
  if (curves.empty()) return;
  for (const nurbs::Curve& curve : curves) spend(curve.points.size(), parameters);
  const cad::Label own = attributes(entry, parameters);
  if (!parameters.ok()) return;
  for (nurbs::Curve& curve : curves) {
    context.placement.apply(curve);
    curve_pointers_.push_back(entry.pointer);
    model_.curves.push_back({own, std::move(curve)});
  }
}

void Reading::stand_together(const cad::Label& label, const std::vector<int>& members, const Context& context,
                             Parameters& by) {
  cad::Part part;
  part.label() = label;
  part.group = context.group;
  for (const int member : members) {
    const DirectoryEntry* const found = entry(member, by);
    if (found == nullptr || report_.is_full()) return;
    std::optional<cad::Face> face = read_face(*found, by);
    if (!face) continue;
    context.placement.apply(*face);
    part.faces.push_back(std::move(*face));
    face_pointers_.push_back(0);
  }
  if (!part.faces.empty()) model_.parts.push_back(std::move(part));
}

// Groups of groups, instances of definitions that hold instances: no entity may hold itself.
void Reading::find_members() {
  Graph members;
  for (const DirectoryEntry& entry : file_.directory()) {
    members.firsts.push_back(members.targets.size());
    const EntityType* const type = type_of(entry);
    if (type == nullptr || type->members == nullptr) continue;
    Parameters parameters = file_.parameters(entry);
    std::vector<int> held;
    if (parameters.ok()) held = type->members(*this, entry, parameters);
    if (!finish(entry, parameters)) held.clear();
    for (const int pointer : held) {
      const DirectoryEntry* const member = file_.entity(pointer);
      if (member == nullptr) continue;
      held_[index(*member)] = 1;
      members.targets.push_back(static_cast<int>(index(*member)));
    }
  }
  members.firsts.push_back(members.targets.size());
  std::vector<std::size_t> order;
  for (const Circle& circle : sort_from_leaves(members, order)) {
    const DirectoryEntry& member = file_.directory()[circle.at];
    fail_once(member, file_.spot(member),
              fmt::format("it holds itself (through D{})", file_.directory()[circle.by].pointer));
  }
  for (const std::size_t node : order) {
    extents_[node] = std::max(1, file_.directory()[node].line_count);
    for (std::size_t k = members.firsts[node]; k < members.firsts[node + 1]; ++k)
      extents_[node] += extents_[static_cast<std::size_t>(members.targets[k])];
  }
}

void Reading::count_entities() {
  const DirectoryEntry* blanked = nullptr;
  std::uint64_t blanked_count = 0;
  // Few kinds, many entities: names are made once a kind.
  std::map<std::pair<int, int>, std::uint64_t> types, unknown;
  std::map<std::pair<int, int>, const DirectoryEntry*> first;
  for (const DirectoryEntry& entry : file_.directory()) {
    ++types[{entry.type, 0}];
    if (type_of(entry) == nullptr) {
      ++unknown[{entry.type, entry.form}];
      if (!entry.is_physically_dependent()) first.emplace(std::pair(entry.type, entry.form), &entry);
    }
    if (entry.blanked && !entry.is_physically_dependent() && blanked_count++ == 0) blanked = &entry;
  }
  for (const auto& [kind, count] : types) model_.entities[std::to_string(kind.first)] = count;
  constexpr std::size_t most_kinds = 100;  // told by name: a file of noise has many
  std::size_t kinds = 0;
  for (const auto& [kind, count] : unknown) {
    const auto [type, form] = kind;
    const std::string_view title = entity_title(type);
    const std::string name = fmt::format("{}{} ({})", type, form != 0 ? fmt::format(" form {}", form) : "",
                                         title.empty() ? "no type of IGES 5.3" : title);
    if (++kinds > most_kinds) {
      model_.unknown["others"] += count;
      continue;
    }
    model_.unknown[name] += count;
    const bool is_geometry = (type >= 100 && type < 200) || (type >= 408 && type < 500) || type > 500;
    const auto stands = first.find(kind);  // what is part of something else is told with that
    const std::string text =
        fmt::format("{} of type {}: not understood, and left out",
                    count == 1 ? std::string("an entity") : fmt::format("{} entities", count), name);
    if (is_geometry && stands != first.end())
      report_.warning(file_.spot(*stands->second), text);
    else
      report_.note(stands != first.end() ? file_.spot(*stands->second)
                                         : file_.lines().line(Section::directory, 1).spot(),
                   text);
  }
  if (blanked != nullptr)
    report_.note(file_.spot(*blanked),
                 fmt::format("{} marked as not to be shown (blanked); taken all the same",
                             blanked_count == 1 ? std::string("an entity is")
                                                : fmt::format("{} entities are", blanked_count)));
}

void Reading::read_levels() {
  for (const DirectoryEntry& entry : file_.directory()) {
    if (entry.type != 406 || entry.form != 3 || entry.level < 0) continue;
    Parameters parameters = file_.parameters(entry);
    parameters.integer();  // how many
    parameters.integer();  // function code
    std::string name = readable(parameters.text());
    if (finish(entry, parameters) && !name.empty()) model_.levels.emplace(entry.level, std::move(name));
  }
}

// Surfaces and curves that say that they stand for themselves, but are part of something.
void Reading::drop_used() {
  const auto is_used = [this](int pointer) {
    return pointer != 0 && used_[index(*file_.entity(pointer))] != 0;
  };
  std::size_t next = 0;
  std::erase_if(model_.parts, [&](const cad::Part& part) {
    const int pointer = part.faces.size() == 1 ? face_pointers_[next] : 0;
    next += part.faces.size();
    return is_used(pointer);
  });
  next = 0;
  std::erase_if(model_.curves, [&](const cad::NamedCurve&) { return is_used(curve_pointers_[next++]); });
}

// What other entities of the file point to. Of types whose fields are not listed, whatever may be a pointer.
std::vector<char> Reading::pointed_to() const {
  std::vector<char> found(file_.directory().size());
  const auto mark = [&](int pointer) {
    if (const DirectoryEntry* const target = file_.entity(std::abs(pointer))) found[index(*target)] = 1;
  };
  for (const DirectoryEntry& entry : file_.directory()) {
    if (entry.type == 126 || entry.type == 128) continue;  // most of a file, and they point to nothing
    const Parameters parameters = file_.parameters(entry);
    if (!parameters.ok()) continue;  // told where it is read
    const Values values(parameters);
    const References references = references_of(entry, values, 0);
    for (const References::Reference& reference : references.all) mark(reference.pointer);
    const StandardType* const type = standard_type(entry.type);
    if (references.own || (type != nullptr && !type->fields.empty() && entry.type != 402)) continue;
    for (std::size_t i = 0; i < values.size(); ++i) mark(values.integer(i).value_or(0));
  }
  return found;
}

// Writers leave entities marked as parts of others that are nowhere: solids first, then what they are made
// of.
void Reading::stand_left_over(const Context& top) {
  const auto is_left = [&](const DirectoryEntry& entry) {
    return entry.is_physically_dependent() && entry.use != 2 && entry.use != 5 && used_[index(entry)] == 0 &&
           held_[index(entry)] == 0 && type_of(entry) != nullptr;
  };
  if (std::ranges::none_of(file_.directory(), is_left)) return;
  const std::vector<char> pointed = pointed_to();
  const auto holds_others = [](const EntityType& type) {
    return type.stand != nullptr || type.part != nullptr;
  };
  for (const bool first : {true, false})
    for (const DirectoryEntry& entry : file_.directory())
      if (is_left(entry) && pointed[index(entry)] == 0 && holds_others(*type_of(entry)) == first)
        stand_entry(entry, top);
}

void Reading::stand_all() {
  count_entities();
  read_levels();
  find_members();
  if (report_.errors() > 0) return;
  const Context top{Placement::scaling(file_.global().factor), {}};
  for (const DirectoryEntry& entry : file_.directory())
    if (may_stand(entry) && held_[index(entry)] == 0) stand_entry(entry, top);
  stand_left_over(top);
  drop_used();
}

}  // namespace selvage::formats::iges
