// Small pictures of the inputs of a report.
#pragma once

#include <string>
#include <vector>

#include "pipeline/options.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

struct Thumbnail {
  std::string png;  // empty: there is none, for the reason that `note` says
  std::string note;
};

inline constexpr int thumbnail_width = 200, thumbnail_height = 150;         // pixels
inline constexpr std::size_t most_thumbnails = 500;                         // of the first ones
inline constexpr std::size_t most_thumbnail_bytes = std::size_t{32} << 20;  // of all of them

// Of each entry of a report, in their order. Each input is read in a process of its own, as any other; it has
// to be where the report says, seen from here, as it was; one that is named several times is drawn once.
// Errors: interrupted; limit (no process can be started).
Result<std::vector<Thumbnail>> thumbnails_of(const Options& options, const std::vector<const Json*>& entries);

}  // namespace selvage::pipeline
