#include "formats/iges/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cad/edges.h"
#include "formats/iges/standard.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

constexpr int deepest = 64;  // entities within entities

std::string described(const DirectoryEntry& entry) {
  const std::string_view title = entity_title(entry.type);
  return title.empty() ? fmt::format("D{}, a {}", entry.pointer, entry.type)
                       : fmt::format("D{}, a {} ({})", entry.pointer, entry.type, title);
}

std::size_t points_of(const nurbs::Surface& surface) {
  return surface.points.size();
}
std::size_t points_of(const nurbs::Curve& curve) {
  return curve.points.size();
}
std::size_t points_of(const cad::Face& face) {
  std::size_t points = points_of(face.surface);
  for (const cad::Edge& edge : cad::edges_of(face)) points += points_of(edge.curve) + points_of(edge.flat);
  return points;
}
std::size_t points_of(const cad::Part& part) {
  std::size_t points = 0;
  for (const cad::Face& face : part.faces) points += points_of(face);
  return points;
}

}  // namespace

// The entity is being read while this lives; false where it already was, or the nesting is too deep.
class Reading::Nested {
 public:
  Nested(Reading& reading, const DirectoryEntry& entry, Parameters& by)
      : reading_(reading), index_(Reading::index(entry)) {
    if (reading_.active_[index_] != 0)
      by.fail(fmt::format("D{} is part of itself", entry.pointer));
    else if (reading_.depth_ >= deepest)
      by.fail(fmt::format("D{} is nested in more than {} others", entry.pointer, deepest));
    else
      entered_ = true;
    if (!entered_) return;
    reading_.active_[index_] = 1;
    ++reading_.depth_;
  }
  ~Nested() {
    if (!entered_) return;
    reading_.active_[index_] = 0;
    --reading_.depth_;
  }
  Nested(const Nested&) = delete;
  Nested& operator=(const Nested&) = delete;
  explicit operator bool() const { return entered_; }

 private:
  Reading& reading_;
  std::size_t index_;
  bool entered_ = false;
};

Reading::Reading(const File& file, TypeOf& type_of, TextReport& report, cad::Model& model)
    : file_(file), type_of_(type_of), report_(report), model_(model) {
  const std::size_t count = file.directory().size();
  for (std::vector<char>* const flags : {&used_, &held_, &active_, &failed_, &flawed_}) flags->resize(count);
  extents_.resize(count);
}

void Reading::warning(const DirectoryEntry& entry, const std::string& text) {
  report_.warning(file_.spot(entry), entry.name() + ": " + text);
}

bool Reading::finish(const DirectoryEntry& entry, Parameters& parameters) {
  if (parameters.flaw() && std::exchange(flawed_[index(entry)], 1) == 0)
    report_.warning(parameters.flaw()->spot, entry.name() + ": " + parameters.flaw()->text);
  if (parameters.ok()) return true;
  const Parameters::Failure& failure = *parameters.failure();
  if (!failure.unsupported && !failure.text.empty()) {
    fail_once(entry, failure.spot, failure.text);
  } else if (std::exchange(failed_[index(entry)], 1) == 0 && !failure.text.empty()) {
    report_.warning(failure.spot, entry.name() + ": " + failure.text + "; it is left out");
    ++model_.unknown[fmt::format("{} ({})", entry.type, entity_title(entry.type))];
  }
  return false;
}

void Reading::fail_once(const DirectoryEntry& entry, const Spot& spot, const std::string& text) {
  if (std::exchange(failed_[index(entry)], 1) == 0) report_.error(spot, entry.name() + ": " + text);
}

const DirectoryEntry* Reading::entry(int pointer, Parameters& by) {
  if (!by.ok()) return nullptr;
  const DirectoryEntry* const found = file_.entity(pointer);
  if (found == nullptr)
    by.fail(pointer == 0 ? std::string("a pointer to an entity is missing")
                         : fmt::format("no entity begins at line {} of the directory", pointer));
  return found;
}

const DirectoryEntry* Reading::entry(int pointer, int type, Parameters& by) {
  const DirectoryEntry* const found = entry(pointer, by);
  if (found == nullptr) return nullptr;
  if (found->type != type) {
    by.fail(fmt::format("a {} ({}) is due, not {}", type, entity_title(type), described(*found)));
    return nullptr;
  }
  use(pointer);
  return found;
}

