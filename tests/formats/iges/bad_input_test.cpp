// Files that are damaged, cut off, of another kind, or merely odd: an error or a warning with its line, or
// the right shape; never a crash.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "core/text_report.h"
#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/reading.h"
#include "formats/iges/structure.h"

namespace selvage::test {

namespace {

// A group of two named faces, with colour, level and transformation.
IgesText small_text() {
  IgesText text;
  const int color = text.add({.type = 314, .parameters = "100.,0.,50.", .status = "00000200"});
  const int matrix = text.add({.type = 124, .parameters = "1.,0.,0.,10.,0.,1.,0.,0.,0.,0.,1.,0."});
  const int name = text.add({.type = 406, .form = 15, .parameters = "1,5Hwarp1"});
  const int one = text.add({.type = 128,
                            .parameters = bilinear(0, 0, 0) + fmt::format(",0,1,{}", name),
                            .color = -color,
                            .level = 3,
                            .transformation = matrix});
  const int two = text.add({.type = 128, .parameters = bilinear(5, 0, 1.5), .label = "TWO"});
  text.add({.type = 402, .form = 7, .parameters = fmt::format("2,{},{},0,1,{}", one, two, name)});
  return text;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

// The small file with other parameters of one entity.
std::string with_parameters(std::size_t entity, const std::string& what, const std::string& by) {
  IgesText text = small_text();
  text.entities[entity].parameters = replaced(text.entities[entity].parameters, what, by);
  return text.bytes();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string joined(const std::vector<std::string>& lines, const std::string& end = "\n") {
  std::string text;
  for (const std::string& line : lines) text += line + end;
  return text;
}

std::string with_lines(const std::string& text,
                       const std::function<void(std::vector<std::string>&)>& change) {
  std::vector<std::string> lines = lines_of(text);
  change(lines);
  return joined(lines);
}

void expect_sound(const IgesReading& reading) {
  EXPECT_EQ(reading.model.has_value(), !reading.diagnostics.has_errors());
  for (const Message& message : reading.diagnostics.messages()) {
    EXPECT_GE(message.place.line, message.text.ends_with("more warnings") ? 0 : 1) << message.text;
    EXPECT_FALSE(message.text.empty());
    EXPECT_EQ(text_prefix(message.text), message.text.size());
  }
}

void expect_error(const std::string& bytes, std::string_view words) {
  const IgesReading reading = read_iges(bytes);
  expect_sound(reading);
  EXPECT_FALSE(reading.model);
  EXPECT_TRUE(reading.says(Severity::error, words)) << reading.text();
}

// Read all the same, with a warning; the two faces are where they should be.
void expect_warning(const std::string& bytes, std::string_view words) {
  const IgesReading reading = read_iges(bytes);
  expect_sound(reading);
  EXPECT_TRUE(reading.says(Severity::warning, words)) << reading.text();
  ASSERT_TRUE(reading.model) << reading.text();
  ASSERT_EQ(reading.model->parts.size(), 1U);
  ASSERT_EQ(reading.model->parts[0].faces.size(), 2U);
  EXPECT_EQ(reading.model->parts[0].faces[0].surface.points[3], Vec3(11, 1, 0));
  EXPECT_EQ(reading.model->parts[0].faces[1].surface.points[3], Vec3(6, 1, 1.5));
}

TEST(IgesBadInput, TheSmallFileIsWhole) {
  const IgesReading reading = read_iges(small_text().bytes());
  EXPECT_EQ(reading.text(), "");
  ASSERT_TRUE(reading.model);
  const cad::Part& part = reading.model->parts.at(0);
  EXPECT_EQ(part.name, "warp1");
  EXPECT_EQ(part.faces.at(0).color, (cad::Color{255, 0, 128}));
  EXPECT_EQ(part.faces.at(0).level, 3);
  EXPECT_EQ(part.faces.at(0).surface.points[0], Vec3(10, 0, 0));
  EXPECT_EQ(part.faces.at(1).name, "TWO");
}

TEST(IgesBadInput, TruncatedAtEveryByte) {
  for (const char* const end : {"\n", "\r\n"}) {
    IgesText text = small_text();
    text.line_end = end;
    const std::string bytes = text.bytes();
    for (std::size_t size = 0; size + 1 < bytes.size(); ++size) {
      const IgesReading reading = read_iges(bytes.substr(0, size));
      expect_sound(reading);
      const auto& messages = reading.diagnostics.messages();
      EXPECT_TRUE(
          std::any_of(messages.begin(), messages.end(),
                      [](const Message& m) { return m.severity != Severity::note && m.place.line >= 1; }))
          << size << " of " << bytes.size() << "\n"
          << reading.text();
      if (HasFailure()) return;
    }
  }
}

TEST(IgesBadInput, CutAmongOurOwnYarns) {
  const std::string bytes = iges_bytes({wave("a", {}, yarn::EndStyle::planar)}, solids());
  for (std::size_t size = 0; size + 1 < bytes.size(); size += 37) {
    const IgesReading reading = read_iges(bytes.substr(0, size));
    expect_sound(reading);
    EXPECT_FALSE(reading.diagnostics.messages().empty());
  }
}

TEST(IgesBadInput, OtherKindsOfFiles) {
  expect_error("", "empty");
  expect_error(" \n \n\n", "empty");
  expect_error("ISO-10303-21;\nHEADER;\n", "section letter");
  expect_error("fabric 1\n", "section letter");
  expect_error(std::string("PK\x03\x04\0\0\0\0", 8) + std::string(500, 'x'), "zero bytes");
  expect_error(std::string(300, '\x81'), "section letter");
  const std::string compressed = fmt::format("{:72}C      1\n", "") + small_text().bytes();
  expect_error(compressed, "compressed ASCII");
  expect_error(std::string("B\0\0\0\x20", 5) + std::string(200, '\0'), "binary IGES");
}

TEST(IgesBadInput, WrongCounts) {
  expect_error(with_parameters(3, "1,1,1,1,", "2,1,1,1,"), "");
  expect_error(with_parameters(3, "1,1,1,1,", "1,0,1,1,"), "highest index");
  expect_error(with_parameters(3, "1,1,1,1,", "-1,1,1,1,"), "highest index");
  expect_error(with_parameters(3, "1,1,1,1,", "1000000000,1,1,1,"), "more than the entity's lines");
  expect_error(with_parameters(3, "1,1,1,1,", "999999999,999999999,1,1,"), "more than the entity's lines");
  expect_error(with_parameters(3, "1,1,1,1,", "99999999999999999999,1,1,1,"), "is no integer");
  expect_error(with_parameters(3, "1,1,1,1,", "1,1,7,1,"), "degree of 7");
  expect_error(with_parameters(3, ",0,1,5", ",0,9,5"), "behind 1 of 9");
  expect_error(with_parameters(3, ",0,1,5", ",0,999,5"), "more than");
  expect_error(with_parameters(5, "2,", "9,"), "behind 5 of 9");
  expect_error(with_parameters(5, "2,", "999,"), "more than");
  expect_error(with_parameters(5, "2,", "3,"), "pointer to an entity is missing");
  expect_error(with_parameters(5, "2,", "-2,"), "cannot be -2");
  expect_warning(with_parameters(2, "5Hwarp1", "9Hwarp1"), "a string of 5 characters says that it has 9");
  expect_warning(with_parameters(2, "5Hwarp1", "99Hwarp1"), "a string of 5 characters says that it has 99");
  expect_error(with_parameters(2, "5Hwarp1", "9Hwa,rp1"), "no delimiter after a string");
  expect_error(with_parameters(2, "5Hwarp1", "99Hwa,rp1"), "longer than what is left");
}

TEST(IgesBadInput, PointersToNowhere) {
  expect_error(with_parameters(5, "2,7,", "2,8,"), "no entity begins");
  expect_error(with_parameters(5, "2,7,", "2,99,"), "no entity begins");
  expect_error(with_parameters(5, "2,7,", "2,0,"), "pointer to an entity is missing");
  expect_error(with_parameters(5, "2,7,", "2,99999999999,"), "cannot be a directory pointer");
  expect_error(with_parameters(5, "2,7,", "2,7.5,"), "is no integer");
  IgesText text = small_text();
  text.entities[3].transformation = 77;
  expect_error(text.bytes(), "which is no 124");
  text.entities[3].transformation = 5;
  expect_error(text.bytes(), "which is no 124");
  text = small_text();
  text.entities[3].color = -99;
  expect_warning(text.bytes(), "there is no colour -99");
  text = small_text();
  text.entities[3].parameters = bilinear(0, 0, 0) + ",0,1,123";
  expect_warning(text.bytes(), "where no entity begins");
}

TEST(IgesBadInput, PointersInCircles) {
  IgesText text = small_text();
  text.entities[1].transformation = 3;
  expect_error(text.bytes(), "circle");
  text = small_text();
  const int other =
      text.add({.type = 124, .parameters = "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.", .transformation = 3});
  text.entities[1].transformation = other;
  expect_error(text.bytes(), "circle");
  text = small_text();
  text.entities[5].parameters = "2,7,11";
  expect_error(text.bytes(), "holds itself");
  text = small_text();
  text.add({.type = 402, .form = 7, .parameters = "1,15"});
  text.add({.type = 402, .form = 14, .parameters = "2,7,13"});
  expect_error(text.bytes(), "holds itself");
}

TEST(IgesBadInput, ManyGroupsWithinGroups) {
  IgesText text = small_text();
  for (int i = 0; i < 3000; ++i)
    text.add({.type = 402, .form = 7, .parameters = fmt::format("1,{}", 11 + 2 * i)});
  expect_error(text.bytes(), "nested too deep");
}

// Each group holds the one before twice: 2^k times the faces.
TEST(IgesBadInput, GroupsThatMultiply) {
  IgesText text = small_text();
  for (int i = 0; i < 40; ++i)
    text.add({.type = 402, .form = 7, .parameters = fmt::format("2,{},{}", 11 + 2 * i, 11 + 2 * i)});
  expect_error(text.bytes(), "control points, instances and all");
}

TEST(IgesBadInput, NumbersThatAreNone) {
  for (const char* bad : {"NaN", "nan", "inf", "-inf", "1E999", "1.2.3", "x", "1-", "3Habc", "1 2"}) {
    expect_error(with_parameters(3, "0.,0.,1.,1.,", fmt::format("0.,0.,1.,{},", bad)), "is no number");
    expect_error(with_parameters(3, "0,0,0,", fmt::format("0,{},0,", bad)), "is no number; 1 of 12");
    expect_error(with_parameters(3, "1,1,1,1,", fmt::format("{},1,1,1,", bad)), "is no integer");
  }
  expect_error(with_parameters(3, "0.,0.,1.,1.,", "0.,1.,0.,1.,"), "below the one before");
  expect_error(with_parameters(3, "0.,0.,1.,1.,", "0.,1.,1.,1.,"), "span nothing");
  IgesText text = small_text();
  text.entities[3].parameters =
      replaced(text.entities[3].parameters, "1.,1.,1.,1.,0,0,0", "1.,0.,1.,1.,0,0,0");
  expect_error(text.bytes(), "weight of 0");
  text.entities[3].parameters =
      replaced(text.entities[3].parameters, "1.,0.,1.,1.,0,0,0", "1.,-2.,1.,1.,0,0,0");
  expect_error(text.bytes(), "weight of -2");
}

TEST(IgesBadInput, Matrices) {
  IgesText text = small_text();
  text.entities[1].parameters = "1.,0.,0.,10.,0.,1.,0.,0.,0.,0.,0.,0.";
  expect_error(text.bytes(), "singular");
  text.entities[1].parameters = "0,0,0,0,0,0,0,0,0,0,0,0";
  expect_error(text.bytes(), "singular");
  text.entities[1].parameters = "1.,0.,0.,10.,0.,1.,0.,0.,0.";
  expect_error(text.bytes(), "parameters end");
  text.entities[1].parameters = "1.,0.,0.,10.,0.,1.,0.,0.,0.,0.,2.,0.";
  const IgesReading reading = read_iges(text.bytes());
  EXPECT_TRUE(reading.says(Severity::warning, "no rotation")) << reading.text();
}

TEST(IgesBadInput, SectionsAndLines) {
  const std::string bytes = small_text().bytes();
  const auto drop = [&](char letter, int number) {
    return with_lines(bytes, [&](std::vector<std::string>& lines) {
      const std::string tail = fmt::format("{}{:>7}", letter, number);
      std::erase_if(lines, [&](const std::string& line) { return line.substr(72) == tail; });
    });
  };
  expect_warning(drop('T', 1), "there is no terminate section");
  expect_error(drop('D', 3), "lines are missing");
  expect_error(drop('P', 3), "lines are missing");
  expect_error(drop('D', 12), "odd number of lines");
  expect_error(
      with_lines(bytes, [](auto& lines) { std::erase_if(lines, [](auto& l) { return l[72] == 'G'; }); }),
      "no global section");
  expect_error(
      with_lines(bytes, [](auto& lines) { std::erase_if(lines, [](auto& l) { return l[72] == 'P'; }); }),
      "which has 0 lines");
  expect_error(with_lines(bytes, [](auto& lines) { std::swap(lines[0], lines[1]); }), "section after the");
  expect_error(with_lines(bytes, [](auto& lines) { lines[3][72] = 'X'; }), "section letter");
  expect_warning(with_lines(bytes, [](auto& lines) { lines[0].replace(73, 7, "     99"); }),
                 "sequence number S99 follows the start");
  expect_warning(with_lines(bytes, [](auto& lines) { lines.back().replace(0, 8, "S     12"); }),
                 "counts 12 lines in the start section; there are 1");
  expect_warning(bytes + "and more\n", "passed over");
  expect_warning(bytes.substr(0, bytes.size() - 1), "no line end");
}

TEST(IgesBadInput, LinesOfOtherLengths) {
  const std::string bytes = small_text().bytes();
  const auto line_with = [](std::vector<std::string>& lines, std::string_view begin,
                            char letter) -> std::string& {
    return *std::find_if(lines.begin(), lines.end(),
                         [&](const std::string& l) { return l.starts_with(begin) && l[72] == letter; });
  };
  // One blank too few or too many behind the data: nothing is in doubt.
  const auto blank_end = [](std::vector<std::string>& lines) -> std::string& {
    return *std::find_if(lines.begin(), lines.end(), [](const std::string& l) {
      return l[72] == 'P' && !l.starts_with("128,") && l[62] == ' ';
    });
  };
  expect_warning(with_lines(bytes, [&](auto& lines) { blank_end(lines).erase(63, 1); }),
                 "section letter stands in column 72");
  expect_warning(with_lines(bytes, [&](auto& lines) { blank_end(lines).insert(63, " "); }),
                 "section letter stands in column 74");
  // A line that is full to its last column: was it a delimiter that was lost?
  expect_error(with_lines(bytes, [&](auto& lines) { line_with(lines, "128,", 'P').erase(63, 1); }),
               "runs over the end of its line");
  expect_warning(with_lines(bytes, [](auto& lines) { lines[0].erase(30, 1); }), "column 72");
  // A character behind the line number.
  expect_warning(with_lines(bytes, [&](auto& lines) { line_with(lines, "128,", 'P') += "x"; }),
                 "behind the line number");
  // A directory line whose fields have moved.
  for (const bool longer : {false, true})
    expect_error(with_lines(bytes,
                            [&](auto& lines) {
                              std::string& line = line_with(lines, "     128", 'D');
                              longer ? line.insert(20, " ") : line.erase(20, 1);
                            }),
                 "fields of this directory line");
  expect_error(with_lines(bytes, [&](auto& lines) { line_with(lines, "128,", 'P').resize(50); }),
               "a line of 50 columns");
}

TEST(IgesBadInput, OddButUnderstood) {
  const std::string bytes = small_text().bytes();
  const auto same = [](const std::string& odd, const std::string& expected_messages) {
    const IgesReading reading = read_iges(odd);
    ASSERT_TRUE(reading.model) << reading.text();
    EXPECT_EQ(reading.text().empty(), expected_messages.empty()) << reading.text();
    EXPECT_EQ(reading.model->parts.at(0).faces.at(0).surface.points[3], Vec3(11, 1, 0));
    EXPECT_EQ(reading.model->parts.at(0).name, "warp1");
  };
  IgesText dos = small_text();
  dos.line_end = "\r\n";
  same(dos.bytes(), "");
  IgesText endless = small_text();
  endless.line_end = "";
  same(endless.bytes(), "");
  same(bytes + "\n\n   \n\x1A", "");
  // Blanks behind the line number; Unix and DOS ends mixed.
  same(with_lines(bytes,
                  [](auto& lines) {
                    for (std::size_t i = 0; i < lines.size(); i += 3) lines[i] += i % 2 == 0 ? "   " : "\r";
                  }),
       "");
  same(with_lines(bytes, [](auto& lines) { lines.insert(lines.begin() + 3, ""); }), "an empty line");
  // Leading zeros and no blanks in numbers.
  same(with_lines(bytes,
                  [](auto& lines) {
                    for (std::string& line : lines)
                      for (std::size_t i = 73; i < 80; ++i)
                        if (line[i] == ' ') line[i] = '0';
                  }),
       "");
}

TEST(IgesBadInput, EightBitText) {
  IgesText text = small_text();
  text.entities[2].parameters =
      "1,5Hgr\xFC"
      "n_";
  IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->parts.at(0).name, "gr\xC3\xBCn_");  // Latin-1
  text.entities[2].parameters = "1,6Hgr\xC3\xBC\x07n";
  reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->parts.at(0).name, "gr\xC3\xBC_n");  // UTF-8 stays
}

TEST(IgesBadInput, Globals) {
  const auto with = [](const std::string& global) {
    IgesText text = small_text();
    text.global = global;
    return text.bytes();
  };
  expect_error(with("1HA,1H;,;"), "");
  expect_error(with("2H,,,1H;,;"), "parameter delimiter");
  expect_error(with("1H1,1H;,;"), "'1' cannot be the parameter delimiter");
  expect_error(with("1H,,1H,,;"), "both delimiters");
  expect_error(with("1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,0.,2,2HMM;"),
               "scale is not positive: 0");
  expect_warning(with("1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,1.,12,2HMM;"),
                 "units are 1 to 11; lengths are taken as MM");
  expect_error(with("1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,1.,3,5HCUBIT;"),
               "'CUBIT'");
  expect_error(with("1H,,1H;,4HPart,99Hpa,rt.igs;"), "longer than what is left");
  expect_error(with("1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,big,2,2HMM;"),
               "'big' is no number");
  expect_error(with("1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,1.,2"), "end without");
  expect_warning(with("1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,1.,2,4HINCH;"),
                 "the number holds");
}

TEST(IgesBadInput, DirectoryFields) {
  const std::string bytes = small_text().bytes();
  const std::string entry = "     128       4";
  expect_error(replaced(bytes, entry, "     1x8       4"), "'     1x8' is no integer (directory field 1)");
  expect_error(replaced(bytes, entry, "     126       4"),
               "126 at D7: the second line is of type 128 (directory field 11)");
  expect_error(replaced(bytes, entry, "     128       5"), "");
  expect_error(replaced(bytes, entry, "     128       3"), "belongs to D5");
  expect_error(replaced(bytes, entry, "     128    9999"), "which has");
  expect_error(replaced(bytes, entry, "     128      -4"), "which has");
  IgesText text = small_text();
  text.entities[3].status = "0000AB00";
  expect_error(text.bytes(), "status '0000AB00' is not of eight digits");
  // The number of lines is not believed where the lines themselves say whose they are.
  EXPECT_EQ(read_iges(with_lines(bytes,
                                 [](auto& lines) {
                                   for (std::string& line : lines)
                                     if (line.starts_with("     128       0") && line[72] == 'D')
                                       line.replace(24, 8, "       1");
                                 }))
                .text(),
            "");
}

// Each entity says that all lines are its own: what is read, and checked, is as much as there is (this took
// minutes).
TEST(IgesBadInput, LineCountsThatAreTooLarge) {
  IgesText text;
  for (int i = 0; i < 40000; ++i) text.add({110, 0, "0.,0.,0.,1.,2.,3."});
  const auto counted = [](std::string owner) {
    return [owner](auto& lines) {
      for (std::string& line : lines) {
        if (line[72] == 'D' && line[79] % 2 == 0) line.replace(24, 8, " 9999999");
        if (line[72] == 'P' && !owner.empty()) line.replace(64, 8, owner);
      }
    };
  };
  const IgesReading reading = read_iges(with_lines(text.bytes(), counted("")));
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->curves.size(), 40000U);
  for (const std::string owner : {"", "       2"}) {
    Findings findings;
    formats::iges::check_structure(Source::from_memory(with_lines(text.bytes(), counted(owner))), findings);
    EXPECT_GE(findings.defects(), 40000);
  }
}

}  // namespace

}  // namespace selvage::test
