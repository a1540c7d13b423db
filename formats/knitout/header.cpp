#include "formats/knitout/header.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/number_text.h"
#include "core/text_lines.h"
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

// False: there are too many.
bool add_carrier(const Carrier& carrier, Header& header, TextReport& report) {
  if (header.carriers.size() == most_carriers) {
    report.error(carrier.spot, fmt::format("a machine has at most {} carriers", most_carriers), Kind::limit);
    return false;
  }
  if (std::find(header.carriers.begin(), header.carriers.end(), carrier.name) != header.carriers.end())
    report.error(carrier.spot, fmt::format("carrier {} is named twice", in_quotes(carrier.name)));
  else
    header.carriers.push_back(carrier.name);
  return true;
}

bool has_magic(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  return head.starts_with(magic);
}

// The first operation that is a machine's only, with all its operands.
bool begins_with_an_operation(std::string_view head) {
  const Source source = Source::from_memory(std::string(head), "");
  TextReport report(source);
  Operation operation;
  TextLines lines(head);
  while (lines.next()) {
    const std::string_view line = lines.line().substr(0, lines.line().find(';'));
    if (!read_operation(line, lines.spot(), operation, report)) {
      if (report.errors() > 0) return false;
      continue;
    }
    if (is_of_loops(operation.verb)) return true;
    if (operation.verb != Verb::extension) return false;
  }
  return false;
}

}  // namespace

bool is_knitout(std::string_view head) {
  return has_magic(head) || begins_with_an_operation(head);
}

FirstLine read_first_line(std::string_view line, std::string_view head, TextReport& report) {
  const Spot spot;
  if (!has_magic(line)) {
    if (begins_with_an_operation(head)) {
      report.warning(spot,
                     "the first line of a knitout program is missing: write ';!knitout-2'; the program is "
                     "read as version 2");
      return FirstLine::missing;
    }
    report.error(spot, "this is no knitout program: its first line is not ';!knitout-2'");
    return FirstLine::wrong;
  }
  std::string_view version = line.substr(line.find('-') + 1);
  while (!version.empty() && (version.back() == ' ' || version.back() == '\r')) version.remove_suffix(1);
  const std::optional<double> number = read_number(version);
  if (!number) {
    report.error(spot, fmt::format("{} is no version of knitout: write ';!knitout-2'", in_quotes(version)));
    return FirstLine::wrong;
  }
  if (*number > newest_version)
    report.warning(spot, fmt::format("knitout of version {}; it is read as version 2", version));
  return FirstLine::magic;
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
  for (; word; word = next_word(rest, line, begin))
    for (std::size_t at = 0; at <= word->name.size();) {  // the carriers of a rail
      const std::size_t end = std::min(word->name.find_first_of(",;", at), word->name.size());
      const Carrier carrier{word->name.substr(at, end - at), word->spot.behind(at)};
      if (!carrier.name.empty() && !add_carrier(carrier, header, report)) return;
      at = end + 1;
    }
}

}  // namespace selvage::formats::knitout
