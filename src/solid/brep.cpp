#include "solid/brep.h"

#include "core/module.h"

namespace selvage::solid {

Result<const BrepModule*> brep_module() {
  Result<const void*> table = open_module("occt", "selvage_brep");
  if (!table) return table.error();
  return static_cast<const BrepModule*>(*table);
}

Result<std::vector<BrepCheck>> check_breps(std::span<const yarn::Body> bodies) {
  Result<const BrepModule*> module = brep_module();
  if (!module) return module.error();
  return (*module)->check(bodies);
}

Result<std::vector<FaceCheck>> check_piece_faces(std::span<const fabric::PieceShape> pieces) {
  Result<const BrepModule*> module = brep_module();
  if (!module) return module.error();
  return (*module)->check_pieces(pieces);
}

}  // namespace selvage::solid
