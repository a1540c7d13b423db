// What receiving systems stumble on. The facts are collected from their manuals and users (src/cli/check.md,
// formats of the other end); where a limit is not known exactly the message says so.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cad/judge.h"

namespace selvage::cad {

namespace {

constexpr double creo_relative = 0.0012;
constexpr int ansys_degree = 20;
constexpr double ansys_merge = 0.75;      // of the shortest line
constexpr double occt_weight = 1e-9;      // below it OpenCASCADE sets all weights to 1
constexpr double occt_resolution = 1e-8;  // at or below it OpenCASCADE takes 1e-4, of whatever unit
constexpr double short_border = 0.5;      // of a border is the most that an accuracy may be
constexpr double sliver = 1e-6;           // of the largest face's area

Message advice(Severity severity, std::string text, TextPlace place) {
  Message message = error(Kind::geometry, std::move(text));
  message.severity = severity;
  message.place = place;
  return message;
}

// 1, 2 or 5 times a power of ten, at or below `value`.
double rounded_down(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0})
    if (step * power <= value) return step * power;
  return power;
}

class Receivers {
 public:
  Receivers(const Model& model, const Measures& m, Findings& findings)
      : model_(model), m_(m), findings_(findings), unit_(name_of(model.units)) {}

  void geometry() {
    creo();
    poles();
    gaps();
    ansys();
    weights();
    slivers();
  }
  void iges() {
    abaqus();
    occt_resolution_of_file();
  }

 private:
  void warn(std::string text, TextPlace place = {}) {
    findings_.add(advice(Severity::warning, std::move(text), place));
  }
  void note(std::string text, TextPlace place = {}) {
    findings_.add(advice(Severity::note, std::move(text), place));
  }

  void creo() {
    const double accuracy = creo_relative * m_.size;
    if (m_.shortest_border > 0 && accuracy > short_border * m_.shortest_border) {
      const std::optional<double> absolute = absolute_accuracy(m_);
      warn(fmt::format("Creo: its default accuracy, 0.0012 of the part's size, is {:.2g} {} here, and {} has "
                       "an edge of {:.2g} {}: import it with the absolute accuracy {:g} {}",
                       accuracy, unit_, m_.shortest_entity, m_.shortest_border, unit_, absolute.value_or(0),
                       unit_),
           m_.shortest_place);
    } else if (m_.shortest_border > 0) {
      note(fmt::format("Creo: an absolute accuracy of {:g} {} suits the shortest edge",
                       absolute_accuracy(m_).value_or(0), unit_));
    }
    if (m_.open_borders > 0)
      warn(
          fmt::format("Creo, SolidWorks: {} edges have a face on one side only (above): the quilt stays "
                      "open; close it, or import it as surfaces",
                      m_.open_borders));
  }

  void poles() {
    if (m_.poles == 0) return;
    const std::string& face = m_.first_pole.entity;
    warn(fmt::format("Creo lists surfaces with a pole as bad geometry, and gmsh does not mesh such faces: {} "
                     "of them, the first is {}; of Selvage's own yarns, write the ends with --ends patch",
                     m_.poles, face),
         m_.first_pole.place);
  }

  void gaps() {
    if (m_.largest_gap <= m_.tolerance) return;
    warn(fmt::format(
        "SolidWorks and Creo knit surfaces only over gaps that their tolerance allows: the largest is {:.3g} "
        "{} at {}; allow more than that at import, or mend it where it was made",
        m_.largest_gap, unit_, m_.gap_entity));
  }

  void ansys() {
    if (m_.largest_degree > ansys_degree)
      warn(fmt::format("ANSYS reads degrees up to {}: there is one of {}; lower it", ansys_degree,
                       m_.largest_degree));
    if (model_.resolution > 0 && m_.shortest_border > 0 &&
        model_.resolution >= ansys_merge * m_.shortest_border)
      warn(fmt::format("ANSYS (IOPTN,GTOLER,FILE) and OpenCASCADE merge what is nearer than the file's "
                       "resolution, {:.3g} {}: {} has an edge of {:.3g} {}; set the tolerance by hand",
                       model_.resolution, unit_, m_.shortest_entity, m_.shortest_border, unit_),
           m_.shortest_place);
  }

  void weights() {
    if (m_.least_weight > 0 && m_.least_weight < occt_weight)
      warn(fmt::format(
          "OpenCASCADE takes all weights of a surface for 1 when one is below 1e-9: the least is {:.3g}",
          m_.least_weight));
  }

  void slivers() {
    if (!m_.least_area || *m_.least_area >= sliver * *m_.largest_area) return;
    warn(fmt::format("ANSYS drops small areas by default, and gmsh, Netgen and HyperMesh fail on slivers: {} "
                     "has an area of {:.3g} {}^2, the largest face {:.3g}; remove it where it was made",
                     m_.least_area_entity, *m_.least_area, unit_, *m_.largest_area),
         m_.least_area_place);
  }

  [[nodiscard]] std::uint64_t count(std::string_view entity) const {
    std::uint64_t sum = 0;
    for (const auto& [name, number] : model_.entities)
      if (name == entity || name.starts_with(std::string(entity) + " ")) sum += number;
    return sum;
  }

  void abaqus() {
    if (const std::uint64_t instances = count("408"); instances > 0)
      warn(
          fmt::format("Abaqus/CAE ignores subfigures (308, 408): the geometry of {} instances exists only in "
                      "them; write the file without instances, or give it to Abaqus as STEP",
                      instances));
    for (const auto& [entity, what] : std::array<std::pair<std::string_view, std::string_view>, 4>{
             {{"102", "composite curves: a face trimmed by one may come untrimmed"},
              {"314", "colours"},
              {"402", "groups: touching parts may be joined"},
              {"406", "names and levels"}}})
      if (const std::uint64_t number = count(entity); number > 0)
        note(fmt::format("Abaqus/CAE ignores {} ({} of {})", what, number, entity));
  }

  void occt_resolution_of_file() {
    if (model_.resolution > 0 && model_.resolution <= occt_resolution)
      warn(fmt::format(
          "OpenCASCADE (and FreeCAD, gmsh) takes the resolution of the file as its tolerance only above "
          "1e-8, and 1e-4 otherwise: it is {:.3g} {} (global parameter 19); write at least 1e-7",
          model_.resolution, unit_));
  }

  const Model& model_;
  const Measures& m_;
  Findings& findings_;
  std::string_view unit_;
};

}  // namespace

std::optional<double> absolute_accuracy(const Measures& measures) {
  if (!(measures.shortest_border > 0)) return std::nullopt;
  return rounded_down(
      std::max(0.01 * measures.shortest_border,
               std::min(2.5 * measures.largest_gap, short_border * measures.shortest_border)));
}

void judge_for_receivers(const Model& model, const Measures& measures, bool is_iges, Findings& findings) {
  Receivers receivers(model, measures, findings);
  receivers.geometry();
  if (is_iges) receivers.iges();
}

}  // namespace selvage::cad
