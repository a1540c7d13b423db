#include "formats/dxf/skeleton.h"

#include <cstdlib>

namespace selvage::formats::dxf {

namespace {

// Handles of the tables and of their entries.
enum : Handle {
  vport_table = 1,
  ltype_table,
  layer_table,
  style_table,
  view_table,
  ucs_table,
  appid_table,
  dimstyle_table,
  block_table,
  root_dictionary,
  group_dictionary,
  first_entry,
  paper_space = model_space + 1,
  model_begin,
  model_end,
  paper_begin,
  paper_end,
};

// $INSUNITS.
int unit_code(Unit unit) {
  switch (unit) {
    case Unit::inch:
      return 1;
    case Unit::mm:
      return 4;
    case Unit::cm:
      return 5;
    case Unit::m:
      return 6;
    case Unit::um:
      return 13;
  }
  std::abort();
}

void section(Tags& file, std::string_view name) {
  file.text(0, "SECTION").text(2, name);
}

void end_section(Tags& file) {
  file.text(0, "ENDSEC");
}

void table(Tags& file, std::string_view name, Handle self, std::size_t entries) {
  file.text(0, "TABLE").text(2, name).handle(5, self).handle(330, 0).text(100, "AcDbSymbolTable");
  file.integer(70, static_cast<long long>(entries));
  if (name == "DIMSTYLE") file.text(100, "AcDbDimStyleTable");
}

void end_table(Tags& file) {
  file.text(0, "ENDTAB");
}

void header(Tags& file, const nurbs::Box2& box, Unit units, Handle next) {
  section(file, "HEADER");
  const auto variable = [&file](std::string_view name) -> Tags& { return file.text(9, name); };
  variable("$ACADVER").text(1, "AC1015");
  variable("$DWGCODEPAGE").text(3, "ANSI_1252");
  variable("$INSBASE").point(10, Vec3::Zero());
  variable("$EXTMIN").point(10, Vec3(box.min().x(), box.min().y(), 0));
  variable("$EXTMAX").point(10, Vec3(box.max().x(), box.max().y(), 0));
  variable("$MEASUREMENT").integer(70, units == Unit::inch ? 0 : 1);
  variable("$INSUNITS").integer(70, unit_code(units));
  variable("$LUNITS").integer(70, 2);  // decimal
  variable("$PDMODE").integer(70, 3);  // points are drawn as crosses
  variable("$PDSIZE").real(40, -1.0);  // of 1 % of the view
  variable("$HANDSEED").handle(5, next);
  end_section(file);
}

void viewport(Tags& file, Handle self, const nurbs::Box2& box) {
  const Vec2 centre = box.center();
  file.record("VPORT", self, vport_table, "AcDbViewportTableRecord", "*Active").integer(70, 0);
  file.real(10, 0.0).real(20, 0.0).real(11, 1.0).real(21, 1.0);
  file.real(12, centre.x()).real(22, centre.y());
  file.real(13, 0.0).real(23, 0.0).real(14, 1.0).real(24, 1.0).real(15, 1.0).real(25, 1.0);
  file.point(16, Vec3::UnitZ()).point(17, Vec3::Zero());
  file.real(40, 1.1 * box.sizes().maxCoeff()).real(41, 1.0).real(42, 50.0).real(43, 0.0).real(44, 0.0);
  file.real(50, 0.0).real(51, 0.0).integer(71, 0).integer(72, 1000).integer(73, 1).integer(74, 3);
  file.integer(75, 0).integer(76, 0).integer(77, 0).integer(78, 0);
}

void tables(Tags& file, const std::vector<Block>& blocks, const nurbs::Box2& box) {
  Handle entry = first_entry;
  section(file, "TABLES");
  table(file, "VPORT", vport_table, 1);
  viewport(file, entry++, box);
  end_table(file);

  table(file, "LTYPE", ltype_table, 3);
  for (const std::string_view name : {"ByBlock", "ByLayer", "Continuous"})
    file.record("LTYPE", entry++, ltype_table, "AcDbLinetypeTableRecord", name)
        .integer(70, 0)
        .text(3, "")
        .integer(72, 65)
        .integer(73, 0)
        .real(40, 0.0);
  end_table(file);

  table(file, "LAYER", layer_table, 4);
  constexpr int black_or_white = 7, red = 1, green = 3;  // points stand out from lines
  for (const std::string_view name :
       {std::string_view("0"), layer::boundary, layer::turn_points, layer::curve_points}) {
    file.record("LAYER", entry++, layer_table, "AcDbLayerTableRecord", name)
        .integer(70, 0)
        .integer(62, name == layer::turn_points    ? red
                     : name == layer::curve_points ? green
                                                   : black_or_white)
        .text(6, "Continuous");
  }
  end_table(file);

  table(file, "STYLE", style_table, 1);
  file.record("STYLE", entry++, style_table, "AcDbTextStyleTableRecord", "Standard").integer(70, 0);
  file.real(40, 0.0).real(41, 1.0).real(50, 0.0).integer(71, 0).real(42, 2.5).text(3, "txt").text(4, "");
  end_table(file);
  for (const auto& [name, self] : {std::pair{"VIEW", view_table}, std::pair{"UCS", ucs_table}}) {
    table(file, name, self, 0);
    end_table(file);
  }
  table(file, "APPID", appid_table, 1);
  file.record("APPID", entry++, appid_table, "AcDbRegAppTableRecord", "ACAD").integer(70, 0);
  end_table(file);
  table(file, "DIMSTYLE", dimstyle_table, 1);
  file.record("DIMSTYLE", entry++, dimstyle_table, "AcDbDimStyleTableRecord", "Standard").integer(70, 0);
  end_table(file);

  table(file, "BLOCK_RECORD", block_table, blocks.size() + 2);
  file.record("BLOCK_RECORD", model_space, block_table, "AcDbBlockTableRecord", "*Model_Space");
  file.record("BLOCK_RECORD", paper_space, block_table, "AcDbBlockTableRecord", "*Paper_Space");
  for (const Block& block : blocks)
    file.record("BLOCK_RECORD", block.record, block_table, "AcDbBlockTableRecord", block.name);
  end_table(file);
  end_section(file);
}

void block(Tags& file, const Block& source) {
  file.entity("BLOCK", source.begin, source.record, "0", "AcDbBlockBegin").text(2, source.name);
  file.integer(70, 0).point(10, Vec3::Zero()).text(3, source.name).text(1, "");
  file.append(source.entities);
  file.entity("ENDBLK", source.end, source.record, "0", "AcDbBlockEnd");
}

void objects(Tags& file) {
  section(file, "OBJECTS");
  file.text(0, "DICTIONARY").handle(5, root_dictionary).handle(330, 0).text(100, "AcDbDictionary");
  file.integer(281, 1).text(3, "ACAD_GROUP").handle(350, group_dictionary);
  file.text(0, "DICTIONARY").handle(5, group_dictionary).handle(330, root_dictionary);
  file.text(100, "AcDbDictionary").integer(281, 1);
  end_section(file);
}

}  // namespace

Tags drawing(const std::vector<Block>& blocks, const nurbs::Box2& box, Unit units, Handle next) {
  Tags file;
  header(file, box, units, next);
  section(file, "CLASSES");
  end_section(file);
  tables(file, blocks, box);
  section(file, "BLOCKS");
  block(file, {"*Model_Space", model_space, model_begin, model_end, 0, {}});
  block(file, {"*Paper_Space", paper_space, paper_begin, paper_end, 0, {}});
  for (const Block& source : blocks) block(file, source);
  end_section(file);
  section(file, "ENTITIES");
  for (const Block& source : blocks)
    file.entity("INSERT", source.insert, model_space, layer::boundary, "AcDbBlockReference")
        .text(2, source.name)
        .point(10, Vec3::Zero());
  end_section(file);
  objects(file);
  file.text(0, "EOF");
  return file;
}

}  // namespace selvage::formats::dxf
