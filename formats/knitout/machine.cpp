#include "formats/knitout/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage::formats::knitout {

std::string name_of(const Needle& needle) {
  return fmt::format("{}{}{}", needle.bed == Bed::front ? 'f' : 'b', needle.is_slider ? "s" : "",
                     needle.number);
}

Machine::Machine(const Header& header, TextReport& report) : header_(header), report_(report) {
  for (const std::string_view name : header.carriers) {
    carrier_numbers_.emplace(name, static_cast<int>(graph_.carriers.size()));
    graph_.carriers.emplace_back(name);
  }
  states_.resize(graph_.carriers.size());
}

Machine::Stack& Machine::stack(const Needle& needle) {
  const std::size_t list = (needle.bed == Bed::front ? 0U : 1U) + (needle.is_slider ? 2U : 0U);
  return stacks_[list][needle.number];
}

// At racking R the back needle B faces the front needle B + R.
int Machine::facing(const Needle& needle) const {
  const int whole = static_cast<int>(whole_);
  return needle.bed == Bed::front ? needle.number - whole : needle.number + whole;
}

Station Machine::station(const Needle& needle) const {
  const int column = needle.bed == Bed::front ? needle.number : facing(needle);
  return {column, !is_aligned(), needle.bed};
}

int Machine::carrier(const Carrier& named) {
  const auto found = carrier_numbers_.find(named.name);
  if (found != carrier_numbers_.end()) return found->second;
  if (!header_.has_carriers && graph_.carriers.size() == most_carriers) {
    report_.error(named.spot, fmt::format("a machine has at most {} carriers", most_carriers), Kind::limit);
    return -1;
  }
  if (!header_.has_carriers) {  // any name is one
    const int number = static_cast<int>(graph_.carriers.size());
    graph_.carriers.emplace_back(named.name);
    states_.emplace_back();
    carrier_numbers_.emplace(named.name, number);
    return number;
  }
  report_.error(named.spot,
                fmt::format("there is no carrier {}: the header names {}", in_quotes(named.name),
                            header_.carriers.empty() ? std::string("none")
                                                     : fmt::format("{}", fmt::join(header_.carriers, " "))));
  return -1;
}

bool Machine::find_carriers(const Operation& operation) {
  set_.clear();
  for (const Carrier& named : operation.carriers) {
    const int number = carrier(named);
    if (number < 0) return false;
    if (std::find(set_.begin(), set_.end(), number) != set_.end()) {
      report_.error(named.spot, fmt::format("carrier {} is named twice", in_quotes(named.name)));
      return false;
    }
    set_.push_back(number);
  }
  return true;
}

bool Machine::all_in(const Operation& operation) {
  for (std::size_t i = 0; i < set_.size(); ++i) {
    State& state = states_[static_cast<std::size_t>(set_[i])];
    if (state.is_in) {
      state.is_used = true;
      continue;
    }
    const Carrier& named = operation.carriers[i];
    report_.error(named.spot,
                  fmt::format("carrier {} is not in: bring it in before, by 'inhook {}' or 'in {}'",
                              in_quotes(named.name), named.name, named.name));
    state = {true, false, true, operation.spot};  // said once
    return false;
  }
  return true;
}

bool Machine::is_on_bed(const Needle& needle, const Spot& spot) {
  const int least = std::min(least_used_, needle.number), most = std::max(most_used_, needle.number);
  if (most - least >= widest_bed) {
    report_.error(
        spot,
        fmt::format("needle {} is beyond the bed: from {} to {} are {} needles, and the widest beds "
                    "have {}",
                    name_of(needle), least, most, most - least + 1, widest_bed),
        Kind::limit);
    return false;
  }
  least_used_ = least;
  most_used_ = most;
  return true;
}

bool Machine::takes_yarn(const Operation& operation) {
  if (!operation.needle.is_slider) return true;
  report_.error(
      operation.needle_spot,
      fmt::format("{} is a slider, which only holds loops: a needle takes yarn", name_of(operation.needle)));
  return false;
}

void Machine::bring_in(const Operation& operation) {
  if (!find_carriers(operation)) return;
  for (std::size_t i = 0; i < set_.size(); ++i) {
    State& state = states_[static_cast<std::size_t>(set_[i])];
    const Carrier& named = operation.carriers[i];
    if (state.is_in)
      report_.error(named.spot, fmt::format("carrier {} is in already, since line {}", in_quotes(named.name),
                                            state.spot.line));
    state = {true, operation.verb == Verb::inhook, false, operation.spot};
  }
}

