// The explicit list of formats: to add a format is to add a folder and a line here.
#include "formats/bdf/bdf.h"
#include "formats/cdb/cdb.h"
#include "formats/dxf/dxf.h"
#include "formats/format.h"
#include "formats/iges/iges.h"
#include "formats/inp/inp.h"
#include "formats/k/k.h"
#include "formats/msh/msh.h"
#include "formats/step/step.h"
#include "formats/svg/svg.h"
#include "formats/txt/txt.h"
#include "formats/unv/unv.h"
#include "formats/vtu/vtu.h"
#include "formats/wif/wif.h"

namespace selvage::formats {

const std::vector<const Descriptor*>& all_formats() {
  static const std::vector<const Descriptor*> list = {
      &txt::descriptor(),       &wif::descriptor(), &iges::descriptor(), &step::descriptor(),
      &svg::descriptor(),       &dxf::descriptor(), &inp::descriptor(),  &cdb::descriptor(),
      &cdb::macro_descriptor(), &k::descriptor(),   &bdf::descriptor(),  &msh::descriptor(),
      &vtu::descriptor(),       &unv::descriptor()};
  return list;
}

}  // namespace selvage::formats