const std::vector<Reading::ListedEdge>* Reading::edge_list(int pointer, Parameters& by) {
  const DirectoryEntry* const list = entry(pointer, 504, by);
  if (list == nullptr) return nullptr;
  const auto [known, is_new] = edge_lists_.try_emplace(list->pointer);
  if (is_new)
    known->second = inside(list, by, [this](Parameters& in) {
      std::vector<ListedEdge> edges(in.count("edges", 5));
      for (ListedEdge& edge : edges) {
        edge.curve = in.pointer();
        use(edge.curve);
        for (const std::size_t k : {0U, 1U}) {
          edge.lists[k] = in.pointer();
          use(edge.lists[k]);
          edge.vertices[k] = in.integer();
        }
      }
      return std::optional(std::move(edges));
    });
  if (known->second) return &*known->second;
  by.give_up({});  // said once
  return nullptr;
}

const std::vector<Vec3>* Reading::vertex_list(int pointer, Parameters& by) {
  const DirectoryEntry* const list = entry(pointer, 502, by);
  if (list == nullptr) return nullptr;
  const auto [known, is_new] = vertex_lists_.try_emplace(list->pointer);
  if (is_new) {
    known->second = inside(list, by, [](Parameters& in) {
      std::vector<Vec3> places(in.count("vertices", 3));
      for (Vec3& place : places) in.reals(place.data(), 3);
      return std::optional(std::move(places));
    });
    const Placement own = placement(*list);
    if (known->second)
      for (Vec3& place : *known->second) place = own(place);
  }
  if (known->second) return &*known->second;
  by.give_up({});  // said once
  return nullptr;
}

void Reading::use(int pointer) {
  if (const DirectoryEntry* const found = file_.entity(pointer)) used_[index(*found)] = 1;
}

bool Reading::spend(std::size_t points, Parameters& by) {
  const bool was_full = is_full();
  points_ += std::min(points, most_points + 1);
  if (!is_full()) return true;
  if (was_full)
    by.give_up({});  // said once
  else
    by.fail(fmt::format("with this entity the file would hold more than {} control points, instances and all",
                        most_points));
  return false;
}

// The function of the entity's type that reads the shape is null where the type has none.
template <class Shape, class FunctionOf>
std::optional<Shape> Reading::shape(int pointer, Parameters& by, std::string_view kind,
                                    FunctionOf function_of) {
  const DirectoryEntry* const found = entry(pointer, by);
  if (found == nullptr) return std::nullopt;
  use(pointer);
  const EntityType* const type = type_of(*found);
  if (type == nullptr)
    return by.give_up(fmt::format("it is made of {}, which is not understood", described(*found)));
  const auto function = function_of(*type);
  if (function == nullptr) return by.fail(fmt::format("a {} is due, not {}", kind, described(*found)));
  const Nested nested(*this, *found, by);
  if (!nested) return std::nullopt;
  std::optional<Shape> shape = inside(found, by, [&](Parameters& in) {
    std::optional<Shape> made = function(*this, *found, in);
    if (made) spend(points_of(*made), in);
    return made;
  });
  if (shape) placement(*found).apply(*shape);
  return shape;
}

std::optional<nurbs::Curve> Reading::curve(int pointer, Parameters& by) {
  return shape<nurbs::Curve>(pointer, by, "curve", [](const EntityType& type) { return type.curve; });
}

std::optional<nurbs::Surface> Reading::surface(int pointer, Parameters& by) {
  return shape<nurbs::Surface>(pointer, by, "surface", [](const EntityType& type) { return type.surface; });
}

std::optional<cad::Part> Reading::part(int pointer, Parameters& by) {
  return shape<cad::Part>(pointer, by, "solid or shell", [](const EntityType& type) { return type.part; });
}

std::optional<cad::Face> Reading::face(int pointer, Parameters& by) {
  const DirectoryEntry* const found = entry(pointer, by);
  if (found == nullptr) return std::nullopt;
  use(pointer);
  return read_face(*found, by);
}

// With its own transformation.
std::optional<cad::Face> Reading::read_face(const DirectoryEntry& entry, Parameters& by) {
  const EntityType* const type = type_of(entry);
  if (type == nullptr || (type->face == nullptr && type->surface == nullptr))
    return by.fail(fmt::format("a face is due, not {}", described(entry)));
  const Nested nested(*this, entry, by);
  if (!nested) return std::nullopt;
  std::optional<cad::Face> face = inside(&entry, by, [&](Parameters& in) {
    std::optional<cad::Face> made;
    if (type->face != nullptr) {
      made = type->face(*this, entry, in);
    } else if (std::optional<nurbs::Surface> surface = type->surface(*this, entry, in)) {
      made.emplace().surface = std::move(*surface);
    }
    if (made) {
      spend(points_of(*made), in);
      made->label() = attributes(entry, in);
    }
    return made;
  });
  if (face) placement(entry).apply(*face);
  return face;
}

