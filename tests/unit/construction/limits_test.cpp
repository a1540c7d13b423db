// What is refused before it costs anything, and names that belong to one yarn each.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>
#include <set>

#include "construction/build.h"
#include "fabric/quantities.h"
#include "formats/registry.h"

namespace {
std::atomic<std::uint64_t> allocations = 0;
}

// Counted: what a search costs, without a clock. Not inlined: the compiler warns where it sees free() meet a
// new that it does not see.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace selvage::fabric {
namespace {

struct Made {
  Fabric fabric;
  Diagnostics diagnostics;
  std::optional<YarnBuilder> builder;
};

std::unique_ptr<Made> made(const std::string& statements) {
  auto result = std::make_unique<Made>();
  const Source source =
      Source::from_memory("fabric 1\nthread T\ndiameter 0.2\nend\n" + statements, "test.txt");
  std::optional<Fabric> fabric = formats::txt::descriptor().read_fabric(source, result->diagnostics);
  if (!fabric) return result;
  result->fabric = std::move(*fabric);
  result->builder = YarnBuilder::create(result->fabric, {}, result->diagnostics);
  return result;
}

std::multiset<std::string> names_of(const YarnBuilder& builder) {
  std::multiset<std::string> names;
  for (std::size_t i = 0; i < builder.count(); ++i) names.insert(builder.plan(i)->name);
  return names;
}

void expect_unique(const std::multiset<std::string>& names) {
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

const std::string plain = "weave\nwarp T 2 pitch 1\nweft T 2 pitch 1\ndraft plain\nend\n";
std::string yarn(const std::string& name, const std::string& more = "") {
  return "yarn " + name + " T\n" + more + "path\n0 0 5\n9 0 5\nend\nend\n";
}

TEST(Names, OfTwoConstructionsDiffer) {
  const auto two = made(plain + plain + "knit jersey\nthread T\ncourses 2\nwales 2\nend\n" +
                        "knit jersey\nthread T\ncourses 2\nwales 2\nend\n");
  ASSERT_TRUE(two->builder);
  const std::multiset<std::string> names = names_of(*two->builder);
  EXPECT_EQ(names.size(), 12U);
  expect_unique(names);
  EXPECT_TRUE(names.contains("warp_1") && names.contains("weave2_warp_1") &&
              names.contains("knit2_course_2"));
  ASSERT_EQ(two->diagnostics.messages().size(), 2U);
  EXPECT_EQ(two->diagnostics.messages()[0].place.line, 10);
  EXPECT_NE(two->diagnostics.messages()[0].text.find("'weave2_warp_1'"), std::string::npos);
  ASSERT_TRUE(two->builder->find("weave2_weft_2"));
  EXPECT_EQ(two->builder->plan(*two->builder->find("weave2_weft_2"))->name, "weave2_weft_2");
}

TEST(Names, OfYarnBlocksStay) {
  for (const std::string& text :
       {yarn("warp_1") + yarn("weave1_weft_2") + plain, plain + yarn("warp_1") + yarn("weave1_weft_2")}) {
    const auto both = made(text);
    ASSERT_TRUE(both->builder);
    const std::multiset<std::string> names = names_of(*both->builder);
    expect_unique(names);
    EXPECT_TRUE(names.contains("warp_1") && names.contains("weave1_weft_2") &&
                names.contains("weave2_warp_1"));
  }
}

TEST(Names, OfPartsAreNoOtherYarns) {
  const std::string plied = yarn("y", "plies 2 0 Z\n");
  EXPECT_TRUE(made(plied + yarn("y.ply3"))->builder);
  const auto clash = made(plied + yarn("y.ply2"));
  EXPECT_FALSE(clash->builder);
  EXPECT_NE(clash->diagnostics.first_error()->text.find("a part of yarn 'y'"), std::string::npos);
  EXPECT_EQ(clash->diagnostics.first_error()->place.line, 12);
}

// All names looked for once each: what that costs grows with their number.
TEST(Names, AreFoundInLinearWork) {
  const auto work = [](int count) {
    std::string text;
    const auto name = [](int i) {
      return "a_name_that_does_not_fit_into_a_short_string_" + std::to_string(i);
    };
    for (int i = 0; i < count; ++i) text += yarn(name(i));
    const auto built = made(text);
    EXPECT_TRUE(built->builder);
    const std::uint64_t before = allocations;
    for (int i = 0; i < count; ++i) EXPECT_EQ(built->builder->find(name(i)), static_cast<std::size_t>(i));
    return allocations - before;
  };
  const std::uint64_t few = work(100), many = work(1600);
  EXPECT_LT(many, 2 * 16 * few);
}

TEST(Work, IsCountedWithoutOverflow) {
  constexpr auto most = std::numeric_limits<std::uint64_t>::max();
  Work work{2, most - 1, 5};
  work += {3, 7, 4};
  EXPECT_EQ(work.yarns, 5U);
  EXPECT_EQ(work.points, most);
  EXPECT_EQ(work.longest, 5U);
  EXPECT_EQ(in_parts({3, most / 2, 9}, 3).points, most);
  EXPECT_EQ(in_parts({3, 4, 9}, 3).points, 12U);
  EXPECT_TRUE(check_work({1, 100, 100}, {}).ok());
  EXPECT_FALSE(check_work({1, 200'000'000, 100}, {}).ok());
  EXPECT_FALSE(check_work({10'000'000, 100, 100}, {}).ok());  // each costs something
  EXPECT_FALSE(check_work({1, 1'000'000, 1'000'000}, {}).ok());
}

TEST(Work, OfManyStatementsAddsUp) {
  const std::string half = "knit jersey\nthread T\ncourses 2500\nwales 2500\nend\n";
  EXPECT_TRUE(made(half)->builder);
  const auto twice = made(half + half);
  EXPECT_FALSE(twice->builder);
  EXPECT_EQ(twice->diagnostics.first_error()->kind, Kind::limit);
  EXPECT_EQ(twice->diagnostics.first_error()->place.line, 10);
}

TEST(Quantities, NameTheUnitAndTheSlip) {
  EXPECT_EQ(oddity(density_quantity, 1.52), "");
  EXPECT_EQ(oddity(density_quantity, 22.6), "");
  EXPECT_NE(oddity(density_quantity, 1520).find("g/cm3: if these are kg/m3, write 1.52"), std::string::npos);
  EXPECT_EQ(oddity(density_quantity, 1e9).find("kg/m3"), std::string::npos);
  EXPECT_NE(oddity(twist_quantity, std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_TRUE(check_proportion("a pitch", 3, 1, Unit::mm, {4, 1}).ok());
  const Status far = check_proportion("a pitch", 9.2e18, 1, Unit::mm, {4, 1});
  ASSERT_FALSE(far.ok());
  EXPECT_EQ(far.error().place.line, 4);
}

}  // namespace
}  // namespace selvage::fabric
