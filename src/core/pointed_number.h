// Numbers as IGES and STEP have reals.
#pragma once

#include "core/number_text.h"

namespace selvage {

// Writes a finite `value` by the shortest digits that read back to the same bits, always with a decimal
// point, exponent letter E: "0.1", "-3.", "1.E+22". At most max_number_length bytes; returns the end.
inline char* write_pointed(char* out, double value) {
  char* end = write_number(out, value);
  char* exponent = end;
  if (end - out > 4 && end[-4] == 'e') exponent = end - 4;
  if (end - out > 5 && end[-5] == 'e') exponent = end - 5;
  char* at = out;
  while (at != exponent && *at != '.') ++at;
  if (at == exponent) {  // no point among the digits
    for (char* from = end; from != exponent; --from) *from = from[-1];
    *exponent++ = '.';
    ++end;
  }
  if (exponent != end) *exponent = 'E';
  return end;
}

}  // namespace selvage
