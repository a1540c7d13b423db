#include "formats/knitout/passes.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace selvage::formats::knitout {

namespace {

constexpr int most_feeds = 6;

// Can the loop stand in the pass `open`, behind its last one?
bool goes_on(const StitchGraph& graph, const Passes& passes, const Loop& loop, int open) {
  const Pass& pass = passes.list[static_cast<std::size_t>(open)];
  const Loop& last = graph.loops[static_cast<std::size_t>(pass.loops.back())];
  const int step = passes.column(loop.made) - passes.column(last.made);
  if (loop.direction != pass.direction || step * pass.direction <= 0) return false;
  const auto below = graph.through(loop);
  return std::all_of(below.begin(), below.end(),
                     [&](int number) { return passes.of_loop[static_cast<std::size_t>(number)] < open; });
}

void find_passes(const StitchGraph& graph, Passes& passes) {
  std::unordered_map<std::uint32_t, int> open;  // of each carrier set
  passes.of_loop.reserve(graph.loops.size());
  for (std::size_t i = 0; i < graph.loops.size(); ++i) {
    const Loop& loop = graph.loops[i];
    const auto [found, is_first] = open.try_emplace(loop.carriers, 0);
    if (is_first || !goes_on(graph, passes, loop, found->second)) {
      found->second = static_cast<int>(passes.list.size());
      passes.list.push_back({loop.carriers, loop.direction, {}, 0});
    }
    passes.list[static_cast<std::size_t>(found->second)].loops.push_back(static_cast<int>(i));
    passes.of_loop.push_back(found->second);
  }
}

// The lowest course that the loops below allow, given those of all earlier passes.
int least_course(const StitchGraph& graph, const Passes& passes, const Pass& pass,
                 const std::vector<int>& courses) {
  int least = 0;
  for (const int number : pass.loops) {
    const Loop& loop = graph.loops[static_cast<std::size_t>(number)];
    for (const int below : graph.through(loop))
      least =
          std::max(least, courses[static_cast<std::size_t>(passes.of_loop[static_cast<std::size_t>(below)])] +
                              (loop.is_tuck ? 0 : 1));
  }
  return least;
}

// How many passes most courses have, were there room for all of them.
int usual_feeds(const StitchGraph& graph, const Passes& passes) {
  std::vector<int> courses, counts;
  for (const Pass& pass : passes.list) {
    const int course = least_course(graph, passes, pass, courses);
    courses.push_back(course);
    counts.resize(std::max(counts.size(), static_cast<std::size_t>(course) + 1));
    ++counts[static_cast<std::size_t>(course)];
  }
  std::vector<int> courses_of(most_feeds + 1);
  for (const int count : counts) ++courses_of[static_cast<std::size_t>(std::min(count, most_feeds))];
  courses_of[0] = 0;
  return static_cast<int>(std::max_element(courses_of.begin(), courses_of.end()) - courses_of.begin());
}

// The first course from one on that has room, found in nearly constant time.
class Room {
 public:
  explicit Room(int feeds) : feeds_(feeds) {}

  // Takes a place: the course, and which of its rows.
  std::pair<int, int> take(int course) {
    const auto found = static_cast<std::size_t>(first_free(course));
    const int feed = taken_[found]++;
    if (taken_[found] == feeds_) next_[found] = static_cast<int>(found) + 1;
    return {static_cast<int>(found), feed};
  }

 private:
  int first_free(int course) {
    int root = course;
    for (;;) {
      while (static_cast<std::size_t>(root) >= next_.size()) {
        next_.push_back(static_cast<int>(next_.size()));
        taken_.push_back(0);
      }
      if (next_[static_cast<std::size_t>(root)] == root) break;
      root = next_[static_cast<std::size_t>(root)];
    }
    for (int at = course; at != root;) at = std::exchange(next_[static_cast<std::size_t>(at)], root);
    return root;
  }

  int feeds_;
  std::vector<int> next_, taken_;
};

}  // namespace

Passes passes_of(const StitchGraph& graph) {
  Passes passes;
  passes.is_doubled = std::any_of(graph.loops.begin(), graph.loops.end(),
                                  [](const Loop& loop) { return loop.made.is_between; });
  find_passes(graph, passes);
  if (passes.list.empty()) return passes;
  passes.feeds = std::max(usual_feeds(graph, passes), 1);
  Room room(passes.feeds);
  std::vector<int> courses;
  for (Pass& pass : passes.list) {
    const auto [course, feed] = room.take(least_course(graph, passes, pass, courses));
    courses.push_back(course);
    pass.row = course * passes.feeds + feed;
    passes.courses = std::max(passes.courses, course + 1);
  }
  return passes;
}

}  // namespace selvage::formats::knitout
