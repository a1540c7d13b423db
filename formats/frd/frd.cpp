#include <fmt/format.h>

#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/number_text.h"
#include "core/text_lines.h"
#include "core/text_report.h"
#include "core/words.h"
#include "formats/registry.h"

namespace selvage::formats::frd {

namespace {

using fem::FieldMesh;
using Shape = FieldMesh::Shape;

std::string_view columns(std::string_view line, std::size_t from, std::size_t count) {
  return from < line.size() ? line.substr(from, count) : std::string_view();
}

std::optional<long> whole(std::string_view text) {
  text = trimmed(text);
  long value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failure == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// Of an element's type: its shape, all its nodes, and where its corners stand among them.
struct Type {
  std::optional<Shape> shape;
  std::size_t nodes = 0;
};
Type type_of(long number) {
  switch (number) {
    case 1:
      return {Shape::hexahedron, 8};
    case 2:
      return {Shape::wedge, 6};
    case 3:
      return {Shape::tetrahedron, 4};
    case 4:
      return {Shape::hexahedron, 20};
    case 5:
      return {Shape::wedge, 15};
    case 6:
      return {Shape::tetrahedron, 10};
    case 7:
      return {Shape::triangle, 3};
    case 8:
      return {Shape::triangle, 6};
    case 9:
      return {Shape::quadrilateral, 4};
    case 10:
      return {Shape::quadrilateral, 8};
    case 11:
      return {std::nullopt, 2};
    case 12:
      return {std::nullopt, 3};
    default:
      return {};
  }
}

constexpr int most_components = 64;

class Reader {
 public:
  Reader(const Source& source, TextReport& report)
      : report_(report), lines_(source.bytes()), size_(source.bytes().size()) {}

  std::optional<FieldMesh> read() {
    while (lines_.next()) {
      const std::string_view key = columns(lines_.line(), 0, 6);
      if (key == "    1U" && columns(lines_.line(), 6, 3) == "MAT") name_material();
      if (key == "    2C" && !read_nodes()) return std::nullopt;
      if (key == "    3C" && !read_elements()) return std::nullopt;
      if (columns(lines_.line(), 4, 6) == "1PSTEP") note_step();
      if (key == "  100C" && !read_results()) return std::nullopt;
      if (trimmed(lines_.line()) == "9999") break;
    }
    if (mesh_.elements.empty()) return refuse(0, "the file has no element that is a surface or a solid");
    if (left_out_ > 0)
      report_.warning(
          lines_.spot(0),
          fmt::format("{} neither surfaces nor solids: left out",
                      left_out_ == 1 ? "1 element is" : fmt::format("{} elements are", left_out_)));
    mesh_.regions.resize(region_of_.size());
    for (const auto& [material, region] : region_of_) {
      const auto name = materials_.find(material);
      mesh_.regions[region] = name != materials_.end() ? name->second : fmt::format("material {}", material);
    }
    return std::move(mesh_);
  }

 private:
  std::nullopt_t refuse(std::size_t column, std::string text, Kind kind = Kind::malformed) {
    return report_.error(lines_.spot(column), std::move(text), kind);
  }
  bool fail(std::size_t column, std::string text, Kind kind = Kind::malformed) {
    refuse(column, std::move(text), kind);
    return false;
  }
  std::optional<double> real(std::size_t from, std::size_t count) {
    const std::string_view word = trimmed(columns(lines_.line(), from, count));
    // CalculiX writes what is not computed as such a word.
    if (same_word(word, "nan") || same_word(word, "-nan")) return std::numeric_limits<double>::quiet_NaN();
    const std::optional<double> value = read_number(word);
    if (!value) refuse(from, fmt::format("{} is not a finite number", in_quotes(word)));
    return value;
  }

  void name_material() {
    const std::string_view rest = columns(lines_.line(), 9, lines_.line().size());
    const std::size_t digits = rest.find_first_of("0123456789");
    if (digits == std::string_view::npos) return;
    // The number has five columns, and the name follows at once.
    const std::optional<long> number = whole(rest.substr(0, 5));
    if (number) materials_[*number] = std::string(trimmed(columns(rest, 5, 80)));
  }

  // The columns of a number of a node; none in a block of bytes.
  std::optional<std::size_t> width_of_numbers(std::string_view format) {
    const std::string_view word = trimmed(format);
    if (word == "0") return 5;
    if (word == "1" || word.empty()) return 10;
    refuse(0, "this block is binary: only ASCII is read (a deck without OUTPUT=BINARY has it)",
           Kind::unsupported);
    return std::nullopt;
  }

  bool read_nodes() {
    if (!mesh_.fields.empty()) return fail(0, "nodes behind results, which have a value for each node");
    const std::optional<std::size_t> width = width_of_numbers(columns(lines_.line(), 73, 2));
    if (!width) return false;
    while (lines_.next() && columns(lines_.line(), 0, 3) != " -3") {
      const std::optional<long> number = whole(columns(lines_.line(), 3, *width));
      if (columns(lines_.line(), 0, 3) != " -1" || !number)
        return fail(0, "a node is expected here, as ' -1', its number and its place");
      Vec3 place;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::optional<double> x = real(3 + *width + 12 * k, 12);
        if (!x) return false;
        place[static_cast<Eigen::Index>(k)] = *x;
      }
      if (!place.allFinite()) return fail(3, "the place of this node is not finite");
      nodes_.try_emplace(*number, static_cast<std::uint32_t>(mesh_.nodes.size()));
      mesh_.node_numbers.push_back(*number);
      mesh_.nodes.push_back(place);
    }
    return true;
  }

  bool read_elements() {
    const std::optional<std::size_t> width = width_of_numbers(columns(lines_.line(), 73, 2));
    if (!width) return false;
    Type type;
    std::uint32_t region = 0;
    long element = 0;
    std::vector<long> numbers;
    while (lines_.next() && columns(lines_.line(), 0, 3) != " -3") {
      const std::string_view key = columns(lines_.line(), 0, 3);
      if (key == " -1") {
        const std::optional<long> kind = whole(columns(lines_.line(), 3 + *width, 5));
        type = type_of(kind.value_or(0));
        if (type.nodes == 0) return fail(3 + *width, "an element of a type that is not known (1 to 12 are)");
        const long material = whole(columns(lines_.line(), 13 + *width, 5)).value_or(0);
        region =
            region_of_.try_emplace(material, static_cast<std::uint32_t>(region_of_.size())).first->second;
        element = whole(columns(lines_.line(), 3, *width)).value_or(0);
        numbers.clear();
        continue;
      }
      if (key != " -2" || type.nodes == 0)
        return fail(0, "the nodes of an element are expected here, as ' -2' and their numbers");
      for (std::size_t at = 3; at < lines_.line().size() && numbers.size() < type.nodes; at += *width) {
        const std::string_view word = trimmed(columns(lines_.line(), at, *width));
        if (word.empty()) break;
        const std::optional<long> number = whole(word);
        if (!number || !nodes_.contains(*number))
          return fail(at, fmt::format("there is no node {}", in_quotes(word)));
        numbers.push_back(*number);
      }
      if (numbers.size() == type.nodes) {
        take_element(type, region, element, numbers);
        type = {};
      }
    }
    return true;
  }

  void take_element(const Type& type, std::uint32_t region, long number, const std::vector<long>& numbers) {
    if (!type.shape) {
      ++left_out_;
      return;
    }
    FieldMesh::Element element{*type.shape, {}, region};
    for (std::size_t k = 0; k < fem::corner_count(*type.shape); ++k)
      element.corners[k] = nodes_.at(numbers[k]);
    // Its first triangle is seen counter-clockwise from the second; VTK's the other way.
    if (type.shape == Shape::wedge) {
      std::swap(element.corners[1], element.corners[2]);
      std::swap(element.corners[4], element.corners[5]);
    }
    mesh_.elements.push_back(element);
    mesh_.element_numbers.push_back(number);
  }

  // Of the results that follow: the step, and which increment of it.
  void note_step() {
    increment_ = whole(columns(lines_.line(), 36, 12)).value_or(1);
    step_ = whole(columns(lines_.line(), 48, 12)).value_or(0);
  }

  // Results of one number belong together; from 1 in the order of the file.
  int set_of(long number) {
    const auto [known, is_new] = set_of_.try_emplace(number, static_cast<int>(set_of_.size()) + 1);
    if (is_new)
      mesh_.steps.push_back(increment_ > 1 ? fmt::format("step {}, increment {}", step_, increment_)
                                           : fmt::format("step {}", step_ > 0 ? step_ : number));
    return known->second;
  }

  bool read_results() {
    const std::optional<std::size_t> width = width_of_numbers(columns(lines_.line(), 73, 2));
    if (!width) return false;
    const int set = set_of(whole(columns(lines_.line(), 58, 5)).value_or(1));
    FieldMesh::Field field;
    field.step = set;
    field.components = 0;
    while (lines_.next() && columns(lines_.line(), 0, 3) != " -3") {
      const std::string_view key = columns(lines_.line(), 0, 3);
      if (key == " -1" && !read_values(field, *width)) return false;
      if ((key == " -4" || key == " -5") && !read_layout(field, key == " -4")) return false;
    }
    if (!field.values.empty()) mesh_.fields.push_back(std::move(field));
    return true;
  }

  // The name of a result, or one of its components. Those that are computed from others come last and have no
  // values.
  bool read_layout(FieldMesh::Field& field, bool is_name) {
    if (!field.values.empty())
      return fail(0, "the components of a result stand before the values of its first node");
    if (is_name) field.name = std::string(trimmed(columns(lines_.line(), 5, 8)));
    if (is_name || trimmed(columns(lines_.line(), 33, 5)).starts_with('1')) return true;
    if (++field.components <= most_components) return true;
    return fail(0, fmt::format("a result has at most {} components", most_components), Kind::limit);
  }

  // Those of the node of this line. Nodes without a line have NaN.
  bool read_values(FieldMesh::Field& field, std::size_t width) {
    const std::optional<long> number = whole(columns(lines_.line(), 3, width));
    const auto node = number ? nodes_.find(*number) : nodes_.end();
    if (node == nodes_.end()) return fail(3, "values of a node that is not there");
    const auto count = static_cast<std::size_t>(field.components);
    if (field.values.empty()) {
      values_ += count * mesh_.nodes.size();
      if (values_ > most_values())
        return fail(0,
                    fmt::format("results of few of many nodes: with a value for each node they are {}, and a "
                                "file of this size may have {}; let the solver write results of all nodes",
                                values_, most_values()),
                    Kind::limit);
      field.values.resize(count * mesh_.nodes.size(), std::numeric_limits<float>::quiet_NaN());
    }
    for (std::size_t k = 0; k < count; ++k) {
      // Six a line; others follow in lines of their own.
      if (k > 0 && k % 6 == 0 && !(lines_.next() && columns(lines_.line(), 0, 3) == " -2"))
        return fail(0, "more values of this node are expected here");
      const std::optional<double> value = real(3 + width + 12 * (k % 6), 12);
      if (!value) return false;
      field.values[node->second * count + k] = static_cast<float>(*value);
    }
    return true;
  }

  // Twelve bytes a value are usual.
  [[nodiscard]] std::size_t most_values() const { return 1'000'000 + 8 * size_; }

  TextReport& report_;
  TextLines lines_;
  std::size_t size_;        // of the file, bytes
  std::size_t values_ = 0;  // of all fields
  std::unordered_map<long, std::uint32_t> nodes_;
  std::map<long, std::uint32_t> region_of_;
  std::map<long, std::string> materials_;
  std::map<long, int> set_of_;
  long step_ = 0, increment_ = 1;
  FieldMesh mesh_;
  std::size_t left_out_ = 0;
};

std::optional<FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [](const Source& text, TextReport& report) { return Reader(text, report).read(); });
}

bool looks_like_frd(std::string_view head) {
  const std::size_t line = head.find('\n');
  return head.starts_with("    1C") && line != std::string_view::npos && head.substr(line + 1, 6) == "    1U";
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "frd",
                                  .title = "Results of CalculiX: a mesh with fields, to be seen",
                                  .extensions = {".frd"},
                                  .sniff = looks_like_frd,
                                  .read_mesh = read_mesh};
  return self;
}

}  // namespace selvage::formats::frd
