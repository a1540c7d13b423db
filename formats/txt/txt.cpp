#include "formats/registry.h"

#include "formats/txt/edit_line.h"
#include "formats/txt/lessons.h"
#include "formats/txt/reader.h"
#include "formats/txt/writer.h"

namespace selvage::formats::txt {

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "txt",
                                  .title = "Fabric TXT, the input language",
                                  .extensions = {".txt"},
                                  .sniff = is_fabric_txt,
                                  .read_fabric = read_fabric,
                                  .read_with = read_fabric_with,
                                  .write_fabric = write_fabric,
                                  .insert_edit = insert_edit,
                                  .is_own = true,
                                  .language = language};
  return self;
}

}  // namespace selvage::formats::txt