void Machine::take_out(const Operation& operation) {
  if (!find_carriers(operation)) return;
  for (std::size_t i = 0; i < set_.size(); ++i) {
    State& state = states_[static_cast<std::size_t>(set_[i])];
    const Carrier& named = operation.carriers[i];
    if (!state.is_in)
      report_.error(named.spot, fmt::format("carrier {} is not in", in_quotes(named.name)));
    else if (!state.is_used)
      report_.warning(state.spot,
                      fmt::format("carrier {} is brought in, and knits nothing", in_quotes(named.name)));
    warn_of_hook(state, graph_.carriers[static_cast<std::size_t>(set_[i])]);
    state = {};
  }
}

void Machine::release(const Operation& operation) {
  if (!find_carriers(operation)) return;
  for (std::size_t i = 0; i < set_.size(); ++i) {
    State& state = states_[static_cast<std::size_t>(set_[i])];
    const Carrier& named = operation.carriers[i];
    if (!state.is_hooked)
      report_.error(named.spot, fmt::format("carrier {} is not in the hook: 'inhook {}' brings it there",
                                            in_quotes(named.name), named.name));
    state.is_hooked = false;
  }
}

void Machine::rack(const Operation& operation) {
  if (std::abs(operation.racking) > most_racking) {
    report_.error(operation.spot,
                  fmt::format("racking {} is beyond the bed: it goes from {} to {}", operation.racking,
                              -most_racking, most_racking),
                  Kind::limit);
    return;
  }
  racking_ = operation.racking;
  whole_ = std::floor(racking_);
  least_swept_ = std::min(least_swept_, racking_);
  most_swept_ = std::max(most_swept_, racking_);
}

// Of loops on the front bed and loops on the back bed that the racking moved past them, who is before whom.
// Only loops that are on their way somewhere: all others are parted by their beds anyway.
void Machine::note_passings(const Spot& spot) {
  if (least_swept_ < most_swept_) {
    for (const int number : back_needles_) {
      const Stack& behind = stack({Bed::back, false, number});
      const int first = number + static_cast<int>(std::floor(least_swept_)),
                last = number + static_cast<int>(std::ceil(most_swept_));
      for (int f = std::max(first, -most_number); f <= std::min(last, most_number); ++f) {
        const Stack& before = stack({Bed::front, false, f});
        passed_ += 1 + before.size() * behind.size();
        for (const int front : before)
          for (const int back : behind)
            if (graph_.loops[static_cast<std::size_t>(front)].was_moved ||
                graph_.loops[static_cast<std::size_t>(back)].was_moved)
              graph_.passings[std::minmax(front, back)] = front < back;
      }
      if (passes_too_much(spot)) break;
    }
  }
  least_swept_ = most_swept_ = racking_;
}

// Far more than where each loop of a cloth is moved past its neighbours, some needles at a time.
bool Machine::passes_too_much(const Spot& spot) {
  const std::size_t loops = graph_.loops.size();
  if (passed_ <= 100'000'000 + 1000 * loops && graph_.passings.size() <= 1'000'000 + 50 * loops) return false;
  report_.error(
      spot,
      fmt::format("the racked beds have moved loops past each other {} times, with {} loops in all: rack "
                  "less far, or while fewer needles hold loops",
                  std::max(passed_, graph_.passings.size()), loops),
      Kind::limit);
  graph_.passings.clear();
  return true;
}

bool Machine::can_hold(std::size_t loops, const Needle& needle, const Spot& spot) {
  if (loops <= most_held) return true;
  report_.error(
      spot,
      fmt::format("{} would hold {} loops, and a needle holds at most {}: knit them off, or drop them",
                  name_of(needle), loops, most_held),
      Kind::limit);
  return false;
}

std::uint32_t Machine::set_number() {
  return set_numbers_.try_emplace(set_, static_cast<std::uint32_t>(set_numbers_.size())).first->second;
}

void Machine::hold(const Needle& needle) {
  if (needle.bed != Bed::back || needle.is_slider) return;
  if (stack(needle).empty())
    back_needles_.erase(needle.number);
  else
    back_needles_.insert(needle.number);
}

