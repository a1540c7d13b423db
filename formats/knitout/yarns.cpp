#include "formats/knitout/yarns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "core/number_text.h"
#include "core/words.h"
#include "fabric/fibres.h"
#include "fabric/repeat.h"

namespace selvage::formats::knitout {

namespace {

using fabric::LinearDensity;
using fabric::Thread;

constexpr double mm_per_inch = 25.4;
constexpr double largest_count = 1e6, largest_diameter = 100;

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

// A name of the carrier that every text takes, and no other carrier has.
std::string thread_name(std::string_view carrier, std::set<std::string>& taken) {
  std::string name = "carrier_";
  for (const char c : carrier)
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
  while (!taken.insert(name).second) name += '_';
  return name;
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
  int last = -1;
  for (int& carrier : chart.carriers) {  // rows without a yarn
    if (carrier < 0) carrier = last;
    last = carrier;
  }
  std::vector<Thread> threads;
  std::vector<std::string> names(graph.carriers.size());
  std::set<std::string> taken;
  std::string silent;
  for (std::size_t i = 0; i < graph.carriers.size(); ++i) {
    if (std::find(chart.carriers.begin(), chart.carriers.end(), static_cast<int>(i)) == chart.carriers.end())
      continue;
    Thread thread;
    thread.name = names[i] = thread_name(graph.carriers[i], taken);
    thread.place = start.place();
    const auto text = header.yarns.find(graph.carriers[i]);
    if (text != header.yarns.end()) thread.place = text->second.spot.place();
    if (text == header.yarns.end() || !read_size(text->second.text, thread)) {
      thread.linear_density.reset();
      thread.diameter = yarn_share * knit.wale_pitch;
      silent += fmt::format("{}{}", silent.empty() ? "" : ", ", in_quotes(graph.carriers[i]));
    }
    threads.push_back(std::move(thread));
  }
  if (!silent.empty())
    report.note(start,
                fmt::format("the header says no thickness of the yarn of carrier {}, as ';;Yarn-C: 0.3 mm': "
                            "{:.3g} mm is taken, a sixth of a wale",
                            silent, yarn_share * knit.wale_pitch));
  const auto count = static_cast<long long>(chart.carriers.size());
  const auto at = [&](long long row) { return chart.carriers[static_cast<std::size_t>(row % count)]; };
  const long long repeat =
      fabric::smallest_shift(count, [&](long long i, long long k) { return at(i) == at(k); });
  for (long long row = 0; row < repeat; ++row)
    knit.threads.push_back(names[static_cast<std::size_t>(at(row))]);
  knit.thread_place = start.place();
  return threads;
}

}  // namespace selvage::formats::knitout
