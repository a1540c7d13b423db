#include "construction/shape_memo.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace selvage::fabric {

namespace {

constexpr std::size_t most_bytes = std::size_t{64} << 20;

std::size_t hash_of(const ShapeMemo::Plan& plan) {
  const std::vector<Vec3>& points = plan.line.curve.points;
  return std::hash<std::string_view>()(
      {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Vec3)});
}

std::size_t bytes_of(const ShapeMemo::Plan& plan, const yarn::Body& body) {
  const std::size_t points = body.surface.points.size() + 2 * plan.line.curve.points.size();
  return points * sizeof(Vec3) +
         (body.surface.knots_v.size() + 2 * plan.line.curve.knots.size()) * sizeof(double);
}

}  // namespace

const ShapeMemo::Known* ShapeMemo::look_up(std::size_t hash, const Plan& plan) {
  const auto found = std::find_if(known_.begin(), known_.end(),
                                  [&](const Known& k) { return k.hash == hash && k.plan == plan; });
  if (found == known_.end()) return nullptr;
  known_.splice(known_.begin(), known_, found);
  return &known_.front();
}

std::shared_ptr<const yarn::Body> ShapeMemo::find(const Plan& plan) {
  const std::size_t hash = hash_of(plan);
  const std::lock_guard lock(mutex_);
  const Known* known = look_up(hash, plan);
  return known != nullptr ? known->body : nullptr;
}

std::uint64_t ShapeMemo::mapped(std::uint64_t shape, const Eigen::Matrix3d& linear) {
  if (shape == 0) return 0;
  std::array<double, 9> numbers{};
  std::copy(linear.data(), linear.data() + numbers.size(), numbers.begin());
  const std::lock_guard lock(mutex_);
  const auto [known, is_new] = mapped_.try_emplace({shape, numbers}, 0);
  if (is_new) known->second = ++last_shape_;
  return known->second;
}

void ShapeMemo::keep(const Plan& plan, yarn::Body& body) {
  if (!body.messages.empty()) return;
  Known known{hash_of(plan), bytes_of(plan, body), plan, nullptr};
  if (known.bytes > most_bytes) return;
  const std::lock_guard lock(mutex_);
  // Another thread may have swept it meanwhile.
  if (const Known* first = look_up(known.hash, plan)) {
    body.shape = first->body->shape;
    return;
  }
  body.shape = ++last_shape_;
  known.body = std::make_shared<const yarn::Body>(body);
  bytes_ += known.bytes;
  known_.push_front(std::move(known));
  while (bytes_ > most_bytes) {
    bytes_ -= known_.back().bytes;
    known_.pop_back();
  }
}

}  // namespace selvage::fabric
