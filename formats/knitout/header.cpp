#include "formats/knitout/header.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/number_text.h"
#include "core/words.h"
#include "formats/knitout/operation.h"

namespace selvage::formats::knitout {

namespace {

constexpr std::string_view magic = ";!knitout-";
constexpr int newest_version = 2;
constexpr double most_gauge = 60;  // of the finest machines

void read_gauge(const Carrier& value, Header& header, TextReport& report) {
  const std::optional<double> gauge = read_number(value.name);
  if (!gauge || !(*gauge > 0) || *gauge > most_gauge) {
    report.error(value.spot, fmt::format("{} is no gauge: needles an inch, above 0 and at most {}",
                                         in_quotes(value.name), most_gauge));
    return;
  }
  header.gauge = gauge;
  header.gauge_spot = value.spot;
}

}  // namespace

bool is_knitout(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  return head.starts_with(magic);
}

bool read_first_line(std::string_view line, TextReport& report) {
  const Spot spot;
  if (!is_knitout(line)) {
    report.error(spot, "this is no knitout program: its first line is not ';!knitout-2'");
    return false;
  }
  std::string_view version = line.substr(line.find('-') + 1);
  while (!version.empty() && (version.back() == ' ' || version.back() == '\r')) version.remove_suffix(1);
  const std::optional<double> number = read_number(version);
  if (!number) {
    report.error(spot, fmt::format("{} is no version of knitout: write ';!knitout-2'", in_quotes(version)));
    return false;
  }
  if (*number > newest_version)
    report.warning(spot, fmt::format("knitout of version {}; it is read as version 2", version));
  return true;
}

void read_header_line(std::string_view line, const Spot& begin, Header& header, TextReport& report) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string_view name = line.substr(2, colon - 2);
  std::string_view rest = line.substr(colon + 1);
  const std::string_view all = rest;
  std::optional<Carrier> word = next_word(rest, line, begin);
  constexpr std::string_view yarn = "Yarn-";
  if (same_word(name, "Gauge") && word) read_gauge(*word, header, report);
  if (name.starts_with(yarn) && word)
    header.yarns[name.substr(yarn.size())] = {
        all.substr(static_cast<std::size_t>(word->name.data() - all.data())), word->spot};
  if (!same_word(name, "Carriers")) return;
  header.has_carriers = true;
  for (; word; word = next_word(rest, line, begin)) {
    if (header.carriers.size() == most_carriers) {
      report.error(word->spot, fmt::format("a machine has at most {} carriers", most_carriers), Kind::limit);
      return;
    }
    if (std::find(header.carriers.begin(), header.carriers.end(), word->name) != header.carriers.end())
      report.error(word->spot, fmt::format("carrier {} is named twice", in_quotes(word->name)));
    else
      header.carriers.push_back(word->name);
  }
}

}  // namespace selvage::formats::knitout
