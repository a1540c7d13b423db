#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/text_buffer.h"
#include "fem/names.h"
#include "fem/sides.h"
#include "formats/foam/settings.h"
#include "formats/registry.h"

namespace selvage::formats::foam {
namespace {

// Owner and its number before the neighbour and its; `nodes` counter-clockwise seen from the neighbour.
struct Face {
  std::size_t owner = 0, neighbour = 0;
  fem::ElementSide nodes{};
};

// Of a triangle the last one is repeated.
std::size_t corners_of(const fem::ElementSide& nodes) {
  return nodes[2] == nodes[3] ? 3 : 4;
}

std::size_t count_cells(const fem::Mesh& mesh) {
  return mesh.elements.size() + mesh.layers.wedges.size();
}

// Those between two cells in OpenFOAM's upper triangular order: by owners, of each by its neighbours.
std::vector<Face> inner_faces(const fem::Mesh& mesh) {
  struct Seen {
    fem::ElementSide key;  // the corners, increasing; of a triangle the largest twice
    std::size_t element, side;
  };
  std::vector<Seen> seen;
  seen.reserve(4 * mesh.elements.size() + 5 * mesh.layers.wedges.size());
  for (std::size_t e = 0; e < count_cells(mesh); ++e)
    for (std::size_t s = 0; s < fem::element_sides(mesh, e).size(); ++s) {
      Seen one{fem::side_nodes(mesh, e, s), e, s};
      // Which corner of a triangle is repeated depends on the cell from which it is seen.
      if (corners_of(one.key) == 3) one.key[3] = *std::max_element(one.key.begin(), one.key.end());
      std::sort(one.key.begin(), one.key.end());
      seen.push_back(one);
    }
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
    return a.key != b.key ? a.key < b.key : a.element < b.element;
  });
  std::vector<Face> faces;
  for (std::size_t k = 0; k + 1 < seen.size(); ++k)
    if (seen[k].key == seen[k + 1].key)
      faces.push_back(
          {seen[k].element, seen[k + 1].element, fem::side_nodes(mesh, seen[k].element, seen[k].side)});
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.owner != b.owner ? a.owner < b.owner : a.neighbour < b.neighbour;
  });
  return faces;
}

// Those of a patch in its order. A face on a high side begins with the node opposite the first one of its
// like.
std::vector<Face> faces_of(const fem::Mesh& mesh, const fem::Patch& patch) {
  std::vector<Face> faces;
  for (const fem::Patch::Side& side : patch.sides)
    faces.push_back({side.element, 0, fem::side_nodes(mesh, side.element, side.side)});
  if (patch.kind != fem::Patch::Kind::periodic || !patch.name.ends_with("_high")) return faces;
  const Vec3 step = mesh.cell->shape().edge(patch.name.front() - 'x');
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const fem::Patch::Side& other = mesh.patches[patch.opposite].sides[k];
    const Vec3 first = mesh.nodes[fem::side_nodes(mesh, other.element, other.side)[0]] + step;
    const auto distance = [&](std::size_t node) { return (mesh.nodes[node] - first).norm(); };
    auto& nodes = faces[k].nodes;
    const auto end = nodes.begin() + static_cast<std::ptrdiff_t>(corners_of(nodes));
    std::rotate(nodes.begin(),
                std::min_element(nodes.begin(), end,
                                 [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); }),
                end);
    if (end != nodes.end()) nodes[3] = nodes[2];
  }
  return faces;
}

// The patches' own names as OpenFOAM takes them: words.
std::vector<std::string> names_of(const std::vector<fem::Patch>& patches) {
  constexpr std::size_t longest = 100;
  fem::NameRule rule{.longest = longest, .taken = {"wall", "all", "defaultFaces"}};
  std::vector<std::string> walls;
  for (const fem::Patch& patch : patches)
    if (patch.kind == fem::Patch::Kind::wall)
      walls.push_back(patch.name);
    else
      rule.taken.emplace_back(patch.name);
  std::vector<std::string> names = fem::unique_names(walls, rule);
  for (const fem::Patch& patch : patches)
    if (patch.kind != fem::Patch::Kind::wall) names.push_back(patch.name);
  return names;
}

// Opens the files of the case one after the other; the first failure is kept.
class Case {
 public:
  Case(const fem::Mesh& mesh, const MeshFileOptions& options)
      : mesh_(mesh), options_(options), faces_(inner_faces(mesh)), names_(names_of(mesh.patches)) {
    inner_ = faces_.size();
    for (const fem::Patch& patch : mesh.patches) {
      starts_.push_back(faces_.size());
      const std::vector<Face> more = faces_of(mesh, patch);
      faces_.insert(faces_.end(), more.begin(), more.end());
    }
  }

