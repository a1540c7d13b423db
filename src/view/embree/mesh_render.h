// The picture of a mesh's surface. Internal to the module selvage_embree.
#pragma once

#include "view/mesh_picture.h"

namespace selvage::view::embree {

Result<Picture> render_mesh(const MeshSurface& surface, const PictureOptions& options);

}  // namespace selvage::view::embree
