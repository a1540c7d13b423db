// Results and meshes that are damaged, or that mean more than their size can: an error at its place, no
// memory that is not theirs, and no more of it than their size allows.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>

#include "formats/registry.h"
#include "results/solved_deck.h"

namespace selvage {
namespace {

template <class Made>
struct ReadBack {
  std::optional<Made> made;
  Diagnostics diagnostics;
  [[nodiscard]] Message error() const {
    const Message* const first = diagnostics.first_error();
    return first != nullptr ? *first : Message();
  }
};
ReadBack<fem::FieldMesh> read_mesh(const formats::Descriptor& format, const std::string& text) {
  const Source source = Source::from_memory(text, "test" + std::string(format.extensions.front()));
  ReadBack<fem::FieldMesh> read;
  read.made = format.read_mesh(source, read.diagnostics);
  return read;
}
ReadBack<fem::SolvedDeck> read_deck(const std::string& text) {
  const Source source = Source::from_memory(text, "test.inp");
  ReadBack<fem::SolvedDeck> read;
  read.made = formats::inp::descriptor().read_deck(source, read.diagnostics);
  return read;
}

// --- frd

const std::string mesh_of_frd =
    "    1C\n    1UTEST\n    2C                             4                                     1\n"
    " -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 1.00000E+00 0.00000E+00 0.00000E+00\n"
    " -1         3 0.00000E+00 1.00000E+00 0.00000E+00\n -1         4 0.00000E+00 0.00000E+00 1.00000E+00\n "
    "-3\n"
    "    3C                             1                                     1\n -1         1    3    0    "
    "1\n"
    " -2         1         2         3         4\n -3\n";
const std::string result_of_frd =
    "  100CL  101 1.00000E+00           4                     0    1           1\n -4  DISP        1    1\n";
const std::string component_of_frd = " -5  D1          1    2    1    0\n";

TEST(BadFrd, AResultIsRead) {
  const auto read = read_mesh(formats::frd::descriptor(), mesh_of_frd + result_of_frd + component_of_frd +
                                                              component_of_frd +
                                                              " -1         2 1.00000E+00 5.00000E-01\n"
                                                              " -3\n 9999\n");
  ASSERT_TRUE(read.made) << read.error().text;
  ASSERT_EQ(read.made->fields.size(), 1U);
  EXPECT_EQ(read.made->fields[0].components, 2);
  ASSERT_EQ(read.made->fields[0].values.size(), 8U);
  EXPECT_EQ(read.made->fields[0].values[3], 0.5F);
  EXPECT_TRUE(std::isnan(read.made->fields[0].values[0]));
}

// Values were made room for at the first node, and a later component wrote behind them.
TEST(BadFrd, ComponentsBehindTheFirstValues) {
  for (const int more : {1, 5, 2000}) {
    std::string text = mesh_of_frd + result_of_frd + component_of_frd + " -1         1 1.00000E+00\n";
    for (int k = 0; k < more; ++k) text += component_of_frd;
    text +=
        " -1         4 1.00000E+30 1.00000E+30 1.00000E+30 1.00000E+30 1.00000E+30 1.00000E+30\n -3\n 9999\n";
    const auto read = read_mesh(formats::frd::descriptor(), text);
    EXPECT_FALSE(read.made);
    EXPECT_EQ(read.error().place.line, 17);
    EXPECT_NE(read.error().text.find("before the values of its first node"), std::string::npos)
        << read.error().text;
  }
}

// Each result has a value for each node: nodes that come later had none.
TEST(BadFrd, NodesBehindResults) {
  const auto read =
      read_mesh(formats::frd::descriptor(), mesh_of_frd + result_of_frd + component_of_frd +
                                                " -1         1 1.00000E+00\n -3\n" +
                                                mesh_of_frd.substr(mesh_of_frd.find("    2C")) + " 9999\n");
  EXPECT_FALSE(read.made);
  EXPECT_EQ(read.error().place.line, 18);
  EXPECT_NE(read.error().text.find("nodes behind results"), std::string::npos) << read.error().text;
}

// The place of a number that a line is too short for was told as before the text.
TEST(BadFrd, ShortLines) {
  for (const std::string text : {"    3C\n -1\n", "    3C\n -1", "    2C\n -1\n", "    2C\n -1         1\n",
                                 "    3C \n -1\n\xFF\xFF\xFF"}) {
    const auto read = read_mesh(formats::frd::descriptor(), text);
    EXPECT_FALSE(read.made);
    EXPECT_EQ(read.error().place.line, 2);
    EXPECT_LE(read.error().place.column, 14);
    EXPECT_TRUE(read.error().excerpt.starts_with(" -1")) << read.error().excerpt;
  }
}

TEST(BadFrd, ManyComponentsOfFewOfManyNodes) {
  std::string text =
      "    1C\n    1UTEST\n    2C                             4                                     1\n";
  for (int k = 1; k <= 2000; ++k) text += fmt::format(" -1{:10} 0.00000E+00 0.00000E+00 0.00000E+00\n", k);
  text += " -3\n";
  std::string result = result_of_frd;
  for (int k = 0; k < 64; ++k) result += " -5\n";
  result += " -1         1 1.00000E+00 1.00000E+00 1.00000E+00 1.00000E+00 1.00000E+00 1.00000E+00\n";
  for (int k = 6; k < 64; k += 6)
    result += " -2           1.00000E+00 1.00000E+00 1.00000E+00 1.00000E+00 1.00000E+00 1.00000E+00\n";
  for (int k = 0; k < 30; ++k) text += result + " -3\n";
  const auto read = read_mesh(formats::frd::descriptor(), text);
  EXPECT_FALSE(read.made);
  EXPECT_EQ(read.error().kind, Kind::limit);
  EXPECT_NE(read.error().text.find("results of few of many nodes"), std::string::npos) << read.error().text;
  const auto wide = read_mesh(
      formats::frd::descriptor(), mesh_of_frd + result_of_frd + [] {
        std::string lines;
        for (int k = 0; k < 65; ++k) lines += " -5\n";
        return lines;
      }());
  EXPECT_EQ(wide.error().kind, Kind::limit);
}

// --- decks beside results

TEST(BadDeck, AnElementWithoutASectionHasItsPlace) {
  const auto read = read_deck(
      "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4, ELSET=a\n7, 1, 2, 3, 4\n8, 1, 2,\n3, 4\n*STEP\n*END STEP\n");
  EXPECT_FALSE(read.made);
  EXPECT_EQ(read.error().place.line, 4);
  EXPECT_NE(read.error().text.find("element 7 has no solid section"), std::string::npos) << read.error().text;
}

TEST(BadDeck, SetsOfSetsAreBounded) {
  std::string elements = "*ELEMENT, TYPE=C3D4, ELSET=a\n";
  for (int k = 1; k <= 2000; ++k) elements += fmt::format("{}, 1, 2, 3, 4\n", k);
  std::string named = elements + "*ELSET, ELSET=b\n", ranges = elements;
  for (int k = 0; k < 2000; ++k) named += "a, a,\n";
  for (int k = 0; k < 2000; ++k) ranges += fmt::format("*ELSET, ELSET=s{}, GENERATE\n1, 900000000, 1\n", k);
  for (const std::string& text : {named, ranges}) {
    const auto read = read_deck(text);
    EXPECT_FALSE(read.made);
    EXPECT_EQ(read.error().kind, Kind::limit);
    EXPECT_NE(read.error().text.find("far more numbers"), std::string::npos) << read.error().text;
  }
}

TEST(BadDeck, SetsByRange) {
  const std::string deck =
      "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n2, 1, 2, 3, 4\n3, 1, 2, 3, 4\n4, 1, 2, 3, 4\n*ELSET, ELSET=odd, "
      "GENERATE\n1, {}, 2\n"
      "*ELSET, ELSET=even, GENERATE\n2, 4, 2\n*MATERIAL, NAME=m\n*ELASTIC\n1000, 0.3\n*SOLID SECTION, "
      "ELSET=odd, MATERIAL=m\n"
      "*SOLID SECTION, ELSET=even, MATERIAL=m\n";
  for (const char* const last : {"3", "900000000000"}) {
    std::string text = deck;
    text.replace(text.find("{}"), 2, last);
    const auto read = read_deck(text);
    ASSERT_TRUE(read.made) << read.error().text;
    EXPECT_EQ(read.made->elements.at(3).section, 0U);
    EXPECT_EQ(read.made->elements.at(4).section, 1U);
  }
}

// --- vtu

std::string array(const std::string& name, const std::string& type, const std::string& inside,
                  int components = 1) {
  return fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>\n", type,
      name, components, inside);
}
std::string piece(const std::string& more = "", const std::string& types = "10") {
  return "<Piece>\n<Points>" + array("", "Float32", "0 0 0 1 0 0 0 1 0 0 0 1", 3) + "</Points>\n<Cells>" +
         array("connectivity", "Int32", "0 1 2 3") + array("offsets", "Int32", "4") +
         array("types", "UInt8", types) + "</Cells>\n" + more + "</Piece>\n";
}
std::string vtu(const std::string& pieces, const std::string& head = "") {
  return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt64\"" + head +
         ">\n<UnstructuredGrid>\n" + pieces;
}

TEST(BadVtu, TypesAndRegionsThatAreNoNumbers) {
  for (const char* const type : {"nan", "1e300", "-1e300"}) {
    const auto read = read_mesh(formats::vtu::descriptor(), vtu(piece("", type)));
    EXPECT_FALSE(read.made);
    EXPECT_NE(read.error().text.find("no cell that is a surface or a solid"), std::string::npos)
        << read.error().text;
  }
  const auto read = read_mesh(formats::vtu::descriptor(),
                              vtu("<!-- yarn 1e300: far -->\n" +
                                  piece("<CellData>" + array("yarn", "Float32", "nan") + "</CellData>\n")));
  EXPECT_TRUE(read.made) << read.error().text;
}

// Of zeros, as vtkZLibDataCompressor writes them, without base64.
std::string compressed_zeros(std::size_t block, std::size_t blocks) {
  const std::string zeros(block, '\0');
  std::string packed(compressBound(block), '\0');
  uLongf size = packed.size();
  EXPECT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                      reinterpret_cast<const Bytef*>(zeros.data()), block, 9),
            Z_OK);
  packed.resize(size);
  std::string bytes;
  const auto add = [&](std::uint64_t number) {
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), &number, raw.size());
    bytes.append(raw.data(), raw.size());
  };
  add(blocks);
  add(block);
  add(0);
  for (std::size_t k = 0; k < blocks; ++k) add(size);
  for (std::size_t k = 0; k < blocks; ++k) bytes += packed;
  return bytes;
}
std::string appended_array(const std::string& name, const std::string& type) {
  return fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"appended\" offset=\"0\"/>\n", type, name);
}

