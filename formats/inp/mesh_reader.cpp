#include "formats/inp/mesh_reader.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/number_text.h"
#include "core/text_lines.h"
#include "core/text_report.h"
#include "core/words.h"
#include "formats/inp/cards.h"

namespace selvage::formats::inp {

namespace {

using fem::FieldMesh;
using Shape = FieldMesh::Shape;

// Types of elements by how their names begin, after a 'D' of those that conduct; of nodes the corners come
// first.
struct ElementType {
  std::string_view begin;
  Shape shape;
  std::size_t nodes;
};
constexpr std::array<ElementType, 22> element_types = {
    {{"C3D10", Shape::tetrahedron, 10}, {"C3D15", Shape::wedge, 15},     {"C3D20", Shape::hexahedron, 20},
     {"C3D4", Shape::tetrahedron, 4},   {"C3D5", Shape::pyramid, 5},     {"C3D6", Shape::wedge, 6},
     {"C3D8", Shape::hexahedron, 8},    {"COH3D6", Shape::wedge, 6},     {"COH3D8", Shape::hexahedron, 8},
     {"SC6", Shape::wedge, 6},          {"SC8", Shape::hexahedron, 8},   {"S3", Shape::triangle, 3},
     {"STRI3", Shape::triangle, 3},     {"STRI65", Shape::triangle, 6},  {"S4", Shape::quadrilateral, 4},
     {"S6", Shape::triangle, 6},        {"S8", Shape::quadrilateral, 8}, {"M3D3", Shape::triangle, 3},
     {"M3D4", Shape::quadrilateral, 4}, {"R3D3", Shape::triangle, 3},    {"R3D4", Shape::quadrilateral, 4},
     {"SFM3D3", Shape::triangle, 3}}};

const ElementType* type_of(std::string_view name) {
  for (const std::string_view tried : {name, name.substr(name.starts_with('D') ? 1 : 0)})
    for (const ElementType& type : element_types)
      if (tried.starts_with(type.begin)) return &type;
  return nullptr;
}

class MeshReader {
 public:
  MeshReader(const Source& source, TextReport& report) : report_(report), lines_(source.bytes()) {}

  std::optional<FieldMesh> read() {
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (line.starts_with("**") || trimmed(line).empty()) continue;
      if (line.starts_with('*')) {
        if (!begin_card()) return std::nullopt;
      } else if ((card_.word == "NODE" && !take_node()) || (card_.word == "ELEMENT" && !take_element())) {
        return std::nullopt;
      }
    }
    if (!find_nodes()) return std::nullopt;
    if (mesh_.elements.empty())
      return report_.error({}, "the deck has no element that is a surface or a solid");
    return std::move(mesh_);
  }

 private:
  bool begin_card() {
    card_ = card_of(lines_.line());
    pending_.clear();
    if (card_.word == "INCLUDE") {
      report_.error(lines_.spot(),
                    fmt::format("this deck takes in {}: view that file, where the mesh is",
                                in_quotes(card_.value("INPUT"))),
                    Kind::unsupported);
      return false;
    }
    if (card_.word != "ELEMENT") return true;
    const std::string name = key_of(card_.value("TYPE"));
    type_ = type_of(name);
    if (type_ == nullptr && warned_.insert(name).second)
      report_.warning(
          lines_.spot(),
          fmt::format("elements of the type {} are neither surfaces nor solids that are shown: left out",
                      in_quotes(name)));
    const std::string set = card_.value("ELSET");
    const auto [known, is_new] =
        regions_.try_emplace(key_of(set), static_cast<std::uint32_t>(mesh_.regions.size()));
    if (is_new && type_ != nullptr) mesh_.regions.push_back(set.empty() ? "elements" : set);
    if (is_new && type_ == nullptr) regions_.erase(known);
    region_ = type_ != nullptr ? known->second : 0;
    return true;
  }

  // The numbers of a line into pending_; false: one is none.
  bool take_numbers() {
    std::vector<std::string_view> parts = split(lines_.line(), ',');
    while (!parts.empty() && trimmed(parts.back()).empty()) parts.pop_back();
    for (const std::string_view part : parts) {
      const std::optional<double> value = trimmed(part).empty() ? 0.0 : read_number(trimmed(part));
      if (!value || !std::isfinite(*value)) {
        report_.error(lines_.spot(), fmt::format("{} is not a number", in_quotes(trimmed(part))));
        return false;
      }
      pending_.push_back(*value);
    }
    return true;
  }

  static long number_of(double value) { return value > 0 && value < 1e15 ? static_cast<long>(value) : 0; }

  bool take_node() {
    pending_.clear();
    if (!take_numbers()) return false;
    pending_.resize(4);
    const auto [known, is_new] =
        nodes_.try_emplace(number_of(pending_[0]), static_cast<std::uint32_t>(mesh_.nodes.size()));
    const Vec3 place(pending_[1], pending_[2], pending_[3]);
    if (is_new) {
      mesh_.nodes.push_back(place);
      mesh_.node_numbers.push_back(known->first);
    } else {
      mesh_.nodes[known->second] = place;
    }
    return true;
  }

  bool take_element() {
    if (type_ == nullptr) return true;
    if (!take_numbers()) return false;
    if (pending_.size() < type_->nodes + 1) return true;  // it goes on in the next line
    FieldMesh::Element element{type_->shape, {}, region_};
    std::array<long, 8> corners{};
    for (std::size_t k = 0; k < fem::corner_count(type_->shape); ++k) corners[k] = number_of(pending_[k + 1]);
    // VTK sees the first triangle of a wedge from the other side.
    if (type_->shape == Shape::wedge) {
      std::swap(corners[1], corners[2]);
      std::swap(corners[4], corners[5]);
    }
    mesh_.elements.push_back(element);
    mesh_.element_numbers.push_back(number_of(pending_[0]));
    corners_.push_back({corners, lines_.spot()});
    pending_.clear();
    return true;
  }

  // Elements may stand before their nodes.
  bool find_nodes() {
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
      for (std::size_t k = 0; k < fem::corner_count(mesh_.elements[e].shape); ++k) {
        const auto found = nodes_.find(corners_[e].numbers[k]);
        if (found == nodes_.end()) {
          report_.error(corners_[e].spot, fmt::format("element {} has the node {}, which the deck has not",
                                                      mesh_.element_numbers[e], corners_[e].numbers[k]));
          return false;
        }
        mesh_.elements[e].corners[k] = found->second;
      }
    return true;
  }

  struct Corners {
    std::array<long, 8> numbers{};
    Spot spot;
  };

  TextReport& report_;
  TextLines lines_;
  FieldMesh mesh_;
  Card card_;
  const ElementType* type_ = nullptr;
  std::uint32_t region_ = 0;
  std::vector<double> pending_;
  std::vector<Corners> corners_;  // of each element
  std::unordered_map<long, std::uint32_t> nodes_;
  std::map<std::string, std::uint32_t> regions_;
  std::set<std::string> warned_;
};

}  // namespace

std::optional<FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [](const Source& text, TextReport& report) { return MeshReader(text, report).read(); });
}

}  // namespace selvage::formats::inp
