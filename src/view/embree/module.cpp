#include <embree3/rtcore.h>

#include <exception>
#include <new>

#include "view/embree/png.h"
#include "view/embree/render.h"
#include "view/picture.h"

namespace selvage::view {

namespace {

Result<Picture> guarded_render(std::span<const yarn::Body> bodies, const PictureOptions& options) try {
  return embree::render_yarns(bodies, options);
} catch (const std::bad_alloc&) {
  return error(Kind::limit, "the picture needs more memory than there is; make it smaller with --size");
} catch (const std::exception& failure) {
  return error(Kind::internal, std::string("the picture failed: ") + failure.what());
}

}  // namespace

}  // namespace selvage::view

extern "C" __attribute__((visibility("default"))) const void* selvage_embree() {
  static const selvage::view::EmbreeModule table = {RTC_VERSION_STRING, &selvage::view::guarded_render,
                                                    &selvage::view::embree::encode_png};
  return &table;
}
