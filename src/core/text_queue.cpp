#include "core/text_queue.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace selvage {

TextQueue::TextQueue(OutputFile& output, int threads)
    : output_(output), threads_(static_cast<std::size_t>(std::max(threads, 1))) {
  spare_.reserve(2 * threads_);
}

TextQueue::~TextQueue() {
  {
    const Lock lock(guard_);
    is_over_ = true;
  }
  changed_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void TextQueue::add(std::string text) {
  push({{}, std::move(text), State::made});
}

void TextQueue::add(Make make) {
  try {
    while (helpers_.size() + 1 < threads_) helpers_.emplace_back([this] { help(); });
  } catch (const std::system_error&) {  // no room for its stack, or a limit: those that there are do it all
    threads_ = helpers_.size() + 1;
  }
  push({std::move(make), {}, State::waiting});
}

void TextQueue::push(Piece piece) {
  Lock lock(guard_);
  pieces_.push_back(std::move(piece));
  changed_.notify_one();
  while (pieces_.size() > 8 * threads_)
    if (!work(lock)) changed_.wait(lock);
}

Status TextQueue::finish() {
  Lock lock(guard_);
  while (!pieces_.empty() || is_writing_)
    if (!work(lock)) changed_.wait(lock);
  if (failure_) std::rethrow_exception(failure_);
  return status_;
}

void TextQueue::help() {
  Lock lock(guard_);
  while (!is_over_)
    if (!work(lock)) changed_.wait(lock);
}

bool TextQueue::work(Lock& lock) {
  if (!is_writing_ && !pieces_.empty() && pieces_.front().state == State::made) {
    write_first(lock);
    return true;
  }
  const auto waiting = std::ranges::find(pieces_, State::waiting, &Piece::state);
  if (waiting == pieces_.end()) return false;
  make(*waiting, lock);
  return true;
}

void TextQueue::write_first(Lock& lock) {
  std::string text = std::move(pieces_.front().text);
  pieces_.pop_front();
  is_writing_ = true;
  guarded(lock, [&] {
    Status status = output_.write(text);
    if (status.ok()) return true;
    status_ = std::move(status);  // read when nobody writes any more
    return false;
  });
  is_writing_ = false;
  recycle(std::move(text));
  changed_.notify_all();
}

void TextQueue::make(Piece& piece, Lock& lock) {
  std::string text;
  if (!spare_.empty()) {
    text = std::move(spare_.back());
    spare_.pop_back();
  }
  piece.state = State::being_made;
  guarded(lock, [&] {
    piece.make(text);
    return true;
  });
  piece.make = {};
  piece.text = std::move(text);
  piece.state = State::made;
  changed_.notify_all();
}

// Runs without the lock, unless all is dropped; what it throws is kept.
template <class Run>
void TextQueue::guarded(Lock& lock, const Run& run) {
  if (failure_ || has_failed_) return;
  lock.unlock();
  std::exception_ptr failure;
  bool fails = false;
  try {
    fails = !run();
  } catch (...) {
    failure = std::current_exception();
  }
  lock.lock();
  if (!failure_) failure_ = failure;
  has_failed_ = has_failed_ || fails;
}

// As many as may be in the hands of threads at once; the others' memory is given back.
void TextQueue::recycle(std::string text) {
  if (spare_.size() >= 2 * threads_) return;
  text.clear();
  spare_.push_back(std::move(text));
}

}  // namespace selvage
