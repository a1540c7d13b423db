// What the functions that read entities share: other entities by pointer, attributes, messages. types.h lists
// these functions, a table row an entity type.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cad/model.h"
#include "formats/iges/file.h"
#include "formats/iges/placement.h"

namespace selvage::formats::iges {

// Where something stands that other entities hold: groups and subfigure instances.
struct Context {
  Placement placement;  // applied after the entity's own
  std::string group;    // name of the outermost group; empty: none
};

struct EntityType;

class Reading {
 public:
  // `type_of` as in types.h: who reads says by which functions.
  using TypeOf = const EntityType*(const DirectoryEntry& entry);
  Reading(const File& file, TypeOf& type_of, TextReport& report, cad::Model& model);

  [[nodiscard]] const File& file() const { return file_; }
  [[nodiscard]] const EntityType* type_of(const DirectoryEntry& entry) const { return type_of_(entry); }
  [[nodiscard]] TextReport& report() { return report_; }
  [[nodiscard]] cad::Model& model() { return model_; }

  // The geometry of the entity at `pointer`, with its own transformation applied, for an entity that is made
  // of it and whose parameters are `by`: these fail where there is no such entity, where it is of another
  // kind or holds `by`'s entity itself, and give up where it is of a type that is not understood. The entity
  // is then part of the other one and does not stand for itself.
  std::optional<nurbs::Curve> curve(int pointer, Parameters& by);
  std::optional<nurbs::Surface> surface(int pointer, Parameters& by);
  std::optional<cad::Face> face(int pointer, Parameters& by);
  std::optional<cad::Part> part(int pointer, Parameters& by);
  // The optional that `read` makes of the parameters of `entry`, a part of the entity whose parameters are
  // `by`: nothing where it is null or these fail, which is said once; `by` give up then.
  template <class Read>
  auto inside(const DirectoryEntry* entry, Parameters& by, const Read& read) -> decltype(read(by)) {
    if (entry == nullptr) return std::nullopt;
    Parameters in = file_.parameters(*entry);
    decltype(read(by)) made;
    if (in.ok()) made = read(in);
    if (finish(*entry, in) && made) return made;
    return by.give_up({});
  }
  // The entry there, whatever it is (an edge list, a vertex list, a boundary); null after by.fail().
  const DirectoryEntry* entry(int pointer, Parameters& by);
  // The same, of one type; it is marked as part of the other one.
  const DirectoryEntry* entry(int pointer, int type, Parameters& by);
  // The edges of a 504 in order; each list is read once. Null after by.fail().
  struct ListedEdge {
    int curve = 0;
    // Where it starts and ends: a 502, and the number of the vertex in it, from 1.
    std::array<int, 2> lists{};
    std::array<std::int64_t, 2> vertices{};
  };
  const std::vector<ListedEdge>* edge_list(int pointer, Parameters& by);
  // The places of a 502, which is read once. Null after by.fail().
  const std::vector<Vec3>* vertex_list(int pointer, Parameters& by);
  // Call it for what is read through entry(): the entity does not stand for itself.
  void use(int pointer);

  // The entity's transformation, with those that the 124 has itself; the identity after an error (reported).
  Placement placement(const DirectoryEntry& entry);

  // Puts the entity into the model: as a part, a curve, or what it holds. Groups and instances call it for
  // their members. `by` as above.
  void stand(int pointer, const Context& context, Parameters& by);
  // Are they surfaces or faces, so that a group of nothing else is one part?
  [[nodiscard]] bool are_faces(const std::vector<int>& members) const {
    return std::all_of(members.begin(), members.end(), [this](int member) { return is_face(member); });
  }
  // A part that is a face each member, in their order.
  void stand_together(const cad::Label& label, const std::vector<int>& members, const Context& context,
                      Parameters& by);

  // Several curves with the attributes of one entity; `parameters` stand behind its own.
  void stand_curves(const DirectoryEntry& entry, const Context& context, Parameters& parameters,
                    std::vector<nurbs::Curve> curves);

  // What is said of an entity, its name by its property 406 form 15, else by its label; `parameters` stand
  // behind its own.
  cad::Label attributes(const DirectoryEntry& entry, Parameters& parameters);

  // How many control points an entity stands for at least, instances and all: lines of 64 columns hold one
  // each or more. Counted before anything is made.
  [[nodiscard]] double extent(const DirectoryEntry& entry) const { return extents_[index(entry)]; }

  // Against files that hold little and say much (a subfigure of subfigures): counts control points over all
  // that is made, and fails past most_points.
  bool spend(std::size_t points, Parameters& by);
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  static constexpr std::size_t most_points = 100'000;  // an input that multiplies shall not take seconds
#else
  static constexpr std::size_t most_points = 100'000'000;
#endif
  [[nodiscard]] bool is_full() const {
    return points_ > most_points;
  }

  void warning(const DirectoryEntry& entry, const std::string& text);
  // Reports the failure of an entity's parameters, if there is one, once; true if there is none.
  bool finish(const DirectoryEntry& entry, Parameters& parameters);

  // Everything that stands for itself.
  void stand_all();

 private:
  template <class Shape, class FunctionOf>
  std::optional<Shape> shape(int pointer, Parameters& by, std::string_view kind, FunctionOf function_of);
  class Nested;
  [[nodiscard]] bool is_face(int pointer) const;

  void stand_entry(const DirectoryEntry& entry, const Context& context);
  void stand_face(const DirectoryEntry& entry, const Context& context, Parameters& parameters);
  void stand_part(const DirectoryEntry& entry, const Context& context, Parameters& parameters,
                  std::optional<cad::Part> part);
  std::optional<cad::Face> read_face(const DirectoryEntry& entry, Parameters& by);
  void count_entities();
  void find_members();
  void read_levels();
  void drop_used();
  [[nodiscard]] std::vector<char> pointed_to() const;
  void stand_left_over(const Context& top);
  [[nodiscard]] std::optional<cad::Color> color(const DirectoryEntry& entry);
  void fail_once(const DirectoryEntry& entry, const Spot& spot, const std::string& text);
  static std::size_t index(const DirectoryEntry& entry) {
    return static_cast<std::size_t>(entry.pointer / 2);
  }

  const File& file_;
  TypeOf& type_of_;
  TextReport& report_;
  cad::Model& model_;
  // By the index of the entity: part of another one; held by a group or definition; being read at present;
  // its failure was reported; what was read through was told.
  std::vector<char> used_, held_, active_, failed_, flawed_;
  std::vector<double> extents_;  // of each entity
  int depth_ = 0;
  std::size_t points_ = 0;
  std::unordered_map<int, std::optional<cad::Color>> colors_;
  std::unordered_map<int, std::optional<std::vector<ListedEdge>>> edge_lists_;
  std::unordered_map<int, std::optional<std::vector<Vec3>>> vertex_lists_;
  // Of each face of the model, and of each curve: its entity, or 0 where it may not be dropped.
  std::vector<int> face_pointers_, curve_pointers_;
};

}  // namespace selvage::formats::iges
