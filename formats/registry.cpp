// The explicit list of formats: to add a format is to add a folder, a line here and its name in the header.
#include "formats/registry.h"

namespace selvage::formats {

const std::vector<const Descriptor*>& all_formats() {
  static const std::vector<const Descriptor*> list = {
      &txt::descriptor(),          &wif::descriptor(),       &knitout::descriptor(), &tg3::descriptor(),
      &iges::descriptor(),         &step::descriptor(),      &stl::descriptor(),     &obj::descriptor(),
      &obj::material_descriptor(), &ply::descriptor(),       &gltf::descriptor(),    &svg::descriptor(),
      &dxf::descriptor(),          &vtp::descriptor(),       &csv::descriptor(),     &inp::descriptor(),
      &cdb::descriptor(),          &cdb::macro_descriptor(), &k::descriptor(),       &bdf::descriptor(),
      &msh::descriptor(),          &vtu::descriptor(),       &unv::descriptor(),     &frd::descriptor(),
      &foam::descriptor(),         &hdf5::descriptor(),      &npz::descriptor()};
  return list;
}

}  // namespace selvage::formats
