// Does our reader see in a file what the second reader, in Python, sees? Every fixture, and every sample as
// we write it, entity by entity. And does the comparison find it when it does not?
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "formats/iges/files.h"
#include "places.h"

namespace selvage::test {
namespace {

namespace fs = std::filesystem;

const fs::path fixtures = fs::path(places::tests()) / "fixtures";

std::vector<std::string> files_below(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (std::find(extensions.begin(), extensions.end(), entry.path().extension()) != extensions.end() &&
        entry.path().string().find("/bad/") == std::string::npos &&
        entry.path().filename() != "CMakeLists.txt")  // samples/ci: no fabric
      files.push_back(fs::relative(entry.path(), folder).string());
  std::sort(files.begin(), files.end());
  return files;
}

// Our view of the file, beside it.
fs::path dumped(const fs::path& file) {
  fs::path dump = scratch() / (file.filename().string() + ".json");
  const Output done =
      run("{ " + places::programs() + "/dump_cad '" + file.string() + "' > '" + dump.string() + "'; }");
  EXPECT_EQ(done.exit_code, 0) << done.text;
  return dump;
}

Output compared(const fs::path& file, const fs::path& dump) {
  return run(places::python() + " -B " + places::tests() + "/formats/iges/iges_agree.py '" + file.string() +
             "' '" + dump.string() + "'");
}

void expect_agreement(const fs::path& file) {
  const Output verdict = compared(file, dumped(file));
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
}

std::string named(const testing::TestParamInfo<std::string>& chosen) {
  std::string name = chosen.param;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

class Fixtures : public testing::TestWithParam<std::string> {};
TEST_P(Fixtures, Agree) {
  expect_agreement(fixtures / GetParam());
}
INSTANTIATE_TEST_SUITE_P(, Fixtures, testing::ValuesIn(files_below(fixtures, {".igs", ".iges"})), named);

class Samples : public testing::TestWithParam<std::string> {};
TEST_P(Samples, Agree) {
  const fs::path file = scratch() / "sample.igs";
  const Output done = run(places::programs() + "/selvage convert --quiet '" + places::samples() + "/" +
                          GetParam() + "' -o '" + file.string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.text;
  expect_agreement(file);
}
INSTANTIATE_TEST_SUITE_P(, Samples, testing::ValuesIn(files_below(places::samples(), {".txt", ".wif"})),
                         named);

TEST(Agreement, OfSolids) {
  for (const char* ends : {"patch", "fan", "planar"}) {
    const fs::path file = scratch() / (std::string(ends) + ".igs");
    const Output done = run(places::programs() + "/selvage convert --quiet --iges-solid --ends " + ends +
                            " '" + places::samples() + "/plain4_path.txt' -o '" + file.string() + "'");
    ASSERT_EQ(done.exit_code, 0) << done.text;
    expect_agreement(file);
  }
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

// A fault in what we made of a file, and a word of the message that tells it.
struct Fault {
  const char *file, *find, *replacement, *says;
};

TEST(Agreement, FindsFaults) {
  for (const Fault& fault :
       {Fault{"iges/surfaces.igs", "\"reversed\":false", "\"reversed\":true", "exchanged"},
        {"iges/surfaces.igs", "\"level\":3", "\"level\":4", "level"},
        {"iges/surfaces.igs", "\"color\":[255,255,0]", "\"color\":[0,255,0]", "colour"},
        {"iges/surfaces.igs", "\"entity\":\"120 at D35\"", "\"entity\":\"120 at D39\"", "120"},
        {"iges/surfaces.igs", "\"units\":\"inch\"", "\"units\":\"mm\"", "apart"},
        {"iges/surfaces.igs", "\"degrees\":[3,2],\"counts\":[5,4],\"knots_u\":[0,0,0,0,1,",
         "\"degrees\":[3,2],\"counts\":[5,4],\"knots_u\":[0,0,0,0,1.5,", "128 at D3"},
        {"iges/curves.igs", "\"name\":\"an arc / a # and 3Hstring\"", "\"name\":\"an arc\"", "name"},
        {"iges/curves.igs", "\"entity\":\"100 at D15\"", "\"entity\":\"100 at D13\"", "100"},
        {"iges/trimmed.igs", "\"kind\":\"surfaces\"", "\"kind\":\"solid\"", "kind"},
        {"iges/trimmed.igs", "\"curve\":{\"degree\":1,\"knots\":[0,0,1,1],\"weights\":[],\"points\":[[1,1,1]",
         "\"curve\":{\"degree\":1,\"knots\":[0,0,1,1],\"weights\":[],\"points\":[[1,1.001,1]", "loop 0"},
        {"iges/subfigures.igs", "\"parts\":[", "\"parts\":[],\"left\":[", "ours has not"},
        {"iges/groups.igs", "\"name\":\"left\"", "\"name\":\"right\"", "name"}}) {
    const fs::path file = fixtures / fault.file;
    const fs::path dump = dumped(file);
    std::string text = contents(dump);
    const std::size_t at = text.find(fault.find);
    if (at == std::string::npos) {
      ADD_FAILURE() << fault.file << " has no " << fault.find;
      continue;
    }
    text.replace(at, std::string_view(fault.find).size(), fault.replacement);
    std::ofstream(dump, std::ios::binary) << text;
    const Output verdict = compared(file, dump);
    EXPECT_EQ(verdict.exit_code, 1) << fault.says << "\n" << verdict.text;
    EXPECT_NE(verdict.text.find(fault.says), std::string::npos) << fault.says << "\n" << verdict.text;
  }
}

}  // namespace
}  // namespace selvage::test
