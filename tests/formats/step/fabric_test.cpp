// From the text to solids: the samples, and every section with every end, as OpenCASCADE judges and reads
// them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "built.h"
#include "formats/registry.h"
#include "places.h"
#include "reading.h"
#include "solid/brep.h"

namespace selvage {
namespace {

using yarn::EndStyle;
namespace fs = std::filesystem;

std::vector<yarn::Body> build(const Source& source, EndStyle ends) {
  Diagnostics diagnostics;
  const std::optional<fabric::Fabric> fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
  EXPECT_TRUE(fabric.has_value());
  fabric::BuildOptions options;
  options.ends = ends;
  return fabric ? test::built(*fabric, options) : std::vector<yarn::Body>{};
}

void expect_valid(const std::vector<yarn::Body>& bodies) {
  Result<std::vector<solid::BrepCheck>> verdicts = solid::check_breps(bodies);
  ASSERT_TRUE(verdicts.ok());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const solid::BrepCheck& verdict = (*verdicts)[i];
    EXPECT_TRUE(verdict.valid) << bodies[i].name;
    EXPECT_EQ(verdict.free_edges, 0) << bodies[i].name;
    EXPECT_NEAR(verdict.volume / bodies[i].volume, 1.0, 1e-6) << bodies[i].name;
    for (const Message& defect : verdict.defects) ADD_FAILURE() << to_string(defect);
  }
}

void expect_read_back(const std::vector<yarn::Body>& bodies) {
  std::string folder = (fs::temp_directory_path() / "selvage-fabric-XXXXXX").string();
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  const fs::path path = fs::path(folder) / "fabric.stp";
  Result<OutputFile> output = OutputFile::create(path);
  ASSERT_TRUE(output.ok());
  auto writer = formats::step::descriptor().open_bodies(*output, {});
  ASSERT_TRUE(writer.ok());
  for (const yarn::Body& body : bodies) {
    Status added = (*writer)->add(body);
    ASSERT_TRUE(added.ok()) << to_string(added.error());
  }
  ASSERT_TRUE((*writer)->finish().ok());
  ASSERT_TRUE(output->commit().ok());
  const tests::ReadFile read = tests::read_step(path.string());
  fs::remove_all(folder);
  ASSERT_EQ(read.parts.size(), bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_EQ(read.parts[i].name, bodies[i].name);
    EXPECT_TRUE(read.parts[i].valid && read.parts[i].is_solid) << bodies[i].name;
    EXPECT_EQ(read.parts[i].free_edges, 0) << bodies[i].name;
    EXPECT_NEAR(read.parts[i].volume / bodies[i].volume, 1.0, 1e-6) << bodies[i].name;
  }
}

TEST(StepFabric, Samples) {
  for (const char* name : {"plain4_grid", "plain4_path", "ring"})
    for (EndStyle style : {EndStyle::patch, EndStyle::fan}) {
      SCOPED_TRACE(name);
      Result<Source> source = Source::open(fs::path(places::samples()) / (std::string(name) + ".txt"));
      ASSERT_TRUE(source.ok());
      const std::vector<yarn::Body> bodies = build(*source, style);
      ASSERT_FALSE(bodies.empty());
      expect_valid(bodies);
      expect_read_back(bodies);
    }
}

// One bent yarn of each section; those with sharp edges (lenticular, polygon) make surfaces with creases.
const char* const every_section = R"(fabric 1
units mm
yarn circle
  section circle 0.5
  path
    0 0 0
    1 0 0.3
    2 0 0
  end
end
yarn ellipse
  section ellipse 0.8 0.3
  path
    0 2 0 0.8 0.3
    1 2 0.3 0.6 0.4 20
    2 2 0 0.8 0.3 0
  end
end
yarn lenticular
  section lenticular 0.8 0.3
  path
    0 4 0
    1 4 0.3
    2 4 0
  end
end
yarn racetrack
  section racetrack 0.8 0.3
  path
    0 6 0
    1 6 0.3
    2 6 0
  end
end
yarn boxy
  section power 0.8 0.3 0.5
  path
    0 8 0
    1 8 0.3
    2 8 0
  end
end
yarn lens
  section power 0.8 0.3 1.5
  path
    0 10 0
    1 10 0.3
    2 10 0
  end
end
yarn square
  section polygon
    -0.3 -0.2
    0.3 -0.2
    0.3 0.2
    -0.3 0.2
  end
  twist 250 Z rotate
  path
    0 12 0
    1 12 0.3
    2 12 0
  end
end
)";

TEST(StepFabric, EverySectionWithEveryEnd) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    SCOPED_TRACE(name_of(style));
    const std::vector<yarn::Body> bodies = build(Source::from_memory(every_section), style);
    ASSERT_EQ(bodies.size(), 7U);
    expect_valid(bodies);
    expect_read_back(bodies);
  }
}

}  // namespace
}  // namespace selvage
