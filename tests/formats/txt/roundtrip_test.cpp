// Writing and reading gives the same model, every number bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "formats/txt/model_text.h"
#include "formats/txt/random_model.h"
#include "formats/txt/reading.h"
#include "places.h"

namespace selvage::test {

namespace {

std::string written(const fabric::Fabric& fabric) {
  Result<OutputFile> file = OutputFile::in_memory();
  EXPECT_TRUE(file.ok());
  const auto facts = formats::txt::descriptor().write_fabric(fabric, *file);
  EXPECT_TRUE(facts.ok()) << to_string(facts.error());
  return *file->contents();
}

std::string write_error(const fabric::Fabric& fabric) {
  Result<OutputFile> file = OutputFile::in_memory();
  const auto facts = formats::txt::descriptor().write_fabric(fabric, *file);
  return facts.ok() ? "" : facts.error().text;
}

fabric::Fabric one_yarn() {
  fabric::Fabric fabric;
  fabric::Yarn yarn;
  yarn.name = "y";
  fabric::Path path;
  path.points = {{0, 0, 0}, {1, 0, 0}};
  yarn.shape = path;
  fabric.items.emplace_back(yarn);
  return fabric;
}

}  // namespace

TEST(RoundTrip, Samples) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(places::samples())) {
    if (entry.path().extension() != ".txt") continue;
    ++count;
    Result<Source> source = Source::open(entry.path());
    ASSERT_TRUE(source.ok());
    const Reading first = read(*source);
    ASSERT_TRUE(first.fabric) << first.text();
    const std::string text = written(*first.fabric);
    const Reading second = read(text);
    ASSERT_TRUE(second.fabric) << second.text() << text;
    EXPECT_EQ(first_difference(*first.fabric, *second.fabric), "") << entry.path();
    EXPECT_EQ(written(*second.fabric), text) << "the writer's text is not canonical";
  }
  EXPECT_GE(count, 10);
}

TEST(RoundTrip, RandomModels) {
  std::array<int, std::variant_size_v<fabric::Item>> kinds{};
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    const fabric::Fabric fabric = random_fabric(seed);
    for (const fabric::Item& item : fabric.items) ++kinds[item.index()];
    const std::string text = written(fabric);
    const Reading back = read(text);
    ASSERT_TRUE(back.fabric) << "seed " << seed << "\n" << back.text();
    ASSERT_EQ(first_difference(fabric, *back.fabric), "") << "seed " << seed;
  }
  for (int kind : kinds) EXPECT_GT(kind, 100) << "a kind of item is hardly ever made";
}

TEST(RoundTrip, TheComparisonSeesTheLastBit) {
  fabric::Fabric one = one_yarn(), other = one_yarn();
  EXPECT_EQ(first_difference(one, other), "");
  auto& path = std::get<fabric::Path>(std::get<fabric::Yarn>(other.items[0]).shape);
  path.points[1].x() = std::nextafter(1.0, 2.0);
  EXPECT_NE(first_difference(one, other), "");
  path.points[1].x() = 1.0;
  path.points[0].x() = -0.0;
  EXPECT_NE(first_difference(one, other), "");
}

TEST(Writer, LooksLikeThis) {
  const Reading reading = read(
      "FABRIC 1\nUnits CM\ntitle \"A title\"  # words\nthread \"warp yarn\"\ntex +30.0\nsection polygon\n0 "
      "0\n"
      "1 0\n0 5e-1\nend\nend\nyarn y1 \"warp yarn\"\ngrid 2 3\n0 0 0\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 "
      "1\nend\n"
      "role Warp\nend");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(written(*reading.fabric), R"(fabric 1
title "A title"
units cm

thread "warp yarn"
  tex 30
  section polygon
    0 0
    1 0
    0 0.5
  end
end

yarn y1 "warp yarn"
  role warp
  grid 2 3
    0 0 0
    0 1 0
    0 0 1

    1 0 0
    1 1 0
    1 0 1
  end
end
)");
}

TEST(Writer, CountsWhatItWrote) {
  Result<OutputFile> file = OutputFile::in_memory();
  const auto facts = formats::txt::descriptor().write_fabric(one_yarn(), *file);
  ASSERT_TRUE(facts.ok());
  EXPECT_EQ(facts->entities.at("yarn"), 1U);
}

TEST(Writer, RefusesWhatTheLanguageCannotSay) {
  fabric::Fabric quote = one_yarn();
  std::get<fabric::Yarn>(quote.items[0]).name = "2\" tape";
  EXPECT_NE(write_error(quote).find("cannot be written"), std::string::npos);
  fabric::Fabric line_break = one_yarn();
  line_break.title = "one\ntwo";
  EXPECT_NE(write_error(line_break).find("cannot be written"), std::string::npos);
  fabric::Fabric nameless = one_yarn();
  std::get<fabric::Yarn>(nameless.items[0]).name = "";
  EXPECT_NE(write_error(nameless).find("empty"), std::string::npos);
  fabric::Fabric infinite = one_yarn();
  infinite.tolerance = std::numeric_limits<double>::infinity();
  EXPECT_NE(write_error(infinite).find("finite"), std::string::npos);
  fabric::Fabric shapeless = one_yarn();
  std::get<fabric::Yarn>(shapeless.items[0]).shape = std::monostate{};
  EXPECT_NE(write_error(shapeless).find("no path"), std::string::npos);
}

TEST(Writer, PassesManyBuffers) {
  fabric::Fabric fabric = one_yarn();
  auto& points = std::get<fabric::Path>(std::get<fabric::Yarn>(fabric.items[0]).shape).points;
  for (int i = 0; i < 200000; ++i) points.emplace_back(2.0 + i, std::sin(i), std::cos(i) / 3.0);
  const std::string text = written(fabric);
  EXPECT_GT(text.size(), std::size_t{5} << 20);
  const Reading back = read(text);
  ASSERT_TRUE(back.fabric) << back.text();
  EXPECT_EQ(first_difference(fabric, *back.fabric), "");
}

}  // namespace selvage::test
