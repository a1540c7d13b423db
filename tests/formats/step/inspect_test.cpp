// What is found in a STEP file before OpenCASCADE sees it: types and numbers of attributes, and how often the
// parts of assemblies occur.
#include "formats/step/inspect.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/graph.h"
#include "formats/step/entities.h"
#include "formats/step/entity_table.h"

namespace selvage::formats::step {
namespace {

std::string file_of(std::string_view statements) {
  return fmt::format(
      "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{}\nENDSEC;\nEND-ISO-"
      "10303-21;\n",
      statements);
}

// What is said of the statements, which begin in line 6, or nothing.
std::string complaint(std::string_view statements) {
  const Source source = Source::from_memory(file_of(statements), "a.stp");
  TextReport report(source);
  const bool is_fit = inspect(source, report).has_value();
  Diagnostics diagnostics;
  report.hand_over(diagnostics);
  EXPECT_EQ(is_fit, diagnostics.messages().empty());
  if (diagnostics.messages().empty()) return {};
  const Message& first = diagnostics.messages().front();
  return fmt::format("{}:{}: {}", first.place.line, first.place.column, first.text);
}

TEST(StepInspect, AnotherSchemaIsToldAndNothingElse) {
  std::string text = file_of("#1=LINE('');");
  text.replace(text.find("AUTOMOTIVE_DESIGN"), 17, "IFC4");
  const Source source = Source::from_memory(text, "a.stp");
  TextReport report(source);
  EXPECT_FALSE(inspect(source, report));
  Diagnostics diagnostics;
  report.hand_over(diagnostics);
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  const Message& message = diagnostics.messages().front();
  EXPECT_EQ(message.text,
            "a STEP file of the schema 'IFC4', not of AP203, AP214 or AP242; export it as one of these");
  EXPECT_EQ(message.place.line, 3);
}

constexpr std::string_view corner =
    "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=DIRECTION('',(1.,0.,0.));\n#3=VECTOR('',#2,1.);\n"
    "#4=LINE('',#1,#3);\n#5=VERTEX_POINT('',#1);\n";

std::string with_corner(std::string_view statement) {
  return complaint(fmt::format("{}{}", corner, statement));
}

TEST(StepInspect, TheTableIsWhole) {
  for (const EntityRow& row : entity_rows) {
    const Entity* const entity = find_entity(row.name);
    ASSERT_NE(entity, nullptr);
    EXPECT_EQ(entity->name, row.name) << "two rows of one name";
  }
  const auto number_of = [](std::string_view name) { return find_entity(name)->whole.size(); };
  // The numbers of parameters that examples of the standards show.
  EXPECT_EQ(number_of("EDGE_CURVE"), 5U);
  EXPECT_EQ(number_of("VERTEX_POINT"), 2U);
  EXPECT_EQ(number_of("EDGE_LOOP"), 2U);
  EXPECT_EQ(number_of("ORIENTED_EDGE"), 5U);
  EXPECT_EQ(number_of("ADVANCED_FACE"), 4U);
  EXPECT_EQ(number_of("B_SPLINE_SURFACE_WITH_KNOTS"), 13U);
  EXPECT_EQ(number_of("NEXT_ASSEMBLY_USAGE_OCCURRENCE"), 6U);
  EXPECT_EQ(number_of("SI_UNIT"), 3U);
  EXPECT_EQ(number_of("PRE_DEFINED_COLOUR"), 1U);
}

TEST(StepInspect, ReferencesToTheWrongTypeHaveTheirPlace) {
  EXPECT_EQ(with_corner("#6=EDGE_CURVE('',#5,#1,#4,.T.);"),
            "11:21: #6: attribute 3 of EDGE_CURVE is #1, a CARTESIAN_POINT, not VERTEX");
  EXPECT_EQ(with_corner("#6=LINE('',#1,#2);"),
            "11:15: #6: attribute 3 of LINE is #2, a DIRECTION, not VECTOR");
  EXPECT_EQ(with_corner("#6=TRIMMED_CURVE('',#4,(#1),\n(#2),.T.,.CARTESIAN.);"),
            "12:2: #6: attribute 4 of TRIMMED_CURVE is #2, a DIRECTION, not CARTESIAN_POINT");
  // In a part of a complex entity.
  EXPECT_EQ(
      with_corner("#6=(BOUNDED_CURVE()B_SPLINE_CURVE(1,(#1,#2),.UNSPECIFIED.,.F.,.F.)CURVE()"
                  "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,1.))REPRESENTATION_ITEM(''));"),
      "11:41: #6: attribute 2 of B_SPLINE_CURVE is #2, a DIRECTION, not CARTESIAN_POINT");
}

TEST(StepInspect, AttributesAreCountedAndOfTheirKind) {
  EXPECT_EQ(with_corner("#6=LINE('',#1);"), "11:8: #6: LINE has 2 attributes here, not 3");
  EXPECT_EQ(with_corner("#6=AXIS1_PLACEMENT();"), "11:19: #6: AXIS1_PLACEMENT has 0 attributes here, not 3");
  EXPECT_EQ(with_corner("#6=(BOUNDED_CURVE()B_SPLINE_CURVE(1,(#1,#1),.UNSPECIFIED.,.F.,.F.)CURVE()"
                        "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE()REPRESENTATION_ITEM(''));"),
            "11:128: #6: RATIONAL_B_SPLINE_CURVE has 0 attributes here, not 1");
  // Without its name OpenCASCADE makes nothing of it, and uses that.
  EXPECT_EQ(
      with_corner("#6=(BOUNDED_CURVE()B_SPLINE_CURVE(1,(#1,#1),.UNSPECIFIED.,.F.,.F.)CURVE()"
                  "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,1.))REPRESENTATION_ITEM());"),
      "11:156: #6: REPRESENTATION_ITEM has 0 attributes here, not 1");
  EXPECT_EQ(with_corner("#6=LINE('',$,#3);"),
            "11:12: #6: attribute 2 of LINE is '$', not a reference to CARTESIAN_POINT");
  EXPECT_EQ(with_corner("#6=CARTESIAN_POINT('',#1);"),
            "11:23: #6: attribute 2 of CARTESIAN_POINT is '#1', not a list");
  EXPECT_EQ(with_corner("#6=CARTESIAN_POINT('',(0.,#1));"),
            "11:27: #6: attribute 2 of CARTESIAN_POINT is '#1', not a number");
  EXPECT_EQ(with_corner("#6=EDGE_LOOP('',());"),
            "11:17: #6: attribute 2 of EDGE_LOOP is a list of 0, fewer than 1");
  EXPECT_EQ(with_corner("#6=DIRECTION('',(1.,0.,0.,0.));"),
            "11:17: #6: attribute 2 of DIRECTION is a list of 4, more than 3");
}

TEST(StepInspect, WhatIsRightOrUnknownIsLeftAlone) {
  EXPECT_EQ(with_corner(
                "#6=EDGE_CURVE('',#5,#5,#4,.T.);\n#7=ORIENTED_EDGE('',*,*,#6,.T.);\n#8=EDGE_LOOP('',(#7));"),
            "");
  EXPECT_EQ(with_corner("#6=EDGE_CURVE($,#5,#5,#4,.T.);\n#7=ORIENTED_EDGE('',#5,#5,#6,.T.);"), "");
  EXPECT_EQ(with_corner("#6=CIRCLE('',#7,1);\n#7=AXIS2_PLACEMENT_3D('',#1,$,$);"), "");
  EXPECT_EQ(
      with_corner("#6=TRIMMED_CURVE('',#4,(#1,PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.);"),
      "");
  EXPECT_EQ(with_corner("#6=CLOTHOID('',#1,2.);\n#7=EDGE_CURVE('',#5,#5,#6,.T.);"), "")
      << "a curve of another edition";
  EXPECT_EQ(with_corner("#6=WOVEN_EDGE(#1,(2,3),.X.);"), "");
  EXPECT_EQ(with_corner("#6=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
                        "#7=(CONVERSION_BASED_UNIT('DEGREE',#9)NAMED_UNIT(#8)PLANE_ANGLE_UNIT());\n"
                        "#8=DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.);\n"
                        "#9=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174),#10);\n"
                        "#10=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));"),
            "");
}

TEST(StepInspect, SchemasByOtherWritersNames) {
  for (const std::string_view schema :
       {"automotive_design", "ccd_cla_gvp_ast", "CONSTRUCTION_HISTORY_SCHEMA",
        "CONFIGURATION_CONTROL_3D_DESIGN_ED2_MIM_LF { 1 0 10303 403 1 1 4}"}) {
    std::string text = file_of(corner);
    text.replace(text.find("AUTOMOTIVE_DESIGN"), 17, schema);
    text.replace(text.find("HEADER"), 6, "Header");
    text += std::string(3, '\0');
    const Source source = Source::from_memory(text, "a.stp");
    TextReport report(source);
    EXPECT_TRUE(inspect(source, report)) << schema;
  }
}

// What is left out against the standard, where no shape depends on it, is told once.
TEST(StepInspect, WhatMayLackIsToldOnce) {
  const std::string text = file_of(
      "#1=COLOUR_RGB('',0.,0.,1.);\n#2=SURFACE_STYLE_RENDERING($,#1);\n#3=SURFACE_STYLE_RENDERING($,#1);\n"
      "#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
      "#5=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#4);");
  const Source source = Source::from_memory(text, "a.stp");
  TextReport report(source);
  EXPECT_TRUE(inspect(source, report));
  Diagnostics diagnostics;
  report.hand_over(diagnostics);
  ASSERT_EQ(diagnostics.messages().size(), 2U);
  EXPECT_EQ(diagnostics.messages()[0].place.line, 7);
  EXPECT_TRUE(
      diagnostics.messages()[0].text.starts_with("#2: attribute 1 of SURFACE_STYLE_RENDERING is '$'"));
  EXPECT_TRUE(diagnostics.messages()[1].text.starts_with(
      "#5: attribute 3 of UNCERTAINTY_MEASURE_WITH_UNIT is not there"));
  for (const Message& message : diagnostics.messages()) EXPECT_EQ(message.severity, Severity::warning);
  // Not where a shape depends on it.
  EXPECT_EQ(with_corner("#6=EDGE_CURVE('',#5,#5,#4,$);"),
            "11:27: #6: attribute 5 of EDGE_CURVE is '$', not a value between dots");
}

// Through what nobody translates: a note that names the callout in which it stands.
TEST(StepInspect, OnlyCirclesOfShapesHarm) {
  EXPECT_EQ(with_corner("#6=DIMENSION_TEXT_ASSOCIATIVITY('',#7);\n#7=DRAUGHTING_CALLOUT('',(#6));"), "");
  EXPECT_EQ(with_corner("#6=OFFSET_CURVE_3D('',#7,1.,.F.,#2);\n#7=OFFSET_CURVE_3D('',#6,1.,.F.,#2);"),
            "11:1: #6 refers to itself, by way of #7");
}

// Levels of assemblies, each with the one below it twice.
std::string doubling(int levels) {
  std::string text =
      "#1=APPLICATION_CONTEXT('');\n#2=PRODUCT_CONTEXT('',#1,'');\n#3=PRODUCT_DEFINITION_CONTEXT('',#1,'');\n"
      "#4=PRODUCT('','','',(#2));\n#5=PRODUCT_DEFINITION_FORMATION('','',#4);\n";
  for (int i = 0; i <= levels; ++i) text += fmt::format("#{}=PRODUCT_DEFINITION('','',#5,#3);\n", 100 + i);
  for (int i = 0; i < 2 * levels; ++i)
    text += fmt::format("#{}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{},#{},$);\n", 1000 + i, 101 + i / 2,
                        100 + i / 2);
  return text;
}

TEST(StepInspect, InstancesAreCountedBeforeTheyAreMade) {
  EXPECT_EQ(complaint(doubling(19)), "");
  EXPECT_EQ(complaint(doubling(40)),
            "11:1: #100: 1099511627776 instances of this product, more than 1000000");
  EXPECT_NE(complaint(doubling(400)).find("2.58224987808691e+120 instances"), std::string::npos);
  std::string mapped =
      "#1=REPRESENTATION_CONTEXT('','');\n#2=CARTESIAN_POINT('',(0.,0.,0.));\n"
      "#3=AXIS2_PLACEMENT_3D('',#2,$,$);\n#100=SHAPE_REPRESENTATION('',(#3),#1);\n";
  for (int i = 0; i < 30; ++i)
    mapped += fmt::format(
        "#{0}=REPRESENTATION_MAP(#3,#{1});\n#{2}=MAPPED_ITEM('',#{0},#3);\n#{3}=MAPPED_ITEM('',#{0},#3);\n"
        "#{4}=SHAPE_REPRESENTATION('',(#{2},#{3}),#1);\n",
        1000 + i, 100 + i, 2000 + i, 3000 + i, 101 + i);
  EXPECT_EQ(complaint(mapped), "9:1: #100: 1073741824 instances of this representation, more than 1000000");
}

TEST(StepInspect, WaysThroughAGraphAreCounted) {
  // A grid of 4 x 4 steps: binomial numbers.
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) {
      if (i < 4) edges.emplace_back(5 * i + k, 5 * (i + 1) + k);
      if (k < 4) edges.emplace_back(5 * i + k, 5 * i + k + 1);
    }
  const Graph grid = make_graph(25, edges);
  std::vector<std::size_t> order;
  ASSERT_TRUE(sort_from_leaves(grid, order).empty());
  EXPECT_EQ(count_ways(grid, order)[24], 70);
  edges.emplace_back(24, 0);
  EXPECT_FALSE(sort_from_leaves(make_graph(25, edges), order).empty());
}

}  // namespace
}  // namespace selvage::formats::step
