#include "formats/vtp/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/number_text.h"
#include "core/text_report.h"

namespace selvage::formats::vtp {

namespace {

using fabric::Measured;
using fabric::MeasuredYarn;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// The numbers of a DataArray, and where each stands.
struct Array {
  std::vector<double> values;
  std::vector<TextPlace> places;
  std::size_t components = 1;
  TextPlace place;
  [[nodiscard]] Vec3 vector(std::size_t i) const {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
};
// By where they stand and their name: "PointData/radius".
using Arrays = std::map<std::string, Array, std::less<>>;

class Reader {
 public:
  Reader(const Source& source, TextReport& report)
      : source_(source), report_(report), text_(source.bytes()) {}

  std::optional<Measured> read() {
    Measured measured;
    while (next_tag()) {
      if (tag_.starts_with("?") || tag_.starts_with("!")) continue;
      if (tag_.starts_with("/")) {
        if (!open_.empty()) open_.pop_back();
        if (tag_ != "/Piece") continue;
        if (!take_piece(measured)) return std::nullopt;
        // The next piece has its own; the names of the yarns stand before all of them.
        std::erase_if(arrays_, [](const auto& array) { return !array.first.starts_with("FieldData/"); });
        continue;
      }
      const std::string_view name = tag_.substr(0, std::min(tag_.find_first_of(" \t\r\n/"), tag_.size()));
      const bool is_whole = tag_.ends_with("/");
      if ((name == "DataArray" || name == "Array") && !is_whole && !read_array()) return std::nullopt;
      if (!is_whole) open_.push_back(name);
    }
    if (measured.yarns.empty() && report_.errors() == 0)
      return refuse({1, 1}, "the file has no line: yarns are the polylines (Lines) of its PolyData");
    return measured;
  }

 private:
  std::nullopt_t refuse(TextPlace place, std::string text) {
    return report_.error(spot_at(source_, place), std::move(text));
  }

  // Leaves the tag behind; its place is kept.
  bool next_tag() {
    move_to(std::min(text_.find('<', at_), text_.size()));
    if (at_ >= text_.size()) return false;
    tag_place_ = here();
    const std::size_t end = text_.find('>', at_);
    if (end == std::string_view::npos) {
      refuse(tag_place_, "this tag is not closed");
      return false;
    }
    tag_ = text_.substr(at_ + 1, end - at_ - 1);
    move_to(end + 1);
    return true;
  }
  void move_to(std::size_t to) {
    for (; at_ < to; ++at_)
      if (text_[at_] == '\n') {
        ++line_;
        line_begin_ = at_ + 1;
      }
  }
  [[nodiscard]] TextPlace here() const { return {line_, static_cast<int>(at_ - line_begin_) + 1}; }

  // Of the tag; empty where it is not there.
  [[nodiscard]] std::string_view attribute(std::string_view name) const {
    const std::string key = fmt::format("{}=", name);
    for (std::size_t i = tag_.find(key); i != std::string_view::npos; i = tag_.find(key, i + 1)) {
      if (i == 0 || !is_blank(tag_[i - 1]) || i + key.size() >= tag_.size()) continue;
      const char quote = tag_[i + key.size()];
      const std::size_t begin = i + key.size() + 1, end = tag_.find(quote, begin);
      if (end != std::string_view::npos) return tag_.substr(begin, end - begin);
    }
    return {};
  }

  bool read_array() {
    if (attribute("format") != "ascii") {
      refuse(tag_place_,
             fmt::format("the array {} has the format {}: only ascii is read (of ParaView's Data Mode: "
                         "Ascii)",
                         in_quotes(attribute("Name")), in_quotes(attribute("format"))));
      return false;
    }
    Array array;
    array.place = tag_place_;
    if (const auto components = read_number(attribute("NumberOfComponents")))
      array.components = *components == 3.0 ? 3 : 1;
    const std::string parent(open_.empty() ? std::string_view() : open_.back());
    const bool is_needed = parent != "Verts" && parent != "Strips" && parent != "Polys";
    const std::size_t end = std::min(text_.find('<', at_), text_.size());
    while (is_needed) {
      std::size_t begin = at_;
      while (begin < end && is_blank(text_[begin])) ++begin;
      move_to(begin);
      if (at_ >= end) break;
      std::size_t stop = at_;
      while (stop < end && !is_blank(text_[stop])) ++stop;
      const std::string_view word = text_.substr(at_, stop - at_);
      const std::optional<double> value = read_number(word);
      if (!value) {
        refuse(here(), fmt::format("{} is not a finite number", in_quotes(word)));
        return false;
      }
      array.places.push_back(here());
      array.values.push_back(*value);
      move_to(stop);
    }
    std::string key = parent == "Points" ? "Points" : fmt::format("{}/{}", parent, attribute("Name"));
    arrays_[std::move(key)] = std::move(array);
    return true;
  }

