// An IGES file as it stands in memory: global values, directory, and a cursor for the parameters of each
// entity. Nothing of the file is copied.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "formats/iges/global.h"
#include "formats/iges/lines.h"
#include "formats/iges/parameters.h"

namespace selvage::formats::iges {

// Two directory lines. Fields that are pointers are as in the file (negative where the standard marks them
// so).
struct DirectoryEntry {
  int type = 0;
  int form = 0;
  int pointer = 0;         // its own: the number of its first line, odd
  int first_line = 0;      // of its parameters, from 1
  int line_count = 0;      // of them, as the entry says
  int structure = 0;       // field 3
  int level = 0;           // below 0: minus the pointer to a 406 form 1 with several
  int transformation = 0;  // pointer to a 124; 0: none
  int color = 0;           // 1-8, or minus the pointer to a 314; 0: none
  bool blanked = false;
  // Subordinate entity switch: 0 independent, 1 physically dependent, 2 logically, 3 both.
  int subordinate = 0;
  int use = 0;  // 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 in parameters, 6 construction
  int hierarchy = 0;
  std::array<char, 8> label{};
  int subscript = 0;
  int line = 0;  // in the file, from 1

  [[nodiscard]] bool is_physically_dependent() const { return (subordinate & 1) != 0; }
  // "128 at D37"
  [[nodiscard]] std::string name() const;
};

class File {
 public:
  // Reads all but the parameters. Errors (nothing comes back): no IGES; lines, global section or directory
  // that cannot be understood. `source` outlives this.
  static std::optional<File> open(const Source& source, TextReport& report);

  [[nodiscard]] const Global& global() const { return global_; }
  [[nodiscard]] const Lines& lines() const { return lines_; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

  // The entry at a directory pointer (its sign is ignored); null where none begins there.
  [[nodiscard]] const DirectoryEntry* entity(int pointer) const;

  // The parameters of an entity, from the first one behind its type. It has failed already where its lines
  // are not there, or where they are those of another entity.
  [[nodiscard]] Parameters parameters(const DirectoryEntry& entry) const;

  // Column 1 of the entry's first line.
  [[nodiscard]] Spot spot(const DirectoryEntry& entry) const {
    return lines_.line(Section::directory, entry.pointer).spot();
  }

 private:
  File(Lines lines, Global global) : lines_(std::move(lines)), global_(std::move(global)) {}
  bool read_directory(TextReport& report);
  void check_terminate(TextReport& report) const;
  [[nodiscard]] int owner_of(int parameter_line) const;

  Lines lines_;
  Global global_;
  std::vector<DirectoryEntry> directory_;
};

// The pointers that may follow an entity's own parameters. The cursor stands behind the last of these.
struct Trailer {
  std::vector<int> associativities, properties;
};
Trailer read_trailer(Parameters& parameters);

// The standard's name of an entity type: "rational B-spline surface"; empty for a type that it does not have.
std::string_view entity_title(int type);

}  // namespace selvage::formats::iges
