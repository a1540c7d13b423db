// The constructions: what a statement of a text becomes. Each has a file of its own name, which says where
// its yarns lie; the statements are in formats/txt/README.md.
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

struct BuildOptions;

// All of them: errors at their lines; `fabric` and the statement outlive the construction; warnings go to
// `diagnostics`.
template <class Statement>
using Make = Result<std::unique_ptr<Construction>>(const Fabric& fabric, const Statement& statement,
                                                   const BuildOptions& options, Diagnostics& diagnostics);

// Errors: a draft that cannot be, pitches too small for the sections (with the smallest ones), levels of
// binders that are not there. Warnings: yarns of one system wider than their pitch, or without room to pass
// each other.
Make<Weave> make_weave;
// The loops are moved so far that nothing overlaps, or as published.
Make<Knit> make_knit;
// Errors, those of a lapping in its text: malformed, an overlap across more than one needle, a bar that knits
// nowhere, pitches too small for the yarns (the smallest one is named).
Make<Warpknit> make_warpknit;
Make<Braid> make_braid;

}  // namespace selvage::fabric
