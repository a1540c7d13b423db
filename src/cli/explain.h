// `selvage explain` and the topics of `selvage help`, made of the words of the language and the program's
// codes.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::cli {

// Words and topics that explain() has a text for, each once, in alphabetical order.
std::vector<std::string> explained_words();

// All meanings of this word, of any case, or the text of this topic; empty: a table of words and topics.
// Error (usage): it is unknown.
Result<std::string> explain(const std::string& word);

// Topics of `selvage help` and `selvage explain`: several words together, or none.
std::vector<std::string> all_topics();
// Such a topic, a block of the language with its statements, or what explain() says. Error (usage): it is
// unknown.
Result<std::string> help_of(const std::string& topic);

}  // namespace selvage::cli
