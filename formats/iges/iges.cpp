#include "formats/registry.h"

#include "formats/iges/header.h"
#include "formats/iges/lines.h"
#include "formats/iges/options.h"
#include "formats/iges/reader.h"
#include "formats/iges/structure.h"
#include "formats/iges/writer.h"

namespace selvage::formats::iges {

namespace {

bool sniff(std::string_view head) {
  return head.size() >= 80 && (head[72] == 'S' || head[72] == 'C') &&  // C: compressed, refused by name
         is_number_field(head.substr(73, 7)) &&
         head.substr(0, 72).find_first_of("\r\n") == std::string_view::npos;
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "iges",
      .title = "IGES 5.3, B-spline surfaces or solids, garment pieces",
      .extensions = {".igs", ".iges"},
      .sniff = sniff,
      .read_model = read_model,
      .check_structure = check_structure,
      .part_mark = part_mark,
      .is_partly_ignored = true,
      .open_bodies = [](OutputFile& output,
                        const SurfaceOptions& options) { return open_writer(output, options); },
      .carries_curves = true,
      .carries_parts = true,
      .carries_lines = true,
      .options = option::all(),
      .other_form = &option::solid,
      .is_usual = true};
  return self;
}

}  // namespace selvage::formats::iges