Placement Reading::placement(const DirectoryEntry& entry) {
  Placement all;
  const DirectoryEntry* user = &entry;
  for (int steps = 0; user->transformation != 0; ++steps) {
    const DirectoryEntry* const matrix = file_.entity(user->transformation);
    const auto fail = [&](const std::string& text) {
      fail_once(*user, file_.spot(*user), text);
      return Placement{};
    };
    if (matrix == nullptr || matrix->type != 124)
      return fail(fmt::format("its transformation is D{}, which is no 124", std::abs(user->transformation)));
    if (steps == deepest) return fail("its transformations run in a circle, or are nested too deep");
    Parameters parameters = file_.parameters(*matrix);
    std::array<double, 12> r{};
    parameters.reals(r.data(), r.size());
    Eigen::Matrix3d linear;
    linear << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
    const double size = linear.norm();
    if (parameters.ok() && !(std::abs(linear.determinant()) > 1e-12 * size * size * size))
      parameters.fail("the matrix is singular");
    if (!finish(*matrix, parameters)) return {};
    const double error = (linear * linear.transpose() - Eigen::Matrix3d::Identity()).norm();
    if (error > 1e-6 && std::exchange(failed_[index(*matrix)], 1) == 0)
      warning(*matrix,
              fmt::format("the matrix is no rotation (by {:.2g}); it is applied as it stands", error));
    all = Placement::of(linear, {r[3], r[7], r[11]}) * all;
    user = matrix;
  }
  return all;
}

cad::Label Reading::attributes(const DirectoryEntry& entry, Parameters& parameters) {
  cad::Label result{{}, color(entry), entry.level, {{entry.line, 1}, entry.name()}};
  for (const int pointer : read_properties(parameters)) {
    const DirectoryEntry* const property = file_.entity(pointer);
    if (property == nullptr) {
      warning(entry, fmt::format("its property would be at line {} of the directory, where no entity begins",
                                 pointer));
      continue;
    }
    if (property->type != 406 || property->form != 15) continue;
    Parameters values = file_.parameters(*property);
    values.integer();  // how many
    result.name = readable(values.text());
    finish(*property, values);
  }
  if (result.name.empty()) {
    const std::string_view label(entry.label.data(), entry.label.size());
    const std::size_t first = std::min(label.find_first_not_of(' '), label.size());
    result.name = readable(label.substr(first));
  }
  if (entry.level < 0) {  // several: the first one
    result.level = 0;
    if (const DirectoryEntry* const levels = file_.entity(entry.level)) {
      Parameters values = file_.parameters(*levels);
      values.integer();
      result.level = static_cast<int>(std::clamp<std::int64_t>(values.integer(), 0, most_pointer));
      finish(*levels, values);
    }
  }
  return result;
}

std::optional<cad::Color> Reading::color(const DirectoryEntry& entry) {
  constexpr std::array<cad::Color, 8> standard = {{{0, 0, 0},
                                                   {255, 0, 0},
                                                   {0, 255, 0},
                                                   {0, 0, 255},
                                                   {255, 255, 0},
                                                   {255, 0, 255},
                                                   {0, 255, 255},
                                                   {255, 255, 255}}};
  if (entry.color == 0) return std::nullopt;
  if (entry.color > 0 && entry.color <= 8) return standard[static_cast<std::size_t>(entry.color) - 1];
  const auto known = colors_.find(entry.color);
  if (known != colors_.end()) return known->second;
  std::optional<cad::Color>& color = colors_[entry.color];
  const DirectoryEntry* const definition = entry.color < 0 ? file_.entity(entry.color) : nullptr;
  if (definition == nullptr || definition->type != 314) {
    warning(entry, fmt::format("there is no colour {}", entry.color));
    return color;
  }
  Parameters parameters = file_.parameters(*definition);
  std::array<double, 3> percent{};
  parameters.reals(percent.data(), percent.size());
  if (!finish(*definition, parameters)) return color;
  const auto part = [&](std::size_t i) {
    return static_cast<int>(std::lround(std::clamp(percent[i], 0.0, 100.0) * 255.0 / 100.0));
  };
  color = cad::Color{part(0), part(1), part(2)};
  return color;
}

bool Reading::is_face(int pointer) const {
  const DirectoryEntry* const found = file_.entity(pointer);
  const EntityType* const type = found != nullptr ? type_of(*found) : nullptr;
  return type != nullptr && (type->face != nullptr || type->surface != nullptr);
}

}  // namespace selvage::formats::iges
