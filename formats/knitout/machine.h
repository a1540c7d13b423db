// A knitting machine of two beds: needles that hold loops, one racking, carriers. It does what operations say
// and keeps what became of it as a stitch graph.
#pragma once

#include <set>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/text_report.h"
#include "formats/knitout/header.h"
#include "formats/knitout/operation.h"
#include "formats/knitout/stitch_graph.h"

namespace selvage::formats::knitout {

// Needles that a yarn passes without a loop, from one loop to its next one, before a warning.
inline constexpr int most_float = 8;

// Needles by which the beds can stand off from each other, either way.
inline constexpr int most_racking = 24;

class Machine {
 public:
  Machine(const Header& header, TextReport& report);

  // Errors: a carrier that there is not or that is not in, needles that do not face each other, racking
  // beyond the bed, knitting on a slider, needles farther apart than a bed is wide. Warnings: loops that
  // ladder.
  void run(const Operation& operation);
  // What hangs on the needles stays there, as open loops. What was dropped after the last loop was taken off
  // the machine, and does not ladder. Warnings of carriers that are still in or in the hook, of long floats
  // and of loops that come undone.
  StitchGraph finish();
  [[nodiscard]] std::size_t num_loops() const { return graph_.loops.size(); }

 private:
  struct State {
    bool is_in = false, is_hooked = false, is_used = false;
    Spot spot;                // of the `in`
    int last_loop = no_loop;  // that was made of its yarn, since it is in
  };
  using Stack = std::vector<int>;  // loops, from the needle's own bed on

  [[nodiscard]] Stack& stack(const Needle& needle);
  [[nodiscard]] int facing(const Needle& needle) const;
  [[nodiscard]] bool is_aligned() const { return whole_ == racking_; }
  [[nodiscard]] Station station(const Needle& needle) const;
  // The number in the graph; -1, with the error, where there is none.
  int carrier(const Carrier& named);
  bool find_carriers(const Operation& operation);  // into set_
  bool all_in(const Operation& operation);
  bool is_on_bed(const Needle& needle, const Spot& spot);
  bool takes_yarn(const Operation& operation);

  void bring_in(const Operation& operation);
  void take_out(const Operation& operation);
  void release(const Operation& operation);
  void rack(const Operation& operation);
  void make_loop(const Operation& operation, bool is_tuck);
  void drop(const Operation& operation);
  void note_floats(const Operation& operation);
  void warn_of_hook(const State& state, const std::string& name);
  void warn_of_ladders();
  void warn_of_floats();
  void transfer(const Operation& operation, bool splits);
  void note_passings(const Spot& spot);
  bool passes_too_much(const Spot& spot);
  bool can_hold(std::size_t loops, const Needle& needle, const Spot& spot);
  std::uint32_t set_number();
  void hold(const Needle& needle);  // after a change of its stack

  const Header& header_;
  TextReport& report_;
  StitchGraph graph_;
  std::unordered_map<std::string_view, int> carrier_numbers_;
  std::vector<State> states_;
  std::map<std::vector<int>, std::uint32_t> set_numbers_;
  std::vector<int> set_;
  std::array<std::unordered_map<int, Stack>, 4>
      stacks_;                  // by needle: front, back, front sliders, back sliders
  std::set<int> back_needles_;  // that hold something
  double racking_ = 0, whole_ = 0;
  double least_swept_ = 0, most_swept_ = 0;       // rackings since loops were looked at
  std::size_t passed_ = 0;                        // needles and loops visited
  std::vector<std::pair<Spot, Needle>> ladders_;  // dropped since the last loop was made
  std::vector<std::pair<Spot, Needle>> undone_;   // dropped loops that are drawn through nothing
  struct Float {
    Spot spot;
    int carrier = 0, needles = 0;
    Needle to;
  };
  std::vector<Float> floats_;  // longer than most_float
  int least_used_ = most_number + 1, most_used_ = -most_number - 1;
};

}  // namespace selvage::formats::knitout
