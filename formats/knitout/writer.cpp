#include "formats/knitout/writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <variant>

#include "core/text_report.h"
#include "formats/knitout/chart.h"
#include "formats/knitout/operation.h"
#include "formats/knitout/program.h"
#include "knit/journey.h"

namespace selvage::formats::knitout {

namespace {

using fabric::Fabric;
using fabric::Knit;
using fabric::LoopMove;
using fabric::Stitch;
using fabric::StitchChart;

// A loop or a tuck that the program makes: its stitch of the chart; row -1: of the cast-on.
struct Made {
  int row = -1, wale = 0;
};

// The chart of the whole cloth, whatever the knit's own one repeats.
Knit whole_chart(const Knit& knit, const StitchChart& chart) {
  Knit whole = knit;
  whole.form = Knit::Form::chart;
  whole.loop.reset();
  whole.own_loops.clear();
  whole.chart.clear();
  whole.chart_lines.clear();
  if (chart.feeds() > 1) whole.feeds = chart.feeds();
  if (chart.is_opposite()) whole.gating = Knit::Gating::opposite;
  for (int row = knit.courses * chart.feeds() - 1; row >= 0; --row) {
    std::string& signs = whole.chart.emplace_back();
    for (int wale = 0; wale < knit.wales; ++wale) signs += static_cast<char>(chart.at(row, wale));
  }
  return whole;
}

class Programmer {
 public:
  Programmer(const Fabric& fabric, const Knit& knit, const StitchChart& chart,
             const fabric::Journeys& journeys)
      : fabric_(fabric), knit_(knit), chart_(chart), journeys_(journeys) {}

  Status write();
  // Does the program, read again, knit the chart?
  [[nodiscard]] Status verify() const;
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::size_t loops() const { return made_.size(); }

 private:
  struct CarrierState {
    std::string thread, name{};
    bool is_in = false, is_held = false, is_right = false;
  };
  [[nodiscard]] Status refuse(std::string text) const {
    return error(Kind::unsupported, "a knitting machine cannot knit this as it is: " + std::move(text))
        .placed(knit_.place);
  }
  // What a needle holds, and on which bed.
  [[nodiscard]] char& holds(int bed, int wale) {
    return (bed > 0 ? front_ : back_)[static_cast<std::size_t>(wale)];
  }
  [[nodiscard]] int bed_at(int row, int wale) const;
  [[nodiscard]] int first_bed(int wale, int bed) const;
  void name_carriers();
  void write_header();
  void bring_in(CarrierState& carrier);
  void let_go(CarrierState& carrier);
  [[nodiscard]] bool needs_cast_on() const;
  void cast_on();
  void stitch(std::string_view word, CarrierState& carrier, int bed, int wale, Made made);
  void transfer(int from_bed, int from, int to);
  void rack(int racking);
  Status bring_together(int row);
  void knit_row(int row);
  Status move_loops(int row);
  void drop_all();

