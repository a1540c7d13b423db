#include "solid/brep.h"

#include "core/module.h"

namespace selvage::solid {

Result<const BrepModule*> brep_module() {
  return module_table<BrepModule>("occt", "selvage_brep");
}

Result<std::vector<BrepCheck>> check_breps(std::span<const yarn::Body> bodies) {
  return call(brep_module(), &BrepModule::check, bodies);
}

Result<std::vector<FaceCheck>> check_piece_faces(std::span<const fabric::PieceShape> pieces) {
  return call(brep_module(), &BrepModule::check_pieces, pieces);
}

}  // namespace selvage::solid
