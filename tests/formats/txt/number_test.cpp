// Numbers with units, params and expressions: what they come to, computed here; and the words of the trade.
#include <gtest/gtest.h>

#include <cmath>

#include "fabric/fibres.h"
#include "fabric/yarn_spec.h"
#include "formats/txt/reading.h"
#include "weave/draft.h"

namespace selvage::test {

namespace {

using namespace fabric;

// A weave whose warp's pitch is the text.
std::string pitch(const std::string& text, const std::string& head = "") {
  return "fabric 1\n" + head + "thread t\ndiameter 20\nend\nweave\nwarp t 2 " + text +
         "\nweft t 2 pitch 1\ndraft plain\nend\n";
}

double pitch_of(const std::string& text) {
  const Reading reading = read(text);
  EXPECT_TRUE(reading.fabric) << text << reading.text();
  return reading.fabric ? reading.weave().warp.pitch : 0.0;
}

const Thread& only_thread(const Reading& reading) {
  EXPECT_TRUE(reading.fabric) << reading.text();
  return reading.fabric->threads.at(0);
}

std::string messages(const std::string& text) {
  return read(text).text();
}

}  // namespace

TEST(Numbers, CarryUnitsOfLength) {
  EXPECT_EQ(pitch_of(pitch("pitch 0.35mm")), 0.35);
  EXPECT_EQ(pitch_of(pitch("0.35MM")), 0.35);
  EXPECT_EQ(pitch_of(pitch("pitch 1.2cm")), 12.0);
  EXPECT_EQ(pitch_of(pitch("pitch 350um")), 0.35);
  EXPECT_EQ(pitch_of(pitch("pitch 0.5in")), 12.7);
  EXPECT_EQ(pitch_of(pitch("pitch 35e-2mm")), 0.35);
  EXPECT_EQ(pitch_of(pitch("pitch 2mm", "units m\n")), 0.002);
  EXPECT_EQ(pitch_of(pitch("pitch 5.08cm", "units inch\n")), 2.0);
}

TEST(Numbers, CountOnALength) {
  EXPECT_EQ(pitch_of(pitch("26/cm")), 10.0 / 26.0);
  EXPECT_EQ(pitch_of(pitch("44/in")), 25.4 / 44.0);
  EXPECT_EQ(pitch_of(pitch("450/m")), 1000.0 / 450.0);
  EXPECT_EQ(pitch_of(pitch("173/10cm")), 100.0 / 173.0);
  EXPECT_EQ(pitch_of(pitch("20/cm", "units cm\n")), 0.05);
}

TEST(Numbers, AreExpressions) {
  EXPECT_EQ(pitch_of(pitch("pitch w/4+1.5", "param w 96cm\n")), 960.0 / 4 + 1.5);
  EXPECT_EQ(pitch_of(pitch("(epc + 2)/cm", "param epc 24\n")), 10.0 / 26.0);
  EXPECT_EQ(pitch_of(pitch("epc/cm", "param epc 24\n")), 10.0 / 24.0);
  EXPECT_EQ(pitch_of(pitch("pitch 2*sett", "param sett 20/cm\n")), 1.0);
  EXPECT_NEAR(pitch_of(pitch("sqrt(2)*2mm+1cm")), std::sqrt(2.0) * 2 + 10, 1e-14);
  EXPECT_NEAR(pitch_of(pitch("b^2*sin(pi/6)", "param a 3\nparam b a-1\n")), 2.0, 1e-15);
  // A param of the name of an inner word.
  EXPECT_EQ(pitch_of(pitch("pitch pitch", "param pitch 0.9\n")), 0.9);
  // Counts and rows, a row that begins with a param too.
  const Reading reading = read(
      "fabric 1\nparam n 3\nparam r 0.5\nyarn y\n diameter 0.1\n path\n 0 0 0\n r*2 0 0\n"
      " r/cos(0)+1 1mm 0 2*r .2 0.5rad\n end\nend\nthread t\nfilaments n*2+1\nend\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  const Path& path = std::get<Path>(std::get<Yarn>(reading.fabric->items[0]).shape);
  EXPECT_EQ(path.points[1], Vec3(1, 0, 0));
  EXPECT_EQ(path.points[2], Vec3(1.5, 1, 0));
  EXPECT_EQ(path.sizes[2]->width, 1.0);
  EXPECT_NEAR(*path.sizes[2]->angle, 0.5 * 180 / std::acos(-1.0), 1e-13);
  EXPECT_EQ(reading.fabric->threads[0].filaments, 7);
}

TEST(Numbers, CarryOtherUnits) {
  const Reading reading = read(
      "fabric 1\nthread t\ntwist 20/in Z\nplies 2 450/m S\ndensity 1520kg/m3\nend\n"
      "material m\nelastic isotropic 72.4GPa 0.22\nexpansion 5e-6/K 5e-6\nend\n");
  const Thread& thread = only_thread(reading);
  EXPECT_NEAR(thread.twist->turns, 20 / 0.0254, 1e-10);
  EXPECT_NEAR(thread.plies->turns, 450, 1e-12);
  EXPECT_NEAR(*thread.density, 1.52, 1e-15);
  EXPECT_EQ(std::get<IsotropicElastic>(reading.fabric->materials[0].elastic).modulus, 72400.0);
  EXPECT_EQ(reading.fabric->materials[0].expansion->along, 5e-6);
}

TEST(Numbers, TellWhatIsWrong) {
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(messages(text).find(part), std::string::npos) << text << messages(text);
  };
  expect(pitch("pitch 3deg"), "the unit 'deg' does not belong here");
  expect(pitch("pitch 3furlong"), "'furlong' is no unit; known here: mm, cm");
  expect(pitch("pitch 1/0"), "divides by zero");
  expect(pitch("0/cm"), "have to be more than 0");
  expect(pitch("pitch ches/4", "param chest 96\n"), "there is no param 'ches'; did you mean 'chest'?");
  expect(pitch("pitch 2*(3"), "a bracket is not closed");
  expect(pitch("pitch 2*cm"), "a unit stands right behind its number, as in 3cm");
  expect("fabric 1\nthread t\nend\nweave\nwarp t 60/inch\nend\n",
         "the number of ends is missing in front of the pitch: write '8 60/inch' for 8 ends");
  expect(pitch("pitch 2+*3"), "does not belong there");
  expect(pitch("pitch 1,5"), "a decimal comma in '1,5'");
  expect(pitch("1", "param a b\nparam b a\n"), "'b' is not a number");
  expect(pitch("1", "param c 1\nparam a b+c\nparam b a\n"), "there is no param 'b'");
  expect(pitch("1", "param a a+1\n"), "there is no param 'a'");
  expect(pitch("1", "param mm 3\n"), "'mm' is a word of the language or a unit");
  expect(pitch("1", "param warp 3\n"), "'warp' is a word of the language or a unit");
  expect(pitch("1", "param a-b 3\n"), "cannot stand in an expression");
  expect(pitch("1", "param a 1\nparam a 2\n"), "the param 'a' is there twice; first on line 2");
  expect(pitch("1", "param a 1mm\nunits cm\n"), "move this line above them");
  expect("fabric 1\nparam t 800/m\nthread y\ntwist t Z\nend\n", "'t' is a distance");
  expect("fabric 1\nthread y\ntex 20\ndtex 200\nend\n",
         "'dtex' is given twice in thread 'y'; first on line 3 (of tex, dtex");
  expect("fabric 1\nthread y\nfilaments 2.5*3\nend\n", "is not a whole number");
}

// Every word that begins a statement is refused as the name of a param.
TEST(Numbers, KeywordsAreReserved) {
  const std::vector<std::string> openings = {"",
                                             "thread t\n",
                                             "material m\n",
                                             "yarn y\n",
                                             "weave\n",
                                             "knit jersey\n",
                                             "warpknit\n",
                                             "braid\n",
                                             "piece p\n",
                                             "cell 0 0 0 1 1 1\n",
                                             "yarn y\ngrid 2 3\n",
                                             "block b\n",
                                             "block b\nyarn y\nend\nend\nuse b\n"};
  int words = 0;
  for (const std::string& opening : openings) {
    const std::string text = messages("fabric 1\n" + opening + "qqqqqqqqqqqq 1\n");
    const std::size_t begin = text.find("; known: ");
    ASSERT_NE(begin, std::string::npos) << opening << text;
    std::string list = text.substr(begin + 9, text.find('\n', begin) - begin - 9) + ",";
    for (std::size_t comma = 0; (comma = list.find(',')) != std::string::npos; list.erase(0, comma + 1)) {
      const std::string word = list.substr(list.find_first_not_of(' '), comma - list.find_first_not_of(' '));
      const std::string said = messages(pitch("1", "param " + word + " 1\n"));
      EXPECT_NE(said.find("is a word of the language"), std::string::npos) << word << said;
      ++words;
    }
  }
  EXPECT_GT(words, 80);
}

TEST(Trade, LinearDensities) {
  const auto tex = [](const std::string& line) {
    return only_thread(read("fabric 1\nthread t\n" + line + "\nend\n")).linear_density->tex();
  };
  EXPECT_DOUBLE_EQ(tex("dtex 167"), 16.7);
  EXPECT_DOUBLE_EQ(tex("Nm 40"), 25.0);
  EXPECT_DOUBLE_EQ(tex("Td 150"), 150.0 / 9);
  EXPECT_NEAR(tex("Ne 30"), 590.541 / 30, 1e-4);
}

TEST(Trade, MaterialsSizeAYarn) {
  // Ne 20 cotton: 29.53 tex at 1.1 cm3/g, Peirce's 1/(28 sqrt(Ne)) inch.
  const Reading cotton = read("fabric 1\nthread t\nNe 20\nmaterial cotton\nend\n");
  const Result<yarn::Section> section = section_of(only_thread(cotton), Unit::mm, false);
  ASSERT_TRUE(section.ok());
  EXPECT_NEAR(yarn::nominal_size(*section).width, 25.4 / (28 * std::sqrt(20.0)), 0.01 * 0.2);
  // A monofilament is all fibre: 100 dtex polyester are 10 mg a metre.
  const Reading mono = read("fabric 1\nthread t\ndtex 100\nmaterial polyester\nfilaments 1\nend\n");
  const Result<yarn::Section> wire = section_of(only_thread(mono), Unit::mm, false);
  ASSERT_TRUE(wire.ok());
  const double d = yarn::nominal_size(*wire).width;
  EXPECT_NEAR(d * d * std::acos(-1.0) / 4 * 1.39, 0.01, 1e-12);  // mm2 g/cm3 = g/m
  // The file's own block wins.
  const Reading own = read(
      "fabric 1\nthread t\ntex 10\nmaterial cotton\nend\nmaterial cotton\ndensity 1\npacking "
      "0.5\nend\n");
  EXPECT_EQ(only_thread(own).fibre_density(), 1.0);
  EXPECT_EQ(only_thread(own).size_packing(), 0.5);
  EXPECT_NE(messages("fabric 1\nthread t\nmaterial coton\nend\n").find("did you mean 'cotton'?"),
            std::string::npos);
}

// Stable materials only: what a block of the text would be refused for.
TEST(Trade, FibresAreStable) {
  for (const Fibre& fibre : all_fibres()) {
    const Material& m = fibre.material;
    ASSERT_TRUE(m.density && m.packing);
    EXPECT_FALSE(fibre.source.empty());
    if (const auto* e = std::get_if<TransverseElastic>(&m.elastic)) {
      EXPECT_LT(e->nu12 * e->nu12, e->e1 / e->e2) << m.name;
      EXPECT_GT(1 - e->nu23 - 2 * e->nu12 * e->nu12 * e->e2 / e->e1, 0) << m.name;
    }
  }
}

TEST(Trade, Colors) {
  const auto color = [](const std::string& words) {
    return *only_thread(read("fabric 1\nthread t\ncolor " + words + "\nend\n")).color;
  };
  EXPECT_EQ(color("navy"), (Color{0, 0, 128}));
  EXPECT_EQ(color("#ff8801"), (Color{255, 136, 1}));
  EXPECT_EQ(color("#FF8801 # a comment"), (Color{255, 136, 1}));
  EXPECT_EQ(color("1 2 3 #ff8801"), (Color{1, 2, 3}));
  EXPECT_NE(messages("fabric 1\nthread t\ncolor indgo\nend\n").find("did you mean 'indigo'?"),
            std::string::npos);
}

TEST(Trade, ListsOfThreads) {
  const Reading reading = read(
      "fabric 1\nthread a\nend\nthread b\nend\nweave\nwarp 4a,2b 12 26/cm\nweft 2\"a\",b 6 pitch 1\ndraft "
      "plain\nend\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.weave().warp.threads, (std::vector<std::string>{"a", "a", "a", "a", "b", "b"}));
  EXPECT_EQ(reading.weave().weft.threads, (std::vector<std::string>{"a", "a", "b"}));
  EXPECT_NE(messages("fabric 1\nthread a\nend\nweave\nwarp 99999999999a 1 1\n").find("from 1 to 1000000"),
            std::string::npos);
}

TEST(Trade, Drafts) {
  const auto rows = [](const std::string& words) {
    const Reading reading =
        read("fabric 1\nthread a\nend\nweave\nwarp a 2 1\nweft a 2 1\ndraft " + words + "\nend\n");
    EXPECT_TRUE(reading.fabric) << reading.text();
    std::vector<std::string> all;
    if (!reading.fabric) return all;
    const Result<Drawdown> made = drawdown_of(reading.weave().draft);
    EXPECT_TRUE(made.ok());
    for (int pick = 0; made.ok() && pick < made->picks; ++pick) {
      std::string& row = all.emplace_back();
      for (int end = 0; end < made->ends; ++end) row += made->warp_on_top(pick, end) ? '1' : '0';
    }
    return all;
  };
  using Rows = std::vector<std::string>;
  EXPECT_EQ(rows("twill 2/1 S"), (Rows{"110", "011", "101"}));
  EXPECT_EQ(rows("twill 3/1/1/1 S"), (Rows{"111010", "011101", "101110", "010111", "101011", "110101"}));
  EXPECT_EQ(rows("twill 3/1/1/1"), (Rows{"111010", "110101", "101011", "010111", "101110", "011101"}));
  EXPECT_EQ(rows("satin 5"), rows("satin 5/2"));
  EXPECT_EQ(rows("satin 8"), rows("satin 8/3"));
  EXPECT_EQ(rows("satin 5/2 warp-faced"), (Rows{"01111", "11101", "10111", "11110", "11011"}));
  EXPECT_EQ(rows("satin 4"), (Rows{"1000", "0100", "0001", "0010"}));
  // Of every satin each row and column has one warp on top, and no two touch, round the edges too.
  for (const int n : {4, 5, 6, 7, 8, 10, 12}) {
    const Rows satin = rows("satin " + std::to_string(n));
    ASSERT_EQ(static_cast<int>(satin.size()), n);
    std::vector<int> ends;
    for (const std::string& row : satin) ends.push_back(static_cast<int>(row.find('1')));
    for (int i = 0; i < n; ++i) {
      const int step =
          std::abs(ends[static_cast<std::size_t>(i)] - ends[static_cast<std::size_t>((i + 1) % n)]);
      if (n != 4) {  // crowfoot: two pairs touch
        EXPECT_GT(std::min(step, n - step), 1) << n;
      }
      EXPECT_EQ(std::count(ends.begin(), ends.end(), i), 1) << n;
    }
  }
  const auto wrong = [](const std::string& words) {
    return messages("fabric 1\nthread a\nend\nweave\nwarp a 2 1\nweft a 2 1\ndraft " + words + "\nend\n");
  };
  EXPECT_NE(wrong("twill 3/1/1").find("an even number of counts"), std::string::npos);
  EXPECT_NE(wrong("satin 3").find("the smallest is 4"), std::string::npos);
  EXPECT_NE(wrong("satin 6/2").find("a satin 6/2 does not exist"), std::string::npos);
  EXPECT_NE(wrong("twill 2/1 X").find("unknown direction of the twill 'X'"), std::string::npos);
}

}  // namespace selvage::test
