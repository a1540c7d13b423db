// What people write instead of what the language has: it is understood, or the message's remedy, applied here
// word for word, makes a text that builds.
#include <gtest/gtest.h>

#include <regex>

#include "construction/build.h"
#include "core/words.h"
#include "formats/txt/reading.h"

namespace selvage::test {

namespace {

const std::string cloth =
    "fabric 1\ntitle \"My cloth\"\nthread cotton\n  Ne 20\n  material cotton\nend\nweave\n  warp cotton 8 "
    "24/cm\n"
    "  weft cotton 8 22/cm\n  draft plain\nend\n";
const std::string knit =
    "fabric 1\nthread cotton\n  Ne 30\n  material cotton\nend\nknit jersey\n  thread cotton\n  courses 4 "
    "18/cm\n"
    "  wales 4 13/cm\nend\n";

const std::string tube_braid =
    "fabric 1\nthread tow\n  tex 800\n  density 1.8\n  section ellipse 3 0.14\nend\nbraid\n  thread tow\n"
    "  carriers 16\n  pattern 2/2\n  radius 12\n  angle 45\n  length 60\nend\n";

const std::string warp_knit =
    "fabric 1\nthread a\n  dtex 44 f13\n  material polyamide\nend\nwarpknit\n  courses 4 20/cm\n"
    "  wales 4 11/cm\n  bar a 1-0/1-2\nend\n";

struct Slip {
  std::string right, wrong;  // of one line, or several
};

std::string with(std::string text, const Slip& slip) {
  const std::size_t at = text.find(slip.right);
  EXPECT_NE(at, std::string::npos) << slip.right;
  return text.replace(at, slip.right.size(), slip.wrong);
}

// Nothing: every yarn is built. Else the first error, of reading or of building.
std::optional<Message> first_error(const std::string& text) {
  const Reading reading = read(text);
  if (!reading.fabric)
    for (const Message& message : reading.diagnostics.messages())
      if (message.severity == Severity::error) return message;
  Diagnostics diagnostics;
  const auto builder = fabric::YarnBuilder::create(*reading.fabric, {}, diagnostics);
  if (const Message* const error = diagnostics.first_error()) return *error;
  for (std::size_t i = 0; i < builder->count(); ++i)
    if (const Result<yarn::Body> body = builder->build(i); !body) return body.error();
  return std::nullopt;
}

// One line of a text, split where the message points.
struct Pointed {
  std::string before, line_front, token, line_back, after;
};
Pointed pointed_at(const std::string& text, const TextPlace& place) {
  std::size_t begin = 0;
  for (int line = 1; line < place.line; ++line) begin = text.find('\n', begin) + 1;
  const std::size_t end = std::min(text.find('\n', begin), text.size());
  const std::size_t at = std::min(begin + static_cast<std::size_t>(place.column) - 1, end);
  const std::size_t stop = std::min(text.find_first_of(" \n", at), end);
  return {text.substr(0, begin), text.substr(begin, at - begin), text.substr(at, stop - at),
          text.substr(stop, end - stop), text.substr(end)};
}

// Each kind of remedy that a message has, done.
std::string remedied(const std::string& text, const Message& message) {
  const Pointed p = pointed_at(text, message.place);
  const auto token = [&](const std::string& now) {
    return p.before + p.line_front + now + p.line_back + p.after;
  };
  const auto rest_of_line = [&](const std::string& now) { return p.before + p.line_front + now + p.after; };
  const std::string& said = message.text;
  std::smatch found;
  if (std::regex_search(said, found, std::regex("did you mean '([^']*)'"))) return token(found[1]);
  if (std::regex_search(said, found, std::regex("\\(write '([^']*)'\\)")))
    return std::regex_replace(text, std::regex("fabric[^\n]*"), found[1].str(),
                              std::regex_constants::format_first_only);
  if (std::regex_search(said, found, std::regex("write '([^']*)'"))) return rest_of_line(found[1]);
  if (std::regex_search(said, found, std::regex("needs brackets: (\\(.*\\))"))) return rest_of_line(found[1]);
  if (std::regex_search(said, found, std::regex("decimal mark is the point, write ([0-9.]+)")))
    return token(found[1]);
  if (std::regex_search(said, found, std::regex("separated by blanks, write ([0-9.]+)")))
    return token(found[1]);
  if (std::regex_search(said, found, std::regex("as in ([0-9]+ [0-9]+ [0-9]+)")))
    return rest_of_line(found[1]);
  if (std::regex_search(said, found, std::regex("as in ([^ ,]+)"))) return rest_of_line(" " + found[1].str());
  if (std::regex_search(said, found, std::regex("is missing: ([^ ,]+),")))
    return rest_of_line(" " + found[1].str());
  if (std::regex_search(said, found, std::regex("known: ([^ ,]+),"))) return token(found[1]);
  if (std::regex_search(said, found, std::regex("statement of a file is '([^']*)'")))
    return found[1].str() + "\n" + text;
  if (said.starts_with("'end' is missing"))
    return p.before + "end\n" + p.line_front + p.token + p.line_back + p.after;
  if (std::regex_search(said, found,
                        std::regex("`([0-9.]+/cm)` for the warp and `([0-9.]+/cm)` for the weft"))) {
    const std::string now =
        std::regex_replace(text, std::regex("warp cotton 8 .*"), "warp cotton 8 " + found[1].str());
    return std::regex_replace(now, std::regex("weft cotton 8 .*"), "weft cotton 8 " + found[2].str());
  }
  if (std::regex_search(said, found, std::regex("at most has \\((Ne [0-9.]+)")))
    return std::regex_replace(text, std::regex("Ne [0-9.]+"), found[1].str());
  if (std::regex_search(said, found, std::regex("'(crimp 0)' keeps the warp straight")))
    return std::regex_replace(text, std::regex("draft plain\n"), "draft plain\n  " + found[1].str() + "\n");
  return text;
}

void expect_cured(const std::string& text) {
  const std::optional<Message> error = first_error(text);
  ASSERT_TRUE(error) << "no message of:\n" << text;
  const std::string now = remedied(text, *error);
  const std::optional<Message> left = first_error(now);
  EXPECT_FALSE(left) << to_string(*error) << "\nleaves\n" << now << (left ? to_string(*left) : std::string());
}

}  // namespace

// A remedy is in the words of the text: the count of a yarn that is too thick for its loops, the crimp of a
// cord whose twist has no room where it bends.
TEST(Slips, RemediesOfKnitsAndCords) {
  expect_cured(
      "fabric 1\nthread y\n  Ne 30\n  material cotton\nend\nknit rib 1x1\n  thread y\n  courses 6 38/in\n"
      "  wales 6 60/in\n  loop 2.9\nend\n");
  expect_cured(
      "fabric 1\nthread cord\n  dtex 2800\n  material nylon\n  twist 380 Z\n  plies 2 370 S\nend\n"
      "thread pick\n  Ne 20\n  material cotton\nend\nweave\n  warp cord 8 100/dm\n"
      "  weft pick 4 10/dm open\n  draft plain\n  profile peirce\nend\n");
}

TEST(Slips, AreUnderstood) {
  const std::string warp = "warp cotton 8 24/cm", count = "Ne 20", title = "\"My cloth\"",
                    draft = "draft plain";
  const std::vector<Slip> slips = {{warp, "warp cotton 8 24 per cm"},
                                   {warp, "warp cotton 8 24 /cm"},
                                   {warp, "warp cotton 8 24/ cm"},
                                   {warp, "warp cotton 8 24 ends/cm"},
                                   {warp, "warp cotton 8 240 threads per 10 cm"},
                                   {warp, "warp cotton 8 60 epi"},
                                   {warp, "warp cotton 8 60epi"},
                                   {warp, "warp cotton 8 60 ends per inch"},
                                   {warp, "warp cotton 8 0.42 mm"},
                                   {warp, "warp cotton 8 24/cm // ends"},
                                   {warp, "// of the loom\n  " + warp},
                                   {warp,
                                    "warp\xC2\xA0"
                                    "cotton 8\xE2\x80\xAF"
                                    "24/cm"},
                                   {"weft cotton 8 22/cm", "fill cotton 8 55 ppi"},
                                   {title, "\xE2\x80\x9CMy cloth\xE2\x80\x9D"},
                                   {count, "Ne 20\n  colour steelblue"},
                                   {count, "Ne 20\n  color #48b"},
                                   {count, "Ne 20\n  color rebeccapurple"},
                                   {count, "Ne 20\n  twist Z 800"},
                                   {count, "Ne 20\n  twist 800 t/m Z"},
                                   {count, "Ne 20\n  twist 800 tpm Z"},
                                   {count, "Ne 40/2"},
                                   {count, "40/2 Ne"},
                                   {count, "diameter 0.2 mm"},
                                   {"  material cotton", "  material Cotton"},
                                   {"  material cotton", "  material E-glass"},
                                   {"  material cotton", "  material PA66"},
                                   {"  material cotton", "  material kevlar"},
                                   {draft, "draft oxford"},
                                   {draft, "draft basket 2x1"},
                                   {draft, "draft taffeta"},
                                   {draft, "draft drill"},
                                   {draft, "draft 1/1"},
                                   {draft, "draft twill 2x2"},
                                   {draft, "draft satin 6"},
                                   {draft, "draft matt 2/2"},
                                   {draft, "draft oxford 2x1"},
                                   {draft, "draft 3/1 drill"},
                                   {draft, "draft denim 2/1"},
                                   {draft, "draft sateen 5"},
                                   {draft, "draft chambray"},
                                   {warp, "warp cotton 8 60/\""},
                                   {count, "count 20 Ne"},
                                   {count, "Ne 20\n  twist Z800"},
                                   {count, "Ne 20\n  twist 800Z"},
                                   {count, "Ne 20\n  packing 65%"},
                                   {count, "Ne 20\n  color dark blue"},
                                   {count, "Ne 20\n  color Dark-Blue"},
                                   {"  material cotton", "  material E glass"},
                                   {"  material cotton", "  material PA 6.6"},
                                   {"  material cotton", "  material nylon 6"},
                                   {warp, "warp cotton 8 24 open"},
                                   {warp, "warp cotton 8 24 thr/cm"},
                                   {warp, "warp cotton 8 24 Fd/cm"},
                                   {warp, "warp cotton 8 24 cm-1"},
                                   {warp, "warp cotton 8 24cm^-1"},
                                   {draft, "draft oxford weave"},
                                   {draft, "draft 8 harness satin"},
                                   {draft, "draft 5 shaft"},
                                   {draft, "draft twill 3/1 left"},
                                   {draft, "draft right-hand twill 2/1"},
                                   {draft, "draft 3/1 S"},
                                   {"  material cotton", "  material 100% cotton"},
                                   {"title", "units millimeters\ntitle"},
                                   {"title", "units inches\ntitle"}};
  for (const Slip& slip : slips) {
    const std::optional<Message> error = first_error(with(cloth, slip));
    EXPECT_FALSE(error) << slip.wrong << "\n" << (error ? to_string(*error) : std::string());
  }
  for (const Slip& slip : std::vector<Slip>{{"knit jersey", "knit single jersey"},
                                            {"knit jersey", "knit single-jersey"},
                                            {"wales 4 13/cm", "wales 4 33 wpi"},
                                            {"courses 4 18/cm", "courses 4 46 cpi"},
                                            {"wales 4 13/cm", "wales 4 13 wpc"},
                                            {"wales 4 13/cm", "wales 4 13/cm\n  loop length 2.8 mm"},
                                            {"wales 4 13/cm", "wales 4 13/cm\n  stitch length 2.8"}}) {
    const std::optional<Message> error = first_error(with(knit, slip));
    EXPECT_FALSE(error) << slip.wrong << "\n" << (error ? to_string(*error) : std::string());
  }
}

TEST(Slips, AreCuredByTheRemediesOfTheirMessages) {
  const std::string warp = "warp cotton 8 24/cm", weft = "weft cotton 8 22/cm", count = "Ne 20",
                    draft = "draft plain";
  const std::vector<Slip> slips = {{warp, "warp cotton 24/cm"},
                                   {warp, "warp cotton 60 epi"},
                                   {warp, "warp cotton 0.42 mm"},
                                   {warp, "warp cotton 24/cm 8"},
                                   {weft, "weft cotton 22 per cm"},
                                   {warp, "warp cotton 8 24"},
                                   {warp, "warp cotton 8 24cm"},
                                   {weft, "weft cotton 8 pitch 22"},
                                   {warp, "warp cotton 8 0,42"},
                                   {warp, "wrap cotton 8 24/cm"},
                                   {warp, "warp coton 8 24/cm"},
                                   {warp, "warp cotton 8 130/cm"},
                                   {warp, "warp cotton 8 150/cm"},
                                   {count, "Ne 20\n  color #ff00zz"},
                                   {count, "Ne 20\n  color #12345"},
                                   {count, "Ne 20\n  color bleu"},
                                   {count, "Ne 20\n  colr blue"},
                                   {count, "Ne 20,5"},
                                   {count, "dtex 140*2"},
                                   {count, "dtex 100+67"},
                                   {count, "78f24"},
                                   {count, "Ne 20\n  twist 800"},
                                   {count, "Ne 20\n  twist 800 right"},
                                   {count, "Ne 20\n  packng 0.6"},
                                   {count, "diametre 0.2"},
                                   {"material cotton", "material coton"},
                                   {"material cotton", "material polyster"},
                                   {draft, "draft plian"},
                                   {draft, "draft oxfrod"},
                                   {draft, "draft satin"},
                                   {draft, "draft basket"},
                                   {warp, "warp 8 cotton 24/cm"},
                                   {warp, "ends cotton 8 24/cm"},
                                   {weft, "picks cotton 8 22/cm"},
                                   {weft, "filling cotton 8 22/cm"},
                                   {weft, "woof cotton 8 22/cm"},
                                   {"weave\n", "woven\n"},
                                   {count, "Ne=20"},
                                   {count, "Ne: 20"},
                                   {count, "Ne:20"},
                                   {count, "Ne 20\n  packing 65"},
                                   {count, "Ne 20\n  color rgb(70,130,180)"},
                                   {"material cotton", "material: cotton"},
                                   {"material cotton", "fibre cotton"},
                                   {"fabric 1\n", "fabric\n"},
                                   {"fabric 1\n", "fabric 1.0\n"},
                                   {"thread cotton", "thread cotton:"},
                                   {draft, "draft twil 2/1"},
                                   {draft, "draft twill"},
                                   {draft, "draft twill 2:1"},
                                   {draft, "drat plain"},
                                   {draft, "draft plain\n  profile pierce"},
                                   {draft, "draft plain\n  spacing relax"},
                                   {"fabric 1\n", ""},
                                   {"end\nweave", "weave"},
                                   {"weave\n", "weve\n"},
                                   {"title", "titel"},
                                   {"title", "units milimeter\ntitle"},
                                   {"thread cotton", "thred cotton"},
                                   {warp, "warp cotton 8 x 24/cm"},
                                   {warp, "warp cotton 8 @ 24/cm"},
                                   {warp, "warp cotton 8, 24/cm"},
                                   {warp, "warp 8 24/cm"},
                                   {draft, "weave plain"},
                                   {draft, "plain"},
                                   {draft, "twill 2/1"},
                                   {draft, "draft leinwand"},
                                   {draft, "draft broken twill"},
                                   {draft, "draft repp"},
                                   {draft, "draft twill 2-1"},
                                   {draft, "draft basket 2*2"},
                                   {"end\nweave", "}\nweave"},
                                   {"end\nweave", "endthread\nweave"},
                                   {"end\nweave", "end-thread\nweave"},
                                   {count, "EC9 68"},
                                   {count, "G150 1/0"},
                                   {count, "Ne 20\n  1 filaments"}};
  for (const Slip& slip : slips) expect_cured(with(cloth, slip));
  for (const Slip& slip : std::vector<Slip>{{"knit jersey", "knit jersy"},
                                            {"wales 4 13/cm", "wales 13/cm"},
                                            {"courses 4 18/cm", "courses 18/cm 4"},
                                            {"courses 4 18/cm", "cpc 18"},
                                            {"wales 4 13/cm", "wpi 33"},
                                            {"knit jersey", "knit stockinette"},
                                            {"knit jersey", "knit 1x1 rib"},
                                            {"knit jersey", "knit cardigan"},
                                            {"courses", "cources"}})
    expect_cured(with(knit, slip));
  for (const Slip& slip : std::vector<Slip>{{"warpknit", "warp knit"},
                                            {"bar a", "GB1 a"},
                                            {"bar a", "gb a"},
                                            {"bar a", "bar 1 a"},
                                            {"bar a", "lapping a"},
                                            {"bar a", "bar"}})
    expect_cured(with(warp_knit, slip));
  expect_cured(with(knit, {"knit jersey", "jersey"}));
  expect_cured(with(tube_braid, {"pattern 2/2", "draft 2/2"}));
  expect_cured(with(cloth, {count, "count 20"}));
  for (const Slip& slip : std::vector<Slip>{{"carriers 16", "16 carriers"},
                                            {"radius 12", "diameter 24"},
                                            {"radius 12", "diameter 24 mm"},
                                            {"pattern 2/2", "pattern 2x2"},
                                            {"angle 45", "angle +-45"},
                                            {"angle 45", "angle 45\xC2\xB0"},
                                            {"angle 45",
                                             "\xC2\xB1"
                                             "45"},
                                            {"angle 45", "braid angle 45"}})
    expect_cured(with(tube_braid, slip));
}

TEST(Slips, PatternsOfBraidsHaveNames) {
  for (const auto& [name, numbers] :
       {std::pair("diamond", "1/1"), std::pair("regular", "2/2"), std::pair("hercules", "3/3")}) {
    const Reading named = read(with(tube_braid, {"2/2", name})),
                  plain = read(with(tube_braid, {"2/2", numbers}));
    ASSERT_TRUE(named.fabric && plain.fabric) << named.text();
    const auto& a = std::get<fabric::Braid>(named.fabric->items.at(0));
    const auto& b = std::get<fabric::Braid>(plain.fabric->items.at(0));
    EXPECT_TRUE(a.over == b.over && a.under == b.under) << name;
  }
}

// A spacer is named as what it is, and its block is one error.
TEST(Slips, SpacerIsOffered) {
  const std::string text =
      read("fabric 1\nthread a\n  dtex 100\n  material PES\nend\nknit spacer\n  front a\n  spacer a\nend\n")
          .text();
  EXPECT_NE(text.find("'gating opposite D'"), std::string::npos) << text;
  EXPECT_EQ(text.find("error: ", text.find("error: ") + 1), std::string::npos) << text;
}

}  // namespace selvage::test
