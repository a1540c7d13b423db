#include "formats/msh/element_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace selvage::formats::msh {
namespace {

// Of some nodes the elements that have them.
class ElementsOfNodes {
 public:
  ElementsOfNodes(const fem::Mesh& mesh, const std::vector<bool>& is_wanted)
      : begins_(mesh.nodes.size() + 1) {
    const auto each = [&](auto&& act) {
      for (std::size_t e = 0; e < mesh.elements.size(); ++e)
        for (const std::size_t node : mesh.nodes_of(e))
          if (is_wanted[node]) act(node, e);
    };
    each([&](std::size_t node, std::size_t) { ++begins_[node + 1]; });
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) begins_[n + 1] += begins_[n];
    elements_.resize(begins_.back());
    std::vector<std::size_t> next = begins_;
    each([&](std::size_t node, std::size_t e) { elements_[next[node]++] = e; });
  }
  [[nodiscard]] std::span<const std::size_t> operator[](std::size_t node) const {
    return std::span(elements_).subspan(begins_[node], begins_[node + 1] - begins_[node]);
  }

 private:
  std::vector<std::size_t> begins_, elements_;
};

bool has_all(std::span<const std::size_t> element, std::span<const std::size_t> nodes) {
  return std::ranges::all_of(
      nodes, [&](std::size_t node) { return std::ranges::find(element, node) != element.end(); });
}

}  // namespace

void write_fibre_fraction(TextBuffer& text, const fem::Mesh& mesh, const BoundingElements& bounding) {
  if (mesh.fibre_fraction.empty()) return;
  std::vector<bool> is_first(mesh.nodes.size(), false);
  for (std::size_t i = 0; i < bounding.size(); ++i) is_first[bounding[i].front()] = true;
  const ElementsOfNodes around(mesh, is_first);
  // One text, one number (a time), three whole ones: step, components, elements.
  text << "$ElementData\n1\n\"fibre_fraction\"\n1\n0\n3\n0\n1\n"
       << bounding.size() + mesh.elements.size() + mesh.cohesive_elements() << '\n';
  for (std::size_t i = 0; i < bounding.size(); ++i) {
    double largest = std::numeric_limits<double>::quiet_NaN();
    for (const std::size_t e : around[bounding[i].front()])
      if (const double share = mesh.fibre_fraction[e];
          has_all(mesh.nodes_of(e), bounding[i]) && (std::isnan(largest) || share > largest))
        largest = share;
    text << i + 1 << ' ' << largest << '\n';
  }
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    text << bounding.size() + e + 1 << ' ' << mesh.fibre_fraction[e] << '\n';
  for (std::size_t k = 0; k < mesh.cohesive_elements(); ++k)
    text << bounding.size() + mesh.elements.size() + k + 1 << " 0\n";
  text << "$EndElementData\n";
}

}  // namespace selvage::formats::msh
