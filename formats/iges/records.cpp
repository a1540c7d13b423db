#include "formats/iges/records.h"

#include <algorithm>
#include <cstring>

#include "core/parallel.h"

namespace selvage::formats::iges {

namespace {

constexpr std::size_t entry_length = 2 * line_length;
// Blanks, and values that move to the next line, are copied in blocks of a fixed length: a few instructions.
// What is too much is written over by what follows; at the end of the buffer it needs room.
constexpr std::ptrdiff_t block = max_number_length;
constexpr std::size_t spare = 2 * block;

// Adds one to a right-justified number with leading blanks; `last` is its last digit.
void count_up(char* last) {
  while (*last == '9') *last-- = '0';
  *last = *last == ' ' ? '1' : static_cast<char>(*last + 1);
}

void right_justified(char* field, std::size_t width, std::int64_t value) {
  char digits[max_number_length];
  char* const end = write_number(digits, static_cast<long long>(value));
  const auto length = static_cast<std::size_t>(end - digits);
  std::memset(field, ' ', width - length);
  std::memcpy(field + width - length, digits, length);
}

}  // namespace

Records::Records(OutputFile& output, std::uint64_t offset, Limits limits, int threads)
    : output_(&output),
      limits_(limits),
      threads_(threads),
      buffer_(std::make_unique_for_overwrite<char[]>(limits.buffer_lines * line_length + spare)),
      line_(buffer_.get()),
      cursor_(line_),
      directory_(std::make_unique_for_overwrite<char[]>(limits.directory_lines / 2 * entry_length)),
      offset_(offset) {
  std::memcpy(tail_, "        P       \n", sizeof tail_);
  number_line();
}

// The number that the present line will have: written whole here, counted up from line to line afterwards.
void Records::number_line() {
  right_justified(tail_ + 9, 7, std::min(lines_ + 1, most_lines));
}

int Records::begin(const Entity& entity) {
  const int pointer = next();
  entity_ = entity;
  entity_line_ = lines_;
  if (measuring_ == Measuring::off) right_justified(tail_ + 1, 7, pointer);
  integer(entity.type);
  return pointer;
}

// Finishes the present line, whose data end at `at`.
void Records::close_line(char* at) {
  const std::ptrdiff_t rest = line_ + data_columns - at;
  std::memset(at, ' ', block);
  if (rest > block) std::memset(at + block, ' ', static_cast<std::size_t>(rest - block));
  std::memcpy(line_ + data_columns, tail_, sizeof tail_);
  ++lines_;
  if (measuring_ != Measuring::off) return;
  if (lines_ < most_lines) count_up(tail_ + 15);
  line_ += line_length;
  if (line_ == buffer_.get() + limits_.buffer_lines * line_length) flush_parameters();
}

// A token that does not fit on the present line begins the next one; returns its end there.
char* Records::next_line(char* token, const char* token_end) {
  char copy[block];
  std::memcpy(copy, token, block);
  const std::ptrdiff_t length = token_end - token;
  close_line(token);
  std::memcpy(line_, copy, block);
  return line_ + length;
}

void Records::integer(std::int64_t value) {
  char* end = write_number(cursor_, static_cast<long long>(value));
  *end++ = ',';
  cursor_ = end > line_ + data_columns ? next_line(cursor_, end) : end;
}

void Records::list(std::span<const int> values) {
  integer(static_cast<std::int64_t>(values.size()));
  for (const int value : values) integer(value);
}

void Records::Tokens::format(const double* values, std::size_t count) {
  text.resize(count * (max_number_length + 1));
  lengths.resize(count);
  char* at = text.data();
  for (std::size_t i = 0; i < count; ++i) {
    char* end = write_pointed(at, values[i]);
    *end++ = ',';
    lengths[i] = static_cast<std::uint8_t>(end - at);
    at = end;
  }
}

// What fits on a line is copied at once.
void Records::put(const Tokens& tokens) {
  const char* from = tokens.text.data();
  for (std::size_t i = 0; i < tokens.lengths.size();) {
    const auto room = static_cast<std::size_t>(line_ + data_columns - cursor_);
    std::size_t run = 0;
    while (i < tokens.lengths.size() && run + tokens.lengths[i] <= room) run += tokens.lengths[i++];
    std::memcpy(cursor_, from, run);
    cursor_ += run;
    from += run;
    if (i == tokens.lengths.size()) return;
    close_line(cursor_);
    cursor_ = line_;
  }
}

void Records::reals_by_threads(const double* values, std::size_t count) {
  constexpr std::size_t chunk = 4096;
  tokens_.resize(4 * static_cast<std::size_t>(threads_));
  for_each_in_order((count + chunk - 1) / chunk, tokens_.size(), threads_,
                    [&](std::size_t i, std::size_t slot) {
                      tokens_[slot].format(values + i * chunk, std::min(chunk, count - i * chunk));
                    },
                    [&](std::size_t /*i*/, std::size_t slot) { put(tokens_[slot]); });
}

void Records::reals(const double* values, std::size_t count) {
  if (measuring_ == Measuring::entities) return;
  constexpr std::size_t many = 20'000;  // to start a thread takes as long as to format a thousand
  if (threads_ > 1 && count >= many) return reals_by_threads(values, count);
  char* at = cursor_;
  const char* limit = line_ + data_columns;
  for (std::size_t i = 0; i < count; ++i) {
    char* end = write_pointed(at, values[i]);
    *end++ = ',';
    if (end > limit) {
      end = next_line(at, end);
      limit = line_ + data_columns;
    }
    at = end;
  }
  cursor_ = at;
}

void Records::ones(std::size_t count) {
  constexpr std::string_view one = "1.,";
  for (std::size_t i = 0; i < count; ++i) {
    if (cursor_ + one.size() > line_ + data_columns) {
      close_line(cursor_);
      cursor_ = line_;
    }
    std::memcpy(cursor_, one.data(), one.size());
    cursor_ += one.size();
  }
}

// A string stays on one line if it can; the count and the first character always stay together.
void Records::text(std::string_view ascii) {
  char head[max_number_length];
  char* head_end = write_number(head, static_cast<long long>(ascii.size()));
  *head_end++ = 'H';
  const auto head_length = static_cast<std::size_t>(head_end - head);
  if (cursor_ != line_ && cursor_ + head_length + ascii.size() + 1 > line_ + data_columns) {
    close_line(cursor_);
    cursor_ = line_;
  }
  std::memcpy(cursor_, head, head_length);
  cursor_ += head_length;
  const auto put = [this](std::string_view part) {
    while (!part.empty()) {
      const auto room = static_cast<std::size_t>(line_ + data_columns - cursor_);
      const std::size_t length = std::min(room, part.size());
      std::memcpy(cursor_, part.data(), length);
      cursor_ += length;
      part.remove_prefix(length);
      if (part.empty()) break;
      close_line(cursor_);
      cursor_ = line_;
    }
  };
  put(ascii);
  put(",");
}

void Records::end(int property) {
  if (property != 0) {
    integer(0);  // associativities that point back
    integer(1);  // properties
    integer(property);
  }
  cursor_[-1] = ';';
  close_line(cursor_);
  cursor_ = line_;
  ++entities_;
  if (measuring_ != Measuring::off) return;
  ++counts_[entity_.type];
  file_entity(entity_line_ + 1, lines_ - entity_line_);
}

// The two directory lines of the entity that has just ended.
void Records::file_entity(std::int64_t first_line, std::int64_t line_count) {
  if (directory_used_ == limits_.directory_lines / 2 * entry_length) flush_directory();
  char* const first = directory_.get() + directory_used_;
  char* const second = first + line_length;
  directory_used_ += entry_length;
  const auto field = [](char* line, std::size_t number, std::int64_t value) {
    right_justified(line + 8 * (number - 1), 8, value);
  };
  field(first, 1, entity_.type);
  field(first, 2, first_line);
  for (const std::size_t number : {3, 4, 6, 8}) field(first, number, 0);
  field(first, 7, entity_.matrix);
  field(first, 5, entity_.level);
  std::memcpy(first + 64, entity_.status.data(), 8);
  first[72] = 'D';
  right_justified(first + 73, 7, 2 * entities_ - 1);
  first[80] = '\n';

  std::memset(second, ' ', 80);
  field(second, 1, entity_.type);
  field(second, 2, 0);
  field(second, 3, -entity_.color);
  field(second, 4, line_count);
  field(second, 5, entity_.form);
  std::string_view label = entity_.label.substr(0, 8);
  while (!label.empty() && label.back() == ' ') label.remove_suffix(1);
  label.copy(second + 64 - label.size(), label.size());
  field(second, 9, 0);
  second[72] = 'D';
  right_justified(second + 73, 7, 2 * entities_);
  second[80] = '\n';
}

Records::Lines Records::measure(Measuring how) {
  const Lines reached = lines();
  if (how != Measuring::off) {
    before_measuring_ = reached;
  } else {
    entities_ = before_measuring_.directory / 2;
    lines_ = before_measuring_.parameters;
    number_line();
  }
  measuring_ = how;
  return reached;
}

void Records::write(std::uint64_t offset, std::string_view bytes) {
  if (status_.ok()) status_ = output_->write_at(offset, bytes);
}

void Records::append(std::vector<Extent>& extents, std::string_view bytes) {
  write(file_end_, bytes);
  if (!extents.empty() && extents.back().offset + extents.back().size == file_end_)
    extents.back().size += bytes.size();
  else
    extents.push_back({file_end_, bytes.size()});
  file_end_ += bytes.size();
}

// Decides where the parameters begin. Not before the first buffer is full, so that a smaller file is always
// exact.
void Records::place_parameters() {
  if (placed_) return;
  placed_ = true;
  room_ = std::max(static_cast<std::uint64_t>(entities_), expected_entities_) * entry_length;
  file_end_ = offset_ + room_;
}

void Records::flush_parameters() {
  place_parameters();
  append(parameter_extents_, {buffer_.get(), static_cast<std::size_t>(line_ - buffer_.get())});
  line_ = buffer_.get();
}

// Directory entries go into the room kept for them, and what does not fit goes between the parameters until
// finish().
void Records::flush_directory() {
  place_parameters();
  std::string_view bytes(directory_.get(), directory_used_);
  std::uint64_t used = 0;
  for (const Extent& extent : directory_extents_) used += extent.size;
  if (used < room_) {
    const std::string_view part =
        bytes.substr(0, static_cast<std::size_t>(std::min<std::uint64_t>(room_ - used, bytes.size())));
    write(offset_ + used, part);
    if (directory_extents_.empty()) directory_extents_.push_back({offset_, 0});
    directory_extents_.front().size += part.size();
    bytes.remove_prefix(part.size());
  }
  if (!bytes.empty()) append(directory_extents_, bytes);
  directory_used_ = 0;
}

// Moves bytes within the file; the places may overlap.
void Records::move(Extent from, std::uint64_t to) {
  if (from.offset == to) return;
  const std::uint64_t most = limits_.buffer_lines * line_length;
  for (std::uint64_t done = 0; done < from.size && status_.ok();) {
    const std::uint64_t size = std::min(most, from.size - done);
    // Up: the last block first; down: the first.
    const std::uint64_t at = to > from.offset ? from.size - done - size : done;
    const Result<std::string> bytes = output_->read_at(from.offset + at, static_cast<std::size_t>(size));
    if (!bytes) {
      status_ = bytes.error();
      return;
    }
    write(to + at, *bytes);
    done += size;
  }
}

Result<std::uint64_t> Records::finish() {
  if (!placed_) expected_entities_ = 0;  // nothing has to be guessed any more
  flush_parameters();
  flush_directory();
  const std::uint64_t directory_size = static_cast<std::uint64_t>(entities_) * entry_length;
  const std::uint64_t end = offset_ + directory_size + static_cast<std::uint64_t>(lines_) * line_length;
  if (directory_size != room_) {
    // Directory blocks that lie among the parameters wait behind everything while the parameters close up.
    std::uint64_t waiting = std::max(end, file_end_);
    std::vector<Extent> strayed;
    for (const Extent& extent : directory_extents_) {
      if (extent.offset < offset_ + room_) continue;
      move(extent, waiting);
      strayed.push_back({waiting, extent.size});
      waiting += extent.size;
    }
    std::uint64_t to = end;
    if (directory_size > room_) {
      for (auto extent = parameter_extents_.rbegin(); extent != parameter_extents_.rend(); ++extent)
        move(*extent, to -= extent->size);
    } else {
      for (const Extent& extent : parameter_extents_) move(extent, offset_ + directory_size);  // there is one
    }
    to = offset_ + directory_size - (waiting - std::max(end, file_end_));
    for (const Extent& extent : strayed) {
      move(extent, to);
      to += extent.size;
    }
  }
  if (status_.ok()) status_ = output_->resize(end);
  if (!status_.ok()) return status_.error();
  return end;
}

}  // namespace selvage::formats::iges
