#include "core/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/readable.h"

namespace selvage {

namespace {

constexpr double bar_interval = 0.1;   // seconds
constexpr double line_interval = 10;   // seconds
constexpr double json_interval = 0.5;  // seconds

std::size_t terminal_columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80U;
}

std::chrono::steady_clock::duration as_duration(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds));
}

}  // namespace

ProgressDisplay::ProgressDisplay(ProgressForm form, std::size_t total)
    : form_(form),
      on_terminal_(form == ProgressForm::shown && ::isatty(STDERR_FILENO) != 0),
      total_(total),
      start_(Clock::now()) {
  // A job of a blink shows nothing.
  next_ = start_ + as_duration(form == ProgressForm::json ? 0 : on_terminal_ ? 0.3 : line_interval);
}

void ProgressDisplay::set(std::size_t done, std::size_t failed, std::string detail) {
  done_ = done;
  failed_ = failed;
  detail_ = std::move(detail);
}

double ProgressDisplay::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

std::optional<double> ProgressDisplay::seconds_left() const {
  if (done_ == 0) return std::nullopt;
  return seconds() / static_cast<double>(done_) * static_cast<double>(total_ - std::min(done_, total_));
}

std::string ProgressDisplay::line() const {
  std::string text = fmt::format("{} of {} inputs done", done_, total_);
  if (failed_ > 0) text += fmt::format(", {} failed", failed_);
  text += fmt::format(", {:.0f} s", seconds());
  if (done_ < total_ && seconds_left()) text += fmt::format(", about {:.0f} s left", *seconds_left());
  if (!detail_.empty()) text += "; " + readable(detail_);
  return text;
}

std::string ProgressDisplay::object() const {
  // What is unknown is left out, as in the report.
  nlohmann::ordered_json object = {
      {"progress", total_ == 0 ? 1.0 : static_cast<double>(done_) / static_cast<double>(total_)},
      {"inputs", total_},
      {"done", done_},
      {"failed", failed_},
      {"seconds", std::round(10 * seconds()) / 10}};
  if (const auto left = seconds_left()) object["seconds_left"] = std::round(10 * *left) / 10;
  if (!detail_.empty()) object["doing"] = detail_;
  return object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

double ProgressDisplay::tick() {
  if (form_ == ProgressForm::none) return 3600;
  const Clock::time_point now = Clock::now();
  if (now >= next_) {
    next_ = now + as_duration(form_ == ProgressForm::json ? json_interval
                              : on_terminal_              ? bar_interval
                                                          : line_interval);
    if (form_ == ProgressForm::json) {
      std::fprintf(stderr, "%s\n", object().c_str());
    } else if (on_terminal_) {
      constexpr std::size_t width = 20;
      const std::size_t filled = total_ == 0 ? 0 : width * std::min(done_, total_) / total_;
      const std::string text = fmt::format("[{:<{}}] {}", std::string(filled, '#'), width, line());
      std::fprintf(stderr, "\r\033[K%s",
                   shortened(text, std::max<std::size_t>(terminal_columns(), 8) - 1).c_str());
      std::fflush(stderr);
      drawn_ = true;
    } else {
      std::fprintf(stderr, "selvage: %s\n", line().c_str());
    }
  }
  return std::chrono::duration<double>(next_ - now).count();
}

void ProgressDisplay::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

void ProgressDisplay::finish() {
  clear();
  detail_.clear();
  if (form_ == ProgressForm::json) std::fprintf(stderr, "%s\n", object().c_str());
}

}  // namespace selvage
