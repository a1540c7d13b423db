// What is known of each element, as $ElementData.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/text_buffer.h"
#include "fem/mesh.h"

namespace selvage::formats::msh {

// The nodes of the points, lines and triangles in front of the volumes' elements, in the order of the file.
class BoundingElements {
 public:
  template <class Nodes>
  void add(const Nodes& nodes) {
    nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
    ends_.push_back(nodes_.size());
  }
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] std::span<const std::size_t> operator[](std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
    return std::span(nodes_).subspan(begin, ends_[i] - begin);
  }

 private:
  std::vector<std::size_t> nodes_, ends_;
};

// Mesh::fibre_fraction, where it was computed; NaN as "nan". meshio wants a value of every element: what is
// no volume has that of the volumes that it bounds, of several the largest; cohesive elements have 0.
void write_fibre_fraction(TextBuffer& text, const fem::Mesh& mesh, const BoundingElements& bounding);

}  // namespace selvage::formats::msh
