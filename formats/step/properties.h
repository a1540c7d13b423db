// What a STEP file says of the volume, area and centre of its products. Internal to the module selvage_occt:
// the program opens it through formats/step/step.h.
#pragma once

#include "core/findings.h"
#include "core/source.h"

namespace selvage::formats::step {

// Geometric validation properties (CAx-IF recommended practice: PROPERTY_DEFINITION 'geometric validation
// property' of a product, a part of it or its place, with a MEASURE_REPRESENTATION_ITEM or a centre point)
// against OpenCASCADE's integrals over the shapes that it reads. Of our own files what differs by more than
// 1e-4 of it (of the size, for the centre) is a defect; of other programs' an area or volume by more than
// 5e-3, a warning by more than 1e-3, as is a centre. Before it is told, the integral is taken a second time,
// adaptively. Reads the file only where it has such properties; what cannot be read is left to the reader to
// tell.
void check_properties(const Source& source, Findings& findings);

}  // namespace selvage::formats::step