  const Array* find(std::string_view name) const {
    const auto found = arrays_.find(name);
    return found == arrays_.end() ? nullptr : &found->second;
  }
  // Of each point; null where it is not there. An array of another length is told.
  const Array* of_points(std::string_view name, std::size_t components = 1) {
    const Array* const array = find(fmt::format("PointData/{}", name));
    if (array == nullptr) return nullptr;
    const std::size_t expected = components * (find("Points")->values.size() / 3);
    if (array->values.size() == expected) return array;
    refuse(array->place, fmt::format("the array {} has {} numbers: {} are expected, {} a point",
                                     in_quotes(name), array->values.size(), expected, components));
    return nullptr;
  }

  // The names of the lines, as VTK has strings: their bytes, each followed by a 0.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    const Array* const bytes = find("FieldData/yarn_names");
    if (bytes == nullptr) return names;
    std::string name;
    for (const double byte : bytes->values) {
      if (byte != 0.0) {
        name += static_cast<char>(static_cast<unsigned char>(std::clamp(byte, 0.0, 255.0)));
      } else {
        names.push_back(std::exchange(name, {}));
      }
    }
    return names;
  }

  bool take_piece(Measured& measured) {
    const Array *const points = find("Points"), *const ids = find("Lines/connectivity"),
                       *const offsets = find("Lines/offsets");
    if (points == nullptr || ids == nullptr || offsets == nullptr)
      return refuse(tag_place_, "this piece has no Points, or no Lines with connectivity and offsets"), false;
    if (points->values.size() % 3 != 0)
      return refuse(points->place, "the numbers of the points are no triples"), false;
    const std::size_t count = points->values.size() / 3;
    const Array *const width = of_points("width"), *const height = of_points("height"),
                       *const radius = of_points("radius"), *const angle = of_points("angle"),
                       *const parameter = of_points("parameter"), *const speed = of_points("speed"),
                       *const tangent = of_points("tangent", 3), *const up = of_points("up", 3);
    if (report_.errors() > 0) return false;
    if (names_.empty()) names_ = names();
    const Array* const roles = find("CellData/role");
    std::size_t first = 0;
    for (std::size_t line = 0; line < offsets->values.size(); ++line) {
      const double end = offsets->values[line];
      if (!(end >= static_cast<double>(first) && end <= static_cast<double>(ids->values.size())))
        return refuse(offsets->places[line], "this offset is not among the points of the lines"), false;
      MeasuredYarn yarn;
      yarn.name = line < names_.size() && !names_[line].empty()
                      ? names_[line]
                      : fmt::format("yarn_{}", measured.yarns.size() + 1);
      if (roles != nullptr && line < roles->values.size() && roles->values[line] >= 0.0 &&
          roles->values[line] <= static_cast<double>(fabric::Role::other))
        yarn.role = static_cast<fabric::Role>(static_cast<int>(roles->values[line]));
      for (; first < static_cast<std::size_t>(end); ++first) {
        const double id = ids->values[first];
        if (!(id >= 0.0 && id < static_cast<double>(count)) ||
            id != static_cast<double>(static_cast<std::size_t>(id)))
          return refuse(ids->places[first],
                        fmt::format("there is no point {:g}: the file has {}", id, count)),
                 false;
        const auto i = static_cast<std::size_t>(id);
        yarn.points.push_back(points->vector(i));
        yarn.places.push_back(points->places[3 * i]);
        if (width != nullptr && height != nullptr)
          yarn.sizes.emplace_back(fabric::SizeAt{width->values[i], height->values[i], std::nullopt});
        else if (radius != nullptr)
          yarn.sizes.emplace_back(
              fabric::SizeAt{2.0 * radius->values[i], 2.0 * radius->values[i], std::nullopt});
        if (!yarn.sizes.empty() && !(yarn.sizes.back()->width > 0.0 && yarn.sizes.back()->height > 0.0))
          return refuse(yarn.places.back(), "the section's size at this point has to be larger than 0"),
                 false;
        if (!yarn.sizes.empty() && angle != nullptr) yarn.sizes.back()->angle = angle->values[i];
        if (parameter != nullptr && speed != nullptr && tangent != nullptr) {
          if (!(speed->values[i] > 0.0) ||
              (!yarn.parameters.empty() && parameter->values[i] <= yarn.parameters.back()))
            return refuse(
                       parameter->places[i],
                       "points out of order: parameters increase along a line, and speeds are larger than 0"),
                   false;
          yarn.parameters.push_back(parameter->values[i]);
          yarn.derivatives.push_back(speed->values[i] * tangent->vector(i));
        }
        if (up != nullptr) yarn.ups.push_back(up->vector(i));
      }
      if (yarn.points.empty())
        return refuse(offsets->places[line],
                      fmt::format("the line of yarn {} has no point", in_quotes(yarn.name))),
               false;
      measured.yarns.push_back(std::move(yarn));
    }
    return true;
  }

  const Source& source_;
  TextReport& report_;
  std::string_view text_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
  std::string_view tag_;  // between the angle brackets
  TextPlace tag_place_;
  std::vector<std::string_view> open_;
  Arrays arrays_;
  std::vector<std::string> names_;  // of the lines
};

}  // namespace

std::optional<Measured> read_points(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics,
                  [](const Source& text, TextReport& report) { return Reader(text, report).read(); });
}

}  // namespace selvage::formats::vtp
