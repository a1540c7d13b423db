// From the text's fabric to yarns as geometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "construction/shape_memo.h"
#include "core/diagnostics.h"
#include "core/new_name.h"
#include "fabric/build_options.h"
#include "fabric/inside.h"
#include "fabric/model.h"
#include "fabric/plan.h"
#include "fabric/plies.h"
#include "yarn/body.h"

namespace selvage::fabric {

// The default of BuildOptions::gap where the space between yarns is meshed, file units: this fraction of the
// smallest section, of tows in weaves as flat as they lie there. Between nearer yarns, tetrahedra are as flat
// as the gap.
constexpr double meshed_gap_fraction = 0.05;
double meshed_gap(const Fabric& fabric);

// Builds the yarns one at a time, in file order; between calls a few shapes are kept
// (construction/shape_memo.h), so that a million yarns need the memory of those. A yarn of plies or filaments
// is built as its parts, in their order.
class YarnBuilder {
 public:
  // Errors: geometry (a thread without a size, a construction that cannot be, an edit of a yarn that is not
  // there), limit; each at its line, all of them are reported. `fabric` outlives the builder.
  static std::optional<YarnBuilder> create(const Fabric& fabric, const BuildOptions& options,
                                           Diagnostics& diagnostics);

  [[nodiscard]] std::size_t count() const { return entries_.size(); }
  // What the text says of a yarn: its block (null: a construction makes it), and whether it is only a ply or
  // a filament of that.
  struct Origin {
    const Yarn* yarn = nullptr;
    bool is_part = false;
    bool is_placed = false;                      // by a `use`: its thread may be one of its block
    const Construction* construction = nullptr;  // null: it stands in the text
    std::size_t index = 0;                       // of the construction's yarns
  };
  [[nodiscard]] Origin origin(std::size_t index) const;
  // Of a ply or a filament: the whole yarn's.
  [[nodiscard]] std::string name(std::size_t index) const { return name_of(entries_[index]); }
  // A construction, and where it is said.
  struct Cloth {
    const Fabric* fabric = nullptr;
    const Item* item = nullptr;
    const Construction* construction = nullptr;
  };
  // In file order, then those of used blocks, each once and as it is by itself.
  [[nodiscard]] std::vector<Cloth> cloths() const;
  // The first yarn (or part of a yarn) of this name; none where there is no such yarn.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  // Of all constructions together; none where yarns stand in the text, or there are no constructions.
  [[nodiscard]] std::optional<Repeat> repeat() const;
  // The yarn's plan, told from the origin, edits applied; a part's own where the yarn has parts; of a yarn
  // that a `use` places the one in its block. Error (unsupported): a grid has none.
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const;
  // Errors: geometry, limit; with the yarn, its file and line. Warnings are in Body::messages. Yarns of a
  // construction that are planned alike are swept once, and moved.
  [[nodiscard]] Result<yarn::Body> build(std::size_t index) const;
  // A yarn as it was swept, `at` away from its place. Those of a construction that are one shape (yarn::Body)
  // are one body, with the label of the first; others stand at their place. Errors: as build.
  struct Shaped {
    std::shared_ptr<const yarn::Body> body;
    yarn::BodyLabel label;
    Vec3 at = Vec3::Zero();
    DecimalGrid grid;  // on which it is moved
  };
  [[nodiscard]] Result<Shaped> shape(std::size_t index) const;

