// What valid texts mean: the model's fields, by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/txt/model_text.h"
#include "formats/txt/reading.h"
#include "places.h"

namespace selvage::test {

namespace {

using namespace fabric;

Fabric good(const std::string& text) {
  Reading reading = read(text);
  EXPECT_TRUE(reading.fabric) << reading.text();
  EXPECT_TRUE(reading.diagnostics.messages().empty()) << reading.text();
  return reading.fabric.value_or(Fabric{});
}

Fabric sample(const std::string& name) {
  Result<Source> source = Source::open(places::samples() + "/" + name);
  EXPECT_TRUE(source.ok());
  Reading reading = read(*source);
  EXPECT_TRUE(reading.fabric) << reading.text();
  EXPECT_TRUE(reading.diagnostics.messages().empty()) << reading.text();
  return reading.fabric.value_or(Fabric{});
}

template <class T>
const T& item(const Fabric& fabric, std::size_t index) {
  return std::get<T>(fabric.items.at(index));
}
const Path& path_of(const Fabric& fabric, std::size_t index = 0) {
  return std::get<Path>(item<Yarn>(fabric, index).shape);
}
const Grid& grid_of(const Fabric& fabric, std::size_t index = 0) {
  return std::get<Grid>(item<Yarn>(fabric, index).shape);
}

std::string yarn(const std::string& rows) {
  return "fabric 1\nyarn y\n path\n" + rows + "\n end\nend\n";
}

const std::string grid_rows = "0 0 0\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1\n";

}  // namespace

TEST(Reader, KnowsWhereItemsEnd) {
  const Fabric fabric = good(
      "fabric 1\nthread t\nend\nyarn a t\n path\n 0 0 0\n 1 0 0\n end\n\n up 0 0 1\nend # a\n# no\ntitle x\n"
      "weave\nwarp t 1 pitch 1\nweft t 1 pitch 1\ndraft\n1\nend\nend\nyarn b t\n path\n 0 1 0\n 1 1 0\n "
      "end\nend");
  EXPECT_EQ(fabric.item_ends, (std::vector<int>{11, 20, 26}));
}

TEST(Reader, Header) {
  const Fabric fabric = good("\n# first\nFABRIC 1 # version\nTitle \"a # b\"\nunits INCH\ntolerance 1e-3");
  EXPECT_EQ(fabric.title, "a # b");
  EXPECT_EQ(fabric.units, Unit::inch);
  EXPECT_TRUE(fabric.units_given);
  EXPECT_EQ(fabric.tolerance, 1e-3);
  EXPECT_EQ(fabric.file, "test.txt");
  const Fabric bare = good("fabric 1");
  EXPECT_EQ(bare.units, Unit::mm);
  EXPECT_FALSE(bare.units_given);
  EXPECT_FALSE(bare.title);
}

TEST(Reader, LineEndsBlanksAndBom) {
  const std::string text =
      "fabric 1\nthread t\n  tex 30 # x\n\nend\nyarn y t\n path\n 0 0 0\n 1 2 3 # row\n\n end\nend\n";
  const Fabric plain = good(text);
  std::string crlf, tabs, dense = text;
  for (char c : text) {
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
    tabs += c == ' ' ? "\t \t" : std::string(1, c);
  }
  dense.pop_back();
  for (const std::string& other :
       {crlf, tabs, dense, "\xEF\xBB\xBF" + text, crlf.substr(0, crlf.size() - 2) + "\r"})
    EXPECT_EQ(first_difference(plain, good(other)), "") << other;
}

TEST(Reader, Numbers) {
  const Fabric fabric =
      good(yarn("+1 -2 +0.5\n1e3 -1.5E-2 .25\n1. 1e-400 -1e-99999\n5e-324 1.7976931348623157e308 -0"));
  const std::vector<Vec3>& points = path_of(fabric).points;
  EXPECT_EQ(points[0], Vec3(1, -2, 0.5));
  EXPECT_EQ(points[1], Vec3(1000, -0.015, 0.25));
  EXPECT_EQ(points[2].y(), 0.0);
  EXPECT_TRUE(std::signbit(points[2].z()));
  EXPECT_EQ(points[2].z(), 0.0);
  EXPECT_EQ(points[3].x(), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(points[3].y(), std::numeric_limits<double>::max());
  EXPECT_TRUE(std::signbit(points[3].z()));
}

TEST(Reader, Thread) {
  const Fabric fabric = good(R"(fabric 1
thread "my yarn"
  Ne 19.7
  density 1.52
  packing 1
  diameter 0.1824
  section power 1.5 0.5 0.7
  twist 800 z rotate
  plies 3 450 S
  filaments 48
  color 200 205 0
  material cotton
end
thread b
  denier 270
  section circle
  twist 0 s
end
thread c
  section polygon
    -1 0   # corner
    1 0

    0 2
  end
  tex 7
end
material cotton
  density 1.54
  elastic transverse 230000 15000 0.2 24000 0.25
  strength transverse 2.5GPa 1500 60 200 90
  expansion 5.4e-6 -1e-6
end
material epoxy
  elastic isotropic 3400 0.35
  strength isotropic 80 120 60
  conductivity 0.2
  diffusivity 1e-12m2/s 4e-7
  permittivity 3.6 4.5
  interface
    stiffness 1e6 5e5
    strength 40MPa 60
    energy 0.2 0.8
  end
end
)");
  ASSERT_EQ(fabric.threads.size(), 3U);
  const Thread& a = fabric.threads[0];
  EXPECT_EQ(a.name, "my yarn");
  EXPECT_EQ(a.place.line, 2);
  EXPECT_EQ(a.linear_density, (LinearDensity{19.7, LinearDensity::Measure::ne}));
  EXPECT_EQ(a.density, 1.52);
  EXPECT_EQ(a.packing, 1.0);
  EXPECT_EQ(a.diameter, 0.1824);
  EXPECT_EQ(a.section, yarn::Section(yarn::Power{1.5, 0.5, 0.7}));
  EXPECT_EQ(a.twist, (Twist{800, Hand::z, true}));
  EXPECT_EQ(a.plies, (Plies{3, 450, Hand::s}));
  EXPECT_EQ(a.filaments, 48);
  EXPECT_EQ(a.color, (Color{200, 205, 0}));
  EXPECT_EQ(a.material, "cotton");
  EXPECT_EQ(fabric.threads[1].linear_density, (LinearDensity{270, LinearDensity::Measure::denier}));
  EXPECT_EQ(fabric.threads[1].section, yarn::Section(yarn::Circle{0}));
  EXPECT_EQ(fabric.threads[1].twist, (Twist{0, Hand::s, false}));
  EXPECT_EQ(fabric.threads[2].section, yarn::Section(yarn::Polygon{{{-1, 0}, {1, 0}, {0, 2}}}));
  EXPECT_EQ(fabric.threads[2].linear_density->value, 7);
  ASSERT_EQ(fabric.materials.size(), 2U);
  EXPECT_EQ(fabric.materials[0].density, 1.54);
  EXPECT_EQ(std::get<TransverseElastic>(fabric.materials[0].elastic),
            (TransverseElastic{230000, 15000, 0.2, 24000, 0.25}));
  EXPECT_EQ(std::get<TransverseStrength>(fabric.materials[0].strength),
            (TransverseStrength{2500, 1500, TransverseStrength::Across{60, 200, 90, 100}}));
  EXPECT_EQ(std::get<IsotropicStrength>(fabric.materials[1].strength), (IsotropicStrength{80, 120, 60}));
  EXPECT_EQ(fabric.materials[0].expansion, (Expansion{5.4e-6, -1e-6}));
  EXPECT_EQ(std::get<IsotropicElastic>(fabric.materials[1].elastic), (IsotropicElastic{3400, 0.35}));
  EXPECT_FALSE(fabric.materials[0].conductivity);
  EXPECT_EQ(fabric.materials[1].conductivity, (Transport{0.2, 0.2}));
  EXPECT_EQ(fabric.materials[1].diffusivity, (Transport{1e-6, 4e-7}));
  EXPECT_EQ(fabric.materials[1].permittivity, (Transport{3.6, 4.5}));
  EXPECT_FALSE(fabric.materials[0].interface);
  ASSERT_TRUE(fabric.materials[1].interface);
  EXPECT_EQ(fabric.materials[1].interface->stiffness, (Interface::Pair{1e6, 5e5}));
  EXPECT_EQ(fabric.materials[1].interface->strength, (Interface::Pair{40, 60}));
  EXPECT_EQ(fabric.materials[1].interface->energy, (Interface::Pair{0.2, 0.8}));
}

TEST(Reader, Sections) {
  const std::vector<std::pair<std::string, yarn::Section>> sections = {
      {"circle 2", yarn::Circle{2}},
      {"ellipse 2 1", yarn::Ellipse{2, 1}},
      {"lenticular 2 1", yarn::Lenticular{2, 1}},
      {"racetrack 2 1", yarn::Racetrack{2, 1}},
      {"power 2 1 3", yarn::Power{2, 1, 3}},
      {"loop7", yarn::Loop7{0}},
      {"LOOP7 0.5", yarn::Loop7{0.5}}};
  for (const auto& [text, section] : sections)
    EXPECT_EQ(good("fabric 1\nthread t\n section " + text + "\nend").threads[0].section, section) << text;
}

TEST(Reader, YarnWithItsOwnStatements) {
  const Fabric fabric = good(R"(fabric 1
yarn y1 late
  role Binder
  color 1 2 3
  section ellipse 2 1
  up 0 0 1
  tangent start 1 0 0
  tangent end 0 1 0
  path centripetal
    0 0 0
    1 0 0  2 1
    2 0 0  3 1.5  -400
  end
end
thread late
  tex 1
end
)");
  const Yarn& yarn = item<Yarn>(fabric, 0);
  EXPECT_EQ(yarn.name, "y1");
  EXPECT_EQ(yarn.place.line, 2);
  EXPECT_EQ(yarn.thread, "late");
  EXPECT_EQ(yarn.thread_place.line, 2);
  EXPECT_EQ(yarn.thread_place.column, 9);
  EXPECT_EQ(yarn.role, Role::binder);
  EXPECT_EQ(yarn.own.color, (Color{1, 2, 3}));
  EXPECT_EQ(yarn.own.name, "");
  EXPECT_EQ(yarn.up, Vec3(0, 0, 1));
  EXPECT_EQ(yarn.up_place.line, 6);
  EXPECT_EQ(yarn.tangent_start, Vec3(1, 0, 0));
  EXPECT_EQ(yarn.tangent_end, Vec3(0, 1, 0));
  const Path& path = path_of(fabric);
  EXPECT_EQ(path.form, yarn::PathForm::centripetal);
  ASSERT_EQ(path.sizes.size(), 3U);
  EXPECT_FALSE(path.sizes[0]);
  EXPECT_EQ(path.sizes[1], (SizeAt{2, 1, std::nullopt}));
  EXPECT_EQ(path.sizes[2], (SizeAt{3, 1.5, -400}));
}

TEST(Reader, FixedRows) {
  const Fabric fabric = good(
      "fabric 1\nyarn a\n  section circle 1\n  path\n    0 0 0\n    1 0 0 Fixed\n    2 0 0 1 1 fixed # "
      "stays\n"
      "    3 0 0 1 1 30 fixed\n    4 0 0\n  end\nend\n");
  EXPECT_EQ(path_of(fabric).fixed, (std::vector<bool>{false, true, true, true, false}));
  EXPECT_EQ(path_of(fabric).sizes[3], (SizeAt{1, 1, 30}));
  const Fabric free =
      good("fabric 1\nyarn a\n  section circle 1\n  path\n    0 0 0\n    1 0 0\n  end\nend\n");
  EXPECT_TRUE(path_of(free).fixed.empty());
}

TEST(Reader, PathForms) {
  const std::vector<std::pair<std::string, yarn::PathForm>> forms = {
      {"", yarn::PathForm::chord},
      {"chord", yarn::PathForm::chord},
      {"uniform", yarn::PathForm::uniform},
      {"centripetal", yarn::PathForm::centripetal},
      {"polyline", yarn::PathForm::polyline},
      {"control", yarn::PathForm::control},
      {"loop", yarn::PathForm::loop}};
  for (const auto& [word, form] : forms)
    EXPECT_EQ(path_of(good("fabric 1\nyarn y\npath " + word + "\n0 0 0\n1 0 0\nend\nend")).form, form);
}

TEST(Reader, SmoothPathsPointsAndHelices) {
  const Path smooth = path_of(good("fabric 1\nyarn y\npath smooth 0.02\n0 0 0\n1 0 0\nend\nend"));
  EXPECT_EQ(smooth.form, yarn::PathForm::smooth);
  EXPECT_EQ(smooth.error, 0.02);
  const Path knots =
      path_of(good("fabric 1\nyarn y\npath control\nknots 0 0 0 0 2 5 5 5 5\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n4 1 "
                   "0\nend\nend"));
  EXPECT_EQ(knots.knots, (std::vector<double>{0, 0, 0, 0, 2, 5, 5, 5, 5}));
  const Fabric fabric = good(
      "fabric 1\nunits mm\nyarn a\npoints \"my scan.csv\" yarn \"tow 1\" error 0.1\nend\n"
      "yarn b\nhelix radius 1cm pitch 2 turns 3.5 left start 90deg\nend\nyarn c\npoints scan.vtp\nend");
  const auto& points = std::get<PointsFile>(item<Yarn>(fabric, 0).shape);
  EXPECT_EQ(points.file, "my scan.csv");
  EXPECT_EQ(points.yarn, "tow 1");
  EXPECT_EQ(points.error, 0.1);
  const auto& helix = std::get<Helix>(item<Yarn>(fabric, 1).shape);
  EXPECT_EQ(helix.radius, 10.0);
  EXPECT_EQ(helix.pitch, 2.0);
  EXPECT_EQ(helix.turns, 3.5);
  EXPECT_TRUE(helix.is_left);
  EXPECT_EQ(helix.start, 90.0);
  EXPECT_EQ(std::get<PointsFile>(item<Yarn>(fabric, 2).shape).file, "scan.vtp");
}

TEST(Reader, LenosPuckersAndMandrels) {
  const std::string head = "fabric 1\nthread t\n diameter 0.2\nend\n";
  const Fabric fabric =
      good(head +
           "weave\nwarp t 4 pitch 1\nweft t 4 pitch 1\ndraft leno full\nend\n"
           "weave\nwarp t 4 pitch 1\nweft t 4 pitch 1\ndraft plain\n"
           "pucker tight 3 slack 5 ratio 1.1 every 6\nend\n"
           "braid\nthread t\ncarriers 8\npattern 1/1\nangle 30\nmandrel\n0 0 0 2\n0 0 9 3\nend\nend");
  EXPECT_EQ(item<Weave>(fabric, 0).draft.form, Draft::Form::leno);
  EXPECT_TRUE(item<Weave>(fabric, 0).draft.full_turns);
  const std::optional<Pucker>& pucker = item<Weave>(fabric, 1).pucker;
  ASSERT_TRUE(pucker.has_value());
  EXPECT_EQ(pucker->tight, 3);
  EXPECT_EQ(pucker->slack, 5);
  EXPECT_EQ(pucker->ratio, 1.1);
  EXPECT_EQ(pucker->picks, 6);
  const Braid& braid = item<Braid>(fabric, 2);
  ASSERT_EQ(braid.mandrel.size(), 2U);
  EXPECT_EQ(braid.mandrel[1].axis, Vec3(0, 0, 9));
  EXPECT_EQ(braid.mandrel[1].radius, 3.0);
}

TEST(Reader, StatesOfWeaves) {
  const auto state_of = [](const std::string& statements) {
    return item<Weave>(good("fabric 1\nthread t\n diameter 0.2\nend\nweave\nwarp t 4 pitch 1\n"
                            "weft t 4 pitch 1\ndraft plain\n" +
                            statements + "end\n"),
                       0)
        .state;
  };
  EXPECT_EQ(state_of(""), std::nullopt);
  EXPECT_EQ(state_of("state loom\n"), Weave::State::loom);
  EXPECT_EQ(state_of("STATE Relaxed # off the loom\n"), Weave::State::relaxed);
  EXPECT_EQ(state_of("crimp 0.3\nthickness 0.5\nspacing relaxed\nlayers 2\nstate finished\n"),
            Weave::State::finished);
}

TEST(Reader, ControlPointsMayCoincide) {
  EXPECT_EQ(
      path_of(good("fabric 1\nyarn y\npath control\n0 0 0\n1 0 0\n1 0 0\n2 0 0\nend\nend")).points.size(),
      4U);
}

TEST(Reader, LinesOfRows) {
  const Path consecutive = path_of(good(yarn("0 0 0\n1 0 0\n2 0 0")));
  EXPECT_EQ(consecutive.place.line, 3);
  EXPECT_TRUE(consecutive.lines.empty());
  const Path apart = path_of(good(yarn("0 0 0\n1 0 0\n\n# here\n2 0 0\n3 0 0")));
  EXPECT_EQ(apart.lines, (std::vector<int>{4, 5, 8, 9}));
  const Path late = path_of(good(yarn("# one\n0 0 0\n1 0 0")));
  EXPECT_EQ(late.lines, (std::vector<int>{5, 6}));
}

TEST(Reader, Grid) {
  const Fabric fabric = good("fabric 1\nyarn y\nclosed\ngrid 2 3\n" + grid_rows + "end\nend");
  const Grid& grid = grid_of(fabric);
  EXPECT_TRUE(item<Yarn>(fabric, 0).closed);
  EXPECT_EQ(grid.sections, 2);
  EXPECT_EQ(grid.per_section, 3);
  ASSERT_EQ(grid.points.size(), 6U);
  EXPECT_EQ(grid.points[4], Vec3(1, 1, 0));
  EXPECT_TRUE(grid.weights.empty());
  EXPECT_FALSE(grid.degree_along);
  EXPECT_FALSE(grid.closed_along);
}

TEST(Reader, GridWordsOnOneLineOrTheirOwn) {
  const std::string rows = "0 0 0 1\n0 1 0 0.5\n0 0 1\n0 0 0\n1 0 0\n1 1 0\n1 0 1\n1 0 0\n";
  const std::string one =
      "fabric 1\nyarn y\ngrid 2 4 degree 1 along degree 2 round knots along 0 0 1 1 knots round 0 0 0 1 2 2 "
      "2 open round "
      "closed\n";
  const std::string own =
      "fabric 1\nyarn y\ngrid 2 4\ndegree 1 along\nclosed\nDEGREE 2 round\nknots along 0 0 1 1 # ok\nopen "
      "round\n\n"
      "knots round 0 0 0 1 2 2 2\n";
  const Fabric fabric = good(one + rows + "end\nend");
  const Grid& grid = grid_of(fabric);
  EXPECT_EQ(grid.degree_along, 1);
  EXPECT_EQ(grid.degree_round, 2);
  EXPECT_EQ(grid.knots_along, (std::vector<double>{0, 0, 1, 1}));
  EXPECT_EQ(grid.knots_round, (std::vector<double>{0, 0, 0, 1, 2, 2, 2}));
  EXPECT_TRUE(grid.open_round);
  EXPECT_TRUE(grid.closed_along);
  EXPECT_EQ(grid.weights, (std::vector<double>{1, 0.5, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(first_difference(fabric, good(own + rows + "end\nend")), "");
}

TEST(Reader, Weave) {
  const Fabric fabric = good(R"(fabric 1
thread "w 1"
end
thread w2
end
weave
  weft w2 3 pitch 0.8
  warp "w 1",w2 , w2 4 pitch 1
  draft
    1 0
    01
  end
  layers 2
  profile Racetrack
end
weave
  warp w2 1 pitch 1
  weft w2 1 pitch 1
  draft satin 5/2
end
weave
  warp w2 1 pitch 1
  weft w2 1 pitch 1
  draft file drafts/x.wif
end
weave
  warp w2 1 pitch 1
  weft w2 1 pitch 1
  draft file "my draft.wif"
end
)");
  const Weave& weave = item<Weave>(fabric, 0);
  EXPECT_EQ(weave.warp.threads, (std::vector<std::string>{"w 1", "w2", "w2"}));
  EXPECT_EQ(weave.warp.count, 4);
  EXPECT_EQ(weave.weft.pitch, 0.8);
  EXPECT_EQ(weave.warp.place.line, 8);
  EXPECT_EQ(weave.draft.form, Draft::Form::rows);
  EXPECT_EQ(weave.draft.rows, (std::vector<std::string>{"10", "01"}));
  EXPECT_EQ(weave.layers, 2);
  EXPECT_EQ(weave.profile, Weave::Profile::racetrack);
  EXPECT_EQ(item<Weave>(fabric, 1).draft.a, 5);
  EXPECT_EQ(item<Weave>(fabric, 1).draft.b, 2);
  EXPECT_EQ(item<Weave>(fabric, 2).draft.file, "drafts/x.wif");
  EXPECT_EQ(item<Weave>(fabric, 3).draft.file, "my draft.wif");
}

TEST(Reader, KnitsAndBraid) {
  const Fabric fabric = good(R"(fabric 1
thread t
end
knit rib 2X1
  thread t
  courses 5
  wales 6
  method uniform
end
warpknit
  bar t 1-0/1-2/2-3/2-1//  # atlas
  bar t  1-0  1-2  Fall-Plate
  wales 10 pitch 1.5
  courses 12 pitch 0.5
  stitch open
end
warpknit queens-cord
  thread t
  wales 3 pitch 1
  courses 4 pitch 1
end
braid
  thread t
  carriers 16
  pattern 3/3
  radius 5
  angle 45.5
  length 20
  axial t 8
end
)");
  const Knit& knit = item<Knit>(fabric, 0);
  EXPECT_EQ(knit.form, Knit::Form::rib);
  EXPECT_EQ(knit.rib_a, 2);
  EXPECT_EQ(knit.rib_b, 1);
  EXPECT_EQ(knit.method, nurbs::Parameterization::uniform);
  const Warpknit& warpknit = item<Warpknit>(fabric, 1);
  ASSERT_EQ(warpknit.bars.size(), 2U);
  EXPECT_EQ(warpknit.bars[0].lapping, "1-0/1-2/2-3/2-1//");
  EXPECT_FALSE(warpknit.bars[0].fall_plate);
  EXPECT_EQ(warpknit.bars[1].lapping, "1-0  1-2");
  EXPECT_TRUE(warpknit.bars[1].fall_plate);
  EXPECT_EQ(warpknit.wales, 10);
  EXPECT_EQ(warpknit.wale_pitch, 1.5);
  EXPECT_EQ(warpknit.course_pitch, 0.5);
  EXPECT_EQ(warpknit.stitch, Warpknit::Stitch::open);
  EXPECT_EQ(item<Warpknit>(fabric, 2).classic, "queens-cord");
  const Braid& braid = item<Braid>(fabric, 3);
  EXPECT_EQ(braid.carriers, 16);
  EXPECT_EQ(braid.over, 3);
  EXPECT_EQ(braid.angle, 45.5);
  EXPECT_EQ(braid.axial_thread, "t");
  EXPECT_EQ(braid.axial_count, 8);
  EXPECT_EQ(braid.axial_place.line, 29);
  EXPECT_FALSE(braid.flat);
}

TEST(Reader, FlatBraids) {
  const std::string block =
      "fabric 1\nthread t\n  diameter 1\nend\nbraid\n  thread t\n  carriers 5\n  pattern 2/2\n  ";
  for (const double width : {0.0, 12.5}) {
    const Fabric fabric =
        good(block + (width > 0.0 ? "flat 12.5" : "Flat") + "\n  angle 30\n  length 20\nend\n");
    const Braid& braid = item<Braid>(fabric, 0);
    EXPECT_TRUE(braid.flat);
    EXPECT_EQ(braid.carriers, 5);
    EXPECT_EQ(braid.width, width);
    EXPECT_EQ(braid.carriers_place.line, 7);
    EXPECT_EQ(braid.carriers_place.column, 12);
    EXPECT_EQ(braid.radius_place.line, 9);
  }
}

TEST(Reader, EditsPieceAndCell) {
  const Fabric fabric = good(R"(fabric 1
edit y point 5 to 1.0 0.2 0.05
edit y weight 6 to 1 0.2 -0.05
edit y length 12.5 point 7 along 0 0 1
yarn y
  path
    0 0 0
    1 0 0
  end
end
piece back
  curve neck C
    0 0
    2 1
    4 1
  end
  curve side
    0 0
    2 1
    4 1
  end
  line hem 5 6 7 8
end
cell 2 0 0.3  0 2 -0.3
  matrix epoxy
  periodic Y x
end
material epoxy
end
)");
  ASSERT_EQ(fabric.edits.size(), 3U);
  EXPECT_EQ(fabric.edits[0].form, Edit::Form::point);
  EXPECT_EQ(fabric.edits[0].joint, 5);
  EXPECT_EQ(fabric.edits[0].target, Vec3(1, 0.2, 0.05));
  EXPECT_EQ(fabric.edits[1].form, Edit::Form::weight);
  EXPECT_EQ(fabric.edits[2].form, Edit::Form::length);
  EXPECT_EQ(fabric.edits[2].length, 12.5);
  EXPECT_EQ(fabric.edits[2].joint, 7);
  EXPECT_EQ(fabric.edits[2].direction, Vec3(0, 0, 1));
  const Piece& piece = item<Piece>(fabric, 1);
  ASSERT_EQ(piece.curves.size(), 3U);
  EXPECT_EQ(piece.curves[0].shape, PieceCurve::Shape::c);
  EXPECT_EQ(piece.curves[1].shape, PieceCurve::Shape::found);
  EXPECT_TRUE(piece.curves[2].is_line);
  EXPECT_EQ(piece.curves[2].points, (std::vector<Vec2>{{5, 6}, {7, 8}}));
  ASSERT_TRUE(fabric.cell);
  EXPECT_EQ(fabric.cell->low, Vec3(0, 0, -0.3));
  EXPECT_EQ(fabric.cell->high, Vec3(2, 2, 0.3));
  EXPECT_EQ(fabric.cell->matrix, "epoxy");
  EXPECT_TRUE(fabric.cell->periodic[0] && fabric.cell->periodic[1]);
  EXPECT_FALSE(fabric.cell->periodic[2]);
}

// The yarns of a construction get their names when it is built: an edit may name them.
TEST(Reader, EditsMayNameYarnsOfAConstruction) {
  const Fabric fabric = good(
      "fabric 1\nthread t\nend\nweave\nwarp t 1 pitch 1\nweft t 1 pitch 1\ndraft plain\nend\nedit warp_1 "
      "point 1 to 0 0 0\n");
  EXPECT_EQ(fabric.edits.size(), 1U);
}

TEST(Reader, Samples) {
  const Fabric grid = sample("plain4_grid.txt");
  ASSERT_EQ(grid.items.size(), 4U);
  EXPECT_EQ(grid_of(grid).points.size(), 256U);
  EXPECT_EQ(grid_of(grid).points[0], Vec3(-0.008008, 0.9, 0.018208));
  EXPECT_EQ(item<Yarn>(grid, 0).name, "warp1");
  EXPECT_EQ(path_of(sample("plain4_path.txt"), 2).points[1], Vec3(0, 0.5, -0.15));
  const Fabric ring = sample("ring.txt");
  EXPECT_TRUE(item<Yarn>(ring, 0).closed);
  EXPECT_EQ(ring.tolerance, 1e-5);
  EXPECT_EQ(item<Weave>(sample("twill_cell.txt"), 0).draft.form, Draft::Form::twill);
  EXPECT_EQ(item<Knit>(sample("jersey.txt"), 0).courses, 6);
  EXPECT_EQ(item<Braid>(sample("braid.txt"), 0).axial_count, 8);
  EXPECT_EQ(item<Warpknit>(sample("warpknit_satin.txt"), 0).bars[0].lapping, "1-0/3-4//");
  EXPECT_EQ(item<Piece>(sample("back_piece.txt"), 0).curves.size(), 6U);
}

TEST(Reader, ManyRowsTakeTheirMemoryOnce) {
  std::string text = "fabric 1\nyarn y\n path\n";
  for (int i = 0; i < 300000; ++i) text += std::to_string(i) + " 0 0.5\n";
  const Fabric fabric = good(text + " end\nend\nyarn z\n path\n0 0 0\n1 0 0\nend\nend\n");
  const std::vector<Vec3>& points = path_of(fabric).points;
  ASSERT_EQ(points.size(), 300000U);
  EXPECT_EQ(points.back().x(), 299999.0);
  EXPECT_LT(points.capacity(), 300010U);
}

TEST(Sniff, FirstStatement) {
  const auto sniff = formats::txt::descriptor().sniff;
  EXPECT_TRUE(sniff("fabric 1\nthread"));
  EXPECT_TRUE(sniff("\xEF\xBB\xBF# comment\r\n\r\n  FABRIC 2\r\n"));
  EXPECT_TRUE(sniff("fabric 1"));
  EXPECT_FALSE(sniff(""));
  EXPECT_FALSE(sniff("fabric"));
  EXPECT_FALSE(sniff("fabric softener\n"));
  EXPECT_FALSE(sniff("fabrics 1\n"));
  EXPECT_FALSE(sniff("ISO-10303-21;\n"));
  EXPECT_FALSE(sniff(std::string_view("\0\0\0\0", 4)));
}

}  // namespace selvage::test
