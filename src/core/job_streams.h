// Standard streams of a job: files, pipes or /dev/null, and never the terminal, into which a process that is
// led astray could type what the user's shell then runs, and whose looks it could change.
#pragma once

#include <array>
#include <string_view>

namespace selvage {

// Of the standard streams, which a job uses: for it the others are /dev/null. Standard error it always has.
struct UsedStreams {
  bool input = false, output = false;
};

class JobStreams {
 public:
  // Before the job's process is made. False from is_open(): errno says why not.
  explicit JobStreams(UsedStreams used);
  JobStreams(const JobStreams&) = delete;
  JobStreams& operator=(const JobStreams&) = delete;
  JobStreams(JobStreams&& other) noexcept;
  JobStreams& operator=(JobStreams&& other) noexcept;
  ~JobStreams();

  [[nodiscard]] bool is_open() const { return is_open_; }

  // In the job's process. What comes from a terminal is read to its end here, before the job begins. False:
  // the streams cannot be had.
  [[nodiscard]] bool enter();

  // In the parent: closes what is the job's.
  void leave();
  // Passes on what the job wrote, now, to where the terminal is; never waits for the job. False: it cannot be
  // passed on.
  [[nodiscard]] bool relay();
  // Descriptors to wait for; negative: none.
  [[nodiscard]] std::array<int, 2> waiting() const { return {relays_[0].from, relays_[1].from}; }

 private:
  struct Relay {
    int from = -1, into = -1;  // ends of a pipe: the parent's, and the job's
    int to = -1;               // the stream
  };
  void open(Relay& relay, int stream);
  bool relay(Relay& relay);

  UsedStreams used_;
  bool is_open_ = true;
  std::array<Relay, 2> relays_;  // of standard output and standard error, where they are terminals
};

}  // namespace selvage
