// IGES texts in memory, and what the reader says of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/source.h"
#include "formats/iges/reader.h"

namespace selvage::test {

struct IgesReading {
  std::optional<cad::Model> model;
  Diagnostics diagnostics;

  [[nodiscard]] std::string text() const;  // all messages
  // Is there a message of this severity on a line, with these words in it?
  [[nodiscard]] bool says(Severity severity, std::string_view words) const;
};
IgesReading read_iges(std::string bytes, const std::string& name = "test.igs");

// An entity of a text made by hand. `parameters` without the type in front and the delimiter behind, broken
// over lines of 64 columns between values.
struct IgesEntity {
  int type = 0, form = 0;
  std::string parameters;
  std::string status = "00000000";
  int color = 0, level = 0, transformation = 0;
  std::string label{};
};
struct IgesText {
  std::string global =
      "1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,1.,2,2HMM,1,0.1,"
      "15H20240102.030405,1.E-06,100.,,,11,0,,;";
  std::vector<IgesEntity> entities;
  std::string line_end = "\n";
  char parameter_delimiter = ',', record_delimiter = ';';

  // The directory pointer of the entity.
  int add(IgesEntity entity) {
    entities.push_back(std::move(entity));
    return 2 * static_cast<int>(entities.size()) - 1;
  }
  [[nodiscard]] std::string bytes() const;
};

// The parameters of a bilinear 128 over [0,1]^2 whose corners are (x,y,z), (x+1,y,z), (x,y+1,z), (x+1,y+1,z).
std::string bilinear(double x, double y, double z);

}  // namespace selvage::test
