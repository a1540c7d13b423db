#include "results/solved_deck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/words.h"

namespace selvage::fem {

namespace {

using Field = FieldMesh::Field;
using Mat3 = Eigen::Matrix3d;

constexpr float no_value = std::numeric_limits<float>::quiet_NaN();

// Derivatives of an element's shape functions in its own coordinates, a column a node: of a tetrahedron with
// ten nodes at one of its corners, of others at the middle, where their strains are best.
using Slopes = Eigen::Matrix<double, 3, Eigen::Dynamic>;
Slopes slopes_of(std::size_t nodes, int corner) {
  Slopes corners(3, 4);
  corners << -1, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1;
  if (nodes == 4) return corners;
  Slopes slopes = Slopes::Zero(3, static_cast<Eigen::Index>(nodes));
  if (nodes == 10) {
    // Of the functions L (2 L - 1) of corners and 4 L L' of midside nodes.
    constexpr std::array<std::array<int, 2>, 6> edges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
    for (int k = 0; k < 4; ++k) slopes.col(k) = (k == corner ? 3 : -1) * corners.col(k);
    for (int k = 0; k < 6; ++k)
      for (const int end : {0, 1})
        if (edges[k][end] == corner) slopes.col(4 + k) = 4 * corners.col(edges[k][1 - end]);
  } else if (nodes == 6) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 in_triangle(k == 0 ? -0.5 : k == 1 ? 0.5 : 0.0, k == 0 ? -0.5 : k == 2 ? 0.5 : 0.0, 0);
      slopes.col(k) = in_triangle - Vec3(0, 0, 1.0 / 6);
      slopes.col(k + 3) = in_triangle + Vec3(0, 0, 1.0 / 6);
    }
  } else {
    for (int k = 0; k < 8; ++k)
      slopes.col(k) = Vec3(k % 4 == 1 || k % 4 == 2 ? 1 : -1, k % 4 >= 2 ? 1 : -1, k >= 4 ? 1 : -1) / 8;
  }
  return slopes;
}

// The strain (tensor) of a displaced element where its shape functions have these slopes.
Mat3 strain_of(const std::vector<Vec3>& places, const std::vector<Vec3>& moved, const Slopes& slopes) {
  Mat3 by_place = Mat3::Zero(), by_motion = Mat3::Zero();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vec3 slope = slopes.col(static_cast<Eigen::Index>(k));
    by_place += places[k] * slope.transpose();
    by_motion += moved[k] * slope.transpose();
  }
  const Mat3 gradient = by_motion * by_place.inverse();
  return 0.5 * (gradient + gradient.transpose());
}

constexpr std::array<std::array<int, 2>, 6> places_of_six = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};

using Six = Eigen::Matrix<double, 6, 1>;
Six six_of(const Mat3& tensor) {
  Six six;
  for (int k = 0; k < 6; ++k) six[k] = tensor(places_of_six[k][0], places_of_six[k][1]);
  return six;
}
Mat3 tensor_of(const Six& six) {
  Mat3 tensor;
  for (int k = 0; k < 6; ++k)
    tensor(places_of_six[k][0], places_of_six[k][1]) = tensor(places_of_six[k][1], places_of_six[k][0]) =
        six[k];
  return tensor;
}

Mat3 stress_of(const Mat3& strain, const SolvedDeck::Section& section, const SolvedDeck::Element& element,
               double warming) {
  Mat3 axes = Mat3::Identity();
  if (section.is_oriented) {
    const Vec3 third = element.along.cross(element.across).normalized();
    axes << element.along.normalized(), third.cross(element.along).normalized(), third;
  }
  Mat3 local = axes.transpose() * strain * axes;
  local -= warming * Mat3(section.expansion.asDiagonal());
  Six engineering = six_of(local);
  engineering.tail<3>() *= 2;
  return axes * tensor_of(section.stiffness * engineering) * axes.transpose();
}

// Means at nodes over elements that have a value, of the nodes' own region.
class NodeMeans {
 public:
  NodeMeans(const FieldMesh& mesh, int components)
      : components_(components),
        sums_(mesh.nodes.size() * static_cast<std::size_t>(components)),
        counts_(mesh.nodes.size()) {}
  template <class Values>
  void add(std::uint32_t node, const Values& values) {
    ++counts_[node];
    for (int k = 0; k < components_; ++k)
      sums_[node * static_cast<std::size_t>(components_) + static_cast<std::size_t>(k)] += values[k];
  }
  [[nodiscard]] Field field(std::string name, int step) const {
    Field made{std::move(name), true, components_, {}, step};
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const double count = counts_[k / static_cast<std::size_t>(components_)];
      made.values.push_back(count > 0 ? static_cast<float>(sums_[k] / count) : no_value);
    }
    return made;
  }

 private:
  int components_;
  std::vector<double> sums_;
  std::vector<double> counts_;
};

