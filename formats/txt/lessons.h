// Every word of the language, explained once: formats/language.h. Tests hold it against the parser's own
// tables.
#pragma once

#include <span>

#include "formats/language.h"

namespace selvage::formats::txt {

const Language& language();

// lessons.cpp: the statements. values.cpp: the words within them. templates.cpp, made of the folder of that
// name: texts to begin with, in the order of its list.
std::span<const Lesson> all_lessons();
std::span<const Value> all_values();
std::span<const Template> all_templates();

// grammar.cpp
std::string textmate_grammar(const Language& language);

}  // namespace selvage::formats::txt
