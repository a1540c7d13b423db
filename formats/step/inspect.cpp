#include "formats/step/inspect.h"

#include "formats/step/assemblies.h"
#include "formats/step/attributes.h"

namespace selvage::formats::step {

std::optional<Part21> inspect(const Source& source, TextReport& report) {
  std::optional<Part21> file = read_part21(source, report);
  if (file) check_attributes(*file, source.bytes(), report);
  if (report.errors() == 0) check_assemblies(*file, report);
  if (report.errors() > 0) return std::nullopt;
  return file;
}

}  // namespace selvage::formats::step
