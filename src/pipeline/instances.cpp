#include "pipeline/instances.h"

#include <algorithm>
#include <cmath>

namespace selvage::pipeline {

namespace {

// Mirror images have the same invariants, and so may a few others; more shapes than that in one class would
// make the search quadratic.
constexpr std::size_t most_shapes = 8;

}  // namespace

InstanceFinder::Kind InstanceFinder::kind_of(const yarn::Body& body) {
  const nurbs::Surface& s = body.surface;
  return {s.degree_u,
          s.degree_v,
          s.count_u,
          s.count_v,
          s.is_rational(),
          body.closed_along,
          static_cast<int>(body.start.style),
          static_cast<int>(body.end.style),
          static_cast<int>(body.role),
          body.color.red,
          body.color.green,
          body.color.blue,
          std::llround(1e6 * body.density)};
}

double InstanceFinder::tolerance_of(const yarn::Body& body) const {
  const double own = 1e-9 * yarn::bounds(body).diagonal().norm();
  return tolerance_ > 0 ? std::min(own, tolerance_) : own;
}

InstanceFinder::Class* InstanceFinder::find(Classes& classes, const yarn::Invariants& invariants,
                                            double tolerance) {
  const auto last = classes.upper_bound(invariants.sizes[0] + 4 * tolerance);
  for (auto at = classes.lower_bound(invariants.sizes[0] - 4 * tolerance); at != last; ++at)
    if (yarn::are_alike(at->second.invariants, invariants, tolerance)) return &at->second;
  return nullptr;
}

void InstanceFinder::count(const yarn::Body& body) {
  Classes& classes = kinds_[kind_of(body)];
  const yarn::Invariants invariants = yarn::invariants_of(body);
  if (Class* const known = find(classes, invariants, tolerance_of(body))) {
    ++known->to_come;
    return;
  }
  classes.emplace(invariants.sizes[0], Class{invariants, 1, {}});
}

std::optional<formats::Instance> InstanceFinder::place(const yarn::Body& body) {
  const double tolerance = tolerance_of(body);
  Class* const known = find(kinds_[kind_of(body)], yarn::invariants_of(body), tolerance);
  if (known == nullptr || (known->to_come <= 1 && known->shapes.empty())) return std::nullopt;
  if (known->to_come > 0) --known->to_come;
  std::optional<formats::Instance> instance;
  for (const Shape& shape : known->shapes) {
    const std::optional<yarn::Congruence> same = yarn::congruence(*shape.body, body, tolerance);
    if (!same) continue;
    instance = formats::Instance{shape.number, shape.body, same->motion};
    found_.largest_deviation = std::max(found_.largest_deviation, same->deviation);
    break;
  }
  if (!instance && known->to_come > 0 && known->shapes.size() < most_shapes) {
    known->shapes.push_back({found_.shapes++, std::make_shared<const yarn::Body>(body)});
    instance = formats::Instance{known->shapes.back().number, known->shapes.back().body, {}};
  }
  if (instance) ++found_.copies;
  if (known->to_come == 0) known->shapes.clear();
  return instance;
}

}  // namespace selvage::pipeline
