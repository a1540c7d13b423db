#include "formats/vtu/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/number_text.h"
#include "core/text_report.h"
#include "core/words.h"
#include "formats/vtu/decoding.h"

namespace selvage::formats::vtu {

namespace {

using fem::FieldMesh;
using Shape = FieldMesh::Shape;

struct Array {
  std::string name;
  std::size_t components = 1;
  std::vector<double> values;
  std::size_t at = 0;  // of its tag, in the text
};

// A tag, and where it begins and what follows it does.
struct Tag {
  std::string_view text;  // between the angle brackets
  std::size_t at = 0, end = 0;
  [[nodiscard]] std::string_view name() const {
    return text.substr(0, std::min(text.find_first_of(" \t\r\n/", 1), text.size()));
  }
  // Empty where it is not there.
  [[nodiscard]] std::string_view attribute(std::string_view key) const {
    for (std::size_t i = text.find(key); i != std::string_view::npos; i = text.find(key, i + 1)) {
      const std::size_t quote = i + key.size() + 1;
      if (i == 0 || text.find_first_of(" \t\r\n", i - 1) != i - 1 || quote >= text.size() ||
          text[quote - 1] != '=')
        continue;
      const std::size_t close = text.find(text[quote], quote + 1);
      if (close != std::string_view::npos) return text.substr(quote + 1, close - quote - 1);
    }
    return {};
  }
};

std::optional<Shape> shape_of(int type) {
  switch (type) {
    case 5:   // the ones of first order
    case 22:  // of second order, whose corners come first, too
    case 69:  // and of any
      return Shape::triangle;
    case 9:
    case 23:
    case 28:
    case 70:
      return Shape::quadrilateral;
    case 10:
    case 24:
    case 71:
      return Shape::tetrahedron;
    case 11:
    case 12:
    case 25:
    case 29:
    case 72:
      return Shape::hexahedron;
    case 13:
    case 26:
    case 31:
    case 32:
    case 73:
      return Shape::wedge;
    case 14:
    case 27:
    case 37:
    case 74:
      return Shape::pyramid;
    default:
      return std::nullopt;
  }
}

// The nearest whole number; of what is none (nan, far too large) the nearest that counts something.
long long whole_number(double value) {
  return std::isnan(value) ? 0 : std::llround(std::clamp(value, -1e9, 1e9));
}

class Reader {
 public:
  Reader(const Source& source, TextReport& report)
      : report_(report), text_(source.bytes()), budget_(text_.size()) {}

  std::optional<FieldMesh> read() {
    find_appended();
    for (std::size_t at = 0; const std::optional<Tag> tag = next(at);) {
      at = tag->end;
      if (tag->text.starts_with("!--")) {
        note_name(tag->text);
        continue;
      }
      const std::string_view name = tag->name();
      if (name == "VTKFile" && !take_coding(*tag)) return std::nullopt;
      if (name == "AppendedData") break;
      if (name == "Points" || name == "Cells" || name == "PointData" || name == "CellData") within_ = name;
      if (name == "DataArray" && !within_.empty() && !take_array(*tag)) return std::nullopt;
      if (name == "/Piece" && !take_piece(tag->at)) return std::nullopt;
      if (name.starts_with("/") && name.substr(1) == within_) within_ = {};
    }
    if (mesh_.elements.empty()) return refuse(0, "the file has no cell that is a surface or a solid");
    if (left_out_ > 0)
      report_.warning(spot(0),
                      fmt::format("{} neither surfaces nor solids: left out",
                                  left_out_ == 1 ? "1 cell is" : fmt::format("{} cells are", left_out_)));
    name_regions();
    return std::move(mesh_);
  }

 private:
  // Places are counted only for messages: bytes of an array may be hundreds of millions.
  [[nodiscard]] Spot spot(std::size_t at) const {
    const std::string_view before = text_.substr(0, at);
    const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    const auto lines = std::count(before.begin(), before.end(), '\n');
    return Spot{line_begin, 1 + static_cast<int>(lines), 1}.behind(at - line_begin);
  }
  std::nullopt_t refuse(std::size_t at, std::string text, Kind kind = Kind::malformed) {
    return report_.error(spot(at), std::move(text), kind);
  }
  bool fail(std::size_t at, std::string text, Kind kind = Kind::malformed) {
    refuse(at, std::move(text), kind);
    return false;
  }

  [[nodiscard]] std::optional<Tag> next(std::size_t from) const {
    const std::size_t at = text_.find('<', from);
    if (at == std::string_view::npos) return std::nullopt;
    const bool is_comment = text_.substr(at, 4) == "<!--";
    const std::size_t end = is_comment ? text_.find("-->", at) : text_.find('>', at);
    if (end == std::string_view::npos) return std::nullopt;
    return Tag{text_.substr(at + 1, end - at - 1), at, end + (is_comment ? 3 : 1)};
  }

