// Damaged files: never a crash, and either a model that survives the writer or errors that say where.
#include <gtest/gtest.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "core/text_report.h"
#include "formats/txt/model_text.h"
#include "formats/txt/reading.h"
#include "places.h"

namespace selvage::test {

namespace {

std::vector<std::string> sample_texts() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(places::samples()))
    if (entry.path().extension() == ".txt") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> texts;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    texts.push_back(bytes.str());
  }
  return texts;
}

void expect_message_is_sound(const Message& message, const std::string& text) {
  const int lines = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  EXPECT_EQ(message.file, "test.txt");
  EXPECT_GE(message.place.line, 1);
  EXPECT_LE(message.place.line, lines);
  EXPECT_GE(message.place.column, 1);
  EXPECT_FALSE(message.text.empty());
  EXPECT_EQ(text_prefix(message.text), message.text.size());
  EXPECT_EQ(text_prefix(message.excerpt), message.excerpt.size());
  EXPECT_EQ(text_prefix(message.yarn), message.yarn.size());
  EXPECT_LE(message.excerpt.size(), 600U);
  EXPECT_LE(message.caret, static_cast<int>(message.excerpt.size()) + 1);
}

// Reads the damaged text; a model has to survive the writer.
void expect_sound(const std::string& text) {
  const Reading reading = read(text);
  const std::vector<Message>& messages = reading.diagnostics.messages();
  EXPECT_EQ(reading.fabric.has_value(), !reading.diagnostics.has_errors());
  EXPECT_LE(reading.diagnostics.error_count(), 20);
  for (const Message& message : messages) expect_message_is_sound(message, text);
  EXPECT_TRUE(std::is_sorted(messages.begin(), messages.end(),
                             [](const Message& a, const Message& b) { return a.place.line < b.place.line; }));
  if (reading.fabric) {
    Result<OutputFile> file = OutputFile::in_memory();
    ASSERT_TRUE(file.ok());
    const auto facts = formats::txt::descriptor().write_fabric(*reading.fabric, *file);
    ASSERT_TRUE(facts.ok()) << to_string(facts.error());
    const Reading again = read(*file->contents());
    ASSERT_TRUE(again.fabric) << again.text();
    EXPECT_EQ(first_difference(*reading.fabric, *again.fabric), "");
  }
  ASSERT_FALSE(testing::Test::HasFailure()) << text.substr(0, 4000);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : engine_(seed) {}

  std::string mutate(std::string text) {
    for (int i = static_cast<int>(below(3)); i >= 0; --i) text = once(std::move(text));
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : engine_() % n; }

  std::string once(std::string text) {
    static const std::vector<std::string> words = {"end",
                                                   "yarn y2 t",
                                                   "grid 99999 99999",
                                                   "path",
                                                   "nan",
                                                   "1e999",
                                                   "-0",
                                                   "\"",
                                                   "#",
                                                   ",",
                                                   "0,5",
                                                   "\xFF",
                                                   "closed",
                                                   "draft",
                                                   "chart",
                                                   "KPTM",
                                                   "weave",
                                                   "piece",
                                                   "fabric 1",
                                                   "cell 0 0 0 1 1 1",
                                                   "polygon",
                                                   "knots along 0 0",
                                                   "//"};
    const std::size_t at = below(text.size() + 1);
    switch (below(8)) {
      case 0:
        return text.substr(0, at);
      case 1:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1U << below(8)));
        return text;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        return text;
      case 3:
        return text.insert(at, words[below(words.size())]);
      case 4:
        return text.erase(at, 1 + below(20));
      default:
        break;
    }
    std::vector<std::string> lines = lines_of(text);
    if (lines.empty()) return text;
    std::string& line = lines[below(lines.size())];
    switch (below(4)) {
      case 0:
        std::swap(line, lines[below(lines.size())]);
        break;
      case 1:
        line.clear();
        break;
      case 2:
        line = lines[below(lines.size())];
        break;
      default:
        line = words[below(words.size())];
        break;
    }
    return joined(lines);
  }

  std::mt19937_64 engine_;
};

}  // namespace

TEST(Damaged, CutAtEveryByte) {
  for (const std::string& text : sample_texts()) {
    if (text.size() > 2000) continue;
    for (std::size_t size = 0; size < text.size(); ++size)
      ASSERT_NO_FATAL_FAILURE(expect_sound(text.substr(0, size)));
  }
}

TEST(Damaged, EveryByteReplaced) {
  for (const std::string& text : sample_texts()) {
    if (text.size() > 1000) continue;
    for (std::size_t at = 0; at < text.size(); ++at)
      for (char c : {'\0', '"', '#', '\n', ',', 'x', '9', '\xC3'}) {
        std::string damaged = text;
        damaged[at] = c;
        ASSERT_NO_FATAL_FAILURE(expect_sound(damaged));
      }
  }
}

TEST(Damaged, AtRandom) {
  const std::vector<std::string> texts = sample_texts();
  ASSERT_GE(texts.size(), 20U);
  Mutator mutator(20240229);
  for (int i = 0; i < 6000; ++i) {
    const std::string& text = texts[static_cast<std::size_t>(i) % texts.size()];
    if (text.size() > 5000 && i % 7 != 0) continue;
    ASSERT_NO_FATAL_FAILURE(expect_sound(mutator.mutate(text))) << "mutation " << i;
  }
}

// The file ends with its page of memory, and behind it lies one that must not be touched.
TEST(Damaged, NothingIsReadBehindTheEnd) {
  constexpr std::size_t page = 4096;
  const auto path =
      std::filesystem::temp_directory_path() / ("selvage-guard-" + std::to_string(::getpid()) + ".txt");
  int guarded = 0;
  for (const std::string& sample : sample_texts()) {
    if (sample.size() > 1000) continue;
    for (std::size_t size = 1; size < sample.size(); size += 7) {
      const std::string text = sample.substr(0, size);
      std::ofstream(path, std::ios::binary) << "#" << std::string(page - 2 - size, '.') << "\n" << text;
      // The system maps the file into the hole before the forbidden page, as long as no better one opens.
      auto* const hole =
          static_cast<char*>(::mmap(nullptr, 2 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
      ASSERT_NE(hole, MAP_FAILED);
      ::munmap(hole, page);
      Result<Source> source = Source::open(path);
      ASSERT_TRUE(source.ok());
      ASSERT_EQ(source->bytes().size(), page);
      if (source->bytes().data() == hole) ++guarded;
      const Reading reading = read(*source);
      EXPECT_EQ(reading.fabric.has_value(), !reading.diagnostics.has_errors());
      ::munmap(hole + page, page);
    }
  }
  std::filesystem::remove(path);
  if (guarded == 0) GTEST_SKIP() << "this system maps files elsewhere";
}

// Every statement of the language without its last word, and with one too many.
TEST(Damaged, EveryLineShortenedAndProlonged) {
  for (const std::string& text : sample_texts()) {
    if (text.size() > 2000) continue;
    const std::vector<std::string> lines = lines_of(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::vector<std::string> damaged = lines;
      const std::size_t blank = lines[i].find_last_of(' ');
      if (blank != std::string::npos) {
        damaged[i] = lines[i].substr(0, blank);
        ASSERT_NO_FATAL_FAILURE(expect_sound(joined(damaged)));
      }
      damaged[i] = lines[i] + " 7";
      ASSERT_NO_FATAL_FAILURE(expect_sound(joined(damaged)));
    }
  }
}

}  // namespace selvage::test
