// Files damaged at random, by seeds: never a crash, and either a model that holds together or errors that say
// where. What once went wrong is kept in files of its own (crashers/).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "core/text_report.h"
#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/reading.h"
#include "places.h"

namespace selvage::test {

namespace {

bool is_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

void expect_whole(const nurbs::Surface& surface) {
  ASSERT_GE(surface.degree_u, 1);
  ASSERT_GE(surface.degree_v, 1);
  ASSERT_GT(surface.count_u, surface.degree_u);
  ASSERT_GT(surface.count_v, surface.degree_v);
  ASSERT_EQ(surface.points.size(),
            static_cast<std::size_t>(surface.count_u) * static_cast<std::size_t>(surface.count_v));
  ASSERT_EQ(surface.knots_u.size(), static_cast<std::size_t>(surface.count_u + surface.degree_u + 1));
  ASSERT_EQ(surface.knots_v.size(), static_cast<std::size_t>(surface.count_v + surface.degree_v + 1));
  ASSERT_TRUE(surface.weights.empty() || surface.weights.size() == surface.points.size());
  EXPECT_TRUE(std::is_sorted(surface.knots_u.begin(), surface.knots_u.end()));
  EXPECT_TRUE(std::is_sorted(surface.knots_v.begin(), surface.knots_v.end()));
  EXPECT_TRUE(is_finite(surface.knots_u) && is_finite(surface.knots_v) && is_finite(surface.weights));
  EXPECT_TRUE(std::all_of(surface.weights.begin(), surface.weights.end(), [](double w) { return w > 0; }));
  EXPECT_LT(surface.first_u(), surface.last_u());
  EXPECT_LT(surface.first_v(), surface.last_v());
}

void expect_sound(const std::string& bytes) {
  const IgesReading reading = read_iges(bytes);
  EXPECT_EQ(reading.model.has_value(), !reading.diagnostics.has_errors());
  EXPECT_LE(reading.diagnostics.error_count(), 20);
  const auto lines = static_cast<int>(std::count(bytes.begin(), bytes.end(), '\n')) + 1;
  for (const Message& message : reading.diagnostics.messages()) {
    EXPECT_FALSE(message.text.empty());
    EXPECT_EQ(text_prefix(message.text), message.text.size());
    EXPECT_LE(message.place.line,
              std::max<std::size_t>(static_cast<std::size_t>(lines), bytes.size() / 80 + 1));
    EXPECT_TRUE(message.place.line >= 1 || message.text.ends_with("more warnings")) << message.text;
  }
  if (!reading.model) return;
  for (const cad::Part& part : reading.model->parts) {
    EXPECT_FALSE(part.faces.empty());
    EXPECT_EQ(text_prefix(part.name), part.name.size());
    for (const cad::Face& face : part.faces) expect_whole(face.surface);
  }
}

std::vector<std::string> whole_files() {
  Wave rational;
  rational.weight_step = 0.5;
  rational.sections = 6;
  rational.round = 8;
  const std::vector<yarn::Body> bodies = {wave("warp_1", rational, yarn::EndStyle::patch),
                                          wave("warp_2", rational, yarn::EndStyle::planar)};
  std::vector<std::string> files = {iges_bytes(bodies, surfaces()), iges_bytes(bodies, solids())};
  const std::filesystem::path folder = std::filesystem::path(places::tests()) / "fixtures" / "iges";
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".igs") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return files;
}

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string operator()(std::string text) {
    for (std::uint64_t n = 1 + random_() % 4; n > 0 && !text.empty(); --n) change(text);
    return text;
  }

 private:
  std::size_t place(const std::string& text) { return random_() % text.size(); }
  // A line's first byte.
  std::size_t line(const std::string& text) {
    const std::size_t before = text.rfind('\n', place(text));
    return before == std::string::npos ? 0 : before + 1;
  }

  void change(std::string& text) {
    constexpr std::string_view likely = "0123456789-+.,;DEH \n\r\0SGDPT";
    static const std::vector<std::string> words = {"999999999", "-1",  "1000000000", "NaN", "1E308", "1E-308",
                                                   ",,,,",      "0",   "99H",        ";",   "1.",    "-0.",
                                                   "128",       "402", "124",        "  ",  "1H;",   "7"};
    switch (random_() % 8) {
      case 0:
        text[place(text)] = likely[random_() % likely.size()];
        break;
      case 1:
        text[place(text)] = static_cast<char>(random_());
        break;
      case 2:
        text.erase(place(text), 1 + random_() % 3);
        break;
      case 3:
        text.insert(place(text), 1, likely[random_() % likely.size()]);
        break;
      case 4: {  // over the text, so that the columns stay
        const std::string& word = words[random_() % words.size()];
        const std::size_t at = place(text);
        text.replace(at, std::min(word.size(), text.size() - at), word);
        break;
      }
      case 5: {  // a number for another
        const std::size_t at = text.find_first_of("0123456789", place(text));
        if (at != std::string::npos) text[at] = static_cast<char>('0' + random_() % 10);
        break;
      }
      case 6: {  // a line twice, or in another place
        const std::size_t from = line(text);
        const std::size_t length = std::min(text.find('\n', from), text.size() - 1) + 1 - from;
        const std::string copy = text.substr(from, length);
        if (random_() % 2 == 0) text.erase(from, length);
        if (!text.empty() && random_() % 2 == 0) text.insert(line(text), copy);
        break;
      }
      default:
        if (random_() % 8 == 0) text.resize(place(text));
    }
  }

  std::mt19937_64 random_;
};

TEST(IgesMutation, DamagedFiles) {
  const std::vector<std::string> files = whole_files();
  ASSERT_GE(files.size(), 8U);
  for (std::uint64_t seed = 0; seed < 12'000; ++seed) {
    const std::string bytes = Mutator(seed)(files[seed % files.size()]);
    expect_sound(bytes);
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
}

TEST(IgesMutation, Crashers) {
  const std::filesystem::path folder =
      std::filesystem::path(places::tests()) / "formats" / "iges" / "crashers";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".igs") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    expect_sound({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
    ASSERT_FALSE(HasFailure()) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 1);
}

}  // namespace

}  // namespace selvage::test