void Machine::make_loop(const Operation& operation, bool is_tuck) {
  if (!takes_yarn(operation) || !is_on_bed(operation.needle, operation.needle_spot)) return;
  if (!find_carriers(operation) || !all_in(operation)) return;
  if (is_tuck && !can_hold(stack(operation.needle).size() + 1, operation.needle, operation.needle_spot))
    return;
  note_passings(operation.spot);
  warn_of_ladders();
  note_floats(operation);
  Stack& held = stack(operation.needle);
  const int number = static_cast<int>(graph_.loops.size());
  Loop loop;
  loop.carriers = set_number();
  loop.direction = static_cast<signed char>(operation.direction);
  loop.is_tuck = is_tuck;
  loop.made = loop.left = station(operation.needle);
  loop.spot = operation.spot;
  loop.first_through = static_cast<std::uint32_t>(graph_.throughs.size());
  loop.through_count = static_cast<std::uint32_t>(held.size());
  graph_.throughs.insert(graph_.throughs.end(), held.begin(), held.end());
  const int opposite_number = facing(operation.needle);
  loop.faces_loops = is_aligned() && std::abs(opposite_number) <= most_number &&
                     !stack({opposite(operation.needle.bed), false, opposite_number}).empty();
  if (!is_tuck) {
    for (std::size_t i = 0; i < held.size(); ++i) {
      Loop& below = graph_.loops[static_cast<std::size_t>(held[i])];
      below.end = Loop::End::knitted;
      below.left = loop.made;
      if (below.next == no_loop) below.next = number;
      below.place_in_stack = static_cast<int>(i);
    }
    held.clear();
  }
  held.push_back(number);
  hold(operation.needle);
  graph_.loops.push_back(loop);
}

// "f3", or "f3 and 5 other needles".
static std::string needles_text(const std::vector<std::pair<Spot, Needle>>& places) {
  std::string text = name_of(places.front().second);
  if (places.size() == 2) text += " and another needle";
  if (places.size() > 2) text += fmt::format(" and {} other needles", places.size() - 1);
  return text;
}

void Machine::warn_of_ladders() {
  if (ladders_.empty()) return;
  report_.warning(ladders_.front().first,
                  fmt::format("the loop dropped from {} runs: it holds the loops below it, which stay as "
                              "they were knitted here",
                              needles_text(ladders_)));
  ladders_.clear();
}

// The yarn's way from the last loop of each carrier.
void Machine::note_floats(const Operation& operation) {
  const int column = station(operation.needle).column;
  for (const int number : set_) {
    State& state = states_[static_cast<std::size_t>(number)];
    if (state.last_loop != no_loop) {
      const int last = graph_.loops[static_cast<std::size_t>(state.last_loop)].made.column;
      if (const int passed = std::abs(column - last) - 1; passed > most_float)
        floats_.push_back({operation.spot, number, passed, operation.needle});
    }
    state.last_loop = static_cast<int>(graph_.loops.size());
  }
}

void Machine::warn_of_floats() {
  if (floats_.empty()) return;
  const Float& first = floats_.front();
  std::string others;
  if (floats_.size() > 1)
    others = fmt::format("; {} floats of the program are longer than {} needles", floats_.size(), most_float);
  report_.warning(
      first.spot,
      fmt::format("carrier {} floats past {} needles on its way to {}: a tuck on the way, or a yarn of "
                  "its own, holds it{}",
                  in_quotes(graph_.carriers[static_cast<std::size_t>(first.carrier)]), first.needles,
                  name_of(first.to), others));
}

void Machine::warn_of_hook(const State& state, const std::string& name) {
  if (!state.is_hooked || !state.is_used) return;
  report_.warning(state.spot, fmt::format("carrier {} is never released from the inserting hook: write "
                                          "'releasehook {}' behind its first loops",
                                          in_quotes(name), name));
}

void Machine::drop(const Operation& operation) {
  if (!is_on_bed(operation.needle, operation.needle_spot)) return;
  Stack& held = stack(operation.needle);
  bool ladders = false, is_undone = false;
  for (const int number : held) {
    Loop& loop = graph_.loops[static_cast<std::size_t>(number)];
    loop.end = Loop::End::dropped;
    loop.left = station(operation.needle);
    ladders = ladders || (!loop.is_tuck && loop.through_count > 0);
    is_undone = is_undone || (!loop.is_tuck && loop.through_count == 0);
  }
  if (is_undone) undone_.emplace_back(operation.spot, operation.needle);
  if (ladders) ladders_.emplace_back(operation.spot, operation.needle);
  held.clear();
  hold(operation.needle);
}

