// `selvage explain` and the topics of `selvage help`, made of the words of the language and the program's
// codes.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::cli {

// Every word that explain() knows, each once, in alphabetical order.
std::vector<std::string> explained_words();

// Of this word, of any case, all that it means; empty: a table of the words. Error (usage): it is unknown.
Result<std::string> explain(const std::string& word);

// Topics of `selvage help` that are neither commands nor words.
std::vector<std::string> all_topics();
// Such a topic, a block of the language with its statements, or what explain() says. Error (usage): it is
// unknown.
Result<std::string> help_of(const std::string& topic);

}  // namespace selvage::cli
