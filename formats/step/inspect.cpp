#include "formats/step/inspect.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/words.h"
#include "formats/step/assemblies.h"
#include "formats/step/attributes.h"

namespace selvage::formats::step {

namespace {

// The application protocols whose geometry OpenCASCADE knows: AP203 of both editions, AP209, 210, 214, 242,
// and drafts of them. Some write the name in small letters.
bool is_known_schema(std::string_view schema) {
  for (const std::string_view known :
       {"CONFIG_CONTROL_", "CONFIGURATION_CONTROL_", "CCD_CLA_GVP_AST", "AUTOMOTIVE_DESIGN", "AP203", "AP214",
        "AP242", "AP209", "AP210", "STRUCTURAL_ANALYSIS_DESIGN", "MULTIDISCIPLINARY_ANALYSIS",
        "ELECTRONIC_ASSEMBLY", "MANAGED_MODEL_BASED", "CONSTRUCTION_HISTORY"})
    if (same_word(schema.substr(0, known.size()), known)) return true;
  return false;
}

// Types of entities and their attributes are judged by what these protocols have. Names of others are told,
// but a shape that is put as in these protocols is read (IFC, for one, puts it in another way).
void check_schema(const Part21& file, TextReport& report) {
  if (std::any_of(file.schemas.begin(), file.schemas.end(), is_known_schema)) return;
  const std::string text = fmt::format("a STEP file of the schema {}, not of AP203, AP214 or AP242",
                                       file.schemas.empty() ? "''" : in_quotes(file.schemas.front()));
  if (std::ranges::find(file.types, "SHAPE_DEFINITION_REPRESENTATION") == file.types.end())
    report.error(file.schema_spot, text + "; export it as one of these", Kind::unsupported);
  else
    report.warning(file.schema_spot, text + "; it is read as one of these");
}

}  // namespace

std::optional<Part21> inspect(const Source& source, TextReport& report) {
  std::optional<Part21> file = read_part21(source, report);
  if (file) check_schema(*file, report);
  if (report.errors() == 0) check_circles(*file, report);
  if (report.errors() == 0) check_attributes(*file, source.bytes(), report);
  if (report.errors() == 0) check_assemblies(*file, report);
  if (report.errors() > 0) return std::nullopt;
  return file;
}

}  // namespace selvage::formats::step