void Machine::transfer(const Operation& operation, bool splits) {
  const Needle &from = operation.needle, &to = operation.other;
  if (!is_on_bed(from, operation.needle_spot) || !is_on_bed(to, operation.other_spot)) return;
  if (from.bed == to.bed) {
    report_.error(operation.other_spot,
                  fmt::format("{} and {} are on one bed: loops go to the other bed, and back", name_of(from),
                              name_of(to)));
    return;
  }
  if (!is_aligned() || facing(from) != to.number) {
    const Needle faced{to.bed, to.is_slider, facing(from)};
    report_.error(
        operation.other_spot,
        is_aligned()
            ? fmt::format("{} does not face {}: at racking {} it faces {}; 'rack {}' brings "
                          "them together",
                          name_of(from), name_of(to), racking_, name_of(faced),
                          from.bed == Bed::front ? from.number - to.number : to.number - from.number)
            : fmt::format("no needles face each other at racking {}: rack a whole number", racking_));
    return;
  }
  if (!can_hold(stack(from).size() + stack(to).size(), to, operation.other_spot)) return;
  note_passings(operation.spot);
  if (splits && (!takes_yarn(operation) || !find_carriers(operation) || !all_in(operation))) return;
  Stack moved = std::move(stack(from));
  stack(from).clear();
  if (splits) {
    stack(from) = moved;
    make_loop(operation, false);
    // What it was pulled through is not let go: it hangs on the other needle.
    for (const int number : moved) graph_.loops[static_cast<std::size_t>(number)].end = Loop::End::on_needle;
    graph_.loops.back().splits = true;
  }
  // Seen from one side their order stays: the needle's own bed is the other one now.
  Stack& there = stack(to);
  for (auto number = moved.rbegin(); number != moved.rend(); ++number) {
    Loop& loop = graph_.loops[static_cast<std::size_t>(*number)];
    loop.was_moved = true;
    loop.left = station(to);
    there.push_back(*number);
  }
  hold(from);
  hold(to);
}

void Machine::run(const Operation& operation) {
  switch (operation.verb) {
    case Verb::in:
    case Verb::inhook:
      return bring_in(operation);
    case Verb::releasehook:
      return release(operation);
    case Verb::out:
    case Verb::outhook:
      return take_out(operation);
    case Verb::knit:
      return operation.carriers.empty() ? drop(operation) : make_loop(operation, false);
    case Verb::tuck:
      if (!operation.carriers.empty()) make_loop(operation, true);
      return;
    case Verb::split:
      return transfer(operation, !operation.carriers.empty());
    case Verb::xfer:
      return transfer(operation, false);
    case Verb::drop:
      return drop(operation);
    case Verb::miss:
      if (is_on_bed(operation.needle, operation.needle_spot) && find_carriers(operation)) all_in(operation);
      return;
    case Verb::rack:
      return rack(operation);
    case Verb::amiss:
    case Verb::stitch:
    case Verb::pause:
    case Verb::extension:
      return;
  }
}

StitchGraph Machine::finish() {
  graph_.carrier_sets.resize(set_numbers_.size());
  for (const auto& [set, number] : set_numbers_) graph_.carrier_sets[number] = set;
  warn_of_floats();
  if (!undone_.empty())
    report_.warning(
        undone_.front().first,
        fmt::format("the loop dropped from {} is drawn through no other one and comes undone: it stays "
                    "as it was knitted here",
                    needles_text(undone_)));
  for (std::size_t i = 0; i < states_.size(); ++i) {
    warn_of_hook(states_[i], graph_.carriers[i]);
    if (states_[i].is_in)
      report_.warning(states_[i].spot,
                      fmt::format("carrier {} is never taken out: its yarn ends at its last stitch; write "
                                  "'outhook {}' behind it",
                                  in_quotes(graph_.carriers[i]), graph_.carriers[i]));
  }
  return std::move(graph_);
}

}  // namespace selvage::formats::knitout
