// The lines of a fixed-length ASCII IGES file, found once and not copied: five sections in order, of which
// each line has its letter in column 73 and its number within the section in columns 74-80.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/source.h"
#include "formats/iges/complaints.h"

namespace selvage::formats::iges {

enum class Section { start, global, directory, parameter, terminate };

inline constexpr std::size_t section_count = 5;
inline constexpr std::string_view section_letters = "SGDPT";
inline constexpr std::array<std::string_view, section_count> section_names = {"start", "global", "directory",
                                                                              "parameter", "terminate"};

// One line of the file, without its line end. The data of a parameter line are columns 1-64, else 1-72.
struct Line {
  const char* at = nullptr;  // column 1
  std::size_t offset = 0;    // the same, in Source::bytes()
  int length = 0;            // all columns that are there
  int data = 0;              // of them, those that hold data
  int number = 0;            // in the file, from 1
  bool is_shifted = false;   // its letter stands in another column than 73: a character was lost or put in

  [[nodiscard]] std::string_view text() const { return {at, static_cast<std::size_t>(length)}; }
  // `column` from 1.
  [[nodiscard]] Spot spot(int column = 1) const {
    return Spot{offset, number, 1}.behind(static_cast<std::size_t>(std::max(column, 1)) - 1);
  }
};

class Lines {
 public:
  // Lines that end with LF or CR LF, or of 80 columns without any end. Refused by a reader, with a message
  // that names it: compressed ASCII, binary, what is no IGES file; a line without a section letter, sections
  // out of order, line numbers out of order (a line is missing). A check always gets what lines there are.
  // `source` outlives this.
  static std::optional<Lines> index(const Source& source, Complaints& complaints);

  [[nodiscard]] int count(Section section) const {
    const auto at = static_cast<std::size_t>(section);
    return stride_ != 0 ? ranges_[at].count : static_cast<int>(irregular_[at].size());
  }
  // `number` from 1 to count(section).
  [[nodiscard]] Line line(Section section, int number) const {
    const auto of_section = static_cast<std::size_t>(section);
    if (stride_ == 0) return irregular_[of_section][static_cast<std::size_t>(number) - 1];
    const int at = ranges_[of_section].first + number - 1;
    const std::size_t offset = static_cast<std::size_t>(at) * stride_;
    return {bytes_.data() + offset, offset, 80, section == Section::parameter ? 64 : 72, at + 1};
  }
  // Where the file ends.
  [[nodiscard]] Spot end() const { return end_; }

 private:
  struct Range {
    int first = 0, count = 0;  // lines of the file, from 0
  };
  class Order;
  Lines() = default;

  bool find_stride(bool is_check);
  bool index_regular(Complaints& complaints);
  bool index_irregular(Complaints& complaints);
  bool add_irregular(Line line, std::size_t letter, Order& order, Complaints& complaints);
  void check_sections(Complaints& complaints) const;

  std::string_view bytes_;
  std::size_t stride_ = 0;  // of a file all of whose lines are equally long, line end included; else 0
  std::array<Range, section_count> ranges_{};
  std::array<std::vector<Line>, section_count> irregular_;
  Spot end_;
};

// Blanks and digits only?
bool is_number_field(std::string_view field);
// The integer in the columns of a field, with blanks and zeros before or behind it: a blank field is 0.
// Nothing when it is no integer or has more than 9 digits.
std::optional<int> column_number(std::string_view field);

}  // namespace selvage::formats::iges
