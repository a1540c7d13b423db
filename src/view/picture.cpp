#include "view/picture.h"

#include "core/module.h"

namespace selvage::view {

Result<const EmbreeModule*> embree_module() {
  Result<const void*> table = open_module("embree", "selvage_embree");
  if (!table) return table.error();
  return static_cast<const EmbreeModule*>(*table);
}

Result<Picture> render(std::span<const yarn::Body> bodies, const PictureOptions& options) {
  Result<const EmbreeModule*> module = embree_module();
  if (!module) return module.error();
  return (*module)->render(bodies, options);
}

Result<std::string> png(const Picture& picture) {
  Result<const EmbreeModule*> module = embree_module();
  if (!module) return module.error();
  return (*module)->png(picture);
}

}  // namespace selvage::view
