#include "pipeline/mesh_picture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/words.h"
#include "pipeline/result_fields.h"
#include "pipeline/view.h"
#include "view/legend.h"
#include "view/mesh_picture.h"
#include "view/scale_bar.h"
#include "yarn/role_color.h"

namespace selvage::pipeline {

namespace {

using fem::FieldMesh;

// As the largest displacement, of the mesh's diagonal, where the factor is chosen by itself.
constexpr double usual_move = 0.05;

// Two digits that mean something, so that it can be said shortly.
double rounded_down(double factor) {
  const double power = std::pow(10.0, std::floor(std::log10(factor)) - 1);
  return std::floor(factor / power) * power;
}

// Moves the nodes by the displacements of this step; the factor.
Result<double> deform(FieldMesh& mesh, const DeformedScale& wanted, int step) {
  const FieldMesh::Field* const moved = displacements_of(mesh, step);
  if (moved == nullptr)
    return error(Kind::unsupported,
                 "the file has no displacements (DISP or U) to deform the mesh by: leave out --deformed");
  double largest = 0;
  Box3 box;
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k) {
    box.extend(mesh.nodes[k]);
    const double size = Eigen::Map<const Eigen::Vector3f>(&moved->values[3 * k]).cast<double>().norm();
    if (std::isfinite(size)) largest = std::max(largest, size);
  }
  const double factor = wanted.factor ? *wanted.factor
                        : largest > 0 ? rounded_down(usual_move * box.diagonal().norm() / largest)
                                      : 1.0;
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k) {
    const Vec3 way = Eigen::Map<const Eigen::Vector3f>(&moved->values[3 * k]).cast<double>();
    if (way.allFinite()) mesh.nodes[k] += factor * way;
  }
  return factor;
}

// Which elements are shown: of regions that are asked for, and of the matrix the part that is.
class Chosen {
 public:
  Chosen(const Options& options, const FieldMesh& mesh, const view::Camera& camera) : mesh_(mesh) {
    const bool has_yarns = !std::all_of(mesh.regions.begin(), mesh.regions.end(), fem::is_matrix);
    const bool has_names = !options.shown_yarns.empty();
    const ShownMatrix part =
        options.shown_matrix.value_or(!has_yarns || has_names ? ShownMatrix::whole : ShownMatrix::half);
    for (const std::string& name : mesh.regions) {
      const bool is_half = fem::is_matrix(name) && part == ShownMatrix::half;
      const bool is_shown =
          pipeline::is_shown(options, name) && !(fem::is_matrix(name) && part == ShownMatrix::none);
      looks_.push_back(!is_shown ? Look::hidden : is_half ? Look::half : Look::whole);
    }
    Box3 box;
    for (const Vec3& p : mesh.nodes) box.extend(p);
    // Upright planes through the middle, from corner to corner of what is seen; from above a level one.
    Vec3 toward = camera.toward_eye();
    if (toward.head<2>().norm() > 0.1) toward.z() = 0;
    const Vec3 sizes = box.sizes().cwiseMax(1e-300);
    normal_ = toward.cwiseQuotient(sizes);
    place_ = normal_.dot(box.center());
  }
  [[nodiscard]] bool has(const FieldMesh::Element& element) const {
    const Look look = looks_[element.region];
    if (look != Look::half) return look == Look::whole;
    Vec3 sum = Vec3::Zero();
    const std::size_t count = fem::corner_count(element.shape);
    for (std::size_t k = 0; k < count; ++k) sum += mesh_.nodes[element.corners[k]];
    return normal_.dot(sum) < place_ * static_cast<double>(count);
  }

 private:
  enum class Look { hidden, half, whole };
  const FieldMesh& mesh_;
  std::vector<Look> looks_;  // of each region
  Vec3 normal_;              // of the half's plane, toward what is taken away
  double place_ = 0;
};

