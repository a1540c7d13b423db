// The files that a text names: `draft file NAME`, `use file NAME`, of any format that can be read as a
// fabric; `points FILE`, of formats with yarns as points.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/model.h"

namespace selvage::pipeline {

// Puts the draft of the named file's weave in the place of every such name, and a block with the named file's
// fabric beside every `use` of one, and the path or grid of a file of points in that of every `points` (its
// lengths, where the file names their unit, brought to that of the text; its sizes make the section where the
// yarn has none), also in the text's blocks and in the files themselves. Names are relative
// to the folder of the text that they stand in; for standard input to the current folder. Only regular files
// are read, and without `allow_outside` only those in the folder of the input `source`, which the fabric was
// read from, or below it, symbolic links followed: a text may come from anyone. A file's own messages go to
// `diagnostics`, and where it gives nothing (missing, elsewhere, no regular file, unreadable, of a format
// without yarns, faulty; not exactly one weave, a draft that names a file again; of another unit, a text that
// uses itself) an error at the line that names it as well. Returns "NAME SHA-256" of each file that was read.
std::vector<std::string> resolve_files(fabric::Fabric& fabric, const Source& source, bool allow_outside,
                                       Diagnostics& diagnostics);

}  // namespace selvage::pipeline