  void find_appended() {
    const std::size_t tag = text_.find("<AppendedData");
    if (tag == std::string_view::npos) return;
    const std::size_t end = text_.find('>', tag), begin = text_.find('_', end);
    if (end == std::string_view::npos || begin == std::string_view::npos) return;
    appended_is_base64_ = text_.substr(tag, end - tag).find("base64") != std::string_view::npos;
    appended_ = text_.substr(begin + 1);
  }

  bool take_coding(const Tag& tag) {
    if (tag.attribute("type") != "UnstructuredGrid")
      return fail(tag.at,
                  fmt::format("VTK data of the type {} are no mesh: an UnstructuredGrid is",
                              in_quotes(tag.attribute("type"))),
                  Kind::unsupported);
    coding_.is_big_endian = tag.attribute("byte_order") == "BigEndian";
    coding_.has_long_heads = tag.attribute("header_type") == "UInt64";
    const std::string_view compressor = tag.attribute("compressor");
    coding_.is_compressed = !compressor.empty();
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      return fail(tag.at,
                  fmt::format("data compressed by {} are not read: write them with zlib, or without "
                              "compression",
                              in_quotes(compressor)),
                  Kind::unsupported);
    return true;
  }

  // "yarn 3: NAME", as this program's own files have them.
  void note_name(std::string_view comment) {
    comment.remove_prefix(3);
    const std::size_t word = comment.find("yarn "), colon = comment.find(':');
    if (word == std::string_view::npos || colon == std::string_view::npos || colon < word + 5) return;
    const std::optional<double> number = read_number(comment.substr(word + 5, colon - word - 5));
    if (!number) return;
    std::string_view name = comment.substr(colon + 1);
    if (name.starts_with(' ')) name.remove_prefix(1);
    if (name.ends_with(' ')) name.remove_suffix(1);
    names_[whole_number(*number)] = std::string(name);
  }

  bool take_array(const Tag& tag) {
    const std::string_view format = tag.attribute("format"), type = tag.attribute("type");
    if (type == "String") return true;
    Array array;
    array.at = tag.at;
    array.name = tag.attribute("Name");
    if (const auto count = read_number(tag.attribute("NumberOfComponents")))
      array.components = *count >= 1.0 && *count <= 64.0 ? static_cast<std::size_t>(*count) : 1;
    const std::string_view inside = text_.substr(tag.end, text_.find('<', tag.end) - tag.end);
    Result<std::vector<double>> values = std::vector<double>();
    if (format == "ascii") {
      values = decode_words(inside);
    } else if (format == "binary") {
      values = decode(inside.substr(std::min(inside.find_first_not_of(" \t\r\n"), inside.size())), true, type,
                      coding_, budget_);
    } else {
      const std::optional<double> offset = read_number(tag.attribute("offset"));
      if (!offset || !(*offset >= 0.0) || *offset > static_cast<double>(appended_.size()))
        return fail(tag.at,
                    fmt::format("the array {} has no place among the appended data", in_quotes(array.name)));
      values = decode(appended_.substr(static_cast<std::size_t>(*offset)), appended_is_base64_, type, coding_,
                      budget_);
    }
    if (!values)
      return fail(tag.at, fmt::format("the array {}: {}", in_quotes(array.name), values.error().text),
                  values.error().kind);
    array.values = std::move(*values);
    arrays_[fmt::format("{}/{}", within_, within_ == "Points" ? std::string_view() : array.name)] =
        std::move(array);
    return true;
  }

  const Array* find(const std::string& key) const {
    const auto found = arrays_.find(key);
    return found == arrays_.end() ? nullptr : &found->second;
  }

  bool take_piece(std::size_t at) {
    const Array *const points = find("Points/"), *const ids = find("Cells/connectivity"),
                       *const offsets = find("Cells/offsets"), *const types = find("Cells/types");
    if (points == nullptr || ids == nullptr || offsets == nullptr || types == nullptr)
      return fail(at, "this piece has no Points, or no Cells with connectivity, offsets and types");
    if (points->values.size() % 3 != 0) return fail(points->at, "the numbers of the points are no triples");
    if (types->values.size() != offsets->values.size())
      return fail(types->at, "there are not as many types as offsets of cells");
    const std::size_t first_node = mesh_.nodes.size(), count = points->values.size() / 3;
    for (std::size_t k = 0; k < count; ++k) {
      mesh_.nodes.emplace_back(points->values[3 * k], points->values[3 * k + 1], points->values[3 * k + 2]);
      if (!mesh_.nodes.back().allFinite())
        return fail(points->at, fmt::format("the point {} is not finite", k));
    }
    std::vector<std::size_t> kept;
    double begin = 0;
    for (std::size_t cell = 0; cell < offsets->values.size(); ++cell) {
      const double end = offsets->values[cell];
      if (!(end >= begin && end <= static_cast<double>(ids->values.size())))
        return fail(offsets->at, fmt::format("the offset of cell {} is not among its points", cell));
      const auto first = static_cast<std::size_t>(std::exchange(begin, end));
      const auto type = static_cast<int>(whole_number(types->values[cell]));
      const std::optional<Shape> shape = shape_of(type);
      if (!shape) {
        ++left_out_;
        continue;
      }
      FieldMesh::Element element{*shape, {}, 0};
      const std::size_t corners = fem::corner_count(*shape);
      if (first + corners > static_cast<std::size_t>(end))
        return fail(ids->at, fmt::format("cell {} has fewer points than its type asks for", cell));
      for (std::size_t k = 0; k < corners; ++k) {
        const double id = ids->values[first + k];
        if (!(id >= 0.0 && id < static_cast<double>(count)))
          return fail(ids->at, fmt::format("there is no point {:g}: the piece has {}", id, count));
        element.corners[k] = static_cast<std::uint32_t>(first_node + static_cast<std::size_t>(id));
      }
      if (type == 11) {  // a voxel goes row by row
        std::swap(element.corners[2], element.corners[3]);
        std::swap(element.corners[6], element.corners[7]);
      }
      kept.push_back(cell);
      mesh_.elements.push_back(element);
    }
    take_regions(kept);
    Status fits = take_fields("PointData", true, first_node, count, {});
    if (fits)
      fits =
          take_fields("CellData", false, mesh_.elements.size() - kept.size(), offsets->values.size(), kept);
    if (fits) fits = fill_fields();
    arrays_.clear();
    return fits || fail(at, fmt::format("fields that few pieces have: {}", fits.error().text), Kind::limit);
  }

