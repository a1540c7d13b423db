#include "view/picture.h"

#include "core/module.h"
#include "view/mesh_picture.h"

namespace selvage::view {

Result<const EmbreeModule*> embree_module() {
  return module_table<EmbreeModule>("embree", "selvage_embree");
}

Result<Picture> render(std::span<const yarn::Body> bodies, const PictureOptions& options) {
  return call(embree_module(), &EmbreeModule::render, bodies, options);
}

Result<Picture> render(const MeshSurface& surface, const PictureOptions& options) {
  return call(embree_module(), &EmbreeModule::render_mesh, surface, options);
}

Result<std::string> png(const Picture& picture) {
  return call(embree_module(), &EmbreeModule::png, picture);
}

}  // namespace selvage::view
