#include "core/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "core/readable.h"

namespace selvage {

namespace {

constexpr double bar_interval = 0.1;  // seconds
constexpr double line_interval = 10;  // seconds

std::size_t terminal_columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80U;
}

std::chrono::steady_clock::duration as_duration(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds));
}

}  // namespace

ProgressDisplay::ProgressDisplay(bool wanted, std::size_t total)
    : wanted_(wanted),
      on_terminal_(wanted && ::isatty(STDERR_FILENO) != 0),
      total_(total),
      start_(Clock::now()) {
  // A job of a blink shows nothing.
  next_ = start_ + as_duration(on_terminal_ ? 0.3 : line_interval);
}

void ProgressDisplay::set(std::size_t done, std::size_t failed, std::string detail) {
  done_ = done;
  failed_ = failed;
  detail_ = std::move(detail);
}

std::string ProgressDisplay::line() const {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  std::string text = fmt::format("{} of {} inputs done", done_, total_);
  if (failed_ > 0) text += fmt::format(", {} failed", failed_);
  text += fmt::format(", {:.0f} s", seconds);
  if (done_ > 0 && done_ < total_)
    text += fmt::format(", about {:.0f} s left",
                        seconds / static_cast<double>(done_) * static_cast<double>(total_ - done_));
  if (!detail_.empty()) text += "; " + readable(detail_);
  return text;
}

double ProgressDisplay::tick() {
  if (!wanted_) return 3600;
  const Clock::time_point now = Clock::now();
  if (now >= next_) {
    next_ = now + as_duration(on_terminal_ ? bar_interval : line_interval);
    if (on_terminal_) {
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

}  // namespace selvage
