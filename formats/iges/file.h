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
  int font = 0, view = 0;  // fields 4 and 6; only a check asks for them
  int level = 0;           // below 0: minus the pointer to a 406 form 1 with several
  int transformation = 0;  // pointer to a 124; 0: none
  int color = 0;           // 1-8, or minus the pointer to a 314; 0: none
  bool blanked = false;
  // Subordinate entity switch: 0 independent, 1 physically dependent, 2 logically, 3 both.
  int subordinate = 0;
  int use = 0;  // 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 in parameters, 6 construction
  std::array<char, 8> label{};
  int line = 0;  // in the file, from 1

  [[nodiscard]] bool is_physically_dependent() const { return (subordinate & 1) != 0; }
  // "128 at D37"
  [[nodiscard]] std::string name() const;
};

class File {
 public:
  // Reads all but the parameters. Nothing comes back to a reader from what is no IGES, and where lines,
  // global section or directory cannot be understood; a check gets what there is. `source` outlives this.
  static std::optional<File> open(const Source& source, Complaints& complaints);

  [[nodiscard]] const Global& global() const { return global_; }
  [[nodiscard]] const Lines& lines() const { return lines_; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

  // The entry at a directory pointer (its sign is ignored); null where none begins there.
  [[nodiscard]] const DirectoryEntry* entity(int pointer) const;

  // The parameters of an entity, from the first one behind its type. It has failed already where its lines
  // are not there, or where they are those of another entity.
  [[nodiscard]] Parameters parameters(const DirectoryEntry& entry) const;

  // Where a field of the entry begins, 1 to 20 on its two lines.
  [[nodiscard]] Spot spot(const DirectoryEntry& entry, int field = 1) const {
    return lines_.line(Section::directory, entry.pointer + (field - 1) / 10).spot(8 * ((field - 1) % 10) + 1);
  }
  // The eight columns in which a parameter line says whose it is; the pointer there, 0 where none can be
  // read.
  [[nodiscard]] std::string_view owner_text(int parameter_line) const;
  [[nodiscard]] int owner_of(int parameter_line) const {
    return column_number(owner_text(parameter_line)).value_or(0);
  }

 private:
  File(Lines lines, Global global) : lines_(std::move(lines)), global_(std::move(global)) {}
  void read_directory(Complaints& complaints);

  Lines lines_;
  Global global_;
  std::vector<DirectoryEntry> directory_;
};

// The pointers to properties that may follow an entity's own parameters, behind those to associativities. The
// cursor stands behind the last of its own.
std::vector<int> read_properties(Parameters& parameters);

}  // namespace selvage::formats::iges
