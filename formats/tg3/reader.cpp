#include "formats/tg3/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/bounds.h"
#include "core/rounding.h"
#include "core/words.h"
#include "formats/tg3/construction.h"
#include "formats/tg3/lay.h"
#include "formats/tg3/properties.h"
#include "formats/tg3/yarn_reader.h"

namespace selvage::formats::tg3 {

namespace {

// Nothing but the yarns' points that TexGen computes from the rest makes a file as large as this.
constexpr std::size_t most_bytes = std::size_t{256} << 20U;

// What TexGen computes from the rest, and how it is to mesh it.
constexpr std::array<std::string_view, 8> computed = {
    "SlaveNode", "SectionAABB", "SectionLength", "SectionMesh", "EdgePoint", "Mesh", "Layer", "Offset"};

// What each element may hold that is read, or that says nothing of the geometry.
const std::map<std::string_view, std::set<std::string_view>>& known_elements() {
  static const std::map<std::string_view, std::set<std::string_view>> known = {
      {"TexGenModel", {"Textile", "Domain"}},
      {"Textile", {"Domain", "Yarn", "PatternCell", "XYarnData", "YYarnData", "XYarns", "YYarns"}},
      {"Yarn", {"Interpolation", "YarnSection", "FibreDistribution", "Repeat", "MasterNode"}},
      {"YarnSection", {"Section", "NodeSection", "PositionSection", "Adjustment", "YarnSection"}},
      {"NodeSection", {"Section", "MidNodeSection"}},
      {"MidNodeSection", {"Section"}},
      {"PositionSection", {"Section"}},
      {"Section", {"Section", "Division", "PolygonPoint", "BezierPoint"}},
      {"Interpolation", {"Interpolation", "Adjustment"}},
      {"Adjustment", {"AdjustmentSection"}},
      {"AdjustmentSection", {"AdjustmentPerimeter"}}};
  return known;
}

std::size_t num_control_points(const fabric::Fabric& fabric) {
  std::size_t count = 0;
  for (const fabric::Item& item : fabric.items)
    if (const auto* const yarn = std::get_if<fabric::Yarn>(&item))
      if (const auto* const grid = std::get_if<fabric::Grid>(&yarn->shape)) count += grid->points.size();
  return count;
}

constexpr double usual_tolerance = 1e-3;      // of the smallest size of the sections, as of tubes
constexpr std::size_t bytes_a_point = 200;    // as IGES, about
constexpr double most_times = 10;             // the bytes of the file
constexpr std::size_t small_bytes = 8 << 20;  // of which there is nothing to say

class Reader {
 public:
  Reader(const Source& source, double tolerance, TextReport& report)
      : source_(source), tolerance_(tolerance), fields_(source, report), properties_(fields_, fabric_) {
    fabric_.file = source.name();
  }

  std::optional<fabric::Fabric> read(const Element& model) {
    if (!check_version(model)) return std::nullopt;
    warn_of_unknown(model);
    const Element* textile = nullptr;
    for (const Element& child : model.children) {
      if (child.name != "Textile") continue;
      if (textile == nullptr)
        textile = &child;
      else
        fields_.warning(child, fmt::format("the textile {} is left out: the first one of a file is read, {}",
                                           in_quotes(fields_.text(child, "name")),
                                           in_quotes(fields_.text(*textile, "name"))));
    }
    if (textile == nullptr) {
      fields_.error(model, "the model has no <Textile>");
      return std::nullopt;
    }
    read_textile(*textile, model);
    if (fields_.errors() > 0) return std::nullopt;
    return std::move(fabric_);
  }

 private:
  bool check_version(const Element& model) {
    if (model.name != "TexGenModel") {
      fields_.error(model, fmt::format("the file is a {}, not a TexGenModel", in_quotes(model.name)));
      return false;
    }
    const std::string_view version = fields_.text(model, "version");
    if (version.starts_with("3.")) return true;
    fields_.error(
        model,
        fmt::format(
            "the model has the version {}: 3 is read (of TexGen 3.0 to 3.13); save it with one of these",
            in_quotes(version)),
        Kind::unsupported);
    return false;
  }

