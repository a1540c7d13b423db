#include "core/box_tree.h"

#include <algorithm>
#include <numeric>

namespace selvage {

BoxTree::BoxTree(std::vector<Box3> boxes, std::uint32_t leaf_size)
    : boxes_(std::move(boxes)), leaf_size_(leaf_size), order_(boxes_.size()) {
  if (boxes_.empty()) return;
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(boxes_.size());
  nodes_.push_back({Box3(), 0, static_cast<std::uint32_t>(order_.size())});
  split(0);
}

void BoxTree::split(std::uint32_t node) {
  const std::uint32_t first = nodes_[node].first, count = nodes_[node].count;
  Box3 box, spread;
  for (std::uint32_t k = first; k < first + count; ++k) {
    box.extend(boxes_[order_[k]]);
    spread.extend(boxes_[order_[k]].center());
  }
  nodes_[node].box = box;
  if (count <= leaf_size_) return;
  Eigen::Index axis = 0;
  spread.diagonal().maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  // Equal centres in the order of the boxes, so that the tree is the same everywhere.
  std::nth_element(begin, begin + count / 2, begin + count, [&](std::uint32_t x, std::uint32_t y) {
    const double cx = boxes_[x].min()[axis] + boxes_[x].max()[axis],
                 cy = boxes_[y].min()[axis] + boxes_[y].max()[axis];
    return cx != cy ? cx < cy : x < y;
  });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({Box3(), first, count / 2});
  nodes_.push_back({Box3(), first + count / 2, count - count / 2});
  nodes_[node].first = left;
  nodes_[node].count = 0;
  split(left);
  split(left + 1);
}

void BoxTree::refit(std::vector<Box3> boxes) {
  boxes_ = std::move(boxes);
  for (std::size_t k = nodes_.size(); k-- > 0;) {  // children stand behind their parents
    Node& node = nodes_[k];
    node.box = node.count == 0 ? nodes_[node.first].box.merged(nodes_[node.first + 1].box) : Box3();
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) node.box.extend(boxes_[order_[i]]);
  }
}

}  // namespace selvage
