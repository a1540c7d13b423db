#include "contact/certify.h"

#include <algorithm>
#include <memory>
#include <unordered_map>

#include "nurbs/patch.h"

namespace selvage::contact {

namespace {

// A part with its control points.
struct Region {
  Part part;
  nurbs::Patch patch;
  Box3 box;
  Vec3 normal = Vec3::Zero();
  double size_u = 0, size_v = 0;  // the longest way across, either direction
};

Region region_of(const CellModel& model, const Part& part, nurbs::Patch patch) {
  Region out;
  out.part = part;
  const Face& face = model.face_of(model.cells()[part.cell]);
  out.patch = std::move(patch);
  for (const Vec3& p : out.patch.points) out.box.extend(p);
  out.normal = middle_normal(out.patch, face.inward);
  const nurbs::Patch& p = out.patch;
  for (const int j : {0, p.count_v - 1})
    out.size_u = std::max(out.size_u, (p.point(p.count_u - 1, j) - p.point(0, j)).norm());
  for (const int i : {0, p.count_u - 1})
    out.size_v = std::max(out.size_v, (p.point(i, p.count_v - 1) - p.point(i, 0)).norm());
  return out;
}

using RegionPtr = std::shared_ptr<const Region>;

struct Task {
  RegionPtr a, b;
  double low;
};

}  // namespace

Certificate certify(const CellModel& model, const Cluster& cluster, double depth, double size, int work,
                    const std::function<bool(const Box3& a, const Box3& b)>& is_known) {
  Certificate out;
  std::vector<Task> tasks;
  const auto consider = [&](RegionPtr a, RegionPtr b) {
    const double low = slab_gap(a->patch, a->normal, b->patch, b->normal);
    if (low < -depth && !is_known(a->box, b->box)) tasks.push_back({std::move(a), std::move(b), low});
  };
  std::unordered_map<std::uint32_t, RegionPtr> cells;  // a cell is in many pairs
  const auto region = [&](std::uint32_t k) {
    RegionPtr& made = cells[k];
    const Cell& cell = model.cells()[k];
    if (!made)
      made = std::make_shared<const Region>(region_of(
          model, {k, cell.low, cell.high}, patch_of(*model.face_of(cell).surface, cell.low, cell.high)));
    return made;
  };
  for (const NearPair& pair : cluster)
    if (pair.low < -depth && !is_known(model.cells()[pair.a].box, model.cells()[pair.b].box))
      tasks.push_back({region(pair.a), region(pair.b), pair.low});
  for (; !tasks.empty(); --work) {
    Task task = std::move(tasks.back());
    tasks.pop_back();
    if (work <= 0) {
      out.unsettled = std::max(out.unsettled, -task.low);
      continue;
    }
    const double size_a = std::max(task.a->size_u, task.a->size_v),
                 size_b = std::max(task.b->size_u, task.b->size_v);
    if (std::max(size_a, size_b) < size) {
      out.open.push_back({task.a->part, task.b->part, task.low});
      continue;
    }
    const bool split_a = size_a >= size_b;
    const Region& whole = split_a ? *task.a : *task.b;
    const Eigen::Index axis = whole.size_u >= whole.size_v ? 0 : 1;
    for (const bool upper : {false, true}) {
      Part half = whole.part;
      (upper ? half.low : half.high)[axis] = 0.5 * (whole.part.low[axis] + whole.part.high[axis]);
      auto part = std::make_shared<const Region>(
          region_of(model, half, half_of(whole.patch, static_cast<int>(axis), upper)));
      if (split_a) {
        consider(std::move(part), task.b);
      } else {
        consider(task.a, std::move(part));
      }
    }
  }
  return out;
}

}  // namespace selvage::contact