  // Once for each name.
  void warn_of_unknown(const Element& element) {
    const auto known = known_elements().find(element.name);
    if (known == known_elements().end()) return;
    for (const Element& child : element.children) {
      if (known->second.contains(child.name))
        warn_of_unknown(child);
      else if (warned_.insert(child.name).second)
        fields_.warning(child,
                        fmt::format("<{}> in <{}> is not known, and left out", child.name, element.name));
    }
  }

  void read_unit(const Element& element) {
    fabric_.units_given = true;
    const std::string_view word =
        element.attribute("GeometryScale") != nullptr ? fields_.text(element, "GeometryScale") : "mm";
    for (const Unit unit : all_units)
      if (name_of(unit) == word) {
        fabric_.units = unit;
        return;
      }
    fields_.error(element,
                  fmt::format("the GeometryScale {} is not known: m, cm, mm, um or inch", in_quotes(word)));
  }

  void read_textile(const Element& element, const Element& model) {
    read_unit(element);
    if (const std::string_view name = fields_.text(element, "name"); !name.empty()) fabric_.title = name;
    const Element* const domain =
        element.child("Domain") != nullptr ? element.child("Domain") : model.child("Domain");
    Textile textile;
    if (domain != nullptr) textile.domain = read_domain(*domain, fields_);
    const bool has_yarns = element.child("Yarn") != nullptr;
    if (has_yarns)
      read_yarns(element, textile);
    else if (std::optional<std::vector<TextileYarn>> built = construct(element, fields_)) {
      const std::string thread = properties_.thread_of(element, element);
      textile.yarns = std::move(*built);
      for (TextileYarn& yarn : textile.yarns) yarn.thread = thread;
    }
    if (fields_.errors() > 0) return;
    if (textile.domain) {
      fabric_.cell = cell_of(*textile.domain);
      if (fabric_.cell) fabric_.cell->matrix = properties_.matrix_of(element);
    } else if (domain == nullptr) {
      fields_.note(element, "the textile has no domain: each yarn stands there once");
    }
    for (const TextileYarn& yarn : textile.yarns) {
      if (fields_.is_full()) return;
      fields_.set_yarn(yarn.name);
      lay(yarn, textile.domain, 0, fields_, fabric_);
    }
    fields_.set_yarn({});
    fit(element, textile);
    if (fabric_.items.empty() && fields_.errors() == 0)
      fields_.error(element, "the textile has no yarn in its domain");
    fabric_.tell_threads_their_materials();
  }

  struct Fitted {
    fabric::Fabric fabric;
    double deviation = 0;  // from the sections, file units
    std::size_t control_points = 0;
  };
  // The yarns within a tolerance. Nothing: it has an error that the exact ones have not.
  [[nodiscard]] std::optional<Fitted> fitted(const Textile& textile, double tolerance) const {
    TextReport said(source_);  // warnings, too: by the exact ones
    const Fields silent(source_, said);
    Fitted made;
    for (const TextileYarn& yarn : textile.yarns)
      made.deviation = std::max(made.deviation, lay(yarn, textile.domain, tolerance, silent, made.fabric));
    if (said.errors() > 0) return std::nullopt;
    made.control_points = num_control_points(made.fabric);
    return made;
  }

  // How large IGES is that has these, in bytes of this file, about.
  [[nodiscard]] double growth(std::size_t control_points) const {
    return static_cast<double>(bytes_a_point * control_points) / static_cast<double>(source_.bytes().size());
  }

  // The words that say with which --tolerance the surfaces get as small as they should be.
  [[nodiscard]] std::string smaller(const Textile& textile, const Fitted& present, double tolerance,
                                    double thinnest) const {
    if (growth(present.control_points) <= most_times) return "";
    for (int doubled = 1; std::ldexp(tolerance, doubled) <= 0.1 * thinnest; ++doubled) {
      const double given = rounded_down(std::ldexp(tolerance, doubled));
      const std::optional<Fitted> next = fitted(textile, given);
      if (next && growth(next->control_points) <= most_times)
        return fmt::format("; --tolerance {:.3g} gives {:.3g} times", given, growth(next->control_points));
    }
    return fmt::format("; no --tolerance up to a tenth of the thinnest section gives {:.3g} times",
                       most_times);
  }