 private:
  struct Made;
  struct Placed;
  struct Shared;
  // One yarn to build: a yarn block, part `part` of yarn `index` of a construction, or entry `index` of a
  // block's builder.
  struct Entry {
    const Yarn* yarn = nullptr;
    const Made* made = nullptr;
    const Placed* placed = nullptr;
    std::uint32_t index = 0, part = 0, parts = 1;
  };
  // Where an entry is asked to be by the `use` of its block; null: where it is.
  struct Where {
    Placement line;
    std::string prefix;  // of its name
  };
  static std::optional<YarnBuilder> make(const Fabric& fabric, const BuildOptions& options,
                                         Diagnostics& diagnostics, const std::shared_ptr<Shared>& shared);
  // build_uses.cpp
  void add_use(const Use& use, Diagnostics& diagnostics);
  void add_copy(const Use& use, const YarnBuilder& within, const Placement& placement,
                const std::string& prefix);
  std::shared_ptr<const YarnBuilder> builder_inside(const NamedBlock& block, const Placement* goes_on,
                                                    Diagnostics& diagnostics);
  [[nodiscard]] std::optional<Repeat> repeat_inside() const;
  [[nodiscard]] Result<yarn::Body> build_placed(const Entry& entry) const;
  [[nodiscard]] Result<yarn::Body> build_here(const Entry& entry, const Where* where) const;
  [[nodiscard]] Result<yarn::Body> build_surface(const Entry& entry) const;
  static void move_to(const Where& where, YarnPlan& plan);
  static std::shared_ptr<Shared> share_among_blocks();
  static std::shared_ptr<ShapeMemo> memo_of(const Shared& shared);
  void add_construction(std::string_view kind, Result<std::unique_ptr<Construction>> made, const Item& item,
                        TextPlace place, Diagnostics& diagnostics);
  void add_cloths(std::vector<Cloth>& all) const;
  // False, with the error, when it is too much together with what there is already.
  bool take_on(const Work& work, TextPlace place, Diagnostics& diagnostics);
  void add_entries(Entry entry, std::uint64_t parts);
  void add_yarn(const Yarn& yarn, Diagnostics& diagnostics);
  void add_item(const Item& item, Diagnostics& diagnostics);
  void make_names_unique(Diagnostics& diagnostics);
  void check_part_names(Diagnostics& diagnostics) const;
  void check_edited_names(Diagnostics& diagnostics) const;
  [[nodiscard]] std::string name_of(const Entry& entry) const;
  [[nodiscard]] Result<YarnPlan> whole_plan(const Entry& entry, const Where* where) const;
  // Told from where the yarn stands.
  [[nodiscard]] Result<YarnPlan> plan_of(const Entry& entry, const Where* where = nullptr) const;
  [[nodiscard]] yarn::BodyLabel label_of(const Entry& entry, const YarnPlan& plan, const Where* where) const;
  [[nodiscard]] ShapeMemo::Plan shape_plan(const Entry& entry, YarnPlan& plan) const;
  [[nodiscard]] Status sweep(yarn::Body& body, const ShapeMemo::Plan& shape, const YarnPlan& plan) const;
  // Does the text or a file say its surface?
  [[nodiscard]] static bool has_surface(const Entry& entry);
  [[nodiscard]] Result<Shaped> shape_of(const Entry& entry, YarnPlan plan, const Where* where) const;
  [[nodiscard]] Result<yarn::Body> build_swept(const Entry& entry, YarnPlan plan, const Where* where) const;
  [[nodiscard]] Result<YarnPlan> part_plan(const Entry& entry, const Where* where) const;
  [[nodiscard]] Result<yarn::Body> build_grid(const Yarn& yarn) const;
  [[nodiscard]] Result<yarn::Body> as_read(yarn::Body body, const Entry& entry) const;
  [[nodiscard]] Message placed(Message message, const Entry& entry) const;

  const Fabric* fabric_ = nullptr;
  BuildOptions options_;
  double tolerance_ = 0;
  // A construction, and what its yarns' names begin with so that no other yarn has them; mostly nothing.
  struct Made {
    std::unique_ptr<Construction> construction;
    const Item* item = nullptr;
    TextPlace place;
    std::string_view kind;  // "weave"
    std::string prefix;
  };
  std::vector<std::unique_ptr<Made>> constructions_;  // entries point to them
  std::vector<std::unique_ptr<const Yarn>> drawn_;    // helices as paths; entries point to them
  std::vector<Entry> entries_;
  Work work_;
  // A yarn of a block, or of one within that: how it comes from where its own builder has it.
  struct Placed {
    const YarnBuilder* builder = nullptr;
    Placement placement;
    Where where;
    Placement body;   // what is done to it when it is built
    TextPlace place;  // of the `use`
  };
  // The first entry of each name; made when it is first asked for.
  struct NameIndex {
    std::once_flag once;
    std::unordered_map<std::string, std::size_t> first;
  };
  std::shared_ptr<NameIndex> names_;
  // The yarn taken apart last: its parts are mostly asked for one after the other.
  struct LastBundle;
  std::shared_ptr<LastBundle> last_bundle_;
  std::shared_ptr<ShapeMemo> shapes_;
  // Of blocks: their builders, and the copies of each.
  std::shared_ptr<Shared> shared_;  // while it is made
  std::shared_ptr<const Fabric> own_fabric_;
  std::vector<std::shared_ptr<const YarnBuilder>> insides_;
  std::vector<std::unique_ptr<Placed>> placed_;
  TakenNames prefixes_;
  std::vector<std::optional<Repeat>> repeats_of_uses_;
};

}  // namespace selvage::fabric
