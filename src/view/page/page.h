// A page of yarns or of a mesh to look at from all sides: one HTML file that needs no network, with all that
// it shows inside. What it does in a browser is in the files *.js, *.css and page.html beside this one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/output.h"
#include "core/units.h"
#include "view/page/shape.h"
#include "yarn/body.h"
#include "yarn/congruence.h"

namespace selvage::view::page {

// A yarn: a shape, and how it comes from where that was made to its place.
struct Yarn {
  yarn::BodyLabel label;
  std::size_t shape = 0;  // of Page::shapes
  yarn::RigidMotion motion;
  double length = 0, volume = 0;  // file units
};

// Two yarns that share space (gap < 0: minus the depth) or nearly touch.
struct Contact {
  std::size_t a = 0, b = 0;  // of Page::yarns
  double gap = 0;
  Vec3 at = Vec3::Zero();
};

// As many as a page lists of each, the worst first; how many there are.
struct Contacts {
  static constexpr std::size_t most = 5000;
  std::vector<Contact> overlaps, near;
  std::size_t overlap_count = 0, near_count = 0;
  double reach = 0;  // of near ones
};

// The skin of a mesh: triangles of the outsides of its regions.
struct Skin {
  std::vector<Eigen::Vector3f> points;  // told from Page::centre
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> region;  // of each triangle, of `regions`
  // Of each triangle: 1 to 3 where its edge opposite of this corner is no edge of an element; else 0.
  std::vector<std::uint8_t> inner;
  struct Region {
    std::string name;
    std::size_t elements = 0;
    bool is_matrix = false;
  };
  std::vector<Region> regions;
  struct Field {
    std::string name;
    bool of_points = true;  // else of triangles
    int components = 1;
    std::vector<float> values;  // of points or triangles, `components` each
    int step = 0;               // from 1, of `steps`; 0: of none
  };
  std::vector<Field> fields;
  std::vector<std::string> steps;
  struct Histogram {
    std::string name;
    double low = 0, high = 0;  // of the first and the last bin
    std::vector<std::uint64_t> counts;
    double least = 0, mean = 0;
  };
  std::vector<Histogram> histograms;
  std::size_t nodes = 0, elements = 0;
};

struct Page {
  std::string name;   // of the input
  std::string title;  // of the fabric, may be empty
  Unit units = Unit::mm;
  Vec3 centre = Vec3::Zero();  // of what is shown: coordinates in the page are told from here
  Box3 box;                    // told from the file's origin
  std::vector<Shape> shapes;
  std::vector<Yarn> yarns;
  std::optional<Contacts> contacts;  // none: nobody looked
  std::string contacts_note;         // why not
  std::string sheets = "null";       // data sheets as JSON (pipeline/sheet_report.h)
  std::string picture;               // a PNG for browsers without WebGL; may be empty
  std::optional<Skin> skin;          // instead of yarns
};

// The library of pages, three.js, as their script has it: a file beside the program or in ../lib/selvage.
// Errors: internal (it is not there, with what to do about it, or is another one than pages are made for);
// io.
Result<std::string> library();

// Errors: io.
Status write(const Page& page, std::string_view library, OutputFile& output);

}  // namespace selvage::view::page
