// Reals as IGES writes them.
#pragma once

namespace selvage::formats::iges {

// Reads the number at the front of [at, end): an optional sign, digits with at most one point, and an
// exponent with the letter E or D ("1", "-.5", "2.", "1.5D-03"); no blanks in front. Returns the first
// character behind it, and `at` where there is no number or one beyond the range of doubles. The value is the
// double nearest to the text, the very bits of std::from_chars.
const char* read_real(const char* at, const char* end, double& value);

}  // namespace selvage::formats::iges
