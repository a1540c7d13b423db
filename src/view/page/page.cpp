#include "view/page/page.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base64.h"
#include "core/little_endian.h"
#include "core/module.h"
#include "core/source.h"
#include "core/text_buffer.h"
#include "core/words.h"
#include "core/xml_text.h"
#include "view/color_scale.h"
#include "view/page/sources.h"
#include "yarn/role_color.h"

namespace selvage::view::page {

namespace {

using Json = nlohmann::json;

constexpr std::string_view three_file = "three.module.min.js";

}  // namespace

// A function that returns what the file exports: `export{a as Box}` becomes `return{Box:a}`. A page that is
// opened as a file cannot import.
Result<std::string> library() {
  const Result<std::filesystem::path> path = find_worker(std::string(three_file));
  if (!path)
    return error(
        Kind::internal,
        fmt::format("a page needs the library three.js, and this installation was built without it: "
                    "'{}' is neither beside the program nor in '../lib/selvage'; run scripts/setup with "
                    "npm installed and build again, or name a .png file with -o",
                    three_file));
  const Result<Source> source = Source::open(*path);
  if (!source) return source.error();
  const std::string_view text = source->bytes();
  const std::size_t at = text.rfind("export{"), end = at == text.npos ? at : text.find('}', at);
  if (end == text.npos || text.find("</script") != text.npos)
    return error(Kind::internal, fmt::format("'{}' is not the three.js that pages are made for; run "
                                             "scripts/setup and build again",
                                             path->string()));
  std::string module = "const THREE = (() => {\n";
  module += text.substr(0, at);
  module += "return{";
  for (const std::string_view one : split(text.substr(at + 7, end - at - 7), ',')) {
    const std::size_t as = one.find(" as ");
    if (as == one.npos)
      module += one;
    else
      module.append(one.substr(as + 4)).append(":").append(one.substr(0, as));
    module += ',';
  }
  return module + "};\n})();\n";
}

namespace {

Json json_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Json json_of(const yarn::Color& color) {
  return {color.red, color.green, color.blue};
}
Json json_of(const Box3& box) {
  return {json_of(box.min()), json_of(box.max())};
}

// Numbers in bytes: where they begin is told in the JSON text.
class Binary {
 public:
  std::size_t add(std::string_view more) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const std::size_t at = bytes_.size();
    bytes_ += more;
    return at;
  }
  template <class Number>
  std::size_t add(const std::vector<Number>& numbers) {
    std::string more;
    for (const Number number : numbers) append_little_endian(more, number);
    return add(more);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

Json json_of(const Shape& shape, Binary& binary) {
  Json json = {{"thickness", shape.thickness},
               {"step", shape.step},
               {"twisted", shape.is_twisted},
               {"boxes", Json::array()}};
  for (const Box3& box : shape.boxes) json["boxes"].push_back(json_of(box));
  for (const Level& level : shape.levels) {
    Json parts = Json::array();
    for (const Part& part : level.parts) {
      Json row = {binary.add(part.bytes), part.rows};
      if (level.is_tube)
        row.insert(row.end(), {part.has_start, part.has_end, part.origin[0], part.origin[1], part.origin[2]});
      parts.push_back(std::move(row));
    }
    Json around = Json::array();
    if (shape.is_twisted)
      for (const double turns : level.around) around.push_back(static_cast<float>(turns));
    json["levels"].push_back({{"tube", level.is_tube},
                              {"around", std::move(around)},
                              {"chord", level.chord},
                              {"columns", level.columns},
                              {"parts", std::move(parts)}});
  }
  return json;
}

Json yarns_json(const Page& page, Binary& binary) {
  Json json = {{"count", page.yarns.size()}, {"roles", Json::array()}, {"names", Json::array()}};
  for (const yarn::Role role : yarn::all_roles) {
    json["roles"].push_back(name_of(role));
    Json colors = Json::array();  // of every second yarn another one
    for (const std::size_t number : {std::size_t{0}, std::size_t{1}}) {
      const yarn::Color color = yarn::role_color(role, number);
      colors.push_back({color.red, color.green, color.blue});
    }
    json["role_colors"].push_back(std::move(colors));
  }
  std::vector<float> motions, measures;
  std::vector<std::uint32_t> shapes;
  std::vector<std::uint8_t> looks;
  Json threads = Json::array();
  std::vector<std::uint32_t> thread_of;
  std::map<std::string, std::uint32_t> thread_numbers;
  for (const Yarn& yarn : page.yarns) {
    const auto [thread, is_new] =
        thread_numbers.emplace(yarn.label.thread, static_cast<std::uint32_t>(thread_numbers.size()));
    if (is_new) threads.push_back(yarn.label.thread);
    thread_of.push_back(thread->second);
    json["names"].push_back(yarn.label.name);
    // A point of the shape, which is told from its centre, in the page's coordinates.
    const Vec3 offset = yarn.motion(page.shapes[yarn.shape].centre) - page.centre;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        motions.push_back(static_cast<float>(yarn.motion.rotation(row, column)));
      motions.push_back(static_cast<float>(offset[row]));
    }
    measures.push_back(static_cast<float>(yarn.length));
    measures.push_back(static_cast<float>(yarn.volume));
    shapes.push_back(static_cast<std::uint32_t>(yarn.shape));
    for (const int part : {yarn.label.color.red, yarn.label.color.green, yarn.label.color.blue,
                           static_cast<int>(yarn.label.role)})
      looks.push_back(static_cast<std::uint8_t>(part));
  }
  json["threads"] = std::move(threads);
  json["motions"] = binary.add(motions);
  json["measures"] = binary.add(measures);
  json["shape_of"] = binary.add(shapes);
  json["thread_of"] = binary.add(thread_of);
  json["looks"] = binary.add(looks);
  return json;
}

Json contacts_json(const Contacts& contacts) {
  const auto rows = [](const std::vector<Contact>& list) {
    Json json = Json::array();
    for (const Contact& c : list) json.push_back({c.a, c.b, c.gap, c.at.x(), c.at.y(), c.at.z()});
    return json;
  };
  return {{"overlaps", rows(contacts.overlaps)},
          {"overlap_count", contacts.overlap_count},
          {"near", rows(contacts.near)},
          {"near_count", contacts.near_count},
          {"reach", contacts.reach}};
}

Json skin_json(const Skin& skin, Binary& binary) {
  std::vector<float> points;
  std::vector<std::uint32_t> corners;
  for (const Eigen::Vector3f& p : skin.points) points.insert(points.end(), p.begin(), p.end());
  for (const auto& t : skin.triangles) corners.insert(corners.end(), t.begin(), t.end());
  Json json = {{"points", binary.add(points)},
               {"point_count", skin.points.size()},
               {"triangles", binary.add(corners)},
               {"triangle_count", skin.triangles.size()},
               {"region_of", binary.add(skin.region)},
               {"inner", binary.add(skin.inner)},
               {"nodes", skin.nodes},
               {"elements", skin.elements},
               {"scale", Json::array()},
               {"steps", skin.steps},
               {"regions", Json::array()},
               {"fields", Json::array()},
               {"histograms", Json::array()}};
  for (const yarn::Color& color : color_scale) json["scale"].push_back(json_of(color));
  for (const Skin::Region& region : skin.regions)
    json["regions"].push_back(
        {{"name", region.name},
         {"elements", region.elements},
         {"matrix", region.is_matrix},
         {"color",
          json_of(region.is_matrix ? yarn::matrix_color : yarn::hue_color(json["regions"].size()))}});
  for (const Skin::Field& field : skin.fields)
    json["fields"].push_back({{"name", field.name},
                              {"step", field.step},
                              {"of_points", field.of_points},
                              {"components", field.components},
                              {"values", binary.add(field.values)}});
  for (const Skin::Histogram& histogram : skin.histograms)
    json["histograms"].push_back({{"name", histogram.name},
                                  {"low", histogram.low},
                                  {"high", histogram.high},
                                  {"counts", histogram.counts},
                                  {"least", histogram.least},
                                  {"mean", histogram.mean}});
  return json;
}

// As it may stand in a script of HTML: no `<` begins a tag there.
std::string in_script(const Json& json) {
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace), safe;
  for (const char letter : text)
    if (letter == '<')
      safe += "\\u003c";
    else
      safe += letter;
  return safe;
}

std::string base64(std::string_view bytes) {
  std::string text;
  append_base64(text, bytes);
  return text;
}

}  // namespace

