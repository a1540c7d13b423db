#include "cad/model.h"

namespace selvage::cad {

std::size_t Model::face_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.faces.size();
  return count;
}

}  // namespace selvage::cad
