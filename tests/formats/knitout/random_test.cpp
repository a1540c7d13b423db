// Random programs: a fabric or an error, never a crash; and a fabric has the loops that the program makes.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "construction/build.h"
#include "knit/knit.h"
#include "reading.h"

namespace selvage {
namespace {

using test::read;
using test::Reading;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  int up_to(int most) { return static_cast<int>(engine_() % static_cast<unsigned>(most + 1)); }
  std::string needle() { return std::string(up_to(3) == 0 ? "b" : "f") + std::to_string(1 + up_to(4)); }

  // Mostly rows of one carrier, so that many programs are charts.
  std::string program(int& loops) {
    std::string text = ";!knitout-2\n;;Carriers: 1 2\nin 1\nin 2\n";
    loops = 0;
    int racking = 0;
    for (int step = 4 + up_to(8); step > 0; --step) {
      const std::string carrier = up_to(3) == 0 ? "2" : "1";
      const bool is_right = up_to(1) == 0;
      switch (up_to(5)) {
        case 0: {  // to another needle and back, or a decrease
          const int from = 1 + up_to(4), by = up_to(2) - 1;
          text += "rack 0\nxfer f" + std::to_string(from) + " b" + std::to_string(from) + "\nrack " +
                  std::to_string(by) + "\nxfer b" + std::to_string(from) + " f" + std::to_string(from + by) +
                  "\nrack " + std::to_string(racking) + "\n";
          break;
        }
        case 1:
          racking = up_to(4) == 0 ? up_to(2) - 1 : 0;
          text += "rack " + std::to_string(racking) + "\n";
          break;
        case 2:
          text += up_to(2) == 0 ? "drop " + needle() + "\n" : "";
          break;
        default:
          for (int i = 1; i <= 5; ++i) {
            const int number = is_right ? i : 6 - i;
            if (up_to(5) == 0) continue;
            const bool is_tuck = up_to(5) == 0;
            text += std::string(is_tuck ? "tuck " : "knit ") + (is_right ? "+ " : "- ") +
                    (up_to(7) == 0 ? "b" : "f") + std::to_string(number) + " " + carrier + "\n";
            ++loops;
          }
      }
    }
    return text + "out 1\nout 2\n";
  }

 private:
  std::mt19937 engine_;
};

TEST(KnitoutRandom, ProgramsAreLaidOrRefused) {
  int laid = 0, cut = 0;
  constexpr int programs = 3000;
  for (unsigned seed = 0; seed < programs; ++seed) {
    int loops = 0;
    const std::string text = Random(seed).program(loops);
    const Reading reading = read(text);
    ASSERT_NE(reading.fabric.has_value(), reading.diagnostics.has_errors()) << text;
    if (!reading.fabric) continue;
    ++laid;
    const auto& knit = std::get<fabric::Knit>(reading.fabric->items.front());
    int made = 0;
    for (const std::string& row : knit.chart)
      made += static_cast<int>(
          std::count_if(row.begin(), row.end(), [](char c) { return c != 'M' && c != '.'; }));
    // Of a program whose end is not supported, what the warning says.
    const std::string said = reading.text();
    const std::size_t ends = said.find(" loops are built");
    if (ends != std::string::npos) {
      const std::size_t begins = said.rfind(": ", ends) + 2;
      ASSERT_EQ(said.substr(begins, ends - begins), std::to_string(made) + " of " + std::to_string(loops))
          << text;
      ++cut;
    } else {
      ASSERT_EQ(made, loops) << text;
    }
    Diagnostics diagnostics;
    fabric::BuildOptions options;
    options.as_published = true;
    const auto construction = fabric::make_knit(*reading.fabric, knit, options, diagnostics);
    ASSERT_TRUE(construction.ok()) << construction.error().text << "\n" << text;
    for (std::size_t i = 0; i < (*construction)->count(); ++i) ASSERT_TRUE((*construction)->plan(i).ok());
  }
  EXPECT_GT(laid, programs / 10);
  EXPECT_GT(cut, programs / 10);
}

// Cut off anywhere, and with any byte made another one.
TEST(KnitoutRandom, DamagedProgramsAreReadOrRefused) {
  int loops = 0;
  const std::string good = Random(7).program(loops);
  for (std::size_t length = 0; length < good.size(); ++length) {
    std::vector<std::string> texts = {good.substr(0, length)};
    for (const char c : {'9', ' ', '\n', '\xFF', 'f', '-', ';'}) {
      texts.push_back(good);
      texts.back()[length] = c;
    }
    for (const std::string& text : texts) {
      const Reading reading = read(text);
      ASSERT_NE(reading.fabric.has_value(), reading.diagnostics.has_errors()) << text;
    }
  }
}

}  // namespace
}  // namespace selvage