  // By the number of the yarn, as this program writes it, or of the material.
  void take_regions(const std::vector<std::size_t>& kept) {
    const Array* number = nullptr;
    for (const char* const key : {"CellData/yarn", "CellData/material", "CellData/region"})
      if (number == nullptr) number = find(key);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const double value =
          number != nullptr && kept[k] < number->values.size() ? number->values[kept[k]] : 0.0;
      const long long key = number == nullptr ? 0 : whole_number(value);
      const auto [known, is_new] = region_of_.try_emplace(key, static_cast<std::uint32_t>(region_of_.size()));
      mesh_.elements[mesh_.elements.size() - kept.size() + k].region = known->second;
    }
    if (number != nullptr) region_word_ = number->name;
  }

  void name_regions() {
    mesh_.regions.resize(region_of_.size());
    for (const auto& [number, region] : region_of_) {
      const auto named = names_.find(number);
      mesh_.regions[region] = region_word_.empty()                   ? "mesh"
                              : region_word_ == "yarn" && number < 0 ? "matrix"
                              : region_word_ == "yarn" && named != names_.end()
                                  ? named->second
                                  : fmt::format("{} {}", region_word_, number);
    }
  }

  // What is there of numbers of each point or cell. A field that a later piece has not is 0 there, and so is
  // one in the pieces before its first.
  Status take_fields(std::string_view where, bool of_nodes, std::size_t first, std::size_t count,
                     const std::vector<std::size_t>& kept) {
    const std::string prefix = fmt::format("{}/", where);
    for (const auto& [key, array] : arrays_) {
      if (!key.starts_with(prefix) || array.values.size() != count * array.components) continue;
      if (!of_nodes && array.name == region_word_) continue;
      auto field =
          std::find_if(mesh_.fields.begin(), mesh_.fields.end(), [&, &wanted = array](const auto& known) {
            return known.name == wanted.name && known.of_nodes == of_nodes;
          });
      if (field == mesh_.fields.end())
        field = mesh_.fields.insert(field, {array.name, of_nodes, static_cast<int>(array.components), {}, 0});
      if (field->components != static_cast<int>(array.components)) continue;
      if (field->values.empty())
        if (Status fits = budget_.take(first * array.components); !fits) return fits;
      field->values.resize(first * array.components);
      const std::size_t rows = of_nodes ? count : kept.size();
      for (std::size_t k = 0; k < rows; ++k)
        for (std::size_t c = 0; c < array.components; ++c)
          field->values.push_back(
              static_cast<float>(array.values[(of_nodes ? k : kept[k]) * array.components + c]));
    }
    return {};
  }

  // Each has values of all nodes or elements.
  Status fill_fields() {
    for (FieldMesh::Field& field : mesh_.fields) {
      const std::size_t size = static_cast<std::size_t>(field.components) *
                               (field.of_nodes ? mesh_.nodes.size() : mesh_.elements.size());
      if (Status fits = budget_.take(size - field.values.size()); !fits) return fits;
      field.values.resize(size);
    }
    return {};
  }

  TextReport& report_;
  std::string_view text_, within_, appended_;
  bool appended_is_base64_ = false;
  Coding coding_;
  NumberBudget budget_;
  std::map<std::string, Array> arrays_;  // of this piece
  std::map<long long, std::string> names_;
  std::map<long long, std::uint32_t> region_of_;
  std::string region_word_;
  FieldMesh mesh_;
  std::size_t left_out_ = 0;
};

}  // namespace

std::optional<FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [](const Source& text, TextReport& report) { return Reader(text, report).read(); });
}

}  // namespace selvage::formats::vtu