Vec3 vector_at(const Field& field, std::size_t k) {
  return Eigen::Map<const Eigen::Vector3f>(&field.values[3 * k]).cast<double>();
}

// Directions of fibres at nodes, those of elements as long as there are any; either way along counts.
Field directions_at_nodes(const FieldMesh& mesh, const std::vector<std::optional<Vec3>>& of_elements) {
  std::vector<Vec3> sums(mesh.nodes.size(), Vec3::Zero());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (!of_elements[e]) continue;
    for (std::size_t c = 0; c < corner_count(mesh.elements[e].shape); ++c) {
      Vec3& sum = sums[mesh.elements[e].corners[c]];
      sum += sum.dot(*of_elements[e]) < 0 ? Vec3(-*of_elements[e]) : *of_elements[e];
    }
  }
  Field made{"along", true, 3, {}, 0};
  for (const Vec3& sum : sums)
    for (const double x : sum)
      made.values.push_back(sum.norm() > 0 ? static_cast<float>(x / sum.norm()) : no_value);
  return made;
}

const SolvedDeck::Element* element_of(const SolvedDeck& deck, const FieldMesh& mesh, std::size_t e) {
  const auto found = deck.elements.find(mesh.element_numbers[e]);
  if (found == deck.elements.end()) return nullptr;
  const FieldMesh::Element& element = mesh.elements[e];
  const std::size_t count = corner_count(element.shape);
  std::vector<long> theirs(
      found->second.nodes.begin(),
      found->second.nodes.begin() + static_cast<std::ptrdiff_t>(std::min(count, found->second.nodes.size()))),
      own;
  for (std::size_t c = 0; c < count; ++c) own.push_back(mesh.node_numbers[element.corners[c]]);
  std::sort(theirs.begin(), theirs.end());
  std::sort(own.begin(), own.end());
  return own == theirs ? &found->second : nullptr;
}

// Strains and stresses of one step, in place of the solver's.
Status reckon(const SolvedDeck& deck, const std::vector<const SolvedDeck::Element*>& elements,
              FieldMesh& mesh, const Field& moved, double warming) {
  std::unordered_map<long, std::size_t> node_of;
  for (std::size_t k = 0; k < mesh.node_numbers.size(); ++k) node_of.try_emplace(mesh.node_numbers[k], k);
  NodeMeans strains(mesh, 6), stresses(mesh, 6);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::vector<Vec3> places, ways;
    for (const long number : elements[e]->nodes) {
      const auto node = node_of.find(number);
      if (node == node_of.end())
        return error(Kind::malformed,
                     fmt::format("the results have no node {} of the deck's element {}: they are "
                                 "of another deck",
                                 number, mesh.element_numbers[e]));
      places.push_back(mesh.nodes[node->second]);
      ways.push_back(vector_at(moved, node->second));
    }
    const FieldMesh::Element& element = mesh.elements[e];
    for (std::size_t c = 0; c < corner_count(element.shape); ++c) {
      const std::uint32_t node = element.corners[c];
      const auto own =
          std::find(elements[e]->nodes.begin(), elements[e]->nodes.end(), mesh.node_numbers[node]);
      const Mat3 strain = strain_of(
          places, ways,
          slopes_of(places.size(), static_cast<int>(std::distance(elements[e]->nodes.begin(), own))));
      strains.add(node, six_of(strain));
      stresses.add(node,
                   six_of(stress_of(strain, deck.sections[elements[e]->section], *elements[e], warming)));
    }
  }
  const int step = moved.step;
  std::erase_if(mesh.fields, [&](const Field& field) {
    return field.step == step && (field.name == "STRESS" || field.name == "TOSTRAIN");
  });
  mesh.fields.push_back(stresses.field("STRESS", step));
  mesh.fields.push_back(strains.field("TOSTRAIN", step));
  return {};
}

}  // namespace