// The surface of the elements that are shown, of points that it has.
view::MeshSurface surface_of(const FieldMesh& mesh, const Chosen& chosen,
                             const std::optional<ShownValues>& shown) {
  FieldMesh part;
  part.nodes = mesh.nodes;
  std::vector<std::uint32_t> element_of;
  for (std::uint32_t k = 0; k < mesh.elements.size(); ++k) {
    if (!chosen.has(mesh.elements[k])) continue;
    part.elements.push_back(mesh.elements[k]);
    element_of.push_back(k);
  }
  const fem::Outside outside = fem::outside_of(part);
  view::MeshSurface surface;
  surface.inner = outside.inner;
  surface.values_are_of_points = shown && shown->of_nodes;
  std::vector<std::uint32_t> number(mesh.nodes.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t k = 0; k < outside.triangles.size(); ++k) {
    std::array<std::uint32_t, 3>& triangle = surface.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t node = outside.triangles[k][i];
      if (number[node] == std::numeric_limits<std::uint32_t>::max()) {
        number[node] = static_cast<std::uint32_t>(surface.points.size());
        surface.points.push_back(mesh.nodes[node]);
        if (surface.values_are_of_points) surface.values.push_back(shown->values[node]);
      }
      triangle[i] = number[node];
    }
    const FieldMesh::Element& element = part.elements[outside.element[k]];
    if (shown && !shown->of_nodes) surface.values.push_back(shown->values[element_of[outside.element[k]]]);
    if (!shown)
      surface.colors.push_back(fem::is_matrix(mesh.regions[element.region])
                                   ? yarn::matrix_color
                                   : yarn::hue_color(element.region));
  }
  return surface;
}

// What the scale's ends are: as asked for, else the least and the largest value; one value alone is told from
// 0.
void set_range(view::MeshSurface& surface, const Options& options) {
  if (options.value_range) {
    surface.low = options.value_range->first;
    surface.high = options.value_range->second;
    return;
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const float value : surface.values) {
    if (!std::isfinite(value)) continue;
    low = std::min<double>(low, value);
    high = std::max<double>(high, value);
  }
  constexpr double one_value = 1e-4;
  const double largest = std::max(std::abs(low), std::abs(high));
  if (high < low || largest == 0)
    low = 0, high = 1;
  else if (high - low < one_value * largest)
    low = std::min(low, 0.0), high = std::max(high, 0.0);
  surface.low = low;
  surface.high = high;
}

Message none_chosen(const FieldMesh& mesh) {
  return error(Kind::unsupported,
               fmt::format("no region is shown: --yarns and --show-matrix leave out all of {}",
                           fmt::join(mesh.regions, ", ")));
}

}  // namespace

std::optional<std::string> draw_mesh(Job& job, FieldMesh mesh) {
  const Options& given = job.options;
  view::PictureOptions options = picture_options(job, {});
  if (!given.from && !given.azimuth && !given.elevation) options.eye.from = view::From::iso;
  const Result<int> step = step_of(mesh, given.step);
  if (!step) return job.fail(step.error());
  std::optional<ShownValues> shown;
  if (!given.field.empty()) {
    Result<ShownValues> values = values_of(mesh, given.field, *step);
    if (!values) return job.fail(values.error());
    shown = std::move(*values);
  }
  double factor = 0;
  if (given.deformed) {
    const Result<double> done = deform(mesh, *given.deformed, *step);
    if (!done) return job.fail(done.error());
    factor = *done;
  }
  const view::Camera camera(options.eye, mesh.nodes, options.width, options.height);
  view::MeshSurface surface = surface_of(mesh, Chosen(given, mesh, camera), shown);
  if (surface.triangles.empty()) return job.fail(none_chosen(mesh));
  if (shown &&
      std::none_of(surface.values.begin(), surface.values.end(), [](float v) { return std::isfinite(v); }))
    return job.fail(
        error(Kind::unsupported, fmt::format("what is shown has no value of {}", in_quotes(given.field))));
  set_range(surface, given);

  const int bar = given.no_scale_bar ? 0 : view::scale_bar_rows(options.width, options.height);
  const int legend = shown ? view::legend_rows(options.width, options.height) : 0;
  options.height -= bar + legend;
  Result<view::Picture> picture = view::render(surface, options);
  if (!picture) return job.fail(picture.error());
  if (legend > 0) {
    std::string title = shown->title;
    if (factor != 0) title += fmt::format("; deformed {:g} times", factor);
    view::add_legend(*picture, legend, {title, surface.low, surface.high}, options.background);
  }
  if (bar > 0) view::add_scale_bar(*picture, bar, Unit::mm, options.background);
  Result<std::string> bytes = view::png(*picture);
  if (!bytes) return job.fail(bytes.error());
  return std::move(*bytes);
}

}  // namespace selvage::pipeline
