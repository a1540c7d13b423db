// Every kind of bad input: exactly these errors, each at its line and column.
#include <gtest/gtest.h>

#include "formats/txt/expected_errors.h"

namespace selvage::test {

namespace {

struct Case {
  const char* name;
  std::string text;
  std::vector<Expected> errors;
};

std::ostream& operator<<(std::ostream& out, const Case& one) {
  return out << one.name;
}

// The text proper begins on line 5.
std::string with_thread(const std::string& rest) {
  return "fabric 1\nthread t\n  diameter 0.2\nend\n" + rest;
}
std::string in_thread(const std::string& line) {
  return "fabric 1\nthread t\n" + line + "\nend\n";
}
std::string in_material(const std::string& line) {
  return "fabric 1\nmaterial m\n" + line + "\nend\n";
}
// `line` is line 6.
std::string in_yarn(const std::string& line) {
  return with_thread("yarn y t\n" + line + "\nend\n");
}
// `rows` begin on line 7.
std::string in_path(const std::string& rows) {
  return with_thread("yarn y t\n  path\n" + rows + "\n  end\nend\n");
}
std::string in_grid(const std::string& rows) {
  return with_thread("yarn y t\n  grid 2 3\n" + rows + "\n  end\nend\n");
}
const std::string six_rows = "0 0 0\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1";
// `chart` is line 8.
std::string chart(const std::string& rows) {
  return with_thread("knit\n thread t\n courses 3\n chart\n" + rows + "\n end\n wales 3\nend\n");
}

// `draft` is line 8.
std::string weave(std::string draft, std::string extra = "") {
  return with_thread("weave\n  warp t 4 pitch 1\n  weft t 4 pitch 1\n  " + draft + "\n" + extra + "end\n");
}
// `line` stands instead of the statement that begins with its first word; the block begins on line 5.
std::string braid(const std::string& line) {
  std::string text = "braid\n";
  for (const char* other : {"thread t", "carriers 16", "pattern 2/2", "radius 5", "angle 45", "length 20"}) {
    const std::string statement = other;
    const bool replaced = line.substr(0, line.find(' ')) == statement.substr(0, statement.find(' '));
    text += "  " + (replaced ? line : statement) + "\n";
  }
  return with_thread(text + "end\n");
}

class BadInput : public testing::TestWithParam<Case> {};

}  // namespace

TEST_P(BadInput, EveryErrorAtItsPlace) {
  expect_errors(read(GetParam().text), GetParam().errors);
}

// More than the first look at the file sees.
const std::string late = "fabric 1\n#" + std::string(5000, '.') + "\n";

const std::vector<Case> lexical_cases = {
    {"empty", "", {{1, 1, "the file is empty"}}},
    {"only_comments", "# nothing\n\n", {{1, 1, "no statement"}}},
    {"only_bom", "\xEF\xBB\xBF", {{1, 1, "no statement"}}},
    {"utf16",
     std::string("\xFF\xFE"
                 "f\0a\0b\0",
                 8),
     {{1, 1, "UTF-16"}}},
    {"binary",
     std::string("\x7F"
                 "ELF\x02\x01\0\0\n\n",
                 10),
     {{1, 1, "not a text file"}}},
    {"control_in_second_line", "fabric 1\nti\x01tle\n", {{2, 3, "not a text file"}}},
    {"nul_late",
     late + "thread " + std::string(1, '\0') + "t\nend\n",
     {{3, 8, "control character (byte 0)"}}},
    {"nul_in_late_comment",
     late + "# a" + std::string(1, '\0') + "\nbad\n",
     {{3, 4, "control character (byte 0)"}}},
    {"latin1_name", "fabric 1\nthread \"gr\xFCn\"\nend\n", {{2, 11, "not UTF-8"}}},
    {"latin1_word",
     "fabric 1\nthread t\n gr\xF6\xDF"
     "e 1\nend\n",
     {{3, 4, "not UTF-8"}}},
    {"lone_cr", "fabric 1\nthread t\r  tex 3\rend\n", {{2, 9, "carriage return"}}},
    {"no_header", "thread t\nend\n", {{1, 1, "'fabric 1'"}}},
    {"no_header_but_more_errors",
     "thread t\n  tex 0\nend\n",
     {{1, 1, "'fabric 1'"}, {2, 7, "larger than 0"}}},
    {"other_text", "Dear Sir,\nI write to you\nabout yarn\n", {{1, 1, "'fabric 1'"}}},
    {"misspelt_header",
     "fabrik 1\nthread t\n tex x\nend\n",
     {{1, 1, "did you mean 'fabric'"}, {3, 6, "not a number"}}},
    {"version_2", "fabric 2\nwhatever new\n", {{1, 8, "version 2"}}},
    {"version_0", "fabric 0\n", {{1, 8, "1 or more"}}},
    {"version_missing", "fabric\n", {{1, 7, "missing"}}},
    {"version_word", "fabric one\n", {{1, 8, "not a number"}}},
    {"version_1_5", "fabric 1.5\n", {{1, 8, "whole number"}}},
    {"header_twice", "fabric 1\nfabric 1\n", {{2, 1, "first statement"}}},
    {"units_unknown", "fabric 1\nunits furlong\n", {{2, 7, "unknown unit 'furlong'"}}},
    {"units_near", "fabric 1\nunits inc\n", {{2, 7, "did you mean 'inch'"}}},
    {"units_twice", "fabric 1\nunits mm\nunits cm\n", {{3, 1, "first on line 2"}}},
    {"title_unquoted", "fabric 1\ntitle Plain weave\n", {{2, 13, "nothing more"}}},
    {"quote_open", "fabric 1\ntitle \"Plain\nunits mm\n", {{2, 7, "quote is not closed"}}},
    {"quote_glued", "fabric 1\nthread \"a\"b\nend\n", {{2, 11, "blank"}}},
    {"name_empty", "fabric 1\nthread \"\"\nend\n", {{2, 8, "empty name"}}},
    {"name_missing", "fabric 1\nthread\nend\n", {{2, 7, "missing"}}},
    {"name_number", "fabric 1\nthread 3a\nend\n", {{2, 8, "not a name"}}},
    {"name_umlaut", "fabric 1\nthread Gr\xC3\xBCn\nend\n", {{2, 8, "not a name"}}},
    {"tolerance_zero", "fabric 1\ntolerance 0\n", {{2, 11, "larger than 0"}}},
    {"trailing", "fabric 1\nunits mm cm\n", {{2, 10, "nothing more"}}},
    {"trailing_end", "fabric 1\nthread t\nend thread\n", {{3, 5, "nothing more"}}},
    {"stray_end", "fabric 1\nend\nunits mm\n", {{2, 1, "without a block"}}},
    {"last_line_without_newline", "fabric 1\nunits", {{2, 6, "missing"}}},
    {"crlf", "fabric 1\r\nthread t\r\n  tex x\r\nend\r\n", {{3, 7, "not a number"}}},
    {"bom_column",
     "\xEF\xBB\xBF"
     "fabric x\n",
     {{1, 8, "not a number"}}},
    {"tab_is_one_column", "fabric 1\nthread t\n\t\ttex x\nend\n", {{3, 7, "not a number"}}},
};

const std::vector<Case> number_cases = {
    {"comma",
     in_thread("tex 1,5"),
     {{3, 5, "a decimal comma in '1,5': the decimal mark is the point, write 1.5"}}},
    {"comma_signed", in_material("expansion -1,5e-3 1"), {{3, 11, "write -1.5e-3"}}},
    {"commas", in_path("0,0,0\n1 0 0\n2 0 0"), {{7, 1, "separated by blanks"}}},
    {"semicolons", in_path("0;0;0\n1 0 0\n2 0 0"), {{7, 1, "not a number"}}},
    {"nan", in_thread("diameter nan"), {{3, 10, "not a finite number"}}},
    {"minus_inf", in_thread("diameter -inf"), {{3, 10, "not a finite number"}}},
    {"infinity", in_thread("diameter +Infinity"), {{3, 10, "not a finite number"}}},
    {"nan_row", in_path("nan 0 0\n1 0 0\n2 0 0"), {{7, 1, "not a finite number"}}},
    {"inf_in_row", in_path("0 0 0\n1 inf 0\n2 0 0"), {{8, 3, "not a finite number"}}},
    {"overflow", in_thread("diameter 1e999"), {{3, 10, "too large"}}},
    {"overflow_long", in_thread("diameter 1" + std::string(400, '0')), {{3, 10, "too large"}}},
    {"unit_glued", in_thread("diameter 0.2furlong"), {{3, 10, "'furlong' is no unit"}}},
    {"two_signs", in_thread("diameter +-1"), {{3, 10, "not a number"}}},
    {"plus_alone", in_thread("diameter +"), {{3, 10, "not a number"}}},
    {"hex", in_thread("diameter 0x1p3"), {{3, 10, "not a number"}}},
    {"missing_value", in_thread("diameter"), {{3, 9, "missing"}}},
    {"missing_before_comment", in_thread("diameter   # none"), {{3, 9, "missing"}}},
    {"count_fraction", in_thread("filaments 4.5"), {{3, 11, "whole number"}}},
    {"count_point", in_thread("filaments 4."), {{3, 11, "whole number"}}},
    {"count_zero", in_thread("filaments 0"), {{3, 11, "1 or more"}}},
    {"count_huge", in_thread("filaments 99999999999999999999"), {{3, 11, "from 1 to 2147483647"}}},
};

const std::vector<Case> thread_cases = {
    {"misspelt", in_thread("diametr 0.2"), {{3, 1, "did you mean 'diameter'"}}},
    {"misspelt_and_wrong", in_thread("diametr 0,2"), {{3, 1, "did you mean"}, {3, 9, "decimal comma"}}},
    {"unknown", in_thread("xyzzy 0.2"), {{3, 1, "known: tex, dtex"}}},
    {"given_twice", in_thread("tex 1\ntex 2"), {{4, 1, "given twice in thread 't'; first on line 3"}}},
    {"two_densities", in_thread("tex 1\nNe 2"), {{4, 1, "given twice"}}},
    {"tex_negative", in_thread("tex -3"), {{3, 5, "larger than 0"}}},
    {"packing_above", in_thread("packing 1.01"), {{3, 9, "larger than 1"}}},
    {"packing_zero", in_thread("packing 0"), {{3, 9, "larger than 0"}}},
    {"packing_tiny", in_thread("packing 1e-30"), {{3, 9, "a packing of 1e-30 of the section"}}},
    {"packing_percent", in_thread("packing 75"), {{3, 9, "larger than 1"}}},
    {"diameter_zero", in_thread("diameter 0"), {{3, 10, "larger than 0"}}},
    {"section_unknown", in_thread("section elipse 1 2"), {{3, 9, "did you mean 'ellipse'"}}},
    {"section_missing", in_thread("section"), {{3, 8, "missing"}}},
    {"section_zero", in_thread("section ellipse 0 1"), {{3, 17, "larger than 0"}}},
    {"section_negative", in_thread("section racetrack 1 -1"), {{3, 21, "larger than 0"}}},
    {"section_one_size", in_thread("section lenticular 1"), {{3, 21, "height is missing"}}},
    {"section_circle_zero", in_thread("section circle 0"), {{3, 16, "larger than 0"}}},
    {"power_exponent", in_thread("section power 1 1 0"), {{3, 19, "exponent"}}},
    {"polygon_two", in_thread("section polygon\n0 0\n1 1\nend"), {{6, 1, "at least 3 corners"}}},
    {"polygon_flat", in_thread("section polygon\n0 0\n1 1\n2 2\nend"), {{3, 9, "area is 0"}}},
    {"polygon_repeats", in_thread("section polygon\n0 0\n1 0\n0 1\n0 0\nend"), {{7, 1, "leave it out"}}},
    {"polygon_double",
     in_thread("section polygon\n0 0\n1 0\n1 0\n0 1\nend"),
     {{6, 1, "equals the one before"}}},
    {"polygon_one_value", in_thread("section polygon\n0 0\n1\n1 0\n0 1\nend"), {{5, 2, "two coordinates"}}},
    {"polygon_three_values",
     in_thread("section polygon\n0 0\n1 2 3\n1 0\n0 1\nend"),
     {{5, 5, "more than 2 values"}}},
    {"twist_hand", in_thread("twist 800 X"), {{3, 11, "unknown twist direction 'X'"}}},
    {"twist_hand_missing", in_thread("twist 800"), {{3, 10, "missing"}}},
    {"twist_negative", in_thread("twist -800 Z"), {{3, 7, "0 or larger"}}},
    {"twist_word", in_thread("twist 800 Z rotates"), {{3, 13, "'rotate' is expected"}}},
    {"plies_none", in_thread("plies 0 100 S"), {{3, 7, "1 or more"}}},
    {"color_256", in_thread("color 0 256 0"), {{3, 9, "from 0 to 255"}}},
    {"color_negative", in_thread("color -1 0 0"), {{3, 7, "from 0 to 255"}}},
    {"color_two", in_thread("color 1 2"), {{3, 10, "missing"}}},
    {"unknown_material", in_thread("material unobtainium"), {{3, 10, "unknown material 'unobtainium'"}}},
    {"near_material",
     in_material("density 1") +
         "thread t\n  material n\nend\nmaterial nylon\nend\nthread u\n material nylom\nend\n",
     {{6, 12, "unknown material 'n'"}, {11, 11, "did you mean 'nylon'"}}},
    {"name_twice", in_thread("tex 1") + "thread t\nend\n", {{5, 8, "used twice; first on line 2"}}},
    {"material_twice",
     in_material("density 1") + "material m\nend\n",
     {{5, 10, "used twice; first on line 2"}}},
    {"elastic_law", in_material("elastic orthotropic 1"), {{3, 9, "unknown elastic law"}}},
    {"isotropic_nu", in_material("elastic isotropic 70 0.5"), {{3, 22, "between -1 and 0.5"}}},
    {"isotropic_e", in_material("elastic isotropic 0 0.3"), {{3, 19, "larger than 0"}}},
    {"transverse_short", in_material("elastic transverse 1 1 0.2 1"), {{3, 29, "nu23 is missing"}}},
    {"transverse_nu12", in_material("elastic transverse 1 9 0.4 1 0.2"), {{3, 24, "nu12"}}},
    {"transverse_nu23", in_material("elastic transverse 2 1 0.2 1 0.99"), {{3, 30, "nu23"}}},
    {"missing_end",
     "fabric 1\nthread t\n  tex 1\nthread u\nend\n",
     {{4, 1, "thread 't', opened on line 2, is still open before 'thread'"}}},
    {"missing_end_at_eof", "fabric 1\nthread t\n  tex 1\n\n", {{5, 1, "still open at the end of the file"}}},
    {"missing_end_no_newline", "fabric 1\nthread t\n  tex 1", {{3, 8, "still open at the end of the file"}}},
    {"misspelt_end",
     "fabric 1\nthread t\n  tex 1\nedn\nunits furlong\n",
     {{4, 1, "did you mean 'end'"}, {5, 7, "unknown unit"}}},
    {"missing_end_then_same_word",
     "fabric 1\nthread t\n  tex 1\n  material m\n\nmaterial m\n  density 2\nend\n",
     {{6, 1, "thread 't', opened on line 2, is still open"}}},
};

const std::vector<Case> yarn_cases = {
    {"unknown_thread",
     "fabric 1\nyarn y nothread\n path\n0 0 0\n1 0 0\n end\nend\n",
     {{2, 8, "this file defines no thread"}}},
    {"near_thread",
     in_path("0 0 0\n1 0 0") + "thread cotton\nend\nyarn z coton\n path\n0 0 0\n1 0 0\nend\nend\n",
     {{13, 8, "unknown thread 'coton'; did you mean 'cotton'?"}}},
    {"name_twice",
     in_path("0 0 0\n1 0 0") + "yarn y\n path\n0 0 0\n1 0 0\nend\nend\n",
     {{11, 6, "used twice; first on line 5"}}},
    {"no_shape", in_yarn("role warp"), {{7, 1, "yarn 'y' ends without its 'path' or 'grid'"}}},
    {"two_shapes", in_path("0 0 0\n1 0 0\nend\npath\n1 0 0\n2 0 0"), {{10, 1, "given twice"}}},
    {"role", in_yarn("role wrap\npath\n0 0 0\n1 0 0\nend"), {{6, 6, "did you mean 'warp'"}}},
    {"path_form", in_yarn("path chrod\n0 0 0\n1 0 0\nend"), {{6, 6, "did you mean 'chord'"}}},
    {"path_form_unknown", in_yarn("path wiggly\n0 0 0\n1 0 0\nend"), {{6, 6, "unknown form of path"}}},
    {"path_one_row", in_path("0 0 0"), {{8, 3, "at least 2 rows; this one has 1"}}},
    {"path_no_row", in_path(""), {{8, 3, "at least 2 rows; this one has 0"}}},
    {"equal_points", in_path("0 0 0\n0 0 0"), {{8, 1, "equals the one before"}}},
    {"equal_points_late",
     in_path("0 0 0\n1 0 0\n# between\n\n 1 0 -0.0\n2 0 0"),
     {{11, 2, "equals the one before"}}},
    {"control_without_length", in_yarn("path control\n1 0 0\n1 0 0\nend"), {{8, 1, "no length"}}},
    {"two_values", in_path("0 0 0\n1 0\n2 0 0"), {{8, 4, "this one has 2 values"}}},
    {"one_value_comment", in_path("0 0 0\n1 # x\n2 0 0"), {{8, 2, "this one has 1 value"}}},
    {"four_values", in_path("0 0 0\n1 0 0 5\n2 0 0"), {{8, 8, "this one has 4 values"}}},
    {"fixed_and_more", in_path("0 0 0\n1 0 0 fixed 3\n2 0 0"), {{8, 13, "nothing more is expected"}}},
    {"fixed_without_z", in_path("0 0 0\n1 0 fixed\n2 0 0"), {{8, 5, "this one has 2 values"}}},
    {"seven_values_fixed", in_path("0 0 0\n1 0 0 1 1 0 9 fixed\n2 0 0"), {{8, 13, "more than 6 values"}}},
    {"seven_values", in_path("0 0 0\n1 0 0 1 1 0 9\n2 0 0"), {{8, 13, "more than 6 values"}}},
    {"size_zero", in_path("0 0 0 1 1\n1 0 0 0 1\n2 0 0"), {{8, 1, "larger than 0"}}},
    {"size_negative", in_path("0 0 0 1 -1\n1 0 0\n2 0 0"), {{7, 1, "larger than 0"}}},
    {"bad_rows_do_not_cascade",
     in_path("x 0 0\n1 O 0"),
     {{7, 1, "unknown word 'x'"}, {8, 3, "'O' is not a number"}, {9, 3, "this one has 1"}}},
    {"closed_two", in_yarn("closed\npath\n0 0 0\n1 0 0\nend"), {{7, 1, "at least 3 rows"}}},
    {"closed_repeats", in_yarn("path\n0 0 0\n1 0 0\n1 1 0\n0 0 0\nend\nclosed"), {{10, 1, "leave it out"}}},
    {"up_zero", in_yarn("up 0 0 0\npath\n0 0 0\n1 0 0\nend"), {{6, 4, "no direction"}}},
    {"up_short", in_yarn("up 0 1\npath\n0 0 0\n1 0 0\nend"), {{6, 7, "missing"}}},
    {"tangent_zero", in_yarn("tangent start 0 -0 0\npath\n0 0 0\n1 0 0\nend"), {{6, 15, "no direction"}}},
    {"tangent_where",
     in_yarn("tangent middle 1 0 0\npath\n0 0 0\n1 0 0\nend"),
     {{6, 9, "known: start, end"}}},
    {"tangent_twice",
     in_yarn("tangent end 1 0 0\ntangent end 1 0 0\npath\n0 0 0\n1 0 0\nend"),
     {{7, 1, "given twice"}}},
    {"path_end_missing",
     with_thread("yarn y t\n  path\n    0 0 0\n    1 0 0\n  role warp\nend\n"),
     {{9, 3, "'path', opened on line 6, is still open before 'role'"}}},
    {"both_ends_missing",
     with_thread("yarn y t\n  path\n    0 0 0\n    1 0 0\nyarn z t\n path\n0 0 0\n1 0 0\nend\nend\n"),
     {{9, 1, "'path', opened on line 6"}}},
    {"both_ends_missing_at_eof",
     with_thread("yarn y t\n  path\n    0 0 0\n    1 0 0\n"),
     {{9, 1, "'path', opened on line 6, is still open at the end"}}},
    {"yarn_end_missing",
     with_thread("yarn y t\n  path\n    0 0 0\n    1 0 0\nend\nyarn z t\n path\n0 0 0\n1 0 0\nend\nend\n"),
     {{10, 1, "yarn 'y', opened on line 5"}}},
};

const std::vector<Case> grid_cases = {
    {"too_few", in_grid("0 0 0\n0 1 0\n0 0 1\n1 0 0\n1 1 0"), {{12, 3, "has 6 rows; this one ends after 5"}}},
    {"too_many", in_grid(six_rows + "\n9 9 9\n9 9 8"), {{13, 1, "a row too many"}}},
    {"one_section", in_yarn("grid 1 3\n0 0 0\n0 1 0\n0 0 1\nend"), {{6, 6, "at least 2 sections"}}},
    {"no_section", in_yarn("grid 0 3\nend"), {{6, 6, "1 or more"}}},
    {"two_round", in_yarn("grid 2 2\n0 0 0\n0 1 0\n1 0 0\n1 1 0\nend"), {{6, 8, "at least 3 points round"}}},
    {"counts_missing", in_yarn("grid\n0 0 0\nend"), {{6, 5, "missing"}}},
    {"counts_beyond_the_file",
     in_yarn("grid 2000000000 2000000000\n0 0 0\n0 1 0\nend"),
     {{9, 1, "has 4000000000000000000 rows; this one ends after 2"}}},
    {"count_overflow", in_yarn("grid 99999999999 3\n0 0 0\nend"), {{6, 6, "from 1 to"}}},
    {"weight_zero",
     in_grid("0 0 0 1\n0 1 0 0\n0 0 1 1\n1 0 0 1\n1 1 0 1\n1 0 1 1"),
     {{8, 7, "weight has to be larger than 0"}}},
    {"weight_negative", in_grid("0 0 0 -2\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1"), {{7, 7, "weight"}}},
    {"five_values", in_grid("0 0 0 1 1\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1"), {{7, 9, "more than 4 values"}}},
    {"two_values", in_grid("0 0 0\n0 1\n0 0 1\n1 0 0\n1 1 0\n1 0 1"), {{8, 4, "this one has 2 values"}}},
    {"bad_number_does_not_cascade",
     in_grid("0 0 0\n0 1,0 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1"),
     {{8, 3, "decimal comma"}}},
    {"section_without_size",
     in_grid("0 0 0\n0 1 0\n0 0 1\n1 0 0\n1 0 0\n1 0 0"),
     {{12, 1, "section 2 has no size"}}},
    {"no_length", in_grid("0 0 0\n0 1 0\n0 0 1\n0 0 0\n0 1 0\n0 0 1"), {{6, 3, "no length"}}},
    {"degree_zero", in_grid("degree 0 along\n" + six_rows), {{7, 8, "from 1 to 25"}}},
    {"degree_high",
     in_grid("degree 2 along\n" + six_rows),
     {{6, 3, "degree 2 along needs more than 2 sections"}}},
    {"degree_round_high",
     in_grid("degree 4 round\n" + six_rows),
     {{6, 3, "degree 4 round needs more than 3 points"}}},
    {"degree_where", in_grid("degree 1 across\n" + six_rows), {{7, 10, "known: along, round"}}},
    {"degree_twice", in_grid("degree 1 along degree 1 along\n" + six_rows), {{7, 25, "twice"}}},
    {"knots_decrease", in_grid("knots along 0 0 1 0.5\n" + six_rows), {{7, 19, "do not decrease"}}},
    {"knots_count",
     in_grid("knots along 0 0 0 1 1\n" + six_rows),
     {{7, 1, "5 knots along: 2 control points of degree 1 have 4"}}},
    {"knots_not_clamped", in_grid("knots along 0 1 2 3\n" + six_rows), {{7, 1, "have to be equal"}}},
    {"knots_all_equal", in_grid("knots along 1 1 1 1\n" + six_rows), {{7, 1, "all knots along are equal"}}},
    {"knots_missing", in_grid("knots along\n" + six_rows), {{7, 12, "missing"}}},
    {"knots_round_closed", in_grid("knots round 0 0 0 1 1 1\n" + six_rows), {{7, 1, "open round"}}},
    {"knots_nan", in_grid("knots along 0 0 x 1\n" + six_rows), {{7, 17, "unknown word 'x'"}}},
    {"knot_repeated",
     in_yarn("grid 4 3\ndegree 1 along knots along 0 0 1 1 2 2\n" + six_rows +
             "\n2 0 0\n2 1 0\n2 0 1\n3 0 0\n3 1 0\n3 0 1\nend"),
     {{7, 16, "more often than its degree"}}},
    {"open_round_three",
     in_grid("open round\n" + six_rows),
     {{6, 3, "at least 4 points"}, {10, 1, "section 1 is not closed"}, {13, 1, "section 2 is not closed"}}},
    {"open_seam",
     in_yarn("grid 2 4 open round\n0 0 0\n0 1 0\n0 0 1\n0 0 0\n1 0 0\n1 1 0\n1 0 1\n1 0 1e-9\nend"),
     {{14, 1, "section 2 is not closed"}}},
    {"open_what", in_grid("open\n" + six_rows), {{7, 5, "'round' is missing"}}},
    {"word_after_rows",
     in_grid("0 0 0\ndegree 1 along\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1"),
     {{8, 1, "before the rows"}}},
    {"unknown_word", in_yarn("grid 2 3 opne round\n" + six_rows + "\nend"), {{6, 10, "known: degree"}}},
    {"word_near", in_grid("clsed\n" + six_rows), {{7, 1, "did you mean 'closed'"}}},
};

const std::vector<Case> construction_cases = {
    {"weave_no_draft",
     with_thread("weave\n warp t 4 pitch 1\n weft t 4 pitch 1\nend\n"),
     {{8, 1, "'weave' ends without its 'draft'"}}},
    {"weave_nothing", with_thread("weave\nend\n"), {{6, 1, "'warp'"}, {6, 1, "'weft'"}, {6, 1, "'draft'"}}},
    {"weave_thread",
     with_thread("weave\n warp t,u 4 pitch 1\n weft t 4 pitch 1\n draft plain\nend\n"),
     {{6, 9, "unknown thread 'u'"}}},
    {"weave_count",
     with_thread("weave\n warp t 0 pitch 1\n weft t 4 pitch 1\n draft plain\nend\n"),
     {{6, 9, "1 or more"}}},
    {"weave_pitch",
     with_thread("weave\n warp t 4 pich 1\n weft t 4 pitch 0\n draft plain\nend\n"),
     {{6, 11, "'pitch' is expected"}, {7, 17, "larger than 0"}}},
    {"weave_thickness", weave("draft plain\nthickness 0"), {{9, 11, "larger than 0"}}},
    {"weave_spacing", weave("draft plain\nspacing loose"), {{9, 9, "relaxed"}}},
    {"weave_thickness_of_a_formula",
     weave("draft plain\nthickness 1\nprofile peirce"),
     {{5, 1, "leave out the profile"}}},
    {"draft_sign", weave("draft\n10\n02\nend"), {{10, 2, "signs 0 and 1"}}},
    {"draft_width", weave("draft\n10\n011\nend"), {{10, 1, "3 signs, the first one has 2"}}},
    {"draft_empty", weave("draft\nend"), {{9, 1, "no rows"}}},
    {"draft_unknown", weave("draft herringbone"), {{8, 9, "unknown draft"}}},
    {"draft_twill", weave("draft twill 2"), {{8, 15, "joined by '/'"}}},
    {"draft_twill_zero", weave("draft twill 0/2"), {{8, 15, "joined by '/'"}}},
    {"draft_satin", weave("draft satin 6/2"), {{8, 15, "does not exist"}}},
    {"draft_file", weave("draft file"), {{8, 13, "missing"}}},
    {"profile", weave("draft plain", "  profile lens\n"), {{9, 11, "unknown profile"}}},
    {"layers", weave("draft plain", "  layers 0\n"), {{9, 10, "1 or more"}}},
    {"knit_form",
     with_thread("knit jersy\n thread t\n courses 3\n wales 3\nend\n"),
     {{5, 6, "did you mean 'jersey'"}}},
    {"knit_form_missing",
     with_thread("knit\n thread t\n courses 3\n wales 3\nend\n"),
     {{9, 1,
       "'knit' ends without its 'chart'; or, behind the word 'knit': jersey, purl, rib, interlock, ..."}}},
    {"knit_form_and_chart",
     with_thread("knit purl\n thread t\n courses 3\n wales 3\n chart\n  K\n end\nend\n"),
     {{5, 1, "leave out either"}}},
    {"knit_chart_sign", chart("KTK\nK X\nKMP"), {{10, 3, "K (knit), P (purl), T (tuck) and M (miss)"}}},
    {"knit_chart_word", chart("KTK\nKnot"), {{10, 2, "K (knit), P (purl), T (tuck) and M (miss)"}}},
    {"knit_chart_ragged", chart("KTK\nkt"), {{10, 1, "2 signs, the first one has 3"}}},
    {"knit_chart_empty",
     with_thread("knit\n thread t\n courses 3\n wales 3\n chart\n end\nend\n"),
     {{10, 2, "no rows"}}},
    {"knit_chart_open",
     with_thread("knit\n chart\n KK\n thread t\n courses 3\n wales 3\nend\n"),
     {{8, 2, "'end' is missing: 'chart'"}}},
    {"knit_negative",
     with_thread("knit jersey\n thread t\n courses -3\n wales -1\nend\n"),
     {{7, 10, "1 or more"}, {8, 8, "1 or more"}}},
    {"knit_rib",
     with_thread("knit rib 1\n thread t\n courses 3\n wales 3\nend\n"),
     {{5, 10, "joined by 'x'"}}},
    {"knit_pitch",
     with_thread("knit purl\n thread t\n courses 3 pitch 0\n wales 3 step 2\nend\n"),
     {{7, 18, "pitch"}, {8, 10, "'pitch'"}}},
    {"knit_loop",
     with_thread("knit purl\n thread t\n courses 3\n wales 3\n loop -1\nend\n"),
     {{9, 7, "length of a loop"}}},
    {"knit_pile",
     with_thread("knit jersey\n thread t\n courses 3\n wales 3\n pile 1\nend\n"),
     {{5, 1, "plating"}}},
    {"knit_plating",
     with_thread("knit purl\n thread t\n courses 3\n wales 3\n plating t\nend\n"),
     {{5, 1, "jersey"}}},
    {"knit_gating",
     with_thread("knit rib 1x1\n thread t\n courses 3\n wales 3\n gating oposite\nend\n"),
     {{9, 9, "opposite"}}},
    {"knit_jacquard",
     with_thread("knit jacquard\n thread t\n courses 3\n wales 3\nend\n"),
     {{9, 1, "chart"}}},
    {"knit_no_thread", with_thread("knit purl\n courses 3\n wales 3\nend\n"), {{8, 1, "'thread'"}}},
    {"knit_end_missing",
     with_thread("knit purl\n thread t\n courses 3\n wales 3\n\nthread u\nend\n"),
     {{10, 1, "'knit', opened on line 5"}}},
    {"warpknit_bar_thread",
     with_thread("warpknit\n bar u 1-0/1-2\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{6, 6, "unknown thread 'u'"}}},
    {"warpknit_lapping",
     with_thread("warpknit\n bar t 1-0/1_2\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{6, 13, "no lapping"}}},
    {"warpknit_lapping_missing",
     with_thread("warpknit\n bar t fall-plate\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{6, 8, "no lapping"}}},
    {"warpknit_no_bar",
     with_thread("warpknit\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{8, 1, "without a 'bar'"}}},
    {"warpknit_classic_no_thread",
     with_thread("warpknit satin\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{8, 1, "'thread'"}}},
    {"warpknit_classic_unknown",
     with_thread("warpknit queenscord\n thread t\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{5, 10, "did you mean 'queens-cord'"}}},
    {"warpknit_classic_bar",
     with_thread("warpknit satin\n thread t\n bar t 1-0\n wales 4 pitch 1\n courses 4 pitch 1\nend\n"),
     {{5, 1, "its own bars"}}},
    {"braid_odd", braid("carriers 15"), {{7, 12, "even"}}},
    {"braid_angle", braid("angle 90"), {{10, 9, "between 0 and 90"}}},
    {"braid_radius", braid("radius 0"), {{9, 10, "larger than 0"}}},
    {"braid_flat_and_radius", braid("radius 5\n flat"), {{10, 2, "line 9"}}},
    {"braid_flat_width",
     braid("radius 5").replace(braid("radius 5").find("radius 5"), 8, "flat 0"),
     {{9, 8, "larger than 0"}}},
    {"braid_pattern", braid("pattern 2x2"), {{8, 11, "joined by '/'"}}},
    {"unknown_block",
     with_thread("trellis\n  rows 4\n  blob\n    1 2 3\n  end\nend\nunits furlong\n"),
     {{5, 1, "unknown word 'trellis'"}, {11, 7, "unknown unit"}}},
    {"misspelt_block",
     with_thread("braaid\n  thread t\n carriers 3\nend\n"),
     {{5, 1, "did you mean 'braid'"},
      {7, 11, "even"},
      {8, 1, "'pattern'"},
      {8, 1, "'radius'"},
      {8, 1, "'angle'"},
      {8, 1, "'length'"}}},
};

const std::vector<Case> other_cases = {
    {"edit_yarn", in_path("0 0 0\n1 0 0") + "edit z point 1 to 0 0 0\n", {{11, 6, "unknown yarn 'z'"}}},
    {"edit_form", in_path("0 0 0\n1 0 0") + "edit y move 1 to 0 0 0\n", {{11, 8, "unknown edit"}}},
    {"edit_joint", in_path("0 0 0\n1 0 0") + "edit y point 0 to 0 0 0\n", {{11, 14, "1 or more"}}},
    {"edit_to", in_path("0 0 0\n1 0 0") + "edit y point 1 0 0 0\n", {{11, 16, "'to' is expected"}}},
    {"edit_length",
     in_path("0 0 0\n1 0 0") + "edit y length 0 point 1 along 0 0 1\n",
     {{11, 15, "larger than 0"}}},
    {"edit_along",
     in_path("0 0 0\n1 0 0") + "edit y length 3 point 1 along 0 0 0\n",
     {{11, 31, "no direction"}}},
    {"piece_empty", "fabric 1\npiece p\nend\n", {{3, 1, "no outline"}}},
    {"piece_twice",
     "fabric 1\npiece p\n line a 0 0 1 1\nend\npiece p\n line a 0 0 1 1\nend\n",
     {{5, 7, "used twice; first on line 2"}}},
    {"curve_twice",
     "fabric 1\npiece p\n line a 0 0 1 1\n line a 1 1 0 0\nend\n",
     {{4, 7, "used twice; first on line 3"}}},
    {"curve_two_points", "fabric 1\npiece p\n curve a\n0 0\n1 1\n end\nend\n", {{6, 2, "at least 3 points"}}},
    {"curve_shape",
     "fabric 1\npiece p\n curve a Q\n0 0\n1 1\n2 0\n end\nend\n",
     {{3, 10, "unknown shape of curve"}}},
    {"curve_method",
     "fabric 1\npiece p\n curve a C by cord\n0 0\n1 1\n2 0\n end\nend\n",
     {{3, 15, "unknown way to place points on a curve 'cord'; did you mean 'chord'"}}},
    {"curve_control_three",
     "fabric 1\npiece p\n curve a control\n0 0\n1 1\n2 0\n end\nend\n",
     {{7, 2, "has at least four"}}},
    {"curve_knots",
     "fabric 1\npiece p\n curve a control\n knots 0 0 0 0 0.5 0.4 1 1 1 1\n0 0\n1 1\n2 1\n3 1\n4 1\n5 0\n "
     "end\nend\n",
     {{11, 2, "knots run from 0 to 1"}}},
    {"curve_knots_count",
     "fabric 1\npiece p\n curve a control\n knots 0 0 0 0 1 1 1\n0 0\n1 1\n2 1\n3 1\n end\nend\n",
     {{9, 2, "of 4 control points has 8 knots; this one has 7"}}},
    {"curve_weight",
     "fabric 1\npiece p\n curve a spline\n0 0\n1 1 0\n2 1\n end\nend\n",
     {{5, 5, "larger than 0"}}},
    {"curve_edit",
     "fabric 1\npiece p\n line a 0 0 1 1\n edit a length 2 along 0 1\nend\n",
     {{4, 18, "'point' is expected"}}},
    {"curve_control_method",
     "fabric 1\npiece p\n curve a control by chord\n0 0\n1 1\n2 1\n3 0\n end\nend\n",
     {{3, 21, "leave 'by' out"}}},
    {"curve_equal",
     "fabric 1\npiece p\n curve a C\n0 0\n0 0\n2 0\n end\nend\n",
     {{5, 1, "equals the one before"}}},
    {"line_short", "fabric 1\npiece p\n line a 0 0 1\nend\n", {{3, 14, "missing"}}},
    {"line_no_length", "fabric 1\npiece p\n line a 1 1 1 1\nend\n", {{3, 2, "no length"}}},
    {"cell_flat", "fabric 1\ncell 0 0 0 1 1 0\nend\n", {{2, 1, "no volume"}}},
    {"cell_short", "fabric 1\ncell 0 0 0 1 1\nend\n", {{2, 15, "missing"}}},
    {"cell_twice",
     "fabric 1\ncell 0 0 0 1 1 1\nend\ncell 0 0 0 1 1 1\n matrix z\nend\n",
     {{4, 1, "first on line 2"}, {5, 9, "unknown material"}}},
    {"cell_matrix", "fabric 1\ncell 0 0 0 1 1 1\n matrix epoxy\nend\n", {{3, 9, "unknown material 'epoxy'"}}},
    {"cell_axis", "fabric 1\ncell 0 0 0 1 1 1\n periodic x w\nend\n", {{3, 13, "unknown axis 'w'"}}},
    {"cell_axis_twice", "fabric 1\ncell 0 0 0 1 1 1\n periodic x y x\nend\n", {{3, 15, "named twice"}}},
};

const auto case_name = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(Lexical, BadInput, testing::ValuesIn(lexical_cases), case_name);
INSTANTIATE_TEST_SUITE_P(Numbers, BadInput, testing::ValuesIn(number_cases), case_name);
INSTANTIATE_TEST_SUITE_P(Threads, BadInput, testing::ValuesIn(thread_cases), case_name);
INSTANTIATE_TEST_SUITE_P(Yarns, BadInput, testing::ValuesIn(yarn_cases), case_name);
INSTANTIATE_TEST_SUITE_P(Grids, BadInput, testing::ValuesIn(grid_cases), case_name);
INSTANTIATE_TEST_SUITE_P(Constructions, BadInput, testing::ValuesIn(construction_cases), case_name);
INSTANTIATE_TEST_SUITE_P(Others, BadInput, testing::ValuesIn(other_cases), case_name);

}  // namespace selvage::test
