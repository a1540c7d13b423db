#include "formats/knitout/yarns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/number_text.h"
#include "core/words.h"
#include "fabric/fibres.h"
#include "fabric/repeat.h"
#include "fabric/yarn_spec.h"
#include "yarn/role_color.h"

namespace selvage::formats::knitout {

namespace {

using fabric::LinearDensity;
using fabric::Thread;

constexpr double mm_per_inch = 25.4;
constexpr double largest_count = 1e6, largest_diameter = 100;
// Of the usual thickness, of each of two yarns that are knitted together: as thick as one.
constexpr double plated_fraction = 1 / std::numbers::sqrt2;

struct CountWord {
  std::string_view word;
  LinearDensity::Measure measure;
};
constexpr std::array<CountWord, 6> count_words = {{{"tex", LinearDensity::Measure::tex},
                                                   {"dtex", LinearDensity::Measure::dtex},
                                                   {"denier", LinearDensity::Measure::denier},
                                                   {"den", LinearDensity::Measure::denier},
                                                   {"Nm", LinearDensity::Measure::nm},
                                                   {"Ne", LinearDensity::Measure::ne}}};

std::optional<LinearDensity::Measure> measure_of(std::string_view word) {
  for (const CountWord& count : count_words)
    if (same_word(count.word, word)) return count.measure;
  return std::nullopt;
}

// Words, and numbers apart from the units that follow them: "0.3mm" is two.
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts;
  std::string spaced;
  for (const char c : text) spaced += c == '\t' || c == ',' || c == ';' || c == '\r' ? ' ' : c;
  for (const std::string_view word : words_of(spaced)) {
    const std::size_t number = std::min(word.find_first_not_of("0123456789.+"), word.size());
    if (number > 0 && number < word.size() && read_number(word.substr(0, number))) {
      parts.emplace_back(word.substr(0, number));
      parts.emplace_back(word.substr(number));
    } else {
      parts.emplace_back(word);
    }
  }
  return parts;
}

// "0.3 mm"; "30 tex cotton", "Ne 20 cotton": a count with a fibre of the trade. False: it tells no size.
bool read_size(std::string_view text, Thread& thread) {
  const std::vector<std::string> parts = parts_of(text);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::optional<double> number = read_number(parts[i]);
    if (!number && thread.material == std::nullopt && fabric::find_fibre(parts[i]) != nullptr)
      thread.material = parts[i];
    if (!number || !(*number > 0)) continue;
    const bool has_next = i + 1 < parts.size();
    if (has_next && same_word(parts[i + 1], "mm") && *number <= largest_diameter) thread.diameter = number;
    if (*number > largest_count) continue;
    if (has_next)
      if (const auto measure = measure_of(parts[i + 1])) thread.linear_density = {*number, *measure};
    if (i > 0 && !thread.linear_density)
      if (const auto measure = measure_of(parts[i - 1])) thread.linear_density = {*number, *measure};
  }
  return thread.diameter || (thread.linear_density && thread.material);
}

// mm.
double diameter_of(const Thread& thread) {
  if (thread.diameter) return *thread.diameter;
  const fabric::Material* const fibre = fabric::find_fibre(thread.material.value_or(""));
  if (fibre == nullptr || !fibre->density || !thread.linear_density) return 0;
  return fabric::yarn_diameter(thread.linear_density->tex(), *fibre->density, fibre->packing.value_or(1));
}

// The threads of a program's carriers, and of carriers that are knitted together as one.
class YarnReader {
 public:
  YarnReader(const Header& header, const StitchGraph& graph, double wale)
      : header_(header), graph_(graph), usual_diameter_(yarn_share * wale), names_(graph.carriers.size()) {}

  // The name of the thread of one carrier. `fraction`: of the usual thickness, where the header says none.
  const std::string& of_carrier(int carrier, double fraction = 1);
  // The name of the one thread of several carriers: as thick as all of them.
  std::string of_set(const std::vector<int>& carriers);
  std::vector<Thread> take_threads() { return std::move(threads_); }
  void report_sizes(const Spot& start, TextReport& report) const;

 private:
  std::string free_name(std::string_view carriers);
  [[nodiscard]] Thread thread_of(int carrier, double fraction);

  const Header& header_;
  const StitchGraph& graph_;
  double usual_diameter_;
  std::vector<std::string> names_;  // of the carriers' threads; empty: not yet read
  std::map<std::vector<int>, std::string> set_names_;
  std::set<std::string> taken_;
  std::vector<Thread> threads_;
  std::map<double, std::string> silent_;  // carriers whose thickness was supposed, by that
};

// A name of the carriers that every text takes, and no other thread has.
std::string YarnReader::free_name(std::string_view carriers) {
  std::string name = "carrier_";
  for (const char c : carriers)
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
  while (!taken_.insert(name).second) name += '_';
  return name;
}

Thread YarnReader::thread_of(int carrier, double fraction) {
  const std::string& name = graph_.carriers[static_cast<std::size_t>(carrier)];
  Thread thread;
  thread.place = graph_.loops.front().spot.place();
  thread.color = yarn::hue_color(static_cast<std::size_t>(carrier));
  const auto text = header_.yarns.find(name);
  if (text != header_.yarns.end()) thread.place = text->second.spot.place();
  if (text == header_.yarns.end() || !read_size(text->second.text, thread)) {
    thread.linear_density.reset();
    thread.diameter = fraction * usual_diameter_;
    std::string& silent = silent_[*thread.diameter];
    silent += fmt::format("{}{}", silent.empty() ? "" : ", ", in_quotes(name));
  }
  return thread;
}

