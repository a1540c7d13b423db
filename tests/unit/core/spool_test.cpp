#include "core/spool.h"

#include <gtest/gtest.h>

#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

TEST(Spool, WhatWaitedStandsBehindWhatCameLater) {
  const test::ScratchFolder folder;
  const std::string many(3'000'000, 'm');
  Result<OutputFile> output = OutputFile::create(folder / "out");
  ASSERT_TRUE(output.ok());
  {
    const Result<std::unique_ptr<Spool>> first = Spool::beside(*output), second = Spool::beside(*output);
    ASSERT_TRUE(first.ok() && second.ok());
    (*first)->text() << "first " << many;
    (*second)->text() << " second";
    ASSERT_TRUE(output->write("head ").ok());
    ASSERT_TRUE((*first)->append_to(*output).ok());
    ASSERT_TRUE((*second)->append_to(*output).ok());
    EXPECT_EQ((*first)->size(), 6 + many.size());
    EXPECT_TRUE(folder.names().empty());
  }
  ASSERT_TRUE(output->commit().ok());
  EXPECT_EQ(test::bytes_of(folder / "out"), "head first " + many + " second");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"out"});
}

TEST(Spool, OfWhatIsInMemoryIsThereToo) {
  Result<OutputFile> output = OutputFile::in_memory();
  ASSERT_TRUE(output.ok());
  const Result<std::unique_ptr<Spool>> spool = Spool::beside(*output);
  ASSERT_TRUE(spool.ok());
  (*spool)->text() << 0.1F << ' ' << 0.1;
  ASSERT_TRUE((*spool)->append_to(*output).ok());
  EXPECT_EQ(*output->contents(), "0.1 0.1");
}

}  // namespace
}  // namespace selvage
