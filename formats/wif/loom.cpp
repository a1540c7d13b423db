#include "formats/wif/loom.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "weave/draft.h"

namespace selvage::formats::wif {

namespace {

using Shafts = std::vector<int>;
using Lifts = std::vector<Shafts>;  // the shafts that each pick moves, ascending, each once

// --- counts

void read_count(const Section& section, std::string_view key, Counted& count, TextReport& report) {
  const Entry* const entry = section.find(key);
  const std::optional<int> value = entry != nullptr ? whole_number(*entry, report) : std::nullopt;
  if (!value) return;
  if (*value < 1)
    report.error(entry->value_spot, fmt::format("{} is not a number of {}s", *value, count.noun));
  else if (*value > most_threads)
    report.error(entry->value_spot,
                 fmt::format("{} {}s are beyond the {} that are taken", *value, count.noun, most_threads),
                 Kind::limit);
  else
    count.most = *value;
}

const Section* required(const Ini& ini, std::string_view name, TextReport& report) {
  const Section* const section = ini.find(name);
  if (section == nullptr) report.error(ini.end(), fmt::format("the section [{}] is missing", name));
  return section;
}

// --- threading, tie-up, lifts

struct Threading {
  int ends = 0;
  std::map<int, std::vector<std::size_t>> ends_of_shaft;  // from 0
};

// In ascending order.
Shafts each_once(Shafts shafts) {
  std::sort(shafts.begin(), shafts.end());
  shafts.erase(std::unique(shafts.begin(), shafts.end()), shafts.end());
  return shafts;
}

// Of what threads and picks need: the draft counts it.
Counted strict(Counted counted) {
  counted.is_soft = false;
  return counted;
}

// The shafts or treadles that an entry names. Zeros say "none" and are left out.
Shafts named(const Numbered& line, const Counted& counted, Surplus* surplus, TextReport& report) {
  std::optional<Shafts> values = whole_numbers(*line.entry, report);
  if (!values) return {};
  std::erase(*values, 0);
  for (const int value : *values)
    if (!is_within(value, counted, *line.entry, surplus, report)) return {};
  return each_once(std::move(*values));
}

// A cloth has the threads that the section speaks of: what it leaves open at its end would hang beside the
// cloth.
int reach(const Section& section, const std::vector<Numbered>& lines, const Counted& threads,
          TextReport& report) {
  const int last = lines.empty() ? 0 : lines.back().number;
  if (last == 0)
    report.error(section.spot, fmt::format("[{}] is empty", section.name));
  else if (last < threads.most && !threads.limit.empty())
    report.warning(section.spot, fmt::format("[{}] ends with thread {} of the {} of {}: the cloth gets {}",
                                             section.name, last, threads.most, threads.limit, last));
  return last;
}

std::optional<Threading> read_threading(const Ini& ini, const Loom& loom, TextReport& report) {
  const Section* const section = required(ini, "THREADING", report);
  if (section == nullptr) return std::nullopt;
  Threading threading;
  const std::vector<Numbered> lines = numbered(*section, loom.warp, report);
  threading.ends = reach(*section, lines, loom.warp, report);
  for (const Numbered& line : lines) {
    const Shafts shafts = named(line, strict(loom.shafts), nullptr, report);
    for (const int shaft : shafts)
      threading.ends_of_shaft[shaft].push_back(static_cast<std::size_t>(line.number) - 1);
  }
  if (threading.ends > 0 && threading.ends_of_shaft.empty())
    report.error(section->spot, "no thread is on a shaft");
  return threading;
}

std::map<int, Shafts> read_tieup(const Section& section, const Loom& loom, TextReport& report) {
  std::map<int, Shafts> tieup;
  Surplus surplus(loom.shafts);
  for (const Numbered& line : numbered(section, loom.treadles, report))
    tieup[line.number] = named(line, loom.shafts, &surplus, report);
  surplus.report_of(section, report);
  return tieup;
}

Lifts read_liftplan(const Section& section, const Loom& loom, TextReport& report) {
  const std::vector<Numbered> lines = numbered(section, loom.weft, report);
  Lifts lifts(static_cast<std::size_t>(reach(section, lines, loom.weft, report)));
  Surplus surplus(loom.shafts);
  for (const Numbered& line : lines)
    lifts[static_cast<std::size_t>(line.number) - 1] = named(line, loom.shafts, &surplus, report);
  surplus.report_of(section, report);
  return lifts;
}

// `most`: shafts of all picks together, since one treadle may be tied to thousands and trodden for each pick.
Lifts read_treadling(const Section& section, const Section& tieup_section, const Loom& loom, std::size_t most,
                     TextReport& report) {
  const std::map<int, Shafts> tieup = read_tieup(tieup_section, loom, report);
  const std::vector<Numbered> lines = numbered(section, loom.weft, report);
  Lifts lifts(static_cast<std::size_t>(reach(section, lines, loom.weft, report)));
  std::set<int> loose;  // treadles that were told of already
  std::size_t all = 0;
  for (const Numbered& line : lines) {
    Shafts& moved = lifts[static_cast<std::size_t>(line.number) - 1];
    for (const int treadle : named(line, strict(loom.treadles), nullptr, report)) {
      const auto tied = tieup.find(treadle);
      if (tied != tieup.end()) {
        all += tied->second.size();
        if (all > most) {
          report.error(
              line.entry->value_spot,
              fmt::format("up to this pick the treadles move more than {} shafts, each pick's counted: "
                          "the draft of a file of this size has fewer; tie treadles to fewer shafts",
                          most),
              Kind::limit);
          return lifts;
        }
        moved.insert(moved.end(), tied->second.begin(), tied->second.end());
      } else if (loom.treadles.limit.empty()) {
        report.error(line.entry->value_spot, fmt::format("treadle {} has no tie-up", treadle));
      } else if (loose.insert(treadle).second) {
        report.warning(line.entry->value_spot, fmt::format("treadle {} is tied to no shaft", treadle));
      }
    }
    moved = each_once(std::move(moved));
  }
  return lifts;
}

// Does [CONTENTS] say that the section is not there?
bool is_disowned(const Ini& ini, std::string_view name, TextReport& report) {
  const Entry* const entry = ini.find("CONTENTS", name);
  return entry != nullptr && !boolean(*entry, report).value_or(true);
}

const Section* filled(const Ini& ini, std::string_view name) {
  const Section* const section = ini.find(name);
  return section == nullptr || section->entries.empty() ? nullptr : section;
}

// Where the wefts' sheds stand.
struct Sheds {
  const Section* section = nullptr;  // LIFTPLAN or TREADLING
  Lifts lifts;
};

std::optional<Sheds> read_sheds(const Ini& ini, const Loom& loom, TextReport& report) {
  const Section* plan = filled(ini, "LIFTPLAN");
  const Section* treadling = filled(ini, "TREADLING");
  const Section* const tieup = filled(ini, "TIEUP");
  if (plan != nullptr && treadling != nullptr) {
    if (is_disowned(ini, "LIFTPLAN", report))
      plan = nullptr;
    else if (tieup == nullptr || is_disowned(ini, "TREADLING", report))
      treadling = nullptr;
  }
  if (plan == nullptr && treadling == nullptr)
    return report.error(ini.end(), tieup != nullptr
                                       ? "[TREADLING] is missing: what is tied up is not trodden"
                                       : "there is neither [LIFTPLAN] nor [TIEUP] and [TREADLING]");
  if (plan == nullptr && tieup == nullptr)
    return report.error(treadling->spot, "[TREADLING] needs [TIEUP], which is missing");
  const std::size_t most = 1'000'000 + 32 * ini.size();
  if (plan == nullptr) return Sheds{treadling, read_treadling(*treadling, *tieup, loom, most, report)};
  Sheds sheds{plan, read_liftplan(*plan, loom, report)};
  if (treadling != nullptr && read_treadling(*treadling, *tieup, loom, most, report) != sheds.lifts)
    report.warning(plan->spot, "[LIFTPLAN] and [TREADLING] differ; the lift plan counts");
  return sheds;
}

// --- the drawdown

// Tells of threads that no other one holds.
void warn_of_loose(const std::vector<std::size_t>& loose, std::string_view system, std::string_view other,
                   const Spot& spot, TextReport& report) {
  if (loose.empty()) return;
  const std::string more = loose.size() > 1 ? fmt::format(" (and {} more)", loose.size() - 1) : std::string();
  report.warning(spot, fmt::format("{} {}{} lies on one side of every {}: nothing binds it", system,
                                   loose.front() + 1, more, other));
}

void warn_of_loose_threads(const std::vector<std::string>& rows, const Spot& threading, const Spot& sheds,
                           TextReport& report) {
  std::vector<std::size_t> loose_wefts, loose_warps;
  std::string low = rows.front(), high = rows.front();
  for (std::size_t pick = 0; pick < rows.size(); ++pick) {
    const std::string& row = rows[pick];
    if (row.find_first_not_of(row.front()) == std::string::npos) loose_wefts.push_back(pick);
    for (std::size_t end = 0; end < row.size(); ++end) {
      low[end] = std::min(low[end], row[end]);
      high[end] = std::max(high[end], row[end]);
    }
  }
  for (std::size_t end = 0; end < low.size(); ++end)
    if (low[end] == high[end]) loose_warps.push_back(end);
  warn_of_loose(loose_warps, "thread", "pick", threading, report);
  warn_of_loose(loose_wefts, "pick", "thread", sheds, report);
}

}  // namespace

Loom read_loom(const Ini& ini, TextReport& report) {
  Loom loom;
  const auto count = [&](const Section* section, std::string_view key, std::string_view limit,
                         Counted& counted) {
    const Entry* const entry = section != nullptr ? section->find(key) : nullptr;
    if (entry == nullptr || (&counted == &loom.treadles && Numbered{0, entry}.is_nothing())) return;
    counted.limit = limit;
    read_count(*section, key, counted, report);
  };
  const Section* const weaving = required(ini, "WEAVING", report);
  count(weaving, "Shafts", "[WEAVING]", loom.shafts);
  count(weaving, "Treadles", "[WEAVING]", loom.treadles);
  count(required(ini, "WARP", report), "Threads", "[WARP]", loom.warp);
  count(required(ini, "WEFT", report), "Threads", "[WEFT]", loom.weft);
  if (weaving == nullptr) return loom;
  if (const Entry* const shed = weaving->find("Rising Shed"))
    loom.is_rising = boolean(*shed, report).value_or(true);
  const Entry* const profile = weaving->find("Profile");
  if (profile != nullptr && boolean(*profile, report).value_or(false))
    report.warning(profile->key_spot,
                   "a profile draft: its threads stand for blocks of threads, but are taken as they are");
  return loom;
}

std::optional<std::vector<std::string>> read_drawdown(const Ini& ini, const Loom& loom, TextReport& report) {
  const std::optional<Threading> threading = read_threading(ini, loom, report);
  const std::optional<Sheds> sheds = read_sheds(ini, loom, report);
  if (!threading || !sheds || report.errors() > 0) return std::nullopt;
  const auto ends = static_cast<std::size_t>(threading->ends);
  const std::size_t picks = sheds->lifts.size();
  if (static_cast<long long>(picks) > fabric::most_crossings / threading->ends)
    return report.error(sheds->section->spot,
                        fmt::format("{} picks by {} threads are more than the {} crossings that are taken",
                                    picks, ends, fabric::most_crossings),
                        Kind::limit);
  const char moved = loom.is_rising ? '1' : '0';
  const char at_rest = loom.is_rising ? '0' : '1';
  std::vector<std::string> rows(picks, std::string(ends, at_rest));
  for (std::size_t pick = 0; pick < picks; ++pick) {
    for (const int shaft : sheds->lifts[pick]) {
      const auto threads = threading->ends_of_shaft.find(shaft);
      if (threads == threading->ends_of_shaft.end()) continue;
      for (const std::size_t end : threads->second) rows[pick][end] = moved;
    }
  }
  warn_of_loose_threads(rows, ini.find("THREADING")->spot, sheds->section->spot, report);
  return rows;
}

}  // namespace selvage::formats::wif
