#include "formats/txt/edit_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

std::string line_of(const NewEdit& added) {
  const fabric::Edit& edit = added.edit;
  const std::string yarn = is_plain_name(edit.yarn) ? edit.yarn : fmt::format("\"{}\"", edit.yarn);
  const bool in_plane = !added.piece.empty();
  const std::string_view indent = in_plane ? "  " : "";
  const std::string vector = in_plane ? fmt::format("{} {}", added.vector[0], added.vector[1])
                                      : fmt::format("{}", fmt::join(added.vector, " "));
  if (edit.form == fabric::Edit::Form::length)
    return fmt::format("{}edit {} length {} point {} along {}", indent, yarn, added.length, edit.joint,
                       vector);
  return fmt::format("{}edit {} {} {} to {}", indent, yarn, word_of(edit_words, edit.form), edit.joint,
                     vector);
}

}  // namespace

std::string insert_edit(std::string_view bytes, int after, const NewEdit& edit) {
  std::size_t at = 0;
  for (int line = 0; line < after && at < bytes.size(); ++line)
    at = std::min(bytes.find('\n', at), bytes.size() - 1) + 1;
  const std::string_view before = bytes.substr(0, at);
  const std::size_t first_end = bytes.find('\n');
  const bool is_ended = before.ends_with('\n');
  const bool has_return = is_ended ? before.ends_with("\r\n")
                                   : first_end != bytes.npos && bytes.substr(0, first_end).ends_with('\r');
  const std::string_view end = has_return ? "\r\n" : "\n";
  const std::string line = line_of(edit);
  return fmt::format("{}{}{}{}{}", before, is_ended ? "" : end, line, is_ended ? end : "", bytes.substr(at));
}

}  // namespace selvage::formats::txt