void part_regions(FieldMesh& mesh) {
  std::vector<std::uint32_t> region_of(mesh.nodes.size(), std::numeric_limits<std::uint32_t>::max());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;  // of a node, for a region
  std::vector<std::uint32_t> copied;
  const std::size_t count = mesh.nodes.size();
  for (FieldMesh::Element& element : mesh.elements)
    for (std::size_t c = 0; c < corner_count(element.shape); ++c) {
      std::uint32_t& corner = element.corners[c];
      std::uint32_t& region = region_of[corner];
      if (region == std::numeric_limits<std::uint32_t>::max()) region = element.region;
      if (region == element.region) continue;
      const auto [copy, is_new] =
          copies.try_emplace({corner, element.region}, static_cast<std::uint32_t>(count + copied.size()));
      if (is_new) copied.push_back(corner);
      corner = copy->second;
    }
  for (const std::uint32_t node : copied) {
    mesh.nodes.push_back(Vec3(mesh.nodes[node]));
    if (!mesh.node_numbers.empty()) mesh.node_numbers.push_back(long(mesh.node_numbers[node]));
  }
  for (Field& field : mesh.fields) {
    if (!field.of_nodes) continue;
    const auto components = static_cast<std::size_t>(field.components);
    field.values.resize(mesh.nodes.size() * components);
    for (std::size_t k = 0; k < copied.size(); ++k)
      std::copy_n(&field.values[copied[k] * components], components, &field.values[(count + k) * components]);
  }
}

Status apply(const SolvedDeck& deck, FieldMesh& mesh) {
  std::vector<const SolvedDeck::Element*> elements;
  std::vector<std::optional<Vec3>> directions(mesh.elements.size());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    elements.push_back(element_of(deck, mesh, e));
    if (elements.back() == nullptr)
      return error(Kind::malformed,
                   fmt::format("the deck has no element {} of these nodes: it is not the one that "
                               "was solved",
                               mesh.element_numbers[e]));
    if (deck.sections[elements.back()->section].is_oriented) directions[e] = elements.back()->along;
  }
  std::vector<double> warmings(mesh.steps.size());
  if (deck.steps.size() == mesh.steps.size()) {
    for (std::size_t k = 0; k < warmings.size(); ++k) warmings[k] = deck.steps[k].warming;
  } else if (std::any_of(deck.steps.begin(), deck.steps.end(),
                         [](const auto& step) { return step.warming != 0; })) {
    return error(Kind::unsupported,
                 fmt::format("the deck has {}, the results have {}: which temperature they are of "
                             "is not known",
                             counted(deck.steps.size(), "step"), counted(mesh.steps.size(), "set")));
  }
  mesh.regions = deck.regions;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) mesh.elements[e].region = elements[e]->region;
  part_regions(mesh);
  std::vector<Field> moved;
  for (const Field& field : mesh.fields)
    if (field.name == "DISP" && field.components == 3) moved.push_back(field);
  for (const Field& field : moved)
    if (Status done = reckon(deck, elements, mesh, field, warmings[static_cast<std::size_t>(field.step) - 1]);
        !done.ok())
      return done;
  if (std::any_of(directions.begin(), directions.end(), [](const auto& one) { return one.has_value(); }))
    mesh.fields.push_back(directions_at_nodes(mesh, directions));
  if (deck.steps.size() == mesh.steps.size())
    for (std::size_t k = 0; k < warmings.size(); ++k)
      if (!deck.steps[k].title.empty())
        mesh.steps[k] = fmt::format("step {}, {}", k + 1, deck.steps[k].title);
  return {};
}

bool add_along_fibre(FieldMesh& mesh) {
  const auto find_along = [&] {
    return std::find_if(mesh.fields.begin(), mesh.fields.end(),
                        [](const Field& field) { return field.name == "along" && field.components == 3; });
  };
  const auto is_tensor = [](const Field& field) { return field.components == 6; };
  if (find_along() == mesh.fields.end()) return false;
  if (std::none_of(mesh.fields.begin(), mesh.fields.end(), is_tensor)) return true;
  if (!find_along()->of_nodes) {
    std::vector<std::optional<Vec3>> directions(mesh.elements.size());
    for (std::size_t e = 0; e < mesh.elements.size(); ++e)
      if (!is_matrix(mesh.regions[mesh.elements[e].region])) directions[e] = vector_at(*find_along(), e);
    part_regions(mesh);
    mesh.fields.push_back(directions_at_nodes(mesh, directions));
    mesh.fields.erase(find_along());
  }
  const Field along = *find_along();
  std::vector<Field> made;
  for (const Field& field : mesh.fields) {
    if (!is_tensor(field) || !field.of_nodes) continue;
    Field& one = made.emplace_back(Field{field.name + std::string(along_the_fibre), true, 1, {}, field.step});
    for (std::size_t k = 0; k < mesh.nodes.size(); ++k) {
      const Vec3 way = vector_at(along, k);
      const Six six = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(&field.values[6 * k]).cast<double>();
      one.values.push_back(static_cast<float>(way.dot(tensor_of(six) * way)));
    }
  }
  mesh.fields.insert(mesh.fields.end(), made.begin(), made.end());
  return true;
}

}  // namespace selvage::fem
