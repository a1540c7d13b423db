// Standard output: the results. What cannot be written there is an error, never silence.
#pragma once

#include <string_view>

#include "core/diagnostics.h"

namespace selvage {

// Writes all of it, at once and unbuffered. Error (io): closed, full, a broken pipe where SIGPIPE is ignored.
Status write_to_standard_output(std::string_view text);

// Opens what of standard input, output and error the caller has closed, so that no file of ours gets its
// number. Reading from, or writing to, what was closed fails as before. To be called before anything is
// opened. Error (io).
Status open_standard_streams();

}  // namespace selvage