  const Fabric& fabric_;
  const Knit& knit_;
  const StitchChart& chart_;
  const fabric::Journeys& journeys_;
  std::string text_;
  std::vector<CarrierState> carriers_;
  std::vector<std::size_t> carrier_of_thread_;       // of the knit's threads, in turn
  std::vector<std::vector<const LoopMove*>> moves_;  // of each row
  std::vector<char> front_, back_;                   // does the needle of a wale hold something?
  std::vector<Made> made_;
  int racking_ = 0;
};

std::string needle_text(int bed, int wale) {
  return fmt::format("{}{}", bed > 0 ? 'f' : 'b', wale + 1);
}

// Carriers keep the names that they have in threads of a program that was read; others are numbered.
void Programmer::name_carriers() {
  constexpr std::string_view of_carrier = "carrier_";
  std::map<std::string_view, std::size_t> numbers;
  for (const std::string& thread : knit_.threads) {
    const auto [found, is_new] = numbers.try_emplace(thread, carriers_.size());
    if (is_new) carriers_.push_back({.thread = thread});
    carrier_of_thread_.push_back(found->second);
  }
  const bool are_named = std::all_of(carriers_.begin(), carriers_.end(), [&](const CarrierState& carrier) {
    return carrier.thread.starts_with(of_carrier) && carrier.thread.size() > of_carrier.size() &&
           carrier.thread.find_first_of(" \t;") == std::string::npos;
  });
  for (std::size_t i = 0; i < carriers_.size(); ++i)
    carriers_[i].name = are_named ? carriers_[i].thread.substr(of_carrier.size()) : fmt::format("{}", i + 1);
}

void Programmer::write_header() {
  text_ = ";!knitout-2\n";
  const double mm = millimetres_per(fabric_.units);
  const fabric::Thread* const first = fabric_.find_thread(knit_.threads.front());
  double wale = knit_.wale_pitch * mm;
  if (!(wale > 0) && first != nullptr && first->diameter) wale = 4 * *first->diameter * mm;
  if (wale > 0) text_ += fmt::format(";;Gauge: {:.12g}\n", 25.4 / wale);
  text_ += ";;Carriers:";
  for (const CarrierState& carrier : carriers_) text_ += " " + carrier.name;
  text_ += '\n';
  for (const CarrierState& carrier : carriers_) {
    const fabric::Thread* const thread = fabric_.find_thread(carrier.thread);
    if (thread == nullptr) continue;
    if (thread->diameter)
      text_ += fmt::format(";;Yarn-{}: {:.12g} mm\n", carrier.name, *thread->diameter * mm);
    else if (thread->linear_density && thread->material)
      text_ += fmt::format(";;Yarn-{}: {:.12g} tex {}\n", carrier.name, thread->linear_density->tex(),
                           *thread->material);
  }
}

void Programmer::bring_in(CarrierState& carrier) {
  if (carrier.is_in) return;
  text_ += fmt::format("inhook {}\n", carrier.name);
  carrier.is_in = carrier.is_held = true;
}

void Programmer::let_go(CarrierState& carrier) {
  if (carrier.is_held) text_ += fmt::format("releasehook {}\n", carrier.name);
  carrier.is_held = false;
}

void Programmer::stitch(std::string_view word, CarrierState& carrier, int bed, int wale, Made made) {
  text_ +=
      fmt::format("{} {} {} {}\n", word, carrier.is_right ? '-' : '+', needle_text(bed, wale), carrier.name);
  holds(bed, wale) = 1;
  made_.push_back(made);
}

// The bed on which a stitch is made: of a tuck that of the loop that it joins.
int Programmer::bed_at(int row, int wale) const {
  const Stitch stitch = chart_.at(row, wale);
  if (chart_.is_opposite() || !fabric::is_tuck(stitch)) return fabric::bed_of(stitch);
  return fabric::bed_of(journeys_.joined(chart_, row, wale));
}

// The bed of the needle's first loop, asked for one bed where both have their own; 0: it is never knitted.
int Programmer::first_bed(int wale, int bed) const {
  for (int row = 0; row < chart_.courses(); ++row)
    if (const Stitch stitch = chart_.at(row, wale); fabric::is_loop(stitch))
      if (const int own = fabric::bed_of(stitch); !chart_.is_opposite() || own == bed) return own;
  return 0;
}

// Loops side by side on empty needles of one bed do not hold, and a tuck joins a loop.
bool Programmer::needs_cast_on() const {
  for (int wale = 0; wale < chart_.wales(); ++wale) {
    bool has_loop[2] = {false, false};
    for (int row = 0; row < chart_.courses(); ++row) {
      const Stitch stitch = chart_.at(row, wale);
      const std::size_t bed = chart_.is_opposite() && fabric::bed_of(stitch) < 0 ? 1 : 0;
      if (fabric::is_tuck(stitch) && !has_loop[bed] && journeys_.at(row, wale).index == 0) return true;
      if (fabric::is_loop(stitch)) has_loop[bed] = true;
    }
  }
  int row = 0;
  while (row < chart_.courses() && journeys_.span(row).first > journeys_.span(row).last) ++row;
  for (int wale = 0; wale + 1 < chart_.wales(); ++wale) {
    const Stitch left = chart_.at(row, wale), right = chart_.at(row, wale + 1);
    if (fabric::is_loop(left) && left == right) return true;
  }
  return false;
}

// Every other needle to the right, the rest on the way back.
void Programmer::cast_on() {
  CarrierState& carrier = carriers_.front();
  bring_in(carrier);
  for (const int turn : {0, 1}) {
    bool has_stitch = false;
    for (int i = 0; i < chart_.wales(); ++i) {
      const int wale = carrier.is_right ? chart_.wales() - 1 - i : i;
      int bed = first_bed(wale, (wale + turn) % 2 == 0 ? 1 : -1);
      if (chart_.is_opposite() ? bed == 0 : wale % 2 != turn || bed == 0) continue;
      stitch("tuck", carrier, bed, wale, {-1, wale});
      has_stitch = true;
    }
    if (has_stitch) carrier.is_right = !carrier.is_right;
  }
  let_go(carrier);
}

void Programmer::transfer(int from_bed, int from, int to) {
  text_ += fmt::format("xfer {} {}\n", needle_text(from_bed, from), needle_text(-from_bed, to));
  holds(from_bed, from) = 0;
  holds(-from_bed, to) = 1;
}

void Programmer::rack(int racking) {
  if (racking != racking_) text_ += fmt::format("rack {}\n", racking);
  racking_ = racking;
}

// Held loops to the bed on which they will be knitted.
Status Programmer::bring_together(int row) {
  if (chart_.is_opposite()) return {};
  for (int wale = 0; wale < chart_.wales(); ++wale) {
    const int bed = bed_at(row, wale);
    if (!fabric::is_loop(chart_.at(row, wale)) || holds(-bed, wale) == 0) continue;
    transfer(-bed, wale, wale);
  }
  return {};
}

void Programmer::knit_row(int row) {
  CarrierState& carrier =
      carriers_[carrier_of_thread_[static_cast<std::size_t>(row) % carrier_of_thread_.size()]];
  bring_in(carrier);
  for (int i = 0; i < chart_.wales(); ++i) {
    const int wale = carrier.is_right ? chart_.wales() - 1 - i : i;
    const Stitch made = chart_.at(row, wale);
    if (!fabric::is_loop(made) && !fabric::is_tuck(made)) continue;
    const int bed = bed_at(row, wale);
    stitch(fabric::is_loop(made) && holds(bed, wale) != 0 ? "knit" : "tuck", carrier, bed, wale, {row, wale});
  }
  carrier.is_right = !carrier.is_right;
  let_go(carrier);
}

// Over the other bed, which is empty there: first all loops that move, then each to its needle. Of loops that
// cross or meet, the one that comes to the front bed first lies before the others.
Status Programmer::move_loops(int row) {
  std::vector<const LoopMove*> moves;
  int bed = 0;
  for (const LoopMove* move : moves_[static_cast<std::size_t>(row)]) {
    const int wale = move->wale - 1, own = bed_at(row, wale);
    if (move->is_dropped) {
      text_ += fmt::format("drop {}\n", needle_text(own, wale));
      holds(own, wale) = 0;
      continue;
    }
    if (journeys_.at(row, wale).off < 0) continue;
    if (chart_.is_opposite())
      return refuse("needles of both beds hold loops, and transfers need one of them free");
    if (bed != 0 && own != bed)
      return refuse(fmt::format("in row {} of the chart loops of both beds are moved", row + 1));
    bed = own;
    moves.push_back(move);
  }
  if (moves.empty()) return {};
  for (const LoopMove* move : moves) {
    if (holds(-bed, move->wale - 1) != 0)
      return refuse(
          fmt::format("wale {} of row {} has no free needle on the other bed", move->wale, row + 1));
    transfer(bed, move->wale - 1, move->wale - 1);
  }
  if (bed < 0) std::reverse(moves.begin(), moves.end());
  for (const LoopMove* move : moves) {
    const int from = move->wale - 1, to = from + move->right;
    rack(bed > 0 ? to - from : from - to);
    transfer(-bed, from, to);
  }
  rack(0);
  return {};
}

void Programmer::drop_all() {
  for (const int bed : {1, -1})
    for (int wale = 0; wale < chart_.wales(); ++wale)
      if (holds(bed, wale) != 0) text_ += fmt::format("drop {}\n", needle_text(bed, wale));
}

Status Programmer::write() {
  if (chart_.wales() > widest_bed)
    return refuse(
        fmt::format("{} wales are more than the {} needles of the widest beds", chart_.wales(), widest_bed));
  name_carriers();
  write_header();
  moves_.resize(static_cast<std::size_t>(chart_.courses()));
  for (const LoopMove& move : knit_.moves) moves_[static_cast<std::size_t>(move.row) - 1].push_back(&move);
  front_.assign(static_cast<std::size_t>(chart_.wales()), 0);
  back_ = front_;
  if (needs_cast_on()) cast_on();
  for (int row = 0; row < chart_.courses(); ++row) {
    if (journeys_.span(row).first > journeys_.span(row).last) continue;
    if (Status together = bring_together(row); !together) return together;
    knit_row(row);
    if (Status moved = move_loops(row); !moved) return moved;
  }
  for (const CarrierState& carrier : carriers_)
    if (carrier.is_in) text_ += fmt::format("outhook {}\n", carrier.name);
  drop_all();
  return {};
}

Status Programmer::verify() const {
  const auto other = [&](const std::string& why) {
    return refuse(fmt::format("what it would knit differs from the chart: {}", why));
  };
  const Source source = Source::from_memory(text_, "knitout");
  Diagnostics diagnostics;
  const std::optional<Program> program = reported(source, diagnostics, run_program);
  if (!program) return other(diagnostics.first_error()->text);
  TextReport report(source);
  std::optional<GraphChart> chart = chart_of(program->graph, report);
  if (!chart) {
    report.hand_over(diagnostics);
    return other(diagnostics.first_error()->text);
  }
  const Result<StitchChart> read = StitchChart::of(chart->knit);
  if (!read) return other(read.error().text);
  const StitchGraph& graph = program->graph;
  const Passes passes = passes_of(graph);
  int first_column = 0;
  for (std::size_t i = 0; i < graph.loops.size(); ++i)
    for (const Station& station : {graph.loops[i].made, graph.loops[i].left})
      first_column = i == 0 ? station.column : std::min(first_column, station.column);
  for (std::size_t i = 0; i < graph.loops.size(); ++i) {
    const Loop& loop = graph.loops[i];
    const Made& made = made_[i];
    if (made.row < 0) continue;
    const fabric::Journey& journey = journeys_.at(made.row, made.wale);
    const bool is_knitted = loop.end == Loop::End::knitted;
    const Made next = is_knitted ? made_[static_cast<std::size_t>(loop.next)] : Made{};
    bool is_same = is_knitted == (journey.off >= 0) && next.row == journey.off;
    if (is_knitted && is_same) {
      const auto stack = graph.through(graph.loops[static_cast<std::size_t>(loop.next)]);
      const auto of_cast_on =
          std::count_if(stack.begin(), stack.begin() + loop.place_in_stack,
                        [&](int number) { return made_[static_cast<std::size_t>(number)].row < 0; });
      is_same = next.wale == made.wale + journey.right && loop.place_in_stack - of_cast_on == journey.index;
    }
    if (is_same && read->journeys() != nullptr) {
      const Pass& pass = passes.list[static_cast<std::size_t>(passes.of_loop[i])];
      is_same = read->journeys()->at(pass.row, loop.made.column - first_column).lift == journey.lift;
    }
    if (!is_same)
      return other(
          fmt::format("the loop of row {}, wale {} would lie otherwise", made.row + 1, made.wale + 1));
  }
  return {};
}

Result<const Knit*> only_knit(const Fabric& fabric) {
  const auto refuse = [](std::string text, TextPlace place = {}) {
    return error(Kind::unsupported, std::move(text)).placed(place);
  };
  if (fabric.items.size() != 1 || !std::holds_alternative<Knit>(fabric.items.front()))
    return refuse("knitout holds one weft knit by its chart (`knit`), and this input is something else");
  const Knit& knit = std::get<Knit>(fabric.items.front());
  if (!knit.plating.empty())
    return refuse("a plated knit is not written as knitout: two yarns in one loop; leave out 'plating'",
                  knit.place);
  if (knit.threads.empty()) return refuse("this knit has no thread", knit.place);
  return &knit;
}

}  // namespace

Result<WriteFacts> write_fabric(const Fabric& fabric, OutputFile& output) {
  const Result<const Knit*> knit = only_knit(fabric);
  if (!knit) return knit.error().placed({}, fabric.file);
  const auto at = [&](const Message& message) { return message.placed((*knit)->place, fabric.file); };
  const Result<StitchChart> chart = StitchChart::of(**knit);
  if (!chart) return at(chart.error());
  if (const long long cells = static_cast<long long>((*knit)->courses) * chart->feeds() * (*knit)->wales;
      cells > most_cells)
    return at(
        error(Kind::limit, fmt::format("{} stitches are more than the {} of a program", cells, most_cells)));
  const Knit whole = whole_chart(**knit, *chart);
  const Result<StitchChart> cloth = StitchChart::of(whole);
  if (!cloth) return at(cloth.error());
  const Result<fabric::Journeys> journeys = fabric::Journeys::of(*cloth, whole);
  if (!journeys) return at(journeys.error());
  Programmer programmer(fabric, whole, *cloth, *journeys);
  if (Status written = programmer.write(); !written) return at(written.error());
  if (Status same = programmer.verify(); !same) return at(same.error());
  if (Status put = output.write(programmer.text()); !put) return put.error();
  WriteFacts facts{.entities = {{"stitch", programmer.loops()}}};
  if ((*knit)->loop || (*knit)->unit || !(*knit)->own_loops.empty() || (*knit)->bed_distance)
    facts.messages.push_back(at(
        warning(Kind::unsupported,
                "a program of a knitting machine says neither how long loops are nor how they lie: 'loop', "
                "'unit', 'points' and the distance of the beds are left out")));
  return facts;
}

}  // namespace selvage::formats::knitout
