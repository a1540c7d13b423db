// Standard error: the messages, in colours where a person reads them.
#pragma once

#include <string>
#include <string_view>

namespace selvage {

// Lines of messages as to_string() makes them (core/diagnostics.h), their severity in colour: what comes
// after it is found by it.
std::string colored(std::string_view messages);

// Writes messages, in colours where standard error is a terminal that has them. NO_COLOR, set to anything,
// takes them away (https://no-color.org), and so does a TERM that says "dumb".
void write_messages(std::string_view messages);

}  // namespace selvage
