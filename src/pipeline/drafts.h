// `draft file NAME`: the drafts that stand in files of their own, of any format that can be read.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/model.h"

namespace selvage::pipeline {

// Puts the draft of the named file's weave in the place of every such name. Names are relative to the folder
// of the input `source`, which the fabric was read from; for standard input to the current folder. Only
// regular files are read, and without `allow_outside` only those in that folder or below it, symbolic links
// followed: a text may come from anyone. The file's own messages go to `diagnostics`, and where it gives no
// draft (missing, elsewhere, no regular file, unreadable, of a format without drafts, faulty, not exactly one
// weave, a draft that names a file again) an error at the draft's line as well. Returns "NAME SHA-256" of
// each file that was read.
std::vector<std::string> resolve_drafts(fabric::Fabric& fabric, const Source& source, bool allow_outside,
                                        Diagnostics& diagnostics);

}  // namespace selvage::pipeline