  Status write() {
    put_mesh("points", "vectorField", [&](TextBuffer& text) { write_points(text); });
    put_mesh("faces", "faceList", [&](TextBuffer& text) {
      write_list(text, faces_.size(), [&](std::size_t k) {
        const fem::ElementSide& n = faces_[k].nodes;
        const std::size_t corners = corners_of(n);
        text << corners;
        for (std::size_t c = 0; c < corners; ++c) text << (c == 0 ? '(' : ' ') << n[c];
        text << ')';
      });
    });
    put_mesh("owner", "labelList", [&](TextBuffer& text) {
      write_list(text, faces_.size(), [&](std::size_t k) { text << faces_[k].owner; });
    });
    put_mesh("neighbour", "labelList", [&](TextBuffer& text) {
      write_list(text, inner_, [&](std::size_t k) { text << faces_[k].neighbour; });
    });
    put_mesh("boundary", "polyBoundaryMesh", [&](TextBuffer& text) { write_boundary(text); });
    put_settings("controlDict", control);
    put_settings("fvSchemes", schemes);
    put_settings("fvSolution", solution);
    return status_;
  }

  [[nodiscard]] std::size_t faces() const { return faces_.size(); }

 private:
  template <class Write>
  void put(std::string_view folder, const std::string& name, std::string_view type, std::string_view note,
           const Write& body) {
    if (!status_) return;
    const Result<OutputFile*> file = options_.open_member(fmt::format("{}/{}", folder, name));
    if (!file) {
      status_ = file.error();
      return;
    }
    TextBuffer text(**file);
    text << "FoamFile\n{\n    version     2.0;\n    format      ascii;\n    class       " << type << ";\n";
    if (!note.empty()) text << "    note        \"" << note << "\";\n";
    text << "    location    \"" << folder << "\";\n    object      " << name << ";\n}\n\n";
    body(text);
    status_ = text.finish();
  }

  template <class Write>
  void put_mesh(const std::string& name, std::string_view type, const Write& body) {
    std::string note;
    if (name == "owner" || name == "neighbour")
      note = fmt::format("nPoints: {} nCells: {} nFaces: {} nInternalFaces: {}", mesh_.nodes.size(),
                         count_cells(mesh_), faces_.size(), inner_);
    put("constant/polyMesh", name, type, note, body);
  }

  void put_settings(const std::string& name, std::string_view words) {
    put("system", name, "dictionary", "", [&](TextBuffer& text) { text << words; });
  }

  template <class Write>
  static void write_list(TextBuffer& text, std::size_t count, const Write& item) {
    text << count << "\n(\n";
    for (std::size_t k = 0; k < count; ++k) {
      item(k);
      text << '\n';
    }
    text << ")\n";
  }

  void write_points(TextBuffer& text) const {
    constexpr double metres = 1e-3;
    write_list(text, mesh_.nodes.size(), [&](std::size_t n) {
      const Vec3 p = metres * mesh_.nodes[n];
      text << '(' << p.x() << ' ' << p.y() << ' ' << p.z() << ')';
    });
  }

  void write_boundary(TextBuffer& text) const {
    text << mesh_.patches.size() << "\n(\n";
    for (std::size_t k = 0; k < mesh_.patches.size(); ++k) {
      const fem::Patch& patch = mesh_.patches[k];
      text << "    " << names_[k] << "\n    {\n";
      if (patch.kind == fem::Patch::Kind::wall)
        text << "        type            wall;\n        inGroups        1(wall);\n";
      if (patch.kind == fem::Patch::Kind::open) text << "        type            patch;\n";
      if (patch.kind == fem::Patch::Kind::periodic)
        text << "        type            cyclic;\n        inGroups        1(cyclic);\n"
             << "        matchTolerance  0.0001;\n        neighbourPatch  " << names_[patch.opposite]
             << ";\n";
      text << "        nFaces          " << patch.sides.size() << ";\n        startFace       " << starts_[k]
           << ";\n    }\n";
    }
    text << ")\n";
  }

  const fem::Mesh& mesh_;
  const MeshFileOptions& options_;
  std::vector<Face> faces_;  // those inside, then patch by patch
  std::vector<std::string> names_;
  std::size_t inner_ = 0;
  std::vector<std::size_t> starts_;
  Status status_;
};

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& options) {
  if (mesh.patches.empty() || mesh.order != 1 || !options.open_member)
    return error(Kind::unsupported, "OpenFOAM's case holds a pore space (--pores) of order 1, in a folder");
  Case the_case(mesh, options);
  if (Status written = the_case.write(); !written) return written.error();
  TextBuffer text(output);
  text << "An OpenFOAM case by Selvage: ParaView opens it by this file.\n";
  return finished(text, {{"points", mesh.nodes.size()},
                         {"cells", count_cells(mesh)},
                         {"faces", the_case.faces()},
                         {"patches", mesh.patches.size()}});
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "foam",
                                  .title = "OpenFOAM case, the pore space of a unit cell as a polyMesh",
                                  .extensions = {".foam"},
                                  .write_mesh = write,
                                  .order_of_pores = 1,
                                  .is_of_pores = true,
                                  .has_layers = true,
                                  .folders = {"constant/polyMesh", "system"}};
  return self;
}

}  // namespace selvage::formats::foam
