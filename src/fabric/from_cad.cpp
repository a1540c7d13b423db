#include "fabric/from_cad.h"

namespace selvage::fabric {

Fabric fabric_of(cad::Model model, Diagnostics& /*diagnostics*/) {
  Fabric fabric;
  fabric.file = std::move(model.file);
  if (!model.title.empty()) fabric.title = std::move(model.title);
  fabric.units = model.units;
  fabric.units_given = true;
  fabric.date = std::move(model.date);
  fabric.parts = std::move(model.parts);
  fabric.curves = std::move(model.curves);
  return fabric;
}

}  // namespace selvage::fabric
