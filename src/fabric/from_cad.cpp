#include "fabric/from_cad.h"

#include "cad/recognize.h"

namespace selvage::fabric {

Fabric fabric_of(cad::Model model, Diagnostics& diagnostics) {
  Fabric fabric;
  fabric.file = std::move(model.file);
  if (!model.title.empty()) fabric.title = std::move(model.title);
  fabric.units = model.units;
  fabric.units_given = true;
  fabric.date = std::move(model.date);
  fabric.file_name = std::move(model.file_name);
  fabric.curves = std::move(model.curves);
  cad::Recognized found = cad::recognize_yarns(std::move(model.parts));
  for (yarn::Body& body : found.yarns) {
    Yarn& yarn = std::get<Yarn>(fabric.items.emplace_back(std::in_place_type<Yarn>));
    yarn.name = body.name;
    yarn.place = body.place;
    yarn.group = body.group;
    yarn.role = body.role;
    yarn.own.color = body.color;
    yarn.shape = std::make_shared<const yarn::Body>(std::move(body));
  }
  fabric.parts = std::move(found.rest);
  for (Message& message : found.messages) {
    message.file = fabric.file;
    diagnostics.add(std::move(message));
  }
  return fabric;
}

}  // namespace selvage::fabric
