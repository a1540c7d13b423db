// The way of the file's text from OpenCASCADE to the OutputFile. Internal to the module selvage_occt.
#pragma once

#include <streambuf>
#include <string>
#include <string_view>

#include "core/output.h"

namespace selvage::formats::step {

// Takes the text of a Part 21 file (ISO 10303-21) and writes it in blocks of a MiB with the same content, but
//   reals in the shortest decimal form that reads back to the same bits, with the decimal point that Part 21
//   asks for.
//     OpenCASCADE prints them by one printf format for all, which must be %a here: with 17 digits 0.1 would
//     read 1.0000000000000001E-01, and with fewer bits are lost;
//   strings whole on one line, and their UTF-8 in the standard's own form (\X2\00FC\X0\), which older readers
//   need; the other lines filled anew to at most 80 columns.
class StepStream : public std::streambuf {
 public:
  explicit StepStream(OutputFile& output);

  // Writes what is left. The first refusal of the OutputFile, if there was one.
  Status close();

 protected:
  int overflow(int c) override;
  int sync() override;

 private:
  // Takes over the buffer's complete lines (everything when `all`) and keeps the rest.
  void drain(bool all);
  void convert(std::string_view text);
  void convert_string(std::string_view piece);
  void put(std::string_view token);
  void put_number(std::string_view number);
  void put_encoded();

  OutputFile& output_;
  std::string raw_;  // as OpenCASCADE printed it
  std::string out_;  // ready to be written
  bool in_string_ = false;
  bool after_backslash_ = false;  // inside a string, the first of two
  std::string encoded_;           // bytes of UTF-8 inside a string that are not written yet
  std::size_t column_ = 0;        // where the next character goes
  char last_ = '\n';              // the last character written
  Status status_;
};

}  // namespace selvage::formats::step
