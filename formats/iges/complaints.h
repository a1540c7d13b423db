// What is wrong with an IGES file, said by the parser alike to who reads the file and to who checks it: a
// reader refuses what it cannot read and puts up with the rest, a check notes everything and goes on.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "core/findings.h"
#include "core/text_report.h"

namespace selvage::formats::iges {

class Complaints {
 public:
  explicit Complaints(TextReport& reader) : reader_(&reader) {}
  explicit Complaints(Findings& check) : check_(&check) {}

  [[nodiscard]] bool is_check() const { return check_ != nullptr; }
  // Is it of use to read on? For a check it always is.
  [[nodiscard]] bool goes_on() const { return is_check() || reader_->errors() == 0; }

  // What cannot be read: an error, a defect for a check. Returns goes_on().
  bool fault(const Spot& spot, std::string text, Kind of_error = Kind::malformed) {
    if (is_check())
      check_->defect(std::move(text), spot.place());
    else
      reader_->error(spot, std::move(text), of_error);
    return goes_on();
  }
  // What a reader puts up with, and says so: a warning, a defect for a check.
  void flaw(const Spot& spot, std::string text) {
    is_check() ? check_->defect(std::move(text), spot.place()) : reader_->warning(spot, std::move(text));
  }
  // The same for what may be so on every line: a reader says it once of each `habit`. `text` makes the text.
  template <class Text>
  void habit(std::string_view habit, const Spot& spot, Text text) {
    if (is_check() || habits_.insert(habit).second) flaw(spot, text());
  }
  // What a reader does not mind.
  void defect(const Spot& spot, std::string text) {
    if (is_check()) check_->defect(std::move(text), spot.place());
  }
  void warning(const Spot& spot, std::string text) {
    if (is_check()) check_->warning(std::move(text), spot.place());
  }
  // What a reader makes of the file: nothing that a check judges.
  void reader_warning(const Spot& spot, std::string text) {
    if (!is_check()) reader_->warning(spot, std::move(text));
  }
  void reader_note(const Spot& spot, std::string text) {
    if (!is_check() && goes_on()) reader_->note(spot, std::move(text));
  }

 private:
  TextReport* reader_ = nullptr;
  Findings* check_ = nullptr;
  std::set<std::string_view> habits_;
};

}  // namespace selvage::formats::iges
