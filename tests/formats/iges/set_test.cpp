// A fabric over several files, yarns by reference: what stands in the files, as two readers see it.
#include <gtest/gtest.h>

#include <deque>

#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/header.h"
#include "formats/iges/options.h"
#include "formats/iges/reader.h"
#include "formats/iges/writer.h"

namespace selvage::test {
namespace {

using formats::SurfaceOptions;
using formats::WriteFacts;
using formats::iges::part_mark;
using formats::iges::Records;
using yarn::EndStyle;

std::vector<yarn::Body> many(int count) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < count; ++i)
    bodies.push_back(wave("yarn" + std::to_string(i), {.y = 0.5 * i, .phase = 0.1 * i}, EndStyle::patch));
  return bodies;
}

struct Written {
  std::deque<OutputFile> files;
  std::optional<Result<WriteFacts>> facts;
  Status status;
};

Written write_set(const std::vector<yarn::Body>& bodies, SurfaceOptions options, std::int64_t lines) {
  ::setenv("SOURCE_DATE_EPOCH", "1500000000", 1);
  Written written;
  written.files.push_back(std::move(*OutputFile::in_memory()));
  options.next_part = [&](int number) -> Result<OutputFile*> {
    EXPECT_EQ(number, static_cast<int>(written.files.size()) + 1);
    return &written.files.emplace_back(std::move(*OutputFile::in_memory()));
  };
  auto writer = std::move(*formats::iges::open_writer(written.files.front(), options, {.lines = lines}));
  for (const yarn::Body& body : bodies) {
    written.status = writer->add(body);
    if (!written.status.ok()) return written;
  }
  written.facts = writer->finish();
  return written;
}

std::int64_t parameter_lines(const std::string& bytes) {
  std::int64_t lines = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 81) lines += bytes[at + 72] == 'P' ? 1 : 0;
  return lines;
}

// Each file by itself, but for its first line, is what a writer makes of its yarns alone.
TEST(Set, EveryFileIsWhole) {
  const std::vector<yarn::Body> bodies = many(7);
  for (const bool solid : {false, true}) {
    const SurfaceOptions options = solid ? solids() : surfaces();
    const std::string three = iges_bytes({bodies.begin(), bodies.begin() + 3}, options);
    Written written = write_set(bodies, options, parameter_lines(three) + 20);
    ASSERT_TRUE(written.facts && written.facts->ok());
    ASSERT_GE(written.files.size(), 3U);
    ASSERT_EQ((*written.facts)->parts.size(), written.files.size());
    std::size_t next = 0;
    std::uint64_t surfaces_written = 0;
    std::string set;
    for (std::size_t k = 0; k < written.files.size(); ++k) {
      const std::size_t count = (*written.facts)->parts[k].at("128") / 3;
      ASSERT_LE(next + count, bodies.size());
      const auto first = bodies.begin() + static_cast<std::ptrdiff_t>(next);
      const std::string bytes = *written.files[k].contents();
      const std::string alone = iges_bytes({first, first + static_cast<std::ptrdiff_t>(count)}, options);
      EXPECT_TRUE(bytes.substr(81) == alone.substr(81)) << "file " << k + 1;
      EXPECT_FALSE(part_mark(alone));
      const std::optional<formats::PartMark> mark = part_mark(bytes);
      ASSERT_TRUE(mark) << bytes.substr(0, 80);
      EXPECT_EQ(mark->number, static_cast<int>(k) + 1);
      EXPECT_EQ(mark->count, static_cast<int>(written.files.size()));
      if (k == 0) set = mark->set;
      EXPECT_EQ(mark->set, set);
      surfaces_written += (*written.facts)->parts[k].at("128");
      next += count;
    }
    EXPECT_EQ(surfaces_written, 21U);
    EXPECT_EQ((*written.facts)->entities.at("128"), 21U);
  }
}

TEST(Set, AnotherContentIsAnotherSet) {
  std::vector<yarn::Body> bodies = many(4);
  const std::int64_t lines = parameter_lines(iges_bytes({bodies[0]}, {})) * 2;
  const auto set_of = [&] { return part_mark(*write_set(bodies, {}, lines).files.front().contents())->set; };
  const std::string first = set_of();
  EXPECT_EQ(set_of(), first);
  bodies.back().surface.points[20].x() += 1e-15;
  EXPECT_NE(set_of(), first);
}