const std::string& YarnReader::of_carrier(int carrier, double fraction) {
  std::string& name = names_[static_cast<std::size_t>(carrier)];
  if (!name.empty()) return name;
  Thread thread = thread_of(carrier, fraction);
  thread.name = name = free_name(graph_.carriers[static_cast<std::size_t>(carrier)]);
  threads_.push_back(std::move(thread));
  return name;
}

std::string YarnReader::of_set(const std::vector<int>& carriers) {
  if (carriers.size() == 1) return of_carrier(carriers.front());
  std::string& name = set_names_[carriers];
  if (!name.empty()) return name;
  Thread all;
  double area = 0, tex = 0;
  std::string joined;
  for (const int carrier : carriers) {
    const Thread one = thread_of(carrier, 1 / std::sqrt(static_cast<double>(carriers.size())));
    joined +=
        fmt::format("{}{}", joined.empty() ? "" : "_", graph_.carriers[static_cast<std::size_t>(carrier)]);
    area += std::pow(diameter_of(one), 2);
    tex += one.linear_density ? one.linear_density->tex() : 0;
    if (carrier == carriers.front()) {
      all = one;
    } else {
      if (all.material != one.material) all.material.reset();
      if (!one.linear_density) all.linear_density.reset();
    }
  }
  if (all.linear_density) all.linear_density = {tex, LinearDensity::Measure::tex};
  if (!all.linear_density || !all.material) all.diameter = std::sqrt(area);
  all.name = name = free_name(joined);
  threads_.push_back(std::move(all));
  return name;
}

void YarnReader::report_sizes(const Spot& start, TextReport& report) const {
  for (const auto& [diameter, silent] : silent_)
    report.note(start,
                fmt::format("the header says no thickness of the yarn of carrier {}, as ';;Yarn-C: 0.3 mm': "
                            "{:.3g} mm is taken",
                            silent, diameter));
}

// Of a jersey all of whose loops are of two carriers, the second one the same everywhere: that one. -1:
// another knit.
int plating_of(const StitchGraph& graph, const GraphChart& chart) {
  const fabric::Knit& knit = chart.knit;
  if (knit.feeds || knit.gating || !knit.moves.empty()) return -1;
  if (std::any_of(knit.chart.begin(), knit.chart.end(),
                  [](const std::string& row) { return row.find_first_not_of('K') != std::string::npos; }))
    return -1;
  int plating = -1;
  for (const int set : chart.carrier_sets) {
    if (set < 0) return -1;
    const std::vector<int>& carriers = graph.carrier_sets[static_cast<std::size_t>(set)];
    if (carriers.size() != 2 || (plating >= 0 && carriers[1] != plating)) return -1;
    plating = carriers[1];
  }
  return plating;
}

// Carriers that are knitted together, but not as plating: they are one yarn, with a note.
void report_together(const StitchGraph& graph, int plating, TextReport& report) {
  if (plating >= 0) return;
  const auto together = std::find_if(graph.loops.begin(), graph.loops.end(), [&](const Loop& loop) {
    return graph.carrier_sets[loop.carriers].size() > 1;
  });
  if (together == graph.loops.end()) return;
  std::string names;
  for (const int carrier : graph.carrier_sets[together->carriers])
    names += fmt::format("{}{}", names.empty() ? "" : " ", graph.carriers[static_cast<std::size_t>(carrier)]);
  report.warning(
      together->spot,
      fmt::format("carriers {} are knitted together: they are built as one yarn, as thick as all of "
                  "them; two yarns are built of a plain jersey alone",
                  names));
}

}  // namespace

std::vector<Thread> read_yarns(const Header& header, const StitchGraph& graph, GraphChart& chart,
                               TextReport& report) {
  fabric::Knit& knit = chart.knit;
  const Spot start = graph.loops.front().spot;
  if (!header.gauge)
    report.note(start,
                fmt::format("the program has no ';;Gauge: NEEDLES' an inch: {} is taken", usual_gauge));
  knit.wale_pitch = mm_per_inch / header.gauge.value_or(usual_gauge) / (chart.is_doubled ? 2 : 1);
  knit.course_pitch = course_share * knit.wale_pitch;
  const int plating = plating_of(graph, chart);
  YarnReader yarns(header, graph, knit.wale_pitch);
  std::vector<std::string> names;  // of the rows
  const auto no_set =
      std::find_if(chart.carrier_sets.begin(), chart.carrier_sets.end(), [](int set) { return set >= 0; });
  int last = *no_set;
  for (const int set : chart.carrier_sets) {  // rows without a yarn take that of the one before
    if (set >= 0) last = set;
    const std::vector<int>& carriers = graph.carrier_sets[static_cast<std::size_t>(last)];
    names.push_back(plating >= 0 ? yarns.of_carrier(carriers.front(), plated_fraction)
                                 : yarns.of_set(carriers));
  }
  if (plating >= 0) {
    knit.form = fabric::Knit::Form::jersey;
    knit.chart.clear();
    knit.chart_lines.clear();
    knit.plating = yarns.of_carrier(plating, plated_fraction);
  }
  yarns.report_sizes(start, report);
  report_together(graph, plating, report);
  const auto count = static_cast<long long>(names.size());
  const auto at = [&](long long row) -> const std::string& {
    return names[static_cast<std::size_t>(row % count)];
  };
  const long long repeat =
      fabric::smallest_shift(count, [&](long long i, long long k) { return at(i) == at(k); });
  for (long long row = 0; row < repeat; ++row) knit.threads.push_back(at(row));
  knit.thread_place = start.place();
  return yarns.take_threads();
}

}  // namespace selvage::formats::knitout
