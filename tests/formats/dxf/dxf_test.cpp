// DXF by hand: values, names, handles. tests/cli/test_pieces.py asks ezdxf.
#include "formats/registry.h"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "formats/dxf/tags.h"
#include "shapes.h"

namespace selvage::formats::dxf {
namespace {

using test::line;

TEST(Dxf, StringValues) {
  EXPECT_EQ(string_value("back 1"), "back 1");
  EXPECT_EQ(string_value("R\xC3\xBC"
                         "cken"),
            "R\\U+00FCcken");
  EXPECT_EQ(string_value("\xE4\xBD\x93"), "\\U+4F53");
  EXPECT_EQ(string_value("\xF0\x9F\xA7\xB5!"), "_!");  // a spool of thread, beyond FFFF
  EXPECT_EQ(string_value("a^b"), "a^ b");
  EXPECT_EQ(string_value("a\nb\xFF"), "a_b_");
}

TEST(Dxf, TagsToTheLetter) {
  Tags tags;
  tags.text(0, "LINE").handle(5, 255).integer(70, 8).real(40, 25).real(40, -0.0).real(42, 1e-10).real(40,
                                                                                                      0.1);
  EXPECT_EQ(tags.bytes(), "  0\nLINE\n  5\nFF\n 70\n8\n 40\n25.0\n 40\n0.0\n 42\n1e-10\n 40\n0.1\n");
  EXPECT_EQ(Tags().point(210, Vec3::UnitZ()).bytes(), "210\n0.0\n220\n0.0\n230\n1.0\n");
}

fabric::PieceShape triangle(const std::string& name) {
  fabric::PieceShape piece;
  piece.name = name;
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(0, 1, 0);
  piece.edges = {{"ab", {}, line(a, b), {}}, {"bc", {}, line(b, c), {}}, {"ca", {}, line(c, a), {}}};
  piece.box = nurbs::Box2(Vec2(0, 0), Vec2(2, 1));
  return piece;
}

// Every handle once, all below the seed; every owner is a handle, or 0.
TEST(Dxf, HandlesAndOwners) {
  Result<OutputFile> output = OutputFile::in_memory();
  Result<std::unique_ptr<BodyWriter>> writer = descriptor().open_bodies(*output, {});
  for (const char* name : {"one", "two", "ONE"}) ASSERT_TRUE((*writer)->add_piece(triangle(name)).ok());
  const Result<WriteFacts> facts = (*writer)->finish();
  ASSERT_TRUE(facts.ok());
  EXPECT_EQ(facts->entities.at("LINE"), 9U);
  EXPECT_EQ(facts->entities.at("BLOCK"), 3U);
  ASSERT_EQ(facts->messages.size(), 1U);  // names ignore case
  EXPECT_NE(facts->messages[0].text.find("'ONE_2'"), std::string::npos);

  std::istringstream file(*output->contents());
  EXPECT_TRUE(descriptor().sniff(file.str()));
  std::set<std::string> handles, owners;
  std::string code, value, variable, last;
  unsigned long seed = 0;
  bool dimstyle = false;
  while (std::getline(file, code) && std::getline(file, value)) {
    const int group = std::stoi(code);
    if (group == 0) dimstyle = value == "DIMSTYLE";
    if (group == 9) variable = value;
    if (group == 5 && variable == "$HANDSEED" && seed == 0) {
      seed = std::stoul(value, nullptr, 16);
    } else if (group == 5 || (group == 105 && dimstyle)) {
      EXPECT_TRUE(handles.insert(value).second) << value;
    }
    if (group == 330) owners.insert(value);
    last = value;
  }
  EXPECT_EQ(last, "EOF");
  EXPECT_GT(handles.size(), 40U);
  for (const std::string& handle : handles) EXPECT_LT(std::stoul(handle, nullptr, 16), seed);
  for (const std::string& owner : owners) EXPECT_TRUE(owner == "0" || handles.contains(owner)) << owner;
}

}  // namespace
}  // namespace selvage::formats::dxf
