// Do the attributes of a STEP file's entities have the number, the kinds and the types that the entities say
// (entities.h)?
#pragma once

#include "formats/step/part21.h"

namespace selvage::formats::step {

// `text` is what the file was read from. Errors, each with line and column. Entities that are not in the
// table are passed by, and so are references to them. What no shape depends on (looks, layers, properties) is
// left out instead (Statement::is_left_out), with a warning.
void check_attributes(Part21& file, std::string_view text, TextReport& report);

// Does an entity refer to itself, by way of others? Circles through what nobody translates (annotations that
// name their callouts) harm no one, nor does a protocol's definition. The first one is an error,
// but for one of what no shape depends on, which is left out with a warning.
void check_circles(Part21& file, TextReport& report);

}  // namespace selvage::formats::step
