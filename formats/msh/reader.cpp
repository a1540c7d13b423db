#include "formats/msh/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/number_text.h"
#include "core/text_lines.h"
#include "core/text_report.h"
#include "core/words.h"

namespace selvage::formats::msh {

namespace {

using fem::FieldMesh;
using Shape = FieldMesh::Shape;

// By Gmsh's numbers of element types; their corners come first.
std::optional<Shape> shape_of(long type) {
  switch (type) {
    case 2:
    case 9:
      return Shape::triangle;
    case 3:
    case 10:
    case 16:
      return Shape::quadrilateral;
    case 4:
    case 11:
      return Shape::tetrahedron;
    case 5:
    case 12:
    case 17:
      return Shape::hexahedron;
    case 6:
    case 13:
    case 18:
      return Shape::wedge;
    case 7:
    case 14:
    case 19:
      return Shape::pyramid;
    default:
      return std::nullopt;  // points and lines
  }
}

bool is_surface(Shape shape) {
  return shape == Shape::triangle || shape == Shape::quadrilateral;
}

using Entity = std::pair<long, long>;  // dimension and tag

class GmshReader {
 public:
  GmshReader(const Source& source, TextReport& report) : report_(report), lines_(source.bytes()) {}

  std::optional<FieldMesh> read() {
    while (lines_.next()) {
      const std::string_view section = trimmed(lines_.line());
      const bool is_good = section == "$MeshFormat"      ? read_format()
                           : section == "$PhysicalNames" ? read_names()
                           : section == "$Entities"      ? read_entities()
                           : section == "$Nodes"         ? (is_new_ ? read_node_blocks() : read_nodes())
                           : section == "$Elements"      ? (is_new_ ? read_element_blocks() : read_elements())
                                                         : true;
      if (!is_good) return std::nullopt;
    }
    leave_out_skins();
    if (!find_nodes()) return std::nullopt;
    if (mesh_.elements.empty())
      return report_.error({}, "the mesh has no element that is a surface or a solid");
    return std::move(mesh_);
  }

 private:
  struct Read {
    FieldMesh::Element element;
    std::array<long, 8> nodes{};
    long number = 0;
    Spot spot;
  };

  bool fail(std::string text, Kind kind = Kind::malformed) {
    report_.error(lines_.spot(), std::move(text), kind);
    return false;
  }
  // The numbers of the next line, `least` of them at least; false: it has not, or the section ends.
  bool next_numbers(std::size_t least) {
    if (!lines_.next()) return fail("the file ends within a section");
    numbers_.clear();
    for (const std::string_view word : words_of(lines_.line())) {
      const std::optional<double> value = read_number(trimmed(word));
      if (!value || !std::isfinite(*value)) return fail(fmt::format("{} is not a number", in_quotes(word)));
      numbers_.push_back(*value);
    }
    if (numbers_.size() >= least) return true;
    return fail(fmt::format("{} numbers are expected here", least));
  }
  static long whole_number(double value) { return std::abs(value) < 1e15 ? static_cast<long>(value) : 0; }
  [[nodiscard]] long whole(std::size_t k) const { return whole_number(numbers_[k]); }

  bool read_format() {
    if (!next_numbers(3)) return false;
    if (numbers_[1] != 0)
      return fail("this mesh is binary: save it as text, with gmsh FILE.msh -save -bin 0 -o TEXT.msh",
                  Kind::unsupported);
    is_new_ = numbers_[0] == 4.1;
    if (is_new_ || (numbers_[0] >= 2 && numbers_[0] < 3)) return true;
    return fail(
        fmt::format(
            "the version {} of Gmsh's format is not read: 4.1 and 2.2 are; save it with gmsh FILE.msh "
            "-save -format msh41 -o NEW.msh",
            numbers_[0]),
        Kind::unsupported);
  }

  bool read_names() {
    if (!next_numbers(1)) return false;
    for (long left = whole(0); left > 0; --left) {
      if (!lines_.next()) return fail("the file ends within a section");
      const std::string_view line = lines_.line();
      const std::size_t open = line.find('"'), close = line.rfind('"');
      const std::vector<std::string_view> words = words_of(line.substr(0, open));
      if (words.size() < 2 || close <= open)
        return fail("a dimension, a tag and a name in quotes are expected here");
      const std::optional<double> dimension = read_number(words[0]), tag = read_number(words[1]);
      if (dimension && tag)
        names_[{whole_number(*dimension), whole_number(*tag)}] = line.substr(open + 1, close - open - 1);
    }
    return true;
  }

  // Of each entity its first physical group.
  bool read_entities() {
    if (!next_numbers(4)) return false;
    const std::array<long, 4> counts = {whole(0), whole(1), whole(2), whole(3)};
    for (long dimension = 0; dimension < 4; ++dimension)
      for (long left = counts[static_cast<std::size_t>(dimension)]; left > 0; --left) {
        const std::size_t groups = dimension == 0 ? 4 : 7;
        if (!next_numbers(groups + 1)) return false;
        if (whole(groups) > 0 && numbers_.size() > groups + 1)
          group_of_[{dimension, whole(0)}] = whole(groups + 1);
      }
    return true;
  }