TEST(Set, PliesStayTogether) {
  std::vector<yarn::Body> bodies = many(5);
  for (const std::size_t k : {1, 2, 3}) bodies[k].group = "twine";
  const std::int64_t one = parameter_lines(iges_bytes({bodies[0]}, {}));
  Written written = write_set(bodies, {}, 3 * one + one / 2);
  ASSERT_TRUE(written.facts && written.facts->ok());
  ASSERT_EQ(written.files.size(), 3U);  // 1; 3 together; 1
  const auto count = [&](std::size_t k) { return (*written.facts)->parts[k].at("128"); };
  EXPECT_EQ(count(0), 3U);
  EXPECT_EQ(count(1), 9U);
  EXPECT_EQ(count(2), 3U);
  EXPECT_EQ((*written.facts)->parts[1].at("402"), 4U);
  // A group that fits nowhere is refused, whatever else is asked for.
  SurfaceOptions options;
  options.own.set(formats::iges::option::split_yarns);
  written = write_set(bodies, options, 2 * one);
  ASSERT_FALSE(written.status.ok());
  EXPECT_EQ(written.status.error().kind, Kind::limit);
  EXPECT_EQ(written.status.error().yarn, "twine");
  EXPECT_NE(written.status.error().text.find("--detail yarn"), std::string::npos);
}

TEST(Set, AYarnThatFitsNowhereIsRefusedOrCut) {
  const std::vector<yarn::Body> bodies = {wave("short", {.sections = 4}, EndStyle::patch),
                                          wave("long", {.sections = 40}, EndStyle::patch)};
  const std::int64_t needed = parameter_lines(iges_bytes({bodies[1]}, {}));
  Written written = write_set(bodies, {}, needed - 1);
  ASSERT_FALSE(written.status.ok());
  EXPECT_EQ(written.status.error().kind, Kind::limit);
  EXPECT_EQ(written.status.error().yarn, "long");
  EXPECT_NE(written.status.error().text.find(std::to_string(needed)), std::string::npos);
  EXPECT_NE(written.status.error().text.find("--split-yarns"), std::string::npos);

  SurfaceOptions options;
  options.own.set(formats::iges::option::split_yarns);
  written = write_set(bodies, options, needed - 1);
  ASSERT_TRUE(written.facts && written.facts->ok());
  ASSERT_EQ((*written.facts)->messages.size(), 1U);
  EXPECT_NE((*written.facts)->messages[0].text.find("long.part1 to long.part2"), std::string::npos);
  EXPECT_EQ((*written.facts)->entities.at("128"), 9U);
  // The row where the pieces meet, read back from two files.
  std::vector<nurbs::Surface> tubes;
  for (OutputFile& file : written.files) {
    Diagnostics diagnostics;
    const auto model =
        formats::iges::read_model(Source::from_memory(*file.contents(), "part.igs"), diagnostics);
    ASSERT_TRUE(model);
    for (const cad::Part& part : model->parts)
      if (part.name.starts_with("long"))
        for (const cad::Face& face : part.faces)
          if (face.surface.count_u == 18) tubes.push_back(face.surface);
  }
  ASSERT_EQ(tubes.size(), 2U);
  EXPECT_EQ(nurbs::boundary_row(tubes[0], true).points, nurbs::boundary_row(tubes[1], false).points);
}

TEST(Set, MarksOfOtherFilesAreNone) {
  EXPECT_FALSE(part_mark(""));
  EXPECT_FALSE(part_mark("Selvage 1.0: B-spline yarns, file 0 of 2, set ab."));
  EXPECT_FALSE(part_mark("Selvage 1.0: B-spline yarns, file 3 of 2, set ab."));
  EXPECT_FALSE(part_mark("Selvage 1.0: B-spline yarns, file 99999999999 of 2, set ab."));
  EXPECT_FALSE(part_mark("Selvage 1.0: B-spline yarns, file 1 of 2000000000, set ab."));
  EXPECT_FALSE(part_mark("Selvage 1.0: B-spline yarns, file 1 of 2, set ."));
  EXPECT_FALSE(part_mark("Other: B-spline yarns, file 1 of 2, set ab."));
  EXPECT_EQ(part_mark("Selvage 1.0: B-spline yarns, file 1 of 2, set ab.  "),
            (formats::PartMark{1, 2, "ab"}));
}

}  // namespace
}  // namespace selvage::test
