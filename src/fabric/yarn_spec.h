// What a yarn's statements mean for its geometry: section, sizes along the path, twist, fibre volume
// fraction.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "yarn/tube.h"

namespace selvage::fabric {

// Diameter of a round yarn, mm: 2 sqrt(tex / (1000 pi density packing)); tex in g/km, density in g/cm3.
double yarn_diameter(double tex, double density, double packing);

// The thread's section with its size filled in (file units): as given, or a circle of the thread's diameter,
// or of the one computed from linear density, density and packing. A size of zero stays where every path row
// gives its own. Error (geometry): something is missing for a size; the message says what, and where the
// thread stands.
Result<yarn::Section> section_of(const Thread& thread, Unit units, bool rows_give_sizes);

// As section_of, for a yarn of a construction: a polygon is moved so that the middle of its box lies on the
// centre line, and half of its thickness and width on each side, as constructions take it of every section.
// Error: as section_of.
Result<yarn::Section> centred_section_of(const Thread& thread, Unit units);

// How far the fibres turn about the path, turns per file unit (Z is positive: a right-handed helix); 0
// without twist.
double fibre_twist(const Thread& thread, Unit units);

// How far a section turns with its thread's twist, radians per file unit (Z is positive); 0 where it does
// not.
double section_twist(const Thread& thread, Unit units);

// Section, sizes and angles, up and twist of a path yarn; parameters are those of the centre line's rows.
// tolerance and max_control_points are the caller's.
Result<yarn::TubeSpec> tube_spec_of(const Fabric& fabric, const Yarn& yarn, const Thread& thread,
                                    const std::vector<double>& row_parameters);

// The rows of a path with the half sizes that its corners need (polyline). Error: as section_of.
Result<yarn::PathRows> path_rows_of(const Fabric& fabric, const Yarn& yarn, const Thread& thread);

// Section size at each row, file units (the thread's own where the row has none).
std::vector<yarn::SectionSize> row_sizes(const Path& path, const yarn::Section& section);

// The largest share of a section that is fibre, tex / (1000 density area), over the sizes of a yarn; none
// without linear density and fibre density. Warnings where it is above 1 or differs from a given packing by
// more than 5 %.
std::optional<Message> fibre_share_warning(const Fabric& fabric, const Yarn& yarn, const Thread& thread);
// The same for a yarn of a construction, whose section is its thread's everywhere.
std::optional<Message> fibre_share_warning(const Fabric& fabric, const Thread& thread, TextPlace place);

// A note on how far the seven-point section of the loop method is from round; none for other sections.
std::optional<Message> roundness_note(const Fabric& fabric, const Thread& thread, TextPlace place);

// A warning that the section of a construction's thread turns along its yarns and is not round: constructions
// keep yarns apart by sections that stand as they are.
std::optional<Message> turning_warning(const Fabric& fabric, const Thread& thread, TextPlace place);

// The smallest section size (width or thickness) of a path yarn or of a thread, file units; none where it has
// no size.
std::optional<double> smallest_size(const Fabric& fabric, const Yarn& yarn);
std::optional<double> smallest_size(const Fabric& fabric, const Thread& thread);

}  // namespace selvage::fabric