  void add_node(long number, std::size_t first) {
    const auto [known, is_new] = nodes_.try_emplace(number, static_cast<std::uint32_t>(mesh_.nodes.size()));
    if (!is_new) return;
    mesh_.nodes.emplace_back(numbers_[first], numbers_[first + 1], numbers_[first + 2]);
    mesh_.node_numbers.push_back(number);
  }

  bool read_nodes() {
    if (!next_numbers(1)) return false;
    for (long left = whole(0); left > 0; --left) {
      if (!next_numbers(4)) return false;
      add_node(whole(0), 1);
    }
    return true;
  }

  bool read_node_blocks() {
    if (!next_numbers(4)) return false;
    for (long blocks = whole(0); blocks > 0; --blocks) {
      if (!next_numbers(4)) return false;
      const long count = whole(3);
      std::vector<long> tags;
      for (long k = 0; k < count; ++k) {
        if (!next_numbers(1)) return false;
        tags.push_back(whole(0));
      }
      for (const long tag : tags) {
        if (!next_numbers(3)) return false;
        add_node(tag, 0);
      }
    }
    return true;
  }

  // The element of a line whose nodes begin at a number.
  bool add_element(long type, long number, std::size_t first, const Entity& region) {
    const std::optional<Shape> shape = shape_of(type);
    if (!shape) return true;
    const std::size_t corners = fem::corner_count(*shape);
    if (numbers_.size() < first + corners) return fail("this element has fewer nodes than its type asks for");
    Read read{{*shape, {}, region_number(region)}, {}, number, lines_.spot()};
    for (std::size_t k = 0; k < corners; ++k) read.nodes[k] = whole(first + k);
    // VTK sees the first triangle of a wedge from the other side.
    if (*shape == Shape::wedge) {
      std::swap(read.nodes[1], read.nodes[2]);
      std::swap(read.nodes[4], read.nodes[5]);
    }
    read_.push_back(read);
    return true;
  }

  std::uint32_t region_number(const Entity& region) {
    const auto [known, is_new] =
        regions_.try_emplace(region, static_cast<std::uint32_t>(mesh_.regions.size()));
    if (is_new) {
      const auto named = names_.find(region);
      mesh_.regions.push_back(named != names_.end() ? named->second
                                                    : fmt::format("region {}", region.second));
    }
    return known->second;
  }

  bool read_elements() {
    if (!next_numbers(1)) return false;
    for (long left = whole(0); left > 0; --left) {
      if (!next_numbers(3)) return false;
      const long type = whole(1), tags = std::max(whole(2), 0L);
      const std::optional<Shape> shape = shape_of(type);
      const long dimension = shape && is_surface(*shape) ? 2 : 3;
      const long group = tags > 0 && numbers_.size() > 3 ? whole(3) : 0;
      if (!add_element(type, whole(0), 3 + static_cast<std::size_t>(tags), {dimension, group})) return false;
    }
    return true;
  }

  bool read_element_blocks() {
    if (!next_numbers(4)) return false;
    for (long blocks = whole(0); blocks > 0; --blocks) {
      if (!next_numbers(4)) return false;
      const Entity entity = {whole(0), whole(1)};
      const long type = whole(2), count = whole(3);
      const auto group = group_of_.find(entity);
      const Entity region = group == group_of_.end() ? entity : Entity{entity.first, group->second};
      for (long k = 0; k < count; ++k) {
        if (!next_numbers(1)) return false;
        if (!add_element(type, whole(0), 1, region)) return false;
      }
    }
    return true;
  }

  // Surfaces beside solids are their skins.
  void leave_out_skins() {
    const auto is_skin = [](const Read& one) { return is_surface(one.element.shape); };
    if (!std::all_of(read_.begin(), read_.end(), is_skin))
      read_.erase(std::remove_if(read_.begin(), read_.end(), is_skin), read_.end());
    // Without the regions that only these have.
    std::vector<std::string> kept;
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (Read& one : read_) {
      const auto [known, is_new] =
          numbers.try_emplace(one.element.region, static_cast<std::uint32_t>(kept.size()));
      if (is_new) kept.push_back(mesh_.regions[one.element.region]);
      one.element.region = known->second;
    }
    mesh_.regions = std::move(kept);
  }

  bool find_nodes() {
    for (Read& one : read_) {
      for (std::size_t k = 0; k < fem::corner_count(one.element.shape); ++k) {
        const auto found = nodes_.find(one.nodes[k]);
        if (found == nodes_.end()) {
          report_.error(one.spot, fmt::format("element {} has the node {}, which the mesh has not",
                                              one.number, one.nodes[k]));
          return false;
        }
        one.element.corners[k] = found->second;
      }
      mesh_.elements.push_back(one.element);
      mesh_.element_numbers.push_back(one.number);
    }
    return true;
  }

  TextReport& report_;
  TextLines lines_;
  FieldMesh mesh_;
  bool is_new_ = true;  // the version 4.1
  std::vector<double> numbers_;
  std::vector<Read> read_;
  std::map<Entity, std::string> names_;  // of physical groups
  std::map<Entity, long> group_of_;      // of entities
  std::map<Entity, std::uint32_t> regions_;
  std::unordered_map<long, std::uint32_t> nodes_;
};

}  // namespace

std::optional<FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [](const Source& text, TextReport& report) { return GmshReader(text, report).read(); });
}

}  // namespace selvage::formats::msh
