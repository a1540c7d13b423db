// The examples of the reference page: all can be read, whole ones built, and there is one of every statement.
#include <gtest/gtest.h>

#include <set>

#include "built.h"
#include "construction/settle_cell.h"
#include "fabric/loft.h"
#include "formats/txt/reading.h"
#include "places.h"

namespace selvage::test {
namespace {

std::string page() {
  const Result<Source> source = Source::open(places::tests() + "/../formats/txt/README.md");
  EXPECT_TRUE(source.ok());
  return source ? std::string(source->bytes()) : std::string();
}

// What stands between lines of three backquotes.
std::vector<std::string> examples() {
  std::vector<std::string> list;
  bool is_inside = false;
  const std::string text = page();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    if (line.compare(indent, 3, "```") == 0) {
      is_inside = !is_inside;
      if (is_inside) list.emplace_back();
    } else if (is_inside) {
      list.back() += line + "\n";
    }
  }
  EXPECT_FALSE(is_inside);
  return list;
}

bool is_whole(const std::string& example) {
  return example.starts_with("fabric 1");
}

// With the header and the threads that it takes for granted.
std::string completed(const std::string& example) {
  std::string text = example;
  for (const std::string name : {"a", "b", "cord", "cotton20"})
    if (!is_whole(example)) text = "thread " + name + "\n diameter 0.2\nend\n" + text;
  return is_whole(example) ? text : "fabric 1\n" + text;
}

TEST(ReferencePage, ExamplesAreRead) {
  EXPECT_GT(examples().size(), 12U);
  for (const std::string& example : examples()) {
    const Reading reading = read(completed(example));
    EXPECT_TRUE(reading.fabric.has_value()) << example << reading.text();
  }
}

TEST(ReferencePage, WholeOnesAreBuilt) {
  int whole = 0;
  for (const std::string& example : examples()) {
    if (!is_whole(example)) continue;
    SCOPED_TRACE(example);
    Reading reading = read(example);
    ASSERT_TRUE(reading.fabric.has_value());
    fabric::loft(*reading.fabric, reading.diagnostics);
    fabric::settle_cell(*reading.fabric, {}, 2, reading.diagnostics);
    EXPECT_FALSE(reading.diagnostics.has_errors()) << reading.text();
    const std::size_t yarns = built(*reading.fabric).size();
    EXPECT_TRUE(yarns > 0 || reading.fabric->items.empty());  // threads alone are none
    ++whole;
  }
  EXPECT_GT(whole, 6);
}

// The words that the reader knows where this is what stands before.
std::vector<std::string> words_behind(const std::string& opening) {
  const std::string text = read("fabric 1\n" + opening + "qqqqqqqqqqqq 1\n").text();
  const std::size_t begin = text.find("; known: ");
  EXPECT_NE(begin, std::string::npos) << opening << text;
  std::vector<std::string> words;
  if (begin == std::string::npos) return words;
  std::string list = text.substr(begin + 9, text.find('\n', begin) - begin - 9) + ",";
  for (std::size_t comma = 0; (comma = list.find(',')) != std::string::npos; list.erase(0, comma + 1)) {
    const std::size_t first = list.find_first_not_of(' ');
    words.push_back(list.substr(first, list.find_first_of(" ,", first) - first));
  }
  return words;
}

TEST(ReferencePage, EveryStatementHasAnExample) {
  std::set<std::string> shown;  // what a line begins with
  for (const std::string& example : examples())
    for (std::size_t begin = 0; begin < example.size();) {
      const std::size_t end = example.find('\n', begin), first = example.find_first_not_of(' ', begin);
      if (first < end) shown.insert(example.substr(first, std::min(example.find(' ', first), end) - first));
      begin = end + 1;
    }
  for (const std::string opening : {"", "thread t\n", "material m\n", "yarn y\n", "weave\n", "knit jersey\n",
                                    "warpknit\n", "braid\n", "piece p\n", "cell 0 0 0 1 1 1\n",
                                    "yarn y\ngrid 2 3\n", "block b\n", "block b\nyarn y\nend\nend\nuse b\n"})
    for (const std::string& word : words_behind(opening))
      EXPECT_TRUE(shown.contains(word)) << opening << word;
}

}  // namespace
}  // namespace selvage::test
