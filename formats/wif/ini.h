// The INI skeleton of a WIF file with the place of everything in it: libraries for INI files tell no columns,
// and the errors here point at the value.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/source.h"
#include "core/text_report.h"
#include "core/words.h"

namespace selvage::formats::wif {

// KEY=VALUE, both without the blanks round them. Views of the source's bytes.
struct Entry {
  std::string_view key, value;
  Spot key_spot, value_spot;
  bool has_value = true;  // false: there was no '=' on the line
};

struct Section {
  std::string_view name;
  Spot spot;
  std::vector<Entry> entries;  // in file order

  // The first entry with this key, any case: the one that Windows would give. Null: there is none.
  [[nodiscard]] const Entry* find(std::string_view key) const;
};

// The sections of a file. One that stands there twice is one with all entries, and a warning; text before the
// first section is a warning, too. Lines end with LF, CRLF or CR; a line that begins with ';' is a comment.
class Ini {
 public:
  Ini(const Source& source, TextReport& report);

  // Names in any case. Null: there is none.
  [[nodiscard]] const Section* find(std::string_view name) const;
  [[nodiscard]] const Entry* find(std::string_view section, std::string_view key) const;
  [[nodiscard]] const std::vector<Section>& sections() const { return sections_; }
  [[nodiscard]] const Spot& end() const { return end_; }
  [[nodiscard]] std::size_t size() const { return end_.offset; }  // bytes

 private:
  void read_line(std::string_view line, const Spot& begin, TextReport& report);
  void open_section(std::string_view name, const Spot& spot, TextReport& report);

  std::vector<Section> sections_;
  std::unordered_map<std::string, std::size_t> places_;  // in sections_, by names in lower case
  std::size_t current_ = 0;                              // index into sections_, if there is one
  bool warned_of_prelude_ = false;
  Spot end_;
};

// Is there a line [WIF] in these bytes?
bool has_wif_section(std::string_view head);

}  // namespace selvage::formats::wif
