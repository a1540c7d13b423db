// What holds for every fabric of the zoo.
#include "property/zoo.h"

#include <gtest/gtest.h>

#include <set>

namespace selvage::zoo {
namespace {

TEST(Zoo, EveryFabricHasACaptionOfItsOwn) {
  std::set<std::string> captions;
  ASSERT_FALSE(all().empty());
  for (const ZooFabric& zoo : all()) {
    ASSERT_TRUE(zoo.fabric.title.has_value()) << zoo.name;
    EXPECT_EQ(zoo.fabric.title->find('\n'), std::string::npos) << zoo.name;
    EXPECT_TRUE(captions.insert(*zoo.fabric.title).second)
        << zoo.name << ": another sample is called '" << *zoo.fabric.title << "' too";
  }
}

}  // namespace
}  // namespace selvage::zoo
