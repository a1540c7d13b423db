// What a machine makes of operations: loops, what each is drawn through, and who passes before whom.
#include <gtest/gtest.h>

#include "reading.h"

namespace selvage {
namespace {

using formats::knitout::Loop;
using formats::knitout::StitchGraph;
using test::head;

StitchGraph graph_of(const std::string& operations) {
  const Source source = Source::from_memory(head + operations, "test.knitout");
  TextReport report(source);
  std::optional<formats::knitout::Program> program = formats::knitout::run_program(source, report);
  EXPECT_EQ(report.errors(), 0);
  return std::move(program->graph);
}

std::vector<int> through(const StitchGraph& graph, std::size_t loop) {
  const auto span = graph.through(graph.loops[loop]);
  return {span.begin(), span.end()};
}

TEST(StitchGraph, AKnitGoesThroughAllThatItsNeedleHolds) {
  const StitchGraph graph = graph_of("knit + f1 1\ntuck - f1 1\nknit + f1 1\nknit - f1 1\n");
  ASSERT_EQ(graph.loops.size(), 4U);
  EXPECT_EQ(through(graph, 2), (std::vector<int>{0, 1}));
  EXPECT_EQ(through(graph, 3), (std::vector<int>{2}));
  EXPECT_TRUE(graph.loops[1].is_tuck);
  EXPECT_EQ(graph.loops[0].next, 2);
  EXPECT_EQ(graph.loops[3].end, Loop::End::on_needle);
}

// At racking R the back needle B faces the front needle B + R.
TEST(StitchGraph, ATransferOverTheOtherBedMovesALoop) {
  const StitchGraph graph =
      graph_of("knit + f1 1\nknit + f2 1\nxfer f1 b1\nrack 1\nxfer b1 f2\nrack 0\nknit - f2 1\n");
  EXPECT_EQ(through(graph, 2), (std::vector<int>{1, 0}));  // what comes lies behind
  EXPECT_EQ(graph.loops[0].made.column, 1);
  EXPECT_EQ(graph.loops[0].left.column, 2);
}

// Seen from the front their order stays: what a back needle was given last lies foremost there.
TEST(StitchGraph, AStackTurnsOverOnItsWayToTheOtherBed) {
  const StitchGraph graph = graph_of("knit + f1 1\ntuck - f1 1\nxfer f1 b1\nknit + b1 1\n");
  EXPECT_EQ(through(graph, 2), (std::vector<int>{1, 0}));
  const StitchGraph back_again = graph_of("knit + f1 1\ntuck - f1 1\nxfer f1 b1\nxfer b1 f1\nknit + f1 1\n");
  EXPECT_EQ(through(back_again, 2), (std::vector<int>{0, 1}));
}

TEST(StitchGraph, ASplitKnitsAndTransfers) {
  const StitchGraph graph = graph_of("knit + f1 1\nsplit - f1 b1 1\nknit + f1 1\nknit - b1 1\n");
  ASSERT_EQ(graph.loops.size(), 4U);
  EXPECT_EQ(through(graph, 1), (std::vector<int>{0}));
  EXPECT_EQ(through(graph, 2), (std::vector<int>{1}));
  EXPECT_EQ(through(graph, 3), (std::vector<int>{0}));  // it went on to b1
  EXPECT_TRUE(graph.loops[1].splits);
}

TEST(StitchGraph, NoCarrierDropsAndTransfers) {
  const StitchGraph graph =
      graph_of("knit + f1 1\nknit + f2 1\nknit + f1\nsplit + f2 b2\ntuck + b2\nknit - b2 1\n");
  ASSERT_EQ(graph.loops.size(), 3U);
  EXPECT_EQ(graph.loops[0].end, Loop::End::dropped);
  EXPECT_EQ(through(graph, 2), (std::vector<int>{1}));
}

TEST(StitchGraph, LoopsPassBeforeThoseOnTheOtherBed) {
  const std::string crossing = "knit + f1 1\nknit + f2 1\nxfer f1 b1\nxfer f2 b2\n";
  const StitchGraph right =
      graph_of(crossing + "rack 1\nxfer b1 f2\nrack -1\nxfer b2 f1\nrack 0\nknit - f2 1\nknit - f1 1\n");
  EXPECT_TRUE(right.passings.at({0, 1}));
  const StitchGraph left =
      graph_of(crossing + "rack -1\nxfer b2 f1\nrack 1\nxfer b1 f2\nrack 0\nknit - f2 1\nknit - f1 1\n");
  EXPECT_FALSE(left.passings.at({0, 1}));
}

TEST(StitchGraph, SlidersHoldLoops) {
  const StitchGraph graph =
      graph_of("knit + f1 1\nxfer f1 bs1\nknit - f1 1\nrack 1\nxfer bs1 f2\nknit - f2 1\n");
  EXPECT_EQ(through(graph, 1), (std::vector<int>{}));
  EXPECT_EQ(through(graph, 2), (std::vector<int>{0}));
}

TEST(StitchGraph, CommentsPausesAndSettingsKnitNothing) {
  const StitchGraph graph = graph_of(
      ";;Gauge: 3\n  knit\t+ f1 1 ; a comment: knit + f9 1\r\npause\nstitch 1 -2.5\namiss f1\nmiss + f2 1\n"
      "x-anything f1 f2 ?\n\n");
  EXPECT_EQ(graph.loops.size(), 1U);
}

}  // namespace
}  // namespace selvage
