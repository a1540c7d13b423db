#include <embree3/rtcore.h>

#include "core/module.h"
#include "view/embree/mesh_render.h"
#include "view/embree/png.h"
#include "view/embree/render.h"
#include "view/picture.h"

namespace selvage::view {

namespace {

Result<Picture> guarded_render(std::span<const yarn::Body> bodies, const PictureOptions& options) {
  return guarded_by_module("the picture failed", [&] { return embree::render_yarns(bodies, options); });
}

Result<Picture> guarded_render_mesh(const MeshSurface& surface, const PictureOptions& options) {
  return guarded_by_module("the picture failed", [&] { return embree::render_mesh(surface, options); });
}

}  // namespace

}  // namespace selvage::view

extern "C" __attribute__((visibility("default"))) const void* selvage_embree() {
  static const selvage::view::EmbreeModule table = {RTC_VERSION_STRING, &selvage::view::guarded_render,
                                                    &selvage::view::guarded_render_mesh,
                                                    &selvage::view::embree::encode_png};
  return &table;
}
