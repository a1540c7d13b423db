#include "view/embree/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace selvage::view::embree {

namespace {

struct Quad {
  std::uint32_t a, b, c, d;
};

// Counter-clockwise seen from outside; a triangle repeats its last corner.
void fill_quads(const Skin& skin, Quad* quads) {
  const auto columns = static_cast<std::uint32_t>(skin.columns);
  const auto rows = static_cast<std::uint32_t>(skin.rows);
  for (std::uint32_t row = 0; row + 1 < rows; ++row)
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t first = row * columns + column;
      *quads++ = {first, first + 1, first + 1 + columns, first + columns};
    }
  if (!skin.has_ends) return;
  const std::uint32_t start_centre = rows * columns, end_centre = start_centre + 1,
                      end = (rows - 1) * columns;
  for (std::uint32_t k = 0; k + 1 < columns; ++k) *quads++ = {k + 1, k, start_centre, start_centre};
  for (std::uint32_t k = end; k + 1 < end + columns; ++k) *quads++ = {k, k + 1, end_centre, end_centre};
}

bool add_skin(RTCDevice device, RTCScene scene, const Skin& skin) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), skin.points.size()));
  auto* quads = static_cast<Quad*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                           RTC_FORMAT_UINT4, sizeof(Quad), skin.facets()));
  const bool made = points != nullptr && quads != nullptr;
  if (made) {
    for (const Vec3f& p : skin.points)
      for (float x : p) *points++ = x;
    fill_quads(skin, quads);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);  // numbered in this order
  }
  rtcReleaseGeometry(geometry);
  return made;
}

bool add_triangles(RTCDevice device, RTCScene scene, const std::vector<Vec3f>& points,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* places = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), points.size()));
  auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
  const bool made = places != nullptr && corners != nullptr;
  if (made) {
    for (const Vec3f& p : points)
      for (const float x : p) *places++ = x;
    for (const auto& triangle : triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  return made;
}

RTCRay ray_of(const Vec3f& origin, const Vec3f& direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
  ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
  ray.tnear = near, ray.tfar = far;
  ray.mask = 0xffffffffU;
  return ray;
}

}  // namespace

template <class Add>
Result<Scene> Scene::make_of(const Add& add) {
  // One thread builds the tree, so that it is the same at every run; the rays are shared out by the caller.
  Scene made;
  made.device_.reset(rtcNewDevice("threads=1,set_affinity=0"));
  if (!made.device_)
    return error(Kind::internal,
                 fmt::format("Embree: no device (error {})", static_cast<int>(rtcGetDeviceError(nullptr))));
  made.scene_.reset(rtcNewScene(made.device_.get()));
  rtcSetSceneFlags(made.scene_.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
  if (add(made.device_.get(), made.scene_.get())) rtcCommitScene(made.scene_.get());
  const RTCError failure = rtcGetDeviceError(made.device_.get());
  if (failure == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (failure != RTC_ERROR_NONE)
    return error(Kind::internal, fmt::format("Embree fails with error {}", static_cast<int>(failure)));
  return made;
}

Result<Scene> Scene::make(const std::vector<Skin>& skins) {
  return make_of([&](RTCDevice device, RTCScene scene) {
    return std::all_of(skins.begin(), skins.end(),
                       [&](const Skin& skin) { return add_skin(device, scene, skin); });
  });
}

Result<Scene> Scene::make(const std::vector<Vec3f>& points,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  return make_of(
      [&](RTCDevice device, RTCScene scene) { return add_triangles(device, scene, points, triangles); });
}

std::optional<Hit> Scene::nearest(const Vec3f& origin, const Vec3f& direction, float beyond) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit found{};
  found.ray = ray_of(origin, direction, beyond, std::numeric_limits<float>::infinity());
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{found.hit.geomID, found.hit.primID,
             found.hit.u,      found.hit.v,
             found.ray.tfar,   Vec3f(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z).normalized()};
}

std::optional<Hit> Walk::next() {
  constexpr float one_place = 1e-3F;  // pixels
  for (;;) {
    const float beyond =
        last_ ? std::nextafter(last_->distance, std::numeric_limits<float>::infinity()) : 0.0F;
    const std::optional<Hit> before = std::exchange(last_, scene_.nearest(origin_, direction_, beyond));
    if (!last_ || !before || before->yarn != last_->yarn || last_->distance - before->distance >= one_place ||
        before->facing.dot(direction_) * last_->facing.dot(direction_) <= 0.0F)
      return last_;
  }
}

bool Scene::is_blocked(const Vec3f& origin, const Vec3f& direction, float reach) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = ray_of(origin, direction, 0, reach);
  rtcOccluded1(scene_.get(), &context, &ray);
  return ray.tfar < 0;
}

}  // namespace selvage::view::embree
