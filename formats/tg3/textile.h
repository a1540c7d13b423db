// A textile as a tg3 file says it: its yarns by nodes and sections, and its domain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fabric/model.h"
#include "formats/tg3/section.h"
#include "formats/tg3/yarn_path.h"
#include "formats/tg3/yarn_surface.h"

namespace selvage::formats::tg3 {

struct TextileYarn {
  std::string name;
  TextPlace place;
  fabric::Role role = fabric::Role::other;
  std::string thread;  // empty: none
  std::vector<PathNode> nodes;
  Interpolation interpolation{};
  std::vector<Section> sections;
  // Of sections between nodes; empty: one section everywhere, or each at its share of the length.
  std::vector<BlendPiece> pieces{};
  std::vector<double> positions{};
  Blend blend{};
  SectionAdjustments adjustments{};
  std::vector<Vec3> repeats{};  // the yarn stands at all sums of whole multiples of these as well
};

// The points x with normal . x >= distance.
struct HalfSpace {
  Vec3 normal = Vec3::Zero();  // unit
  double distance = 0;
};

// Where there is cloth: what all half spaces share.
struct Domain {
  TextPlace place;
  std::vector<HalfSpace> sides;
};

struct Textile {
  std::vector<TextileYarn> yarns;
  std::optional<Domain> domain;
};

}  // namespace selvage::formats::tg3
