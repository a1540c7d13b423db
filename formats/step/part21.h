// The text of a Part 21 file (ISO 10303-21) as statements: what is counted, where it stands, and whether it
// is whole, before OpenCASCADE sees it. Its parser takes half a file for a whole one and follows references
// in circles.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/source.h"
#include "core/text_report.h"

namespace selvage::formats::step {

struct Statement {
  int id = 0;  // of #id
  int line = 0;
  std::uint32_t type = 0;       // in Part21::types
  std::uint32_t first_ref = 0;  // in Part21::refs; up to the next statement's
};

struct Part21 {
  // Of the header, decoded to UTF-8.
  std::string description, file_name, time_stamp, originating_system;
  std::vector<std::string> schemas;

  std::vector<Statement> statements;  // of all DATA sections, by id
  std::vector<int> refs;              // ids that they name, a list a statement
  std::vector<std::string>
      types;  // "CARTESIAN_POINT"; of a complex entity all its types, with a blank between

  // Null for an id that is not in the file.
  [[nodiscard]] const Statement* find(int id) const;
  [[nodiscard]] std::vector<int> refs_of(const Statement& statement) const;
  [[nodiscard]] std::string_view type_of(const Statement& statement) const { return types[statement.type]; }
};

// Errors, each with its line: another kind of file, a file that ends early, broken statements, an id that is
// defined twice or not at all, entities that refer to each other in a circle. Nothing comes back then.
std::optional<Part21> read_part21(const Source& source, TextReport& report);

// A Part 21 string without its quotes as UTF-8: doubled quotes and backslashes, \X\, \S\, \X2\ and \X4\.
// Bytes from 0x80 are kept where they are UTF-8, else taken for Latin-1; control characters become '_'.
std::string decoded(std::string_view text);

}  // namespace selvage::formats::step
