// The text of a Part 21 file (ISO 10303-21) as statements: what is counted, where it stands, and whether it
// is whole, before OpenCASCADE sees it. Its parser takes half a file for a whole one and follows references
// in circles.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text_report.h"

namespace selvage::formats::step {

struct Statement {
  Spot spot;  // where it begins
  int id = 0;
  std::uint32_t type = 0;       // in Part21::types
  std::uint32_t first_ref = 0;  // in Part21::refs; up to the next statement's
  bool is_left_out = false;     // at fault, and no shape depends on it: nobody may see it (readable_bytes)
};

// Its spots are in the Source that it was read from.
struct Part21 {
  // Of the header, decoded to UTF-8.
  std::string description, file_name, time_stamp, originating_system;
  std::vector<std::string> schemas;
  Spot schema_spot;  // of FILE_SCHEMA; without it the file's begin

  std::vector<Statement> statements;  // of all DATA sections, by id
  std::vector<int> refs;              // ids that they name, a list a statement, in the order of the text
  std::vector<int> targets;           // places in `statements`, one a reference; -1: in another file
  std::vector<std::string>
      types;  // "CARTESIAN_POINT"; of a complex entity all its types, with a blank between

  // Null for an id that is not in the file.
  [[nodiscard]] const Statement* find(int id) const;
  // The end of the references of the statement in this place.
  [[nodiscard]] std::size_t refs_end(std::size_t place) const;
  [[nodiscard]] std::string_view type_of(const Statement& statement) const { return types[statement.type]; }
};

// The file's bytes for a reader that knows the types of entities: what is left out has a type there that
// nobody knows. `kept` holds them where they are not the source's own. Precondition: `file` was read from
// `source`.
std::string_view readable_bytes(const Source& source, const Part21& file, std::string& kept);

// The first string of a statement, decoded to UTF-8: the name of every representation item. Empty where there
// is none. Precondition: `statement` was read from `source`.
std::string first_string(const Source& source, const Statement& statement);

// Errors, each with its line: another kind of file, a file that ends early, broken statements, an id that is
// defined twice or not at all, entities that refer to each other in a circle. Nothing comes back then.
std::optional<Part21> read_part21(const Source& source, TextReport& report);

}  // namespace selvage::formats::step
