// check_structure: sound files stay silent, and each planted fault is found, on its line.
#include "formats/iges/structure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "places.h"

namespace selvage::test {
namespace {

std::string fixture(const std::string& name) {
  std::ifstream file(places::tests() + "/fixtures/iges/" + name, std::ios::binary);
  EXPECT_TRUE(file.good()) << name;
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

Findings findings_in(const std::string& bytes) {
  Findings findings;
  formats::iges::check_structure(Source::from_memory(bytes, "f.igs"), findings);
  return findings;
}

std::string all_of(const Findings& findings) {
  std::string text;
  for (Message message : findings.messages()) {
    message.file = "f.igs";
    text += to_string(message) + "\n";
  }
  return text;
}

// The bytes with `text` written over line `line`, from `column` on; both count from 1.
std::string over(std::string bytes, int line, int column, const std::string& text) {
  std::size_t at = 0;
  for (int i = 1; i < line; ++i) at = bytes.find('\n', at) + 1;
  EXPECT_NE(bytes.substr(at + static_cast<std::size_t>(column) - 1, text.size()), text);
  return bytes.replace(at + static_cast<std::size_t>(column) - 1, text.size(), text);
}

TEST(Structure, OwnFilesAreSound) {
  for (const yarn::EndStyle ends : {yarn::EndStyle::patch, yarn::EndStyle::fan, yarn::EndStyle::planar})
    for (const bool solid : {false, true}) {
      formats::SurfaceOptions options = solid ? solids() : surfaces();
      options.file_name = "weave.igs";
      const Findings findings = findings_in(iges_bytes(plain_weave(ends), options));
      EXPECT_EQ(findings.messages().size(), 0U) << all_of(findings);
    }
  formats::SurfaceOptions options = surfaces(Unit::inch);
  options.file_name = "ring.igs";
  const Findings ring_findings = findings_in(iges_bytes({ring("ring")}, options));
  EXPECT_EQ(ring_findings.messages().size(), 0U) << all_of(ring_findings);
}

TEST(Structure, FixturesAreSound) {
  for (const char* name : {"curves.igs", "surfaces.igs", "trimmed.igs", "solids.igs", "subfigures.igs",
                           "unit_m.igs", "unit_mil.igs"}) {
    const Findings findings = findings_in(fixture(name));
    EXPECT_EQ(findings.messages().size(), 0U) << name << "\n" << all_of(findings);
  }
  // It leaves out what has no default; nothing of it is wrong.
  const Findings findings = findings_in(fixture("groups.igs"));
  EXPECT_EQ(findings.defects(), 0) << all_of(findings);
  EXPECT_GT(findings.warnings(), 3);
}

struct Fault {
  const char* file;
  int line, column;
  const char* text;
  int found_on;
  const char* says;
  Severity severity = Severity::error;
};

class Faults : public testing::TestWithParam<Fault> {};

TEST_P(Faults, IsFound) {
  const Fault& fault = GetParam();
  const Findings findings = findings_in(over(fixture(fault.file), fault.line, fault.column, fault.text));
  const std::vector<Message> messages = findings.messages();
  EXPECT_TRUE(std::any_of(messages.begin(), messages.end(), [&](const Message& message) {
    return message.place.line == fault.found_on && message.severity == fault.severity &&
           message.text.find(fault.says) != std::string::npos;
  })) << all_of(findings);
}

constexpr const char* small_file = "unit_m.igs";
constexpr const char* loops = "trimmed.igs";
INSTANTIATE_TEST_SUITE_P(
    Lines, Faults,
    testing::Values(
        Fault{small_file, 6, 30, "\t", 6, "0x09"},
        Fault{small_file, 1, 3, "\xE9", 1, "0xE9", Severity::warning},
        Fault{small_file, 9, 73, "X", 9, "no section letter"},
        Fault{small_file, 9, 73, "G", 9, "a line of the global section after the directory section"},
        Fault{small_file, 7, 80, "7", 7, "sequence number D7 follows D2: lines are missing"},
        Fault{small_file, 8, 80, "3", 8, "sequence number D3 follows D3: repeated"},
        Fault{small_file, 8, 74, "      x", 8, "not the sequence number 4"},
        Fault{small_file, 7, 74, "3      ", 7, "right-justified", Severity::warning},
        Fault{small_file, 13, 17, "D      5", 13, "counts 5 lines in the directory section; there are 4"},
        Fault{small_file, 13, 25, "X      4", 13, "where the number of parameter lines is due"}));

INSTANTIATE_TEST_SUITE_P(
    Global, Faults,
    testing::Values(
        Fault{small_file, 2, 3, "3", 2, "'3' cannot be the parameter delimiter"},
        Fault{small_file, 2, 7, "-", 2, "'-' cannot be the record delimiter"},
        Fault{small_file, 2, 9, "9", 2, "no delimiter after a string"},
        Fault{small_file, 3, 7, "0.", 3, "scale is not positive"},
        Fault{small_file, 3, 10, "2", 3, "unit 2 is MM, but its name is given as 'M'"},
        Fault{small_file, 3, 14, "X", 3, "unit 6 is M, but its name is given as 'X'"},
        Fault{small_file, 3, 10, "0", 3, "there is no unit 0"},
        Fault{small_file, 3, 16, "0", 3, "number of line weights", Severity::warning},
        Fault{small_file, 3, 29, "3", 3, "is no date", Severity::warning},
        Fault{small_file, 3, 41, "0.E-06", 3, "a resolution (global parameter 19) of 0", Severity::warning},
        Fault{small_file, 3, 41, "1.E+03", 3, "lose the shape", Severity::warning},
        Fault{small_file, 3, 41, "1.E-40", 3, "finer than the numbers", Severity::warning},
        Fault{small_file, 3, 48, "0.5", 3, "the largest coordinate is said to be 0.5", Severity::warning},
        Fault{small_file, 3, 54, "12", 3, "there is no version 12", Severity::warning},
        Fault{small_file, 3, 57, "9", 3, "there is no drafting standard 9", Severity::warning},
        Fault{small_file, 3, 41, "1.x-06", 3, "is no number"}));

INSTANTIATE_TEST_SUITE_P(
    Directory, Faults,
    testing::Values(
        Fault{small_file, 8, 6, "126", 8, "the second line is of type 126"},
        Fault{small_file, 7, 14, "abc", 7, "is no integer (directory field 2)"},
        Fault{small_file, 7, 16, "3", 11, "128 at D3: its parameters begin with '1.0'"},
        Fault{small_file, 7, 16, "9", 7, "to begin on line P9, of 4"},
        Fault{small_file, 8, 32, "2", 8, "2 parameter lines are counted, and the next one belongs to it too"},
        Fault{small_file, 8, 32, "4", 8, "4 parameter lines are counted, and there are 3"},
        Fault{small_file, 6, 32, "0", 6, "a count of 0 parameter lines"},
        Fault{small_file, 8, 23, "-9", 8, "the colour points to 9"},
        Fault{small_file, 8, 24, "9", 8, "there is no colour 9"},
        Fault{small_file, 7, 56, "1", 7, "the transformation points to a 110 at D1"},
        Fault{small_file, 7, 56, "7", 7, "the transformation points to 7, where no directory entry begins"},
        Fault{small_file, 7, 65, "0a", 7, "is not of eight digits"},
        Fault{small_file, 7, 67, "04", 7, "the subordinate part is 00 to 03"},
        Fault{small_file, 7, 69, "07", 7, "the use part is 00 to 06"},
        Fault{small_file, 8, 39, "44", 8, "type 128 has no form 44"},
        Fault{loops, 5, 56, "1", 5, "its transformations go in a circle"},
        Fault{loops, 7, 67, "00", 7, "it is part of another entity", Severity::warning}));

INSTANTIATE_TEST_SUITE_P(
    Parameters, Faults,
    testing::Values(Fault{small_file, 11, 72, "1", 11, "its parameter line points back to"},
                    Fault{small_file, 12, 8, ",", 12, "the parameters end without ';'"},
                    Fault{small_file, 9, 1, "100", 9, "its parameters begin with '100'"},
                    Fault{small_file, 9, 5, "0.x", 9, "'0.x' is no number"},
                    Fault{small_file, 10, 5, "9", 12, "37 values; 109 are due"},
                    Fault{loops, 93, 7, "90H", 93, "a string of 90 characters is longer than what is left"},
                    Fault{loops, 93, 9, "h", 93, "the h behind a string's length is small"},
                    Fault{loops, 89, 7, "9", 89, "142 at D25: points to a 110 at D9"},
                    Fault{loops, 89, 9, "14", 89, "points to 14, where no directory entry begins"},
                    Fault{loops, 89, 9, "25", 89, "points to itself"},
                    Fault{loops, 94, 19, "3", 94, "where the number of properties is due"},
                    Fault{loops, 94, 21, "31", 94, "a property that is a 142 at D31"},
                    Fault{loops, 75, 13, "2.0", 75, "it is no rotation"},
                    Fault{loops, 75, 21, "0.0", 75, "it is singular"},
                    Fault{loops, 75, 21, "-1.", 75, "left-handed"}));

INSTANTIATE_TEST_SUITE_P(
    Numbers, Faults,
    testing::Values(
        Fault{small_file, 10, 27, "2.0", 10, "knot 3 in u is 1 after 2"},
        Fault{loops, 95, 39, "0.0", 95, "the knot 0 in u is there 5 times, at degree 3"},
        Fault{small_file, 10, 55, "-1.", 10, "weight 1 is -1"},
        Fault{small_file, 10, 55, "3.0", 10, "PROP3 says that it is polynomial, and its weights are 1 to 3"},
        Fault{small_file, 10, 13, "1", 10, "PROP1 says that it is closed in u, and its ends are 1",
              Severity::warning},
        Fault{small_file, 10, 15, "1", 10, "PROP2 says that it is closed in v", Severity::warning},
        Fault{small_file, 10, 19, "1", 10, "said to be periodic in u", Severity::warning},
        Fault{small_file, 11, 57, "1.0,0.0", 11, "the range in u is 1 to 0"},
        Fault{small_file, 11, 61, "1.5", 11, "the range in u is 0 to 1.5, and the knots allow 0 to 1",
              Severity::warning},
        Fault{small_file, 11, 57, "0.5,1.5", 11, "the range in u is 0.5 to 1.5, and the knots allow 0 to 1"},
        Fault{small_file, 11, 57, "0.0,0.0,\n", 11, "columns"}));

TEST(Structure, ClosedSurfaceSaidToBeOpen) {
  const std::string bytes = iges_bytes({ring("ring")}, surfaces());
  const std::size_t at = bytes.find("\n128,") + 1, flags = bytes.find(",1,1,", at + 5);
  ASSERT_NE(flags, std::string::npos);
  std::string broken = bytes;
  broken[flags + 1] = '0';
  const Findings findings = findings_in(broken);
  EXPECT_NE(all_of(findings).find("warning: 128 at D5: PROP1 says that it is open in u, and it is closed"),
            std::string::npos)
      << all_of(findings);
  EXPECT_TRUE(findings.is_sound());  // receivers go by the numbers
}

TEST(Structure, LengthOfLines) {
  const std::string good = fixture("unit_m.igs");
  for (const int line : {1, 5, 9, 13}) {
    std::string longer = good;
    longer.insert(static_cast<std::size_t>(81 * line - 1), "x");
    const std::vector<Message> found = findings_in(longer).messages();
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found[0].place.line, line);
    EXPECT_EQ(found[0].text, "the line has 81 columns; 80 are due");
    std::string shorter = good;
    shorter.erase(static_cast<std::size_t>(81 * (line - 1) + 60), 1);
    const std::string text = all_of(findings_in(shorter));
    EXPECT_NE(text.find("f.igs:" + std::to_string(line) + ":1: error: the line has 79 columns"),
              std::string::npos)
        << text;
  }
}

TEST(Structure, MissingLinesAndSections) {
  const std::string good = fixture("unit_m.igs");
  for (std::size_t line = 0; line < 13; ++line) {
    std::string broken = good;
    broken.erase(81 * line, 81);
    EXPECT_FALSE(findings_in(broken).is_sound()) << line;
  }
  EXPECT_NE(all_of(findings_in(good.substr(0, 81 * 12))).find("there is no terminate section"),
            std::string::npos);
}

// Cut anywhere, or with any byte changed: something is said or the file is as good as before; never a crash.
TEST(Structure, AnyDamageIsPutUpWith) {
  const std::string good = fixture("trimmed.igs");
  for (std::size_t at = 0; at < good.size(); ++at) {
    if (at + 1 < good.size()) {
      EXPECT_FALSE(findings_in(good.substr(0, at)).is_sound()) << at;
    }
    std::string broken = good;
    broken[at] = static_cast<char>("9,;H-\n D\xFF"[at % 9]);
    findings_in(broken);
  }
}

// What ANSYS writes behind its points.
TEST(Structure, ZerosTooManyAreAWarning) {
  const auto found_behind = [](std::string_view more) {
    std::string text = fixture("unit_m.igs");
    const std::size_t at = text.find(';', 81 * 8);
    text.replace(at, more.size() + 1, std::string(more) + ";");
    return findings_in(text);
  };
  const Findings zeros = found_behind(",0,0,0");
  EXPECT_NE(all_of(zeros).find("warning: "), std::string::npos);
  EXPECT_NE(all_of(zeros).find("1 zero too many at the end"), std::string::npos) << all_of(zeros);
  EXPECT_TRUE(zeros.is_sound());
  EXPECT_NE(all_of(found_behind(",0,0,7")).find("error: "), std::string::npos);
  EXPECT_NE(all_of(found_behind(",0,0,7")).find("1 value too many"), std::string::npos);
}

// One fault does not hide another one, wherever they are.
TEST(Structure, AllFaultsAreFound) {
  std::string broken = fixture("unit_m.igs");
  broken = over(broken, 13, 17, "D      5");
  broken = over(broken, 10, 27, "2.0");
  broken = over(broken, 7, 80, "7");
  broken = over(broken, 8, 24, "9");
  broken = over(broken, 3, 7, "0.");
  broken.insert(0, std::string(80, '\t') + "\n");
  const std::string text = all_of(findings_in(broken));
  for (const char* says :
       {":1:1: error: an empty line", ":4:7: error: the model space scale",
        ":8:74: error: sequence number D7", ":9:17: error: 128 at D3: there is no colour 9",
        ":11:31: error: 128 at D3: knot 3 in u", ":14:17: error: the terminate line counts 5"})
    EXPECT_NE(text.find(says), std::string::npos) << says << "\n" << text;
}

TEST(Structure, LinesWithoutEnds) {
  std::string endless = fixture("unit_m.igs");
  std::erase(endless, '\n');
  EXPECT_EQ(all_of(findings_in(endless)),
            "f.igs:1:81: error: the lines have no ends: they follow each other every 80 columns\n");
}

TEST(Structure, TwentyOfAKindAreShown) {
  std::string many;
  for (int i = 0; i < 50; ++i) many += "x\n";
  const std::vector<Message> messages = findings_in(many).messages();
  const auto shown = std::count_if(messages.begin(), messages.end(), [](const Message& message) {
    return message.text.find("columns; 80 are due") != std::string::npos;
  });
  EXPECT_EQ(static_cast<std::size_t>(shown), Tally::shown_of_a_kind + 1);
  EXPECT_TRUE(std::any_of(messages.begin(), messages.end(), [](const Message& message) {
    return message.text == "x50, of which 30 are not shown; for example: the line has 1 columns; 80 are due";
  }));
}

}  // namespace
}  // namespace selvage::test