TEST(BadVtu, CompressedBlocksAreBounded) {
  const std::string pieces = "<Piece>\n<Points>" + appended_array("", "UInt8") + "</Points>\n";
  const auto read = read_mesh(formats::vtu::descriptor(),
                              vtu(pieces, " compressor=\"vtkZLibDataCompressor\"") +
                                  "<AppendedData encoding=\"raw\">_" + compressed_zeros(1U << 20U, 40));
  EXPECT_FALSE(read.made);
  EXPECT_EQ(read.error().kind, Kind::limit) << read.error().text;
  EXPECT_EQ(read.error().place.line, 4);
}

TEST(BadVtu, ArraysAtOnePlaceAreBounded) {
  std::string pieces = "<Piece>\n<PointData>";
  for (int k = 0; k < 100; ++k) pieces += appended_array(fmt::format("a{}", k), "UInt8");
  const std::string zeros(8U << 17U, '\0');
  std::string data(8, '\0');
  const std::uint64_t size = zeros.size();
  std::memcpy(data.data(), &size, 8);
  const auto read =
      read_mesh(formats::vtu::descriptor(),
                vtu(pieces) + "</PointData></Piece><AppendedData encoding=\"raw\">_" + data + zeros);
  EXPECT_FALSE(read.made);
  EXPECT_EQ(read.error().kind, Kind::limit) << read.error().text;
}

