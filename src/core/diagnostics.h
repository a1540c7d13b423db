// What went wrong, where, and what to do about it.
//
// Every boundary of the program returns Result<T>: a value or a Message. Functions that can report several
// things (readers, checks) also take a Diagnostics that collects warnings and further errors.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/vec.h"

namespace selvage {

enum class Severity { note, warning, error };

enum class Kind {
  malformed,    // the input breaks its format's rules
  unsupported,  // well formed, but not something that this version does
  io,           // the operating system refused: missing, no permission, full
  geometry,     // the shape is impossible or defective
  limit,        // a size, time, memory or format limit would be passed
  usage,        // the command line
  internal,     // our own fault: a crash of a worker, a broken invariant
  interrupted,  // Ctrl-C or a signal
};

// Where in a text file something stands; line and column count from 1, 0 means unknown.
// Columns count bytes; a tab is one column.
struct TextPlace {
  int line = 0;
  int column = 0;
};

// What a message is about; what is unknown stays empty.
struct About {
  std::string file{};        // as the user named it
  TextPlace place{};         // in `file`
  std::string yarn{};        // the yarn concerned
  std::optional<Vec3> at{};  // the place in the model concerned, in file units
};

struct Message : About {
  Severity severity = Severity::error;
  Kind kind = Kind::malformed;
  std::string text{};     // what is wrong and, where it is known, the remedy; no trailing newline
  std::string excerpt{};  // the offending line (shortened when long), without its newline
  int caret = 0;          // 1-based column in `excerpt` under which the caret stands; 0: none

  // The same, of this place, file, yarn or point where it does not say one itself.
  [[nodiscard]] Message placed(TextPlace where, std::string_view in_file = {}) const;
  [[nodiscard]] Message of_yarn(std::string_view name, TextPlace where = {}) const;
  [[nodiscard]] Message at_point(const Vec3& point) const;
};

// "FILE:LINE:COLUMN: error: TEXT" and, with an excerpt, the line and a caret under it; parts that are
// unknown are left out ("FILE: error: TEXT"). The yarn and the place in space follow the text when the text
// does not name the yarn itself. No trailing newline.
std::string to_string(const Message& message);

std::string_view name_of(Severity severity);
std::string_view name_of(Kind kind);

// Short makers of a Message.
Message error(Kind kind, std::string text, About about = {});
Message warning(Kind kind, std::string text, About about = {});
Message note(Kind kind, std::string text);

// The known word nearest to `word` (edit distance, ignoring case) if it is near enough to be what the user
// meant (at most a third of its length away); empty otherwise. Used for "did you mean".
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& known);

// Collects messages. Errors past `max_errors` are counted, not kept.
class Diagnostics {
 public:
  explicit Diagnostics(int max_errors = 20) : max_errors_(max_errors) {}

  void add(Message message);

  [[nodiscard]] bool has_errors() const { return errors_ > 0; }
  [[nodiscard]] int error_count() const { return errors_; }
  // True once as many errors are kept as are shown: a reader may stop here.
  [[nodiscard]] bool is_full() const { return errors_ >= max_errors_; }
  [[nodiscard]] const std::vector<Message>& messages() const { return messages_; }
  [[nodiscard]] const Message* first_error() const;

 private:
  int max_errors_;
  int errors_ = 0;
  std::vector<Message> messages_;
};

// A value or the Message that says why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT: implicit by design
  Result(Message message)
      : state_(std::in_place_index<1>, std::move(message)) {}  // NOLINT: implicit by design

  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() { return std::get<0>(state_); }
  const T& value() const { return std::get<0>(state_); }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  Message& error() { return std::get<1>(state_); }
  const Message& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Message> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Message message) : message_(std::move(message)) {}  // NOLINT: implicit by design

  [[nodiscard]] bool ok() const { return !message_; }
  explicit operator bool() const { return ok(); }
  Message& error() { return *message_; }
  const Message& error() const { return *message_; }

 private:
  std::optional<Message> message_;
};

using Status = Result<void>;

}  // namespace selvage
