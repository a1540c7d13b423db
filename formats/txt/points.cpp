// A yarn's path without rows of its own: `points`, `helix`.
#include "formats/txt/blocks.h"

namespace selvage::formats::txt {

// points FILE [yarn NAME] [error E]
fabric::PointsFile read_points_file(Parser& p) {
  constexpr std::array<Word<bool>, 2> words{{{"yarn", true}, {"error", false}}};
  fabric::PointsFile points;
  points.place = p.statement().place();
  if (p.more() && !p.next_is('"')) {
    points.file = p.take_word();
    if (points.file.find('"') != std::string::npos || text_prefix(points.file) != points.file.size())
      p.error(p.last(), "the name of a file is UTF-8, and has no double quotes");
  } else {
    points.file = p.name("the file of points").value_or("");
  }
  while (p.more()) {
    const auto is_yarn = p.choice("word of the points", words);
    if (!is_yarn) break;
    if (*is_yarn ? !points.yarn.empty() : points.error.has_value())
      return p.error(p.last(), "this is given twice"), p.take_rest(), points;
    if (*is_yarn)
      points.yarn = p.name("the yarn's name in that file").value_or("");
    else
      points.error = p.positive("the error", Measure::length);
  }
  p.finish();
  return points;
}

// helix radius R pitch P turns N [left | right] [start ANGLE]
fabric::Helix read_helix(Parser& p) {
  constexpr std::array<Word<int>, 3> words{{{"left", 1}, {"right", 0}, {"start", 2}}};
  fabric::Helix helix;
  helix.place = p.statement().place();
  p.expect("radius");
  helix.radius = p.positive("the radius", Measure::length).value_or(1.0);
  p.expect("pitch");
  helix.pitch = p.positive("the pitch", Measure::length).value_or(1.0);
  p.expect("turns");
  helix.turns = p.positive("the number of turns").value_or(1.0);
  while (p.more()) {
    const auto word = p.choice("word of the helix", words);
    if (!word) break;
    if (*word == 2)
      helix.start = p.number("the angle at the start", Measure::angle).value_or(0.0);
    else
      helix.is_left = *word == 1;
  }
  p.finish();
  return helix;
}

}  // namespace selvage::formats::txt
