// The fabrics by construction: `weave`, `knit`, `warpknit`, `braid`.
#include <fmt/format.h>

#include <charconv>
#include <numeric>

#include "formats/txt/blocks.h"
#include "formats/txt/pitch.h"
#include "formats/txt/slip.h"
#include "formats/txt/trade_draft.h"
#include "knit/lapping.h"
#include "mechanics/constants.h"
#include "weave/draft.h"

namespace selvage::formats::txt {

namespace {

using fabric::Braid;
using fabric::Draft;
using fabric::Knit;
using fabric::Warpknit;
using fabric::Weave;
using fabric::WeaveSystem;

// --- weave
// ----------------------------------------------------------------------------------------------------------

// A pitch without what may follow it.
std::string_view without_open(std::string_view text) {
  constexpr std::string_view open = "open";
  if (text.size() <= open.size() || !same_word(text.substr(text.size() - open.size()), open)) return text;
  const std::string_view before = text.substr(0, text.size() - open.size());
  return before.ends_with(' ') || before.ends_with('\t') ? trimmed(before) : text;
}

// [pitch] P: the word may be left out before a number.
std::optional<double> read_pitch(Parser& p) {
  const std::string_view word = p.peek_word();
  const bool is_number = word.empty() || !is_letter(word.front()) || p.scope().begins_with_param(word) ||
                         word.find('(') != std::string_view::npos;
  for (const std::string_view sign : {"x", "@", "*", "\xC3\x97", "at"})
    if (same_word(word, sign) && !p.scope().begins_with_param(word)) {
      const std::string_view behind = trimmed(p.peek_rest().substr(word.size()));
      p.error(p.here(), fmt::format("between the number and the pitch stands a blank alone: write '{}'",
                                    readable(behind)));
      p.take_rest();
      return std::nullopt;
    }
  if (!is_number || same_word(word, "pitch")) p.expect("pitch");
  const std::string_view text = without_open(p.peek_rest());
  const std::optional<std::string> own =
      p.has_failed() ? std::nullopt : pitch_in_own_form(with_plain_blanks(text));
  if (!own) return p.positive("the pitch", Measure::pitch);
  p.take_bytes(text.size());
  const std::optional<Result<double>> value = p.scope().value(*own, Measure::pitch);
  if (value && value->ok()) return **value;
  p.error(p.last(),
          fmt::format("the pitch: {}", value ? value->error().text : in_quotes(text) + " is not a number"));
  return std::nullopt;
}

// The number of yarns that is missing in front of a pitch: `warp cotton 24/cm`. `noun`: "ends".
bool lacks_count(Parser& p, std::string_view noun) {
  const std::string plain = with_plain_blanks(p.peek_rest());
  const std::string_view text = without_open(plain);
  const std::size_t blank = text.find_last_of(" \t");
  const std::string_view front = blank == std::string_view::npos ? text : trimmed(text.substr(0, blank));
  const auto is_pitch = [&](std::string_view part) {
    return !part.empty() && part.front() >= '0' && part.front() <= '9' &&
           (pitch_in_own_form(part) || (part.find_first_of(" \t") == std::string_view::npos &&
                                        (p.scope().is_count(part) || p.scope().is_length(part))));
  };
  if (is_pitch(text)) {
    p.error(p.here(), fmt::format("the number of {} is missing in front of the pitch: write '8 {}' for 8 {}",
                                  noun, readable(text), noun));
  } else if (const std::string_view behind = text.substr(std::min(text.size(), front.size()));
             is_pitch(front) && trimmed(behind).find_first_not_of("0123456789") == std::string_view::npos) {
    p.error(p.here(), fmt::format("the number of {} is in front of the pitch: write '{} {}'", noun,
                                  trimmed(behind), readable(front)));
  } else {
    return false;
  }
  return true;
}

// Names used in turn, `a,b`; `4a,2b`, and in a list `4 a, 2 b`: four times one, twice the other.
void read_threads(Parser& p, std::vector<std::string>& threads) {
  const std::vector<std::string_view> words = words_of(p.peek_rest());
  const bool is_list =
      std::any_of(words.begin(), words.end(), [](std::string_view word) { return word.ends_with(","); });
  do {
    const Spot spot = p.here();
    const std::size_t times = p.leading_count(is_list);
    const auto thread = p.reference(p.threads);
    if (!thread) continue;
    if (times < 1 || !p.take_listed(times))
      return p.error(spot, fmt::format("the lists of threads of a text have from 1 to {} of them in all",
                                       Parser::most_listed));
    threads.insert(threads.end(), times, std::string(*thread));
  } while (p.comma());
}

void read_extent(Parser& p, std::string_view noun, int& count, double& pitch) {
  if (lacks_count(p, noun)) return;
  const auto number = p.count(fmt::format("the number of {}", noun));
  const auto distance = read_pitch(p);
  if (!p.finish()) return;
  count = *number;
  pitch = *distance;
}

void read_system(Parser& p, WeaveSystem& system, std::string_view noun) {
  system.place = p.statement().place();
  // `warp 8 cotton 24/cm`.
  const std::vector<std::string_view> words = words_of(p.peek_rest());
  if (words.size() > 2 && words[0].find_first_not_of("0123456789") == std::string_view::npos &&
      is_identifier(words[1])) {
    const std::string_view text = p.peek_rest();
    const auto behind = static_cast<std::size_t>(words[1].data() + words[1].size() - text.data());
    return p.error(p.here(), fmt::format("the thread stands in front of the number of {}: write '{} {}{}'",
                                         noun, words[1], words[0], readable(text.substr(behind))));
  }
  read_threads(p, system.threads);
  if (p.has_failed() || lacks_count(p, noun)) return;
  const auto number = p.count(fmt::format("the number of {}", noun));
  const auto distance = read_pitch(p);
  PitchText& text = p.pitches[system.place.line];
  text = {p.last(), std::string(p.token()), false};
  text.is_open = p.more() && same_word(p.peek_word(), "open") && p.expect("open");
  if (!p.finish()) return;
  system.count = *number;
  system.pitch = *distance;
  system.counted_on = length_counted_on(with_plain_blanks(text.text));
}

// The rows of a user's own loop.
struct OwnLoopRows {
  fabric::OwnLoop& loop;
  Spot last;  // of the last row
  bool good = true;
};

// Of larger drafts the builder tells what is wrong with them: here the cost would have nothing to do with the
// length of the text.
constexpr long long most_shafts_checked = 100;

// A weave's statements, and the places of those that only the whole block can validate: of its draft, which
// is required or forbidden, and of its state, which conflicts with other statements.
struct WeaveBlock : Weave {
  std::optional<Spot> draft_place, state_place, levels_place, pile_place;
  std::vector<std::pair<std::string_view, Spot>> plates;  // what presses the cloth, by its word
  std::vector<Spot> stacked_warps;
};

void read_warp(Parser& p, WeaveBlock& weave, std::string_view) {
  read_system(p, weave.warp, "ends");
}
void read_weft(Parser& p, WeaveBlock& weave, std::string_view) {
  read_system(p, weave.weft, "picks");
}

// Rows of signs, one character each and equally many a row: a draft's, a chart's.
struct SignRows {
  std::string_view kind;     // "draft"
  std::string_view signs;    // "01"
  std::string_view meaning;  // of the signs
  std::vector<std::string>& rows;
  std::vector<int>* lines = nullptr;  // where each row stands; null: nobody asks
  bool good = true;
};

void read_sign_row(Parser& p, SignRows& rows) {
  const Spot spot = p.statement();
  const std::string_view text = p.take_rest();
  std::string row;
  for (const char& c : text) {
    if (c == ' ' || c == '\t') continue;
    const char sign = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    if (rows.signs.find(sign) == std::string_view::npos) {
      rows.good = false;
      return p.error(spot.behind(static_cast<std::size_t>(&c - text.data())),
                     fmt::format("a {} has the signs {}", rows.kind, rows.meaning));
    }
    row += sign;
  }
  if (!rows.rows.empty() && row.size() != rows.rows.front().size()) {
    rows.good = false;
    p.error(spot, fmt::format("this row of the {} has {} signs, the first one has {}", rows.kind, row.size(),
                              rows.rows.front().size()));
    return;
  }
  rows.rows.push_back(std::move(row));
  if (rows.lines != nullptr) rows.lines->push_back(spot.line);
}

void read_sign_rows(Parser& p, SignRows rows) {
  static const Table<SignRows> table({}, read_sign_row, true);
  if (p.read_block(rows.kind, "", p.statement(), table, rows) && rows.good && rows.rows.empty())
    p.error(p.last(), fmt::format("the {} has no rows", rows.kind));
}

void read_draft_rows(Parser& p, Draft& draft) {
  draft.form = Draft::Form::rows;
  read_sign_rows(p, {"draft", "01", "0 and 1 (1: warp on top)", draft.rows});
}

void read_draft_numbers(Parser& p, Draft& draft) {
  const std::string what = fmt::format("the {}", word_of(draft_words, draft.form));
  const bool is_twill = draft.form == Draft::Form::twill, is_satin = draft.form == Draft::Form::satin;
  if (!p.more())
    return p.error(p.here(), fmt::format("{} says how the yarns go over and under, as in {}", what,
                                         is_twill   ? "2/1"
                                         : is_satin ? "5 or 8/3 (shafts, and the step)"
                                                    : "2x2"));
  const auto numbers = p.counts(what, '/');
  if (!numbers) return;
  const Spot spot = p.last();
  const std::size_t least = is_satin ? 1 : 2, most = is_twill ? numbers->size() : 2;
  if (numbers->size() < least || numbers->size() > most)
    return p.error(spot, fmt::format("{}: {} whole numbers joined by '/' are expected, as in 2/1", what,
                                     is_satin ? "one or two" : "two"));
  draft.a = numbers->front();
  draft.b = numbers->size() > 1 ? (*numbers)[1] : 0;
  if (is_twill && numbers->size() > 2) draft.further.assign(numbers->begin() + 2, numbers->end());
  if (is_twill && p.more()) draft.hand = p.choice("direction of the twill", hand_words).value_or(Hand::z);
  if (is_satin && p.more()) draft.warp_faced = p.choice("face of the satin", face_words).value_or(false);
  if (draft.form == Draft::Form::basket && draft.a != draft.b)
    p.report.note(spot,
                  fmt::format("basket {0}/{1}: groups of {0} and of {1} in turn, both ways; {0} ends x {1} "
                              "picks as one, as an Oxford has them, are `basket {0}x{1}`",
                              draft.a, draft.b));
  // What cannot be is told where it stands.
  const long long shafts = std::accumulate(numbers->begin(), numbers->end(), 0LL);
  if (p.finish() && shafts <= most_shafts_checked)
    if (const Result<fabric::Drawdown> made = fabric::drawdown_of(draft);
        !made && made.error().kind == Kind::malformed)
      p.error(spot, made.error().text);
}

void read_draft(Parser& p, WeaveBlock& weave, std::string_view) {
  Draft& draft = weave.draft;
  weave.draft_place = p.statement();
  draft.place = p.statement().place();
  if (!p.more()) return read_draft_rows(p, draft);
  const std::string_view text = p.peek_rest();
  if (const auto understood = draft_of_trade(text, draft)) {
    p.take_bytes(text.size());
    if (!understood->empty())
      p.report.note(p.last(), fmt::format("draft {}: understood as {}", in_quotes(text), *understood));
    return;
  }
  if (const std::string instead = instead_of_draft(text); !instead.empty()) {
    p.error(p.here(), fmt::format("there is no draft {}: {}", in_quotes(text), instead));
    return p.skip_statement();
  }
  if (const std::string_view word = p.peek_word(), near = near_draft_of_trade(word); !near.empty()) {
    p.error(p.here(), same_word(near, word)
                          ? fmt::format("{} is a draft by itself: write '{}'", in_quotes(text), near)
                          : fmt::format("unknown draft {}; did you mean '{}'?", in_quotes(word), near));
    return p.skip_statement();
  }
  const auto form = p.choice("draft", draft_words);
  if (!form) return p.skip_statement();
  draft.form = *form;
  if (*form == Draft::Form::file) {
    draft.file = read_file_name(p, "the draft's file");
  } else if (*form == Draft::Form::leno) {
    if (p.more()) draft.full_turns = p.choice("kind of leno", leno_words).value_or(false);
  } else if (draft.has_pile()) {
    draft.a = 6;
    if (p.more()) draft.a = p.count("the ends from wale to wale", 4).value_or(draft.a);
    if (draft.a % 2 != 0)
      p.error(
          p.last(),
          fmt::format("the ground of a {0} is plain, so that its wales repeat after an even number of ends: "
                      "write '{0} {1}' or '{0} {2}'",
                      word_of(draft_words, *form), draft.a - 1, draft.a + 1));
  } else if (*form != Draft::Form::plain) {
    read_draft_numbers(p, draft);
    return;
  }
  p.finish();
}

void read_profile(Parser& p, WeaveBlock& weave, std::string_view) {
  const auto profile = p.choice("profile", profile_words);
  if (profile == Weave::Profile::sine && p.more())
    weave.amplitude = p.positive("the amplitude", Measure::length);
  if (p.finish()) weave.profile = *profile;
}

void read_spacing(Parser& p, WeaveBlock& weave, std::string_view) {
  const auto spacing = p.choice("spacing", spacing_words);
  if (p.finish()) weave.spacing = *spacing;
}

void read_state(Parser& p, WeaveBlock& weave, std::string_view) {
  weave.state_place = p.statement();
  const auto state = p.choice("state", state_words);
  if (p.finish()) weave.state = *state;
}

// Reports statements of a weave that its state, an equilibrium of interlaced yarns, excludes.
void check_state(Parser& p, const WeaveBlock& weave) {
  if (!weave.state) return;
  const auto report = [&](std::string_view needs, std::string_view remedy) {
    p.error(*weave.state_place, fmt::format("'state' needs {}: {}", needs, remedy));
  };
  if (weave.profile == Weave::Profile::straight || !weave.binders.empty())
    report("yarns that interlace, and straight yarns with binders do not",
           "use a draft without 'profile' and 'binder', or leave out the state");
  else if (weave.profile)
    report("yarns whose path is free, and 'profile' prescribes it", "leave out the profile, or the state");
  if (weave.draft.form == Draft::Form::leno)
    report("warps that stay side by side, and those of a leno cross each other",
           "use another draft, or leave out the state");
  if (weave.pucker)
    report("warps of equal length, and 'pucker' makes some of them longer",
           "leave out the pucker, or the state");
}

// pucker tight T slack S ratio R every N
void read_pucker(Parser& p, WeaveBlock& weave, std::string_view) {
  fabric::Pucker pucker;
  pucker.place = p.statement().place();
  p.expect("tight");
  pucker.tight = p.count("the number of tight warps").value_or(1);
  p.expect("slack");
  pucker.slack = p.count("the number of slack warps").value_or(1);
  p.expect("ratio");
  pucker.ratio = p.number("the ratio of the lengths of slack and tight warps").value_or(1.1);
  if (!p.has_failed() && !(pucker.ratio > 1.0 && pucker.ratio <= 2.0))
    p.error(p.last(), "slack warps are longer than tight ones: their ratio lies above 1, and is 2 at most");
  p.expect("every");
  pucker.picks = p.count("the picks from wave to wave", 2).value_or(2);
  if (p.finish()) weave.pucker = pucker;
}

void read_crimp(Parser& p, WeaveBlock& weave, std::string_view) {
  const auto share = p.number("the warp's share of the crimp");
  if (share && !(*share >= 0.0 && *share <= 1.0)) p.error(p.last(), "a share lies between 0 and 1");
  if (p.finish()) weave.crimp = *share;
}

void read_fraction(Parser& p, WeaveBlock& weave, std::string_view) {
  weave.plates.emplace_back("fraction", p.statement());
  const auto fraction = p.number("the fibre fraction of the cloth");
  if (fraction && !(*fraction > 0.0 && *fraction < mechanics::densest_packing))
    p.error(p.last(),
            fmt::format("a fibre fraction of the cloth lies between 0 and {:.3f} (round fibres, packed "
                        "hexagonally)",
                        mechanics::densest_packing));
  if (p.finish()) weave.fraction = *fraction;
}

// compact P [MPa]
void read_compact(Parser& p, WeaveBlock& weave, std::string_view) {
  weave.plates.emplace_back("compact", p.statement());
  const auto pressure = p.positive("the pressure in MPa", Measure::modulus);
  if (p.more() && same_word(p.peek_word(), "MPa")) p.expect("MPa");
  if (p.finish()) weave.pressure = *pressure;
}

// Reports what leaves nothing to be pressed.
void check_plates(Parser& p, const WeaveBlock& weave) {
  for (const auto& plates : weave.plates) {
    const auto report = [&](bool is, std::string_view other, std::string_view why) {
      if (is)
        p.error(plates.second, fmt::format("'{0}' and '{1}' exclude each other, {2}: leave out one of them",
                                           plates.first, other, why));
    };
    report(weave.thickness.has_value(), "thickness", "since both say how far apart the plates are");
    report(weave.profile.has_value(), "profile", "since only yarns whose path is free are pressed");
    report(!weave.binders.empty(), "binder", "since only yarns that interlace are pressed");
    report(weave.draft.form == Draft::Form::leno, "draft leno", "since a leno is not pressed");
    report(weave.pucker.has_value(), "pucker", "since plates leave no waves");
    report(weave.pile || weave.draft.has_pile(), "pile", "since plates leave no pile upright");
  }
  if (weave.plates.size() > 1)
    p.error(weave.plates.back().second,
            "'fraction' and 'compact' exclude each other, since both say how far apart the plates are: leave "
            "out one of them");
}

void read_binder(Parser& p, WeaveBlock& weave, std::string_view) {
  fabric::Binder binder;
  binder.place = p.statement().place();
  const auto thread = p.reference(p.threads);
  p.expect("every");
  const auto every = p.count("every how many gaps");
  if (p.choice("binder", binder_words).value_or(false)) {
    binder.first = p.count("the first gap").value_or(1);
    p.expect("levels");
  }
  do
    if (const auto level = p.count("a level", 0)) binder.levels.push_back(*level);
  while (p.more());
  if (!p.finish()) return;
  binder.thread = *thread;
  binder.every = *every;
  weave.binders.push_back(std::move(binder));
}

// A comma may stand right behind it.
std::optional<int> read_level_of_warp(Parser& p) {
  const std::string_view word = p.peek_word(), digits = word.substr(0, word.find(','));
  int level = 0;
  if (digits.empty() || digits.size() == word.size() ||
      std::from_chars(digits.data(), digits.data() + digits.size(), level).ptr !=
          digits.data() + digits.size())
    return p.count("a level", 0);
  p.take_bytes(digits.size());
  return level;
}

// levels [THREAD] L1 L2 ... , [THREAD] L1 L2 ...
void read_levels(Parser& p, WeaveBlock& weave, std::string_view) {
  if (!weave.levels_place) weave.levels_place = p.statement();
  fabric::WarpColumn column;
  do {
    if (!p.more())
      return p.error(p.here(), "a warp has a level for each weft of the repeat, as in 'levels 1 0 , 2 1'");
    fabric::StackedWarp warp;
    weave.stacked_warps.push_back(p.here());
    warp.place = p.here().place();
    if (p.next_is('"') || (p.next_is_letter() && !p.scope().begins_with_param(p.peek_word())))
      warp.thread = p.reference(p.threads).value_or("");
    do
      if (const auto level = read_level_of_warp(p)) warp.levels.push_back(*level);
    while (!p.has_failed() && p.more() && !p.next_is(','));
    column.push_back(std::move(warp));
  } while (!p.has_failed() && p.comma());
  if (p.finish()) weave.columns.push_back(std::move(column));
}

// Reports statements that go with drafts, or with yarns without free paths.
void check_levels(Parser& p, const WeaveBlock& weave) {
  if (!weave.levels_place) return;
  const auto report = [&](std::string_view word, std::string_view why) {
    p.error(
        *weave.levels_place,
        fmt::format("'levels' and '{0}' exclude each other, {1}: leave out '{0}', or the levels", word, why));
  };
  if (weave.draft_place) report("draft", "both say which yarn is on top");
  if (weave.profile) report("profile", "since warps with levels have the paths of least energy");
  if (!weave.binders.empty()) report("binder", "since a warp with levels binds by itself");
  if (weave.pucker) report("pucker", "since it goes with one layer");
  if (weave.crimp) report("crimp", "since warps above each other have crimps of their own");
  if (weave.spacing) report("spacing", "since it goes with a draft");
  if (weave.draft_place || weave.profile) return;
  if (const Result<fabric::Drawdown> made = fabric::drawdown_of(weave.columns, weave.layers.value_or(1));
      !made && made.error().kind == Kind::malformed) {
    const TextPlace place = made.error().place;
    const auto spot = std::ranges::find_if(weave.stacked_warps, [&](const Spot& warp) {
      return warp.line == place.line && warp.column == place.column;
    });
    p.error(spot == weave.stacked_warps.end() ? *weave.levels_place : *spot, made.error().text);
  }
}

// pile H [THREAD] [every N] [face | back | both] [cut]
void read_warp_pile(Parser& p, WeaveBlock& weave, std::string_view) {
  fabric::WarpPile pile;
  weave.pile_place = p.statement();
  pile.place = p.statement().place();
  pile.picks = 0;
  pile.height = p.positive("the height of the pile", Measure::length).value_or(1.0);
  std::optional<fabric::WarpPile::Side> side;
  while (p.more()) {
    const std::string_view word = p.peek_word();
    const bool is_side = std::any_of(pile_words.begin(), pile_words.end(),
                                     [&](const auto& known) { return same_word(known.text, word); });
    if (same_word(word, "cut") && !pile.is_cut)
      pile.is_cut = p.expect("cut");
    else if (same_word(word, "every") && pile.picks == 0 && p.expect("every"))
      pile.picks = p.count("the picks from loop to loop", 3).value_or(3);
    else if (is_side && !side)
      side = p.choice("side of the pile", pile_words);
    else if (pile.thread.empty())
      pile.thread = p.reference(p.threads).value_or(std::string_view{});
    else
      break;
  }
  if (!p.finish()) return;
  // Velvet has its pile on the face, a towel on both sides.
  pile.side = side.value_or(pile.is_cut ? fabric::WarpPile::Side::face : fabric::WarpPile::Side::both);
  weave.pile = std::move(pile);
}

// Reports statements of a weave that its pile excludes, and a pile without a thread of its own.
void check_pile(Parser& p, WeaveBlock& weave) {
  if (!weave.pile && !weave.draft.has_pile()) return;
  const Spot place = weave.pile ? *weave.pile_place : *weave.draft_place;
  const std::string what =
      weave.pile ? "pile" : fmt::format("draft {}", word_of(draft_words, weave.draft.form));
  const auto report = [&](bool is, std::string_view word, std::string_view why) {
    if (is)
      p.error(place,
              fmt::format("'{}' and '{}' exclude each other, {}: leave out one of them", what, word, why));
  };
  report(weave.profile.has_value(), "profile", "since pile rises out of a ground whose paths are free");
  report(weave.spacing.has_value(), "spacing", "since pile rises between picks or ends at even pitches");
  report(weave.pucker.has_value(), "pucker", "since pile rises out of a level ground");
  report(weave.layers.has_value(), "layers", "since a cloth of pile is one layer");
  report(weave.levels_place.has_value(), "levels", "since a cloth of pile is one layer");
  report(weave.draft.form == Draft::Form::leno, "draft leno", "since ends of pile stay beside the warps");
  report(weave.pile && weave.draft.has_pile(),
         fmt::format("draft {}", word_of(draft_words, weave.draft.form)), "since its picks are pile");
  const std::vector<std::string>& threads = weave.weft.threads;
  if (weave.draft.has_pile() && std::all_of(threads.begin(), threads.end(), [&](const std::string& thread) {
        return thread == threads.front();
      }))
    p.error(place, fmt::format("the picks of '{}' are ground and pile in turn, the pile of a thread of its "
                               "own: write 'weft {},2NAME ...' for one ground pick and two pile picks",
                               what, threads.empty() ? "GROUND" : threads.front()));
  if (!weave.pile || weave.pile->picks > 0) return;
  // As most terry has, or as many as the picks can be divided by.
  weave.pile->picks = 3;
  for (const int picks : {3, 4, 5})
    if (weave.weft.count % picks == 0) {
      weave.pile->picks = picks;
      break;
    }
}

// --- knit
// -----------------------------------------------------------------------------------------------------------

template <class T>
void read_construction_thread(Parser& p, T& construction, std::string_view) {
  const auto thread = p.reference(p.threads);
  if (!p.finish()) return;
  construction.thread = *thread;
  construction.thread_place = p.last().place();
}

// N [[pitch] P]
void read_knit_extent(Parser& p, std::string_view noun, int& count, double& pitch) {
  if (lacks_count(p, noun)) return;
  const auto number = p.count(fmt::format("the number of {}", noun));
  std::optional<double> distance;
  if (p.more()) distance = read_pitch(p);
  if (!p.finish()) return;
  count = *number;
  pitch = distance.value_or(0.0);
}

void read_knit_courses(Parser& p, Knit& knit, std::string_view) {
  read_knit_extent(p, "courses", knit.courses, knit.course_pitch);
}

void read_knit_wales(Parser& p, Knit& knit, std::string_view) {
  read_knit_extent(p, "wales", knit.wales, knit.wale_pitch);
}

void read_loop(Parser& p, Knit& knit, std::string_view) {
  if (same_word(p.peek_word(), "length")) p.take_word();
  const auto length = p.positive("the length of a loop", Measure::length);
  if (p.finish()) knit.loop = *length;
}

// `stitch length L`.
void read_stitch_length(Parser& p, Knit& knit, std::string_view word) {
  if (p.expect("length")) read_loop(p, knit, word);
}

void read_knit_threads(Parser& p, Knit& knit, std::string_view) {
  knit.thread_place = p.here().place();
  read_threads(p, knit.threads);
  p.finish();
}

void read_plating(Parser& p, Knit& knit, std::string_view) {
  const auto thread = p.reference(p.threads);
  if (p.finish()) knit.plating = *thread;
}

void read_pile(Parser& p, Knit& knit, std::string_view) {
  const auto height = p.positive("the height of the pile", Measure::length);
  const bool is_cut = p.more() && p.expect("cut");
  if (!p.finish()) return;
  knit.pile = *height;
  knit.pile_is_cut = is_cut;
}

void read_gating(Parser& p, Knit& knit, std::string_view) {
  const auto gating = p.choice("gating", gating_words);
  std::optional<double> distance;
  if (gating == Knit::Gating::opposite && p.more())
    distance = p.positive("the distance of the beds", Measure::length);
  if (!p.finish()) return;
  knit.gating = *gating;
  knit.bed_distance = distance;
}

void read_crossing(Parser& p, Knit& knit, std::string_view) {
  const auto point = p.point("the point where both yarns cross");
  if (p.finish()) knit.crossing = *point;
}

// --- a user's own loop
// -----------------------------------------------------------------------------------------------

constexpr std::size_t most_loop_points = 64;

void read_loop_row(Parser& p, OwnLoopRows& rows) {
  rows.last = p.statement();
  Vec3 point;
  for (double& x : point) x = p.number("x in wales, y in courses, z in thicknesses").value_or(0);
  if (!p.finish()) {
    rows.good = false;
    return;
  }
  if (!rows.loop.points.empty() && rows.loop.points.back() == point) {
    rows.good = false;
    p.error(rows.last, "this point equals the one before it");
  }
  rows.loop.points.push_back(point);
}

// Up to the `end` of the block; false where something was wrong.
bool read_own_loop(Parser& p, fabric::OwnLoop& loop, std::size_t least, std::size_t most) {
  static const Table<OwnLoopRows> table({}, read_loop_row);
  loop.place = p.statement().place();
  OwnLoopRows rows{loop, p.statement()};
  const bool is_closed = p.read_block("points", "", p.statement(), table, rows) && rows.good;
  const std::size_t count = loop.points.size();
  if (is_closed && (count < least || count > most)) {
    p.error(p.last(), fmt::format("a loop has from {} to {} points; this one has {}", least, most, count));
    return false;
  }
  return is_closed;
}

void read_knit_points(Parser& p, Knit& knit, std::string_view) {
  const Spot spot = p.statement();
  fabric::OwnLoop loop;
  if (p.more()) loop.sign = p.choice("stitch", stitch_signs).value_or('K');
  p.finish();
  for (const fabric::OwnLoop& other : knit.own_loops)
    if (other.sign == loop.sign)
      p.error(spot,
              fmt::format("the points of {} are given twice; first on line {}", loop.sign, other.place.line));
  constexpr std::size_t least = 3;
  if (read_own_loop(p, loop, least, most_loop_points)) knit.own_loops.push_back(std::move(loop));
}

void read_chart(Parser& p, Knit& knit, std::string_view) {
  if (!p.finish()) return;
  knit.chart_place = p.statement().place();
  SignRows rows{
      "chart", "KPTUM.",
      "K (knit), P (purl), T (tuck) and M (miss); U (tuck of the back bed) with 'gating opposite'; . where "
      "the row's yarn does not come",
      knit.chart, &knit.chart_lines};
  if (knit.form == Knit::Form::jacquard) {
    rows.signs = "123456";
    rows.meaning = "1 to 6: which of the threads knits";
  }
  read_sign_rows(p, rows);
}

bool read_moved_loop(Parser& p, fabric::LoopMove& move) {
  move.place = p.statement().place();
  const auto row = p.count("the row of the chart"), wale = p.count("the wale");
  move.row = row.value_or(1);
  move.wale = wale.value_or(1);
  return row && wale;
}

void read_transfer(Parser& p, Knit& knit, std::string_view) {
  fabric::LoopMove move;
  if (!read_moved_loop(p, move)) return p.skip_statement();
  const auto side = p.choice("side", side_words);
  const auto wales = p.count("the number of wales", 0);
  if (!p.finish()) return;
  move.right = *side * *wales;
  knit.moves.push_back(move);
}

void read_drop(Parser& p, Knit& knit, std::string_view) {
  fabric::LoopMove move;
  move.is_dropped = true;
  if (read_moved_loop(p, move) && p.finish()) knit.moves.push_back(move);
}

// --- warpknit
// -------------------------------------------------------------------------------------------------------

void read_bar(Parser& p, Warpknit& warpknit, std::string_view) {
  fabric::WarpknitBar bar;
  bar.place = p.statement().place();
  const auto thread = p.reference(p.threads);
  if (!thread) return;
  bar.thread = *thread;
  std::string_view lapping = p.take_rest();
  const Spot spot = p.last();
  constexpr std::string_view fall_plate = "fall-plate";
  if (lapping.size() > fall_plate.size() &&
      same_word(lapping.substr(lapping.size() - fall_plate.size()), fall_plate)) {
    lapping.remove_suffix(fall_plate.size());
    bar.fall_plate = true;
  }
  while (!lapping.empty() && (lapping.back() == ' ' || lapping.back() == '\t')) lapping.remove_suffix(1);
  if (lapping.empty()) return p.error(p.here(), "the bar's lapping is missing, such as 1-0/1-2");
  bar.lapping_place = spot.place();
  if (const Result<fabric::Lapping> read = fabric::parse_lapping(lapping, bar.lapping_place); !read) {
    const int before = read.error().place.column - spot.column;
    return p.error(spot.behind(static_cast<std::size_t>(std::max(before, 0))), read.error().text);
  }
  bar.lapping = lapping;
  warpknit.bars.push_back(std::move(bar));
}

// Of the bar before it.
void read_bar_points(Parser& p, Warpknit& warpknit, std::string_view) {
  const Spot spot = p.statement();
  p.finish();
  fabric::OwnLoop loop;
  constexpr std::size_t least = 4;
  if (!read_own_loop(p, loop, least, fabric::most_points_of_a_loop)) return;
  if (warpknit.bars.empty())
    return p.error(spot, "the points of a loop stand behind the 'bar' that knits it");
  if (warpknit.bars.back().own_loop)
    return p.error(spot, "the loop of this bar is given twice: one block 'points' behind each 'bar'");
  warpknit.bars.back().own_loop = std::move(loop);
}

// THREADS every N [first C]
void read_inserted_weft(Parser& p, Warpknit& warpknit, std::string_view) {
  fabric::WarpknitWeft weft;
  weft.place = p.statement().place();
  read_threads(p, weft.threads);
  p.expect("every");
  const auto every = p.count("every how many courses");
  if (p.more() && p.expect("first")) weft.first = p.count("the first course").value_or(1);
  if (!p.finish()) return;
  weft.every = *every;
  warpknit.weft = std::move(weft);
}

void read_warpknit_wales(Parser& p, Warpknit& warpknit, std::string_view) {
  read_extent(p, "wales", warpknit.wales, warpknit.wale_pitch);
}

void read_warpknit_courses(Parser& p, Warpknit& warpknit, std::string_view) {
  read_extent(p, "courses", warpknit.courses, warpknit.course_pitch);
}

// --- braid
// ----------------------------------------------------------------------------------------------------------

// What a braid's statements say, and where its carriers stand: only the whole block tells whether they may be
// odd.
struct BraidBlock : Braid {
  Spot carriers_spot{};
  bool has_length = false, has_mandrel = false;
};

void read_carriers(Parser& p, BraidBlock& braid, std::string_view) {
  const auto count = p.count("the number of carriers", 2);
  if (!p.finish()) return;
  braid.carriers = *count;
  braid.carriers_spot = p.last();
  braid.carriers_place = p.last().place();
}

// The names of the three usual patterns.
std::optional<std::array<int, 2>> pattern_named(std::string_view word) {
  struct Named {
    std::string_view name;
    int yarns;
  };
  constexpr std::array<Named, 4> names = {{{"diamond", 1}, {"regular", 2}, {"standard", 2}, {"hercules", 3}}};
  for (const Named& known : names)
    if (same_word(known.name, word)) return std::array{known.yarns, known.yarns};
  return std::nullopt;
}

void read_pattern(Parser& p, BraidBlock& braid, std::string_view) {
  std::optional<std::array<int, 2>> numbers = pattern_named(p.peek_word());
  if (numbers)
    p.take_word();
  else
    numbers = p.pair("the pattern", '/');
  if (!p.finish()) return;
  braid.over = (*numbers)[0];
  braid.under = (*numbers)[1];
}

void read_radius(Parser& p, BraidBlock& braid, std::string_view) {
  const auto value = p.positive("the radius", Measure::length);
  if (!p.finish()) return;
  braid.radius = *value;
  braid.radius_place = p.last().place();
}

void read_braid_length(Parser& p, BraidBlock& braid, std::string_view) {
  braid.has_length = true;
  const auto length = p.positive("the length", Measure::length);
  if (p.finish()) braid.length = *length;
}

struct MandrelRows {
  std::vector<fabric::MandrelRow> rows;
};

void read_mandrel_row(Parser& p, MandrelRows& rows) {
  std::array<double, 4> row{};
  const Spot spot = p.statement();
  const int count = p.row(row.data(), 4, "a row of the mandrel");
  if (count < 0) return;
  if (count != 4 || !(row[3] > 0.0))
    return p.error(spot,
                   "a row of the mandrel is x y z RADIUS: a point of its axis, and the radius of the cloth's "
                   "middle surface there, larger than 0");
  const Vec3 axis(row[0], row[1], row[2]);
  if (!rows.rows.empty() && rows.rows.back().axis == axis)
    return p.error(spot, "this point of the axis equals the one before it");
  rows.rows.push_back({axis, row[3]});
}

void read_mandrel(Parser& p, BraidBlock& braid, std::string_view word) {
  static const Table<MandrelRows> table({}, read_mandrel_row);
  braid.radius_place = p.statement().place();
  braid.has_mandrel = true;
  p.finish();
  const int errors = p.report.errors();
  MandrelRows rows;
  if (p.read_block(word, "", p.statement(), table, rows) && rows.rows.size() < 2 &&
      p.report.errors() == errors)
    p.error(p.last(), "a mandrel has at least 2 rows");
  braid.mandrel = std::move(rows.rows);
}

void read_level(Parser& p, BraidBlock& braid, std::string_view word) {
  (word == "flat" ? braid.flat : braid.planar) = true;
  braid.radius_place = p.statement().place();
  if (!p.more()) return;
  const auto value = p.positive("the width", Measure::length);
  if (p.finish()) braid.width = *value;
}

// `+-45`, `45°`: the number alone.
std::string_view plain_angle(std::string_view text) {
  for (const std::string_view sign : {"\xC2\xB1", "+-", "+/-"})
    if (text.starts_with(sign)) text = trimmed(text.substr(sign.size()));
  constexpr std::string_view degree = "\xC2\xB0";
  return trimmed(text.ends_with(degree) ? text.substr(0, text.size() - degree.size()) : text);
}

void read_angle(Parser& p, BraidBlock& braid, std::string_view) {
  if (const std::string_view text = p.peek_rest(), plain = plain_angle(text); plain != text && !plain.empty())
    return p.error(p.here(), fmt::format("the angle is a number of degrees, of both directions: write '{}'",
                                         readable(plain)));
  const auto value = p.number("the angle", Measure::angle);
  if (value && !(*value > 0.0 && *value < 90.0))
    p.error(p.last(), "the angle between yarn and axis lies between 0 and 90 degrees, both excluded");
  if (p.finish()) braid.angle = *value;
}

void read_axial(Parser& p, BraidBlock& braid, std::string_view) {
  braid.axial_place = p.statement().place();
  const auto thread = p.reference(p.threads);
  const auto count = p.count("the number of axial yarns");
  if (!p.finish()) return;
  braid.axial_thread = *thread;
  braid.axial_count = *count;
}

}  // namespace

// A word, or what stands in double quotes.
std::string read_file_name(Parser& p, std::string_view what) {
  const Spot spot = p.here();
  if (!p.more() || p.next_is('"')) return std::string(p.name(what).value_or(""));
  const std::string_view word = p.take_word();
  if (text_prefix(word) != word.size() || word.find('"') != std::string_view::npos)
    p.error(spot, fmt::format("{} is no name of a file: UTF-8 without double quotes", in_quotes(word)));
  return std::string(word);
}

void read_weave(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<WeaveBlock> table({{"warp", read_warp, Times::once},
                                        {"weft", read_weft, Times::once},
                                        {"fill", read_weft, Times::once, "weft"},
                                        {"draft", read_draft},
                                        {"profile", read_profile},
                                        {"crimp", read_crimp},
                                        {"spacing", read_spacing},
                                        {"state", read_state},
                                        {"pucker", read_pucker},
                                        {"thickness", into(&Weave::thickness, a_length("the thickness"))},
                                        {"fraction", read_fraction},
                                        {"compact", read_compact},
                                        {"layers", into(&Weave::layers, a_count("the number of layers"))},
                                        {"binder", read_binder, Times::any},
                                        {"levels", read_levels, Times::any},
                                        {"pile", read_warp_pile}});
  WeaveBlock weave;
  const Spot opened = p.statement();
  weave.place = opened.place();
  p.finish();
  const int errors = p.report.errors();
  const bool is_closed = p.read_block(word, "", opened, table, weave);
  const bool is_straight = weave.profile == Weave::Profile::straight;
  if (is_closed && !is_straight && !weave.draft_place && !weave.levels_place)
    p.error(p.last(), "'weave' ends without its 'draft'");
  if (is_closed && p.report.errors() == errors) {
    if (is_straight && weave.draft_place)
      p.error(*weave.draft_place, "straight yarns do not interlace: leave out the draft, or the profile");
    if (!is_straight && !weave.binders.empty() && !weave.levels_place)
      p.error(opened, "a binder goes through straight layers: it needs 'profile straight'");
    const bool is_leno = weave.draft.form == Draft::Form::leno;
    if (is_leno &&
        (weave.profile || weave.crimp || weave.spacing || weave.thickness || weave.layers || weave.pucker))
      p.error(
          opened,
          "a leno has a geometry of its own: leave out profile, crimp, spacing, thickness, layers, pucker");
    if (is_leno && weave.warp.count % 2 != 0)
      p.error(
          opened,
          fmt::format("a leno's warps are pairs of a standing and a doup end: their number is even, not {}",
                      weave.warp.count));
    if (weave.pucker && (is_straight || weave.layers))
      p.error(opened, "a pucker goes with one layer of interlaced yarns");
    if (is_straight && weave.crimp) p.error(opened, "straight yarns have no crimp to share");
    if (is_straight && weave.spacing)
      p.error(opened, "straight yarns have no intersections to make room for");
    if (weave.profile && weave.thickness)
      p.error(opened,
              "with a profile its formula makes the thickness: leave out the profile, or the thickness");
    check_state(p, weave);
    check_plates(p, weave);
    check_levels(p, weave);
    check_pile(p, weave);
  }
  fabric.items.emplace_back(static_cast<Weave&&>(weave));
}

void read_knit(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Knit> table({{"thread", read_knit_threads, Times::once},
                                  {"courses", read_knit_courses, Times::once},
                                  {"wales", read_knit_wales, Times::once},
                                  {"loop", read_loop},
                                  {"stitch", read_stitch_length, Times::at_most_once, "loop"},
                                  {"feeds", into(&Knit::feeds, a_count("the rows of the chart in a course"))},
                                  {"gating", read_gating},
                                  {"plating", read_plating},
                                  {"pile", read_pile},
                                  {"unit", into(&Knit::unit, a_length("the loop's unit"))},
                                  {"crossing", read_crossing},
                                  {"shape", into(&Knit::shape, one_of("shape", knit_shape_words))},
                                  {"points", read_knit_points, Times::any},
                                  {"method", into(&Knit::method, one_of("method", knit_method_words))},
                                  {"chart", read_chart},
                                  {"transfer", read_transfer, Times::any},
                                  {"drop", read_drop, Times::any}});
  Knit knit;
  const Spot opened = p.statement();
  knit.place = opened.place();
  const bool has_form = p.more();
  const bool is_spacer = same_word(p.peek_word(), "spacer");
  if (is_spacer) {
    p.report.error(
        p.here(),
        "a spacer is not built as one; two faces with yarns between them are a chart of K, P, T and U with "
        "'gating opposite D', D their distance: see 'selvage explain gating'",
        Kind::unsupported);
    p.take_bytes(p.peek_rest().size());
    return p.skip_statement();
  }
  if (const std::string instead = instead_of_knit(p.peek_rest()); !instead.empty()) {
    p.error(p.here(), fmt::format("there is no knit {}: {}", in_quotes(p.peek_rest()), instead));
    p.take_bytes(p.peek_rest().size());
    return p.skip_statement();
  }
  // A plain knit of one bed.
  if (same_word(p.peek_word(), "single") || same_word(p.peek_word(), "plain")) p.take_word();
  if (same_word(p.peek_word(), "single-jersey")) p.take_word();
  const bool is_named = p.more();
  const auto form = !has_form  ? std::optional(Knit::Form::chart)
                    : is_named ? p.choice("knit", knit_words)
                               : std::optional(Knit::Form::jersey);
  knit.form = form.value_or(Knit::Form::jersey);
  const auto rib = knit.form == Knit::Form::rib ? p.pair("the rib", 'x') : std::nullopt;
  if (rib) {
    knit.rib_a = (*rib)[0];
    knit.rib_b = (*rib)[1];
  }
  p.finish();
  const int errors = p.report.errors();
  if (p.read_block(word, "", opened, table, knit) && p.report.errors() == errors && form) {
    const bool has_chart = !has_form || form == Knit::Form::jacquard;
    if (!has_chart && !knit.chart.empty())
      p.error(opened, fmt::format("a knit '{}' has its own stitches: leave out either the word or the chart",
                                  word_of(knit_words, *form)));
    if (!has_form && knit.chart.empty())
      p.error(
          p.last(),
          "'knit' ends without its 'chart'; or, behind the word 'knit': jersey, purl, rib, interlock, ...");
    if (has_form && has_chart && knit.chart.empty())
      p.error(p.last(), "a jacquard ends without its 'chart': rows of 1, 2, ..., which of the threads knits");
    if (has_form && !knit.moves.empty())
      p.error(opened,
              "'transfer' and 'drop' go with a chart of K, P, T and M: leave out either the word or these");
    if (has_form && knit.feeds)
      p.error(opened, "'feeds' goes with a chart: leave out either the word or 'feeds'");
    if (form != Knit::Form::jersey && !knit.plating.empty())
      p.error(opened, "'plating' goes with 'knit jersey'");
    if (knit.pile && knit.plating.empty())
      p.error(opened, "a pile takes a thread of its own: add 'plating THREAD'");
    if (knit.unit && (knit.course_pitch > 0 || knit.wale_pitch > 0))
      p.error(opened,
              "the loop's unit says how far courses and wales are apart: leave out 'unit', or the pitches");
    if (knit.shape == Knit::Shape::relaxed && (form != Knit::Form::jersey || !knit.plating.empty()))
      p.error(opened, "'shape relaxed' goes with 'knit jersey' without plating");
    if (knit.shape == Knit::Shape::relaxed &&
        knit.method.value_or(nurbs::Parameterization::uniform) != nurbs::Parameterization::uniform)
      p.error(opened, "relaxed loops take uniform parameters: leave out 'method', or 'shape relaxed'");
    if (!knit.own_loops.empty() && (knit.loop || knit.unit || knit.shape || !knit.plating.empty()))
      p.error(opened,
              "the points of a loop say its size and shape: leave out 'points', or 'loop', 'unit', "
              "'shape' and 'plating'");
    if (has_form && form != Knit::Form::interlock && knit.gating)
      p.error(opened, "'gating' goes with a chart or an interlock");
  }
  fabric.items.emplace_back(std::move(knit));
}

void read_warpknit(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<Warpknit> table({{"thread", read_construction_thread<Warpknit>},
                                      {"bar", read_bar, Times::any},
                                      {"points", read_bar_points, Times::any},
                                      {"weft", read_inserted_weft},
                                      {"wales", read_warpknit_wales, Times::once},
                                      {"courses", read_warpknit_courses, Times::once},
                                      {"stitch", into(&Warpknit::stitch, one_of("stitch", stitch_words))},
                                      {"substrate", into(&Warpknit::substrate, a_length("the substrate"))}});
  Warpknit warpknit;
  const Spot opened = p.statement();
  warpknit.place = opened.place();
  const bool is_classic = p.more();
  if (is_classic) {
    const auto classic = p.choice("warp knit", classic_words);
    if (classic && p.finish()) warpknit.classic = *classic;
  }
  const int errors = p.report.errors();
  const bool closed = p.read_block(word, "", opened, table, warpknit);
  if (closed && p.report.errors() == errors) {
    if (is_classic && !warpknit.bars.empty())
      p.error(opened, fmt::format("a warp knit '{}' has its own bars: leave out either the word or the bars",
                                  warpknit.classic));
    if (is_classic && warpknit.thread.empty()) p.error(p.last(), "'warpknit' ends without its 'thread'");
    if (!is_classic && warpknit.bars.empty()) p.error(p.last(), "'warpknit' ends without a 'bar'");
    if (!is_classic && !warpknit.thread.empty())
      p.error(opened,
              "the threads of this warp knit are those of its bars: 'thread' belongs to those known by name, "
              "such as tricot");
  }
  fabric.items.emplace_back(std::move(warpknit));
}

void read_braid(Parser& p, fabric::Fabric& fabric, std::string_view word) {
  static const Table<BraidBlock> table({{"thread", read_construction_thread<BraidBlock>, Times::once},
                                        {"carriers", read_carriers, Times::once},
                                        {"pattern", read_pattern, Times::once},
                                        {"radius", read_radius, Times::once},
                                        {"flat", read_level, Times::once, "radius"},
                                        {"planar", read_level, Times::once, "radius"},
                                        {"mandrel", read_mandrel, Times::once, "radius"},
                                        {"angle", read_angle, Times::once},
                                        {"length", read_braid_length},
                                        {"axial", read_axial}});
  BraidBlock braid;
  const Spot opened = p.statement();
  braid.place = opened.place();
  p.finish();
  if (p.read_block(word, "", opened, table, braid)) {
    if (!braid.has_mandrel && !braid.has_length) p.error(p.last(), "'braid' ends without its 'length'");
    if (braid.has_mandrel && braid.has_length)
      p.error(opened, "the mandrel has its own length: leave out 'length'");
  }
  if (braid.carriers % 2 != 0 && !braid.flat)
    p.error(braid.carriers_spot,
            braid.planar
                ? "half of the carriers of a planar braid run each way: their number has to be even"
                : "half of the carriers of a tube run each way round: their number has to be even (or "
                  "the braid `flat`)");
  fabric.items.emplace_back(static_cast<Braid&&>(braid));
}

}  // namespace selvage::formats::txt
