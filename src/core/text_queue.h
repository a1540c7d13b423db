// Text that threads make, on its way to an OutputFile in order.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/output.h"

namespace selvage {

// Pieces of text are written in the order in which they were added, while later ones are made. Who adds goes
// on meanwhile, and helps where more than a few wait; helpers are started when the first piece is to be made.
// Members are never called by two threads at a time.
class TextQueue {
 public:
  // Adds a piece to an empty text; called by any thread, once.
  using Make = std::function<void(std::string&)>;

  // As many `threads` as that, the caller's among them: at least 1.
  TextQueue(OutputFile& output, int threads);
  TextQueue(const TextQueue&) = delete;
  TextQueue& operator=(const TextQueue&) = delete;
  ~TextQueue();  // what is not written yet is dropped

  void add(std::string text);
  void add(Make make);
  // Waits until all is written. The first failure of the file (io), or what a make() has thrown, which is
  // thrown again: after it nothing more is made or written.
  Status finish();

 private:
  enum class State { waiting, being_made, made };
  struct Piece {
    Make make;
    std::string text;
    State state;
  };
  using Lock = std::unique_lock<std::mutex>;

  void push(Piece piece);
  // Writes a piece, or makes one; false: all are in the hands of others.
  bool work(Lock& lock);
  void write_first(Lock& lock);
  void make(Piece& piece, Lock& lock);
  template <class Run>
  void guarded(Lock& lock, const Run& run);
  void recycle(std::string text);
  void help();

  OutputFile& output_;
  std::size_t threads_;
  std::vector<std::thread> helpers_;
  std::mutex guard_;
  std::condition_variable changed_;
  std::deque<Piece> pieces_;
  std::vector<std::string> spare_;  // a few, whose memory is used again
  bool is_writing_ = false, is_over_ = false, has_failed_ = false;
  std::exception_ptr failure_;
  Status status_;  // the file's, once it has failed
};

}  // namespace selvage
