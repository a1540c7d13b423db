// The writer behind the descriptor, with what only tests set.
#pragma once

#include <span>

#include "formats/format.h"
#include "formats/iges/header.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

// One IGES file. Every add either writes the whole thing or, where it fails before the output does, nothing
// of it: finish() then still gives a whole file with what came before. Errors: geometry (a number that is not
// finite; a solid of a yarn whose ends are open), limit (more lines in a section than the limits allow), io.
class FileWriter : public BodyWriter {
 public:
  // A yarn, or a copy of one.
  struct Item {
    yarn::Body body;
    std::optional<Instance> instance{};
  };
  // The plies or filaments of a yarn, one after the other, and the group that has the yarn's name.
  virtual Status add_group(std::span<const Item> parts) = 0;
  // The lines of the longer section of a file that holds nothing but this yarn.
  virtual std::int64_t lines_of(const yarn::Body& body) = 0;
  [[nodiscard]] virtual bool is_empty() const = 0;
  // After finish(): what the file begins with, and a number that is another one for another content.
  [[nodiscard]] virtual const Header& header() const = 0;
  [[nodiscard]] virtual std::uint64_t digest() const = 0;
};
std::unique_ptr<FileWriter> open_file(OutputFile& output, const SurfaceOptions& options,
                                      Records::Limits limits);

// A fabric: as many files as it needs (SurfaceOptions::next_part), cut between yarns; those whose group is
// the same stay together, and are checked and written when the next one comes. Errors as above; limit: the
// yarn fits into no file, or there can be one only.
Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options,
                                                Records::Limits limits = {});

}  // namespace selvage::formats::iges