// A field has a value for each node of all pieces.
TEST(BadVtu, FieldsOfFewOfManyPiecesAreBounded) {
  std::string nodes;
  for (int k = 0; k < 40'000; ++k) nodes += "0 0 0 ";
  std::string pieces = piece();
  pieces.replace(pieces.find("0 0 0 1 0 0 0 1 0 0 0 1"), 23, nodes);
  for (int k = 0; k < 400; ++k)
    pieces += piece("<PointData>" + array(fmt::format("f{}", k), "Float32", "1 2 3 4") + "</PointData>\n");
  const auto read = read_mesh(formats::vtu::descriptor(), vtu(pieces));
  EXPECT_FALSE(read.made);
  EXPECT_EQ(read.error().kind, Kind::limit) << read.error().text;
  EXPECT_NE(read.error().text.find("fields that few pieces have"), std::string::npos) << read.error().text;
}

// --- tables of points

TEST(BadPoints, APieceIsReadOnce) {
  const Source source = Source::from_memory(
      "<VTKFile type=\"PolyData\">\n<PolyData>\n<Piece>\n<Points>" + array("", "Float32", "0 0 0 1 0 0", 3) +
          "</Points>\n<Lines>" + array("connectivity", "Int32", "0 1") + array("offsets", "Int32", "2") +
          "</Lines>\n</Piece>\n</Piece>\n</Piece>\n",
      "test.vtp");
  Diagnostics diagnostics;
  EXPECT_FALSE(formats::vtp::descriptor().read_points(source, diagnostics));
  ASSERT_TRUE(diagnostics.has_errors());
  EXPECT_NE(diagnostics.first_error()->text.find("this piece has no Points"), std::string::npos)
      << diagnostics.first_error()->text;
}

TEST(BadPoints, BytesOfNamesThatAreNone) {
  const Source source = Source::from_memory(
      "<VTKFile type=\"PolyData\">\n<PolyData>\n<FieldData>" +
          array("yarn_names", "Float64", "1e300 -1e300 97 0") + "</FieldData>\n<Piece>\n<Points>" +
          array("", "Float32", "0 0 0 1 0 0", 3) + "</Points>\n<Lines>" +
          array("connectivity", "Int32", "0 1") + array("offsets", "Int32", "2") + "</Lines>\n</Piece>\n",
      "test.vtp");
  Diagnostics diagnostics;
  const auto measured = formats::vtp::descriptor().read_points(source, diagnostics);
  ASSERT_TRUE(measured);
  EXPECT_TRUE(measured->yarns.front().name.ends_with('a'));
}

}  // namespace
}  // namespace selvage