  // Surfaces are laid within the tolerance that was given, and those that would be far larger than the file
  // within the usual one of tubes.
  void fit(const Element& element, const Textile& textile) {
    const std::size_t exact = num_control_points(fabric_);
    if (fields_.errors() > 0 || exact == 0) return;
    const bool is_large = growth(exact) > most_times && bytes_a_point * exact > small_bytes;
    if (tolerance_ == 0 && !is_large) return;
    double thinnest = infinity;
    for (const TextileYarn& yarn : textile.yarns)
      for (const Section& section : yarn.sections)
        thinnest = std::min(thinnest, sizes_of(section).minCoeff());
    const double tolerance = tolerance_ > 0 ? tolerance_ : usual_tolerance * thinnest;
    std::optional<Fitted> made = fitted(textile, tolerance);
    if (!made || made->control_points >= exact) return;
    fabric_.items = std::move(made->fabric.items);
    const std::string said = fmt::format(
        "the surfaces are fitted to within {:.2g} {} of their sections, with {} control points instead of "
        "{}: in IGES about {:.3g} MB, {:.3g} times the bytes of this file{}",
        made->deviation, name_of(fabric_.units), made->control_points, exact,
        1e-6 * static_cast<double>(bytes_a_point * made->control_points), growth(made->control_points),
        is_large ? smaller(textile, *made, tolerance, thinnest) : "");
    if (tolerance_ > 0)
      fields_.note(element, said);
    else
      fields_.warning(element, said);
  }

  void read_yarns(const Element& element, Textile& textile) {
    const std::map<int, fabric::Role> roles = roles_of(element);
    int number = 0;
    for (const Element& child : element.children) {
      if (child.name != "Yarn") continue;
      if (fields_.is_full()) return;
      const std::string name = fmt::format("yarn_{}", number);
      fields_.set_yarn(name);
      std::optional<TextileYarn> yarn = read_yarn(child, fields_);
      if (yarn) {
        yarn->name = name;
        yarn->thread = properties_.thread_of(child, element);
        if (const auto role = roles.find(number); role != roles.end()) yarn->role = role->second;
        textile.yarns.push_back(std::move(*yarn));
      }
      fields_.set_yarn({});
      ++number;
    }
  }

  // Weaves say which of their yarns run along x and along y.
  [[nodiscard]] std::map<int, fabric::Role> roles_of(const Element& element) const {
    constexpr int most_yarns = 1'000'000;
    std::map<int, fabric::Role> roles;
    for (const Element& group : element.children) {
      if (group.name != "XYarns" && group.name != "YYarns") continue;
      const fabric::Role role = group.name == "XYarns" ? fabric::Role::warp : fabric::Role::weft;
      for (const Element& yarn : group.children)
        roles[fields_.whole(yarn, "yarnindex", 0, most_yarns)] = role;
    }
    return roles;
  }

  const Source& source_;
  double tolerance_;  // file units; 0: none was given
  Fields fields_;
  fabric::Fabric fabric_;
  Properties properties_;
  std::set<std::string_view> warned_;
};

}  // namespace

bool is_tg3(std::string_view head) {
  const std::size_t first = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return first != std::string_view::npos && head[first] == '<' &&
         head.find("<TexGenModel") != std::string_view::npos;
}

std::optional<fabric::Fabric> read_fabric(const Source& source, Diagnostics& diagnostics) {
  return read_within(source, 0, diagnostics);
}

std::optional<fabric::Fabric> read_within(const Source& source, double tolerance, Diagnostics& diagnostics) {
  return reported(
      source, diagnostics,
      [tolerance](const Source& text, TextReport& report) -> std::optional<fabric::Fabric> {
        if (text.bytes().size() > most_bytes)
          return report.error(
              spot_at(text, {1, 1}),
              fmt::format("the file has {} MB: up to {} are read; save it without what TexGen computes "
                          "(its standard output)",
                          text.bytes().size() >> 20U, most_bytes >> 20U),
              Kind::limit);
        const Result<Element> model = read_xml(text.bytes(), computed);
        if (!model)
          return report.error(spot_at(text, model.error().place), model.error().text, model.error().kind);
        return Reader(text, tolerance, report).read(*model);
      });
}

}  // namespace selvage::formats::tg3