void fill(TextBuffer& to, std::string_view text, const std::function<void(std::string_view slot)>& put) {
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t at = rest.find("{{");
    to << rest.substr(0, at);
    if (at == rest.npos) break;
    const std::size_t end = rest.find("}}", at);
    put(rest.substr(at + 2, end - at - 2));
    rest.remove_prefix(end + 2);
  }
}

Status write(const Page& page, std::string_view library, OutputFile& output) {
  Binary binary;
  Json json = {{"selvage", SELVAGE_VERSION},
               {"name", page.name},
               {"title", page.title},
               {"units", name_of(page.units)},
               {"centre", json_of(page.centre)},
               {"box", json_of(page.box)},
               {"shapes", Json::array()},
               {"contacts_note", page.contacts_note},
               {"sheets", Json::parse(page.sheets, nullptr, false)}};
  for (const Shape& shape : page.shapes) json["shapes"].push_back(json_of(shape, binary));
  if (page.skin)
    json["skin"] = skin_json(*page.skin, binary);
  else
    json["yarns"] = yarns_json(page, binary);
  if (page.contacts) json["contacts"] = contacts_json(*page.contacts);

  TextBuffer text(output);
  fill(text, page_html(), [&](std::string_view slot) {
    if (slot == "name")
      text << xml_text(page.title.empty() ? page.name : page.title);
    else if (slot == "css")
      text << palette_css() << page_css();
    else if (slot == "picture")
      text << (page.picture.empty() ? "" : "data:image/png;base64,") << base64(page.picture);
    else if (slot == "data")
      text << in_script(json);
    else if (slot == "binary")
      text << base64(binary.bytes());
    else if (slot == "three")
      text << library;
    else if (slot == "scripts")
      for (const std::string_view script : scripts()) text << script;
  });
  return text.finish();
}

}  // namespace selvage::view::page
