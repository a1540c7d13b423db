#include "pipeline/mesh_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "core/words.h"
#include "fem/quality.h"

namespace selvage::pipeline {

namespace {

namespace page = view::page;

// Of all fields together.
constexpr std::size_t most_values = 8'000'000;
constexpr std::size_t bins = 30;

// Counts values between two ends; what is beyond them is in the first or the last bin.
class Counter {
 public:
  Counter(std::string name, double low, double high) {
    histogram_.name = std::move(name);
    histogram_.low = low;
    histogram_.high = high;
    histogram_.counts.resize(bins);
    histogram_.least = std::numeric_limits<double>::infinity();
  }
  void add(double value) {
    const double share = (value - histogram_.low) / (histogram_.high - histogram_.low);
    ++histogram_.counts[static_cast<std::size_t>(std::clamp(share * bins, 0.0, bins - 1.0))];
    histogram_.least = std::min(histogram_.least, value);
    sum_ += value;
    ++count_;
  }
  [[nodiscard]] page::Skin::Histogram result() const {
    page::Skin::Histogram made = histogram_;
    made.mean = count_ > 0 ? sum_ / count_ : 0;
    return made;
  }

 private:
  page::Skin::Histogram histogram_;
  double sum_ = 0, count_ = 0;
};

std::vector<page::Skin::Histogram> quality_of(const fem::FieldMesh& mesh) {
  Counter angles("Smallest dihedral angle, degrees", 0, 75), jacobians("Scaled Jacobian", 0, 1),
      aspects("Aspect ratio", 1, 10);
  bool is_any = false;
  for (const fem::FieldMesh::Element& element : mesh.elements) {
    if (element.shape != fem::FieldMesh::Shape::tetrahedron) continue;
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.nodes[element.corners[k]];
    const fem::ElementShape shape = fem::shape_of(corners);
    angles.add(shape.min_dihedral);
    jacobians.add(shape.scaled_jacobian);
    aspects.add(shape.aspect);
    is_any = true;
  }
  if (!is_any) return {};
  return {angles.result(), jacobians.result(), aspects.result()};
}

// The nodes that triangles have, in the page's numbers.
struct Numbering {
  std::vector<std::uint32_t> of_node;  // or none
  std::vector<std::uint32_t> nodes;
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Numbering(const fem::FieldMesh& mesh, const fem::Outside& outside) : of_node(mesh.nodes.size(), none) {
    for (const auto& triangle : outside.triangles)
      for (const std::uint32_t node : triangle) {
        if (of_node[node] != none) continue;
        of_node[node] = static_cast<std::uint32_t>(nodes.size());
        nodes.push_back(node);
      }
  }
};

void add_fields(Job& job, const fem::FieldMesh& mesh, const fem::Outside& outside, const Numbering& numbering,
                page::Skin& skin) {
  std::size_t values = 0, left_out = 0;
  for (const fem::FieldMesh::Field& field : mesh.fields) {
    const std::vector<std::uint32_t>& from = field.of_nodes ? numbering.nodes : outside.element;
    const auto components = static_cast<std::size_t>(field.components);
    values += from.size() * components;
    if (values > most_values) {
      ++left_out;
      continue;
    }
    page::Skin::Field shown{field.name, field.of_nodes, field.components, {}, field.step};
    for (const std::uint32_t k : from)
      shown.values.insert(shown.values.end(),
                          field.values.begin() + static_cast<std::ptrdiff_t>(k * components),
                          field.values.begin() + static_cast<std::ptrdiff_t>((k + 1) * components));
    skin.fields.push_back(std::move(shown));
  }
  if (left_out > 0)
    job.say(warning(Kind::limit, fmt::format("the page has no room for {} of {}: they are left out",
                                             counted(left_out, "field"), mesh.fields.size())));
}

}  // namespace

page::Page mesh_page(Job& job, const fem::FieldMesh& mesh) {
  page::Page made;
  made.name = std::filesystem::path(job.input.path).filename().string();
  const fem::Outside outside = fem::outside_of(mesh);
  const Numbering numbering(mesh, outside);
  for (const std::uint32_t node : numbering.nodes) made.box.extend(mesh.nodes[node]);
  made.centre = made.box.center();
  page::Skin& skin = made.skin.emplace();
  skin.nodes = mesh.nodes.size();
  skin.elements = mesh.elements.size();
  skin.steps = mesh.steps;
  for (const std::uint32_t node : numbering.nodes)
    skin.points.emplace_back((mesh.nodes[node] - made.centre).cast<float>());
  for (std::size_t k = 0; k < outside.triangles.size(); ++k) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = numbering.of_node[outside.triangles[k][i]];
    skin.triangles.push_back(triangle);
    skin.inner.push_back(outside.inner[k]);
    skin.region.push_back(mesh.elements[outside.element[k]].region);
  }
  for (const std::string& name : mesh.regions) skin.regions.push_back({name, 0, fem::is_matrix(name)});
  for (const fem::FieldMesh::Element& element : mesh.elements) ++skin.regions[element.region].elements;
  add_fields(job, mesh, outside, numbering, skin);
  skin.histograms = quality_of(mesh);
  return made;
}

}  // namespace selvage::pipeline
