// Meshes in files, and the other programs that read them.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "formats/format.h"
#include "places.h"
#include "tetrahedra/mesher.h"
#include "unit/fem/bodies.h"

namespace selvage::test {

namespace fs = std::filesystem;

// A folder of the test's own, removed with all that is in it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "selvage-mesh-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
    path_ = name;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Runs a command in a folder; both of its outputs.
inline std::string run(const Folder& folder, const std::string& command) {
  std::FILE* pipe = ::popen(("cd '" + folder.path().string() + "' && " + command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return "";
  std::string output;
  std::array<char, 4096> block;
  for (std::size_t got = 0; (got = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    output.append(block.data(), got);
  ::pclose(pipe);
  return output;
}

inline std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline void save(const fem::Mesh& mesh, const formats::Descriptor& format, const fs::path& file) {
  Result<OutputFile> output = OutputFile::create(file);
  ASSERT_TRUE(output.ok()) << to_string(output.error());
  const Result<formats::WriteFacts> facts = format.write_mesh(mesh, *output, {});
  ASSERT_TRUE(facts.ok()) << to_string(facts.error());
  const Status committed = output->commit();
  ASSERT_TRUE(committed.ok()) << to_string(committed.error());
}

inline fem::Mesh mesh_of(const fabric::Fabric& fabric, const std::vector<yarn::Body>& bodies,
                         const fem::MeshOptions& options) {
  Diagnostics diagnostics;
  Result<fem::Mesh> mesh = fem::mesh_yarns(fabric, bodies, fabric.units, options, diagnostics);
  if (!mesh) {
    ADD_FAILURE() << to_string(mesh.error());
    return {};
  }
  return std::move(*mesh);
}

// CalculiX on a deck NAME.inp in the folder; its .dat. It exits with 0 whatever happens: its words tell.
inline std::string solve(const Folder& folder, const std::string& name, bool may_warn = true) {
  const std::string words = run(folder, places::ccx() + " " + name);
  if (!may_warn) {
    EXPECT_EQ(words.find("*WARNING"), std::string::npos) << words;
  }
  EXPECT_NE(words.find("Job finished"), std::string::npos) << words;
  EXPECT_EQ(words.find("*ERROR"), std::string::npos) << words;
  EXPECT_EQ(words.find("nonpositive jacobian"), std::string::npos) << words;
  return text_of(folder / (name + ".dat"));
}

inline std::string solve_without_warning(const Folder& folder, const std::string& name) {
  return solve(folder, name, false);
}

// Adds the stresses of all elements to what each step of a deck prints.
inline void ask_for_stresses(const fs::path& deck) {
  std::string text = text_of(deck);
  const std::string end = "*END STEP", wish = "*EL PRINT, ELSET=All\nS\n";
  for (std::size_t at = text.find(end); at != std::string::npos; at = text.find(end, at + wish.size() + 1))
    text.insert(at, wish);
  std::ofstream(deck) << text;
}

// Stresses xx, yy, zz, xy, xz, yz at all integration points, step by step, from a .dat.
inline std::vector<std::vector<std::array<double, 6>>> stresses_by_step(const std::string& dat) {
  std::vector<std::vector<std::array<double, 6>>> steps;
  std::istringstream lines(dat);
  bool is_inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("stresses (elem") != std::string::npos) {
      steps.emplace_back();
      is_inside = true;
      continue;
    }
    if (!is_inside || line.empty()) continue;
    std::istringstream row(line);
    std::size_t element = 0, point = 0;
    std::array<double, 6> s{};
    if (row >> element >> point >> s[0] >> s[1] >> s[2] >> s[3] >> s[4] >> s[5])
      steps.back().push_back(s);
    else
      is_inside = false;
  }
  return steps;
}

// "total force (fx,fy,fz) for set NAME": the three numbers under it.
inline Vec3 total_force(const std::string& dat, const std::string& set) {
  const std::size_t at = dat.find("total force (fx,fy,fz) for set " + set + " ");
  EXPECT_NE(at, std::string::npos) << "no force of " << set;
  if (at == std::string::npos) return Vec3::Zero();
  std::istringstream numbers(dat.substr(dat.find('\n', at)));
  Vec3 force = Vec3::Zero();
  numbers >> force.x() >> force.y() >> force.z();
  return force;
}

}  // namespace selvage::test
