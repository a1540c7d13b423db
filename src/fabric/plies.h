// Ply yarns and multifilaments: a yarn replaced by its parts, each a yarn of its own.
//
// Plies are helices about the yarn's centre line, in the yarn's own frame, with the ply twist; their discs
// are the densest arrangement in the yarn's section (fabric/disc_packing.h). Filaments lie in the yarn, or in
// each of its plies, in the same way with the thread's twist. Z is a right-handed helix. Discs are sections
// perpendicular to the part's own path: where a bundle turns, the parts are inclined against each other, and
// their diameter is the one at which they just clear each other (0.5 % of it is left between them for the
// tubes' tolerance).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "core/diagnostics.h"
#include "fabric/plan.h"

namespace selvage::fabric {

// How far yarns are taken apart. usual: into filaments where a single yarn has at most `max_usual_filaments`.
enum class Detail { yarn, plies, usual, filaments };
inline constexpr int max_usual_filaments = 300;

// How many yarns a yarn of this thread becomes: 1 without plies and filaments. `filaments` counts those of
// one single yarn: of each ply where there are plies.
std::uint64_t part_count(const Thread& thread, Detail detail);

// Of part number `part` (from 0): "warp_1.ply2", "warp_1.f17", "warp_1.ply2.f17".
std::string part_name(const std::string& yarn, const Thread& thread, Detail detail, std::size_t part);

// A yarn made ready to be taken apart.
class Bundle {
 public:
  // `parent` is the plan of a yarn whose thread has more than one part. own_tolerance: each part's tolerance
  // is at most 1/1000 of its diameter. Errors: geometry (a section that varies along the path or, when it is
  // not round, is to be twisted; a bend tighter than the yarn; so much twist that its outside is inclined by
  // 45 degrees or more), limit.
  static Result<Bundle> make(YarnPlan parent, Unit units, Detail detail, bool own_tolerance);

  ~Bundle();
  Bundle(Bundle&&) noexcept;
  Bundle& operator=(Bundle&&) noexcept;

  // Errors: geometry. Part 0 carries the messages: what share of the section the filaments fill where that is
  // not the thread's packing.
  [[nodiscard]] Result<YarnPlan> part(std::size_t part) const;

 private:
  struct Content;
  explicit Bundle(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace selvage::fabric
