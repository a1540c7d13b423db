#include "formats/registry.h"

#include <array>
#include <bit>
#include <limits>
#include <optional>

#include "core/text_buffer.h"
#include "core/xml_text.h"
#include "fem/quality.h"
#include "formats/vtu/encoding.h"
#include "formats/vtu/reader.h"

namespace selvage::formats::vtu {
namespace {

template <class T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, float>) return "Float32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  return "UInt8";
}

template <class T>
void write_array(TextBuffer& text, std::string_view name, const std::vector<T>& values, int components = 1) {
  const Result<std::string> encoded = encode(values.data(), values.size() * sizeof(T));
  if (!encoded) return text.fail(encoded.error());
  text << "        <DataArray type=\"" << type_name<T>() << "\" Name=\"" << name << "\"";
  if (components > 1) text << " NumberOfComponents=\"" << components << '"';
  text << " format=\"binary\">\n" << *encoded << "\n        </DataArray>\n";
}

std::vector<double> flat(const std::vector<Vec3>& vectors) {
  std::vector<double> result;
  result.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) result.insert(result.end(), {v.x(), v.y(), v.z()});
  return result;
}

struct Cells {
  std::vector<std::int64_t> connectivity, offsets;  // point indices; where each cell's end
  std::vector<std::uint8_t> types;                  // VTK's

  template <class Nodes>
  void add(std::uint8_t type, const Nodes& nodes) {
    for (const auto node : nodes) connectivity.push_back(static_cast<std::int64_t>(node));
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    types.push_back(type);
  }
  [[nodiscard]] std::size_t count() const { return types.size(); }
};

void write_cells(TextBuffer& text, const Cells& cells) {
  write_array(text, "connectivity", cells.connectivity);
  write_array(text, "offsets", cells.offsets);
  write_array(text, "types", cells.types);
}

Cells cells_of(const fem::Mesh& mesh) {
  // Hexahedra, tetrahedra of 4 and 10 nodes, in the order of ours. Of a wedge VTK wants the first triangle
  // counter-clockwise seen from outside.
  constexpr std::uint8_t wedge = 13;
  const int type = mesh.shape == fem::Mesh::Shape::hexahedron ? 12 : mesh.order == 1 ? 10 : 24;
  Cells cells;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const std::vector<std::size_t> n = mesh.different_nodes_of(e);
    if (mesh.is_wedge(e))
      cells.add(wedge, std::array{n[0], n[2], n[1], n[3], n[5], n[4]});
    else
      cells.add(static_cast<std::uint8_t>(type), n);
  }
  return cells;
}

using Nodes = std::array<std::size_t, 6>;

// Of cohesive interfaces: wedges of 6 or 12 nodes. The linear one begins with a triangle that is seen
// clockwise from the other one; that of twelve nodes is as ours, the midpoints of both triangles behind all
// corners.
void add_wedges(Cells& cells, const fem::Mesh& mesh) {
  for (const fem::Interface& interface : mesh.interfaces)
    for (const fem::FacingSides& facing : interface.sides) {
      const Nodes &p = facing.first.nodes, &q = facing.second.nodes;
      if (mesh.order == 1)
        cells.add(13, std::array{p[0], p[2], p[1], q[0], q[2], q[1]});
      else
        cells.add(31, std::array{p[0], p[1], p[2], q[0], q[1], q[2], p[3], p[4], p[5], q[3], q[4], q[5]});
    }
}

// Of surfaces: triangles of 3 or 6 nodes, of each interface those of its first region, then of its second.
void add_triangles(Cells& cells, const fem::Mesh& mesh) {
  for (const fem::Interface& interface : mesh.interfaces)
    for (const auto which : {&fem::FacingSides::first, &fem::FacingSides::second})
      for (const fem::FacingSides& facing : interface.sides) {
        const Nodes& n = (facing.*which).nodes;
        if (mesh.order == 1)
          cells.add(5, std::array{n[0], n[1], n[2]});
        else
          cells.add(22, n);
      }
}

// Of each of these cells its interface, and the region whose side it is; none: a wedge.
struct OfInterfaces {
  std::vector<std::int32_t> interface;
  std::vector<std::optional<std::size_t>> region;
};

OfInterfaces of_interfaces(const fem::Mesh& mesh) {
  OfInterfaces result;
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    const fem::Interface& one = mesh.interfaces[i];
    const auto add = [&](std::optional<std::size_t> region) {
      result.interface.insert(result.interface.end(), one.sides.size(), static_cast<std::int32_t>(i));
      result.region.insert(result.region.end(), one.sides.size(), region);
    };
    if (mesh.joining == fem::Joining::cohesive) {
      add(std::nullopt);
      continue;
    }
    add(one.first);
    add(one.second);
  }
  return result;
}

// A voxel has no quality to speak of. `more`: cells that have none.
void write_quality(TextBuffer& text, const fem::Mesh& mesh, std::size_t more) {
  if (mesh.shape == fem::Mesh::Shape::hexahedron && mesh.cell) return;
  std::vector<float> jacobians, angles, aspects;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const fem::ElementShape shape = fem::shape_of(mesh, e);
    jacobians.push_back(static_cast<float>(shape.scaled_jacobian));
    angles.push_back(static_cast<float>(shape.min_dihedral));
    aspects.push_back(static_cast<float>(shape.aspect));
  }
  for (auto* values : {&jacobians, &angles, &aspects})
    values->insert(values->end(), more, std::numeric_limits<float>::quiet_NaN());
  write_array(text, "scaled_jacobian", jacobians);
  write_array(text, "min_dihedral", angles);
  write_array(text, "aspect", aspects);
}

void write_cell_data(TextBuffer& text, const fem::Mesh& mesh) {
  std::vector<std::int32_t> yarns(mesh.elements.size(), -1), materials;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    if (mesh.regions[i].kind == fem::Region::Kind::yarn)
      for (std::size_t e = mesh.regions[i].first_element; e < mesh.regions[i].last_element; ++e)
        yarns[e] = static_cast<std::int32_t>(i);
  materials.assign(mesh.element_material.begin(), mesh.element_material.end());
  std::vector<Vec3> along = mesh.along, across = mesh.across;
  std::vector<double> fractions = mesh.fibre_fraction;
  OfInterfaces others = of_interfaces(mesh);
  // Layers of wedges are no interfaces.
  const std::size_t wedges = mesh.layers.wedges.size();
  others.interface.insert(others.interface.end(), wedges, -1);
  others.region.resize(others.region.size() + wedges);
  const std::size_t more = others.interface.size(), all = mesh.elements.size() + more;
  for (const std::optional<std::size_t>& region : others.region) {
    const bool is_yarns = region && mesh.regions[*region].kind == fem::Region::Kind::yarn;
    yarns.push_back(is_yarns ? static_cast<std::int32_t>(*region) : -1);
  }
  along.resize(all, Vec3::Zero());
  across.resize(all, Vec3::Zero());
  if (!fractions.empty()) fractions.resize(all, 0.0);
  if (!materials.empty()) materials.resize(all, -1);
  write_array(text, "yarn", yarns);
  write_array(text, "along", flat(along), 3);
  write_array(text, "across", flat(across), 3);
  if (!fractions.empty()) write_array(text, "fibre_fraction", fractions);
  if (!materials.empty()) write_array(text, "material", materials);
  if (more > wedges) {
    others.interface.insert(others.interface.begin(), mesh.elements.size(), -1);
    write_array(text, "interface", others.interface);
  }
  write_quality(text, mesh, more);
}

// Two hyphens would end a comment.
std::string comment_text(std::string name) {
  for (std::size_t i = 1; i < name.size(); ++i)
    if (name[i] == '-' && name[i - 1] == '-') name[i] = '_';
  if (!name.empty() && name.back() == '-') name.back() = '_';
  return name;
}

// An array for each, which is called like it and holds its number: programs that read arrays of numbers alone
// have the names, too.
void write_names(TextBuffer& text, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    text << "      <DataArray type=\"Int32\" Name=\"" << xml_text(names[i])
         << "\" NumberOfTuples=\"1\" format=\"ascii\">" << i << "</DataArray>\n";
}

// The file up to its data; `names`: of the yarns, and of interfaces.
void write_grid(TextBuffer& text, const std::vector<std::string>& names,
                const std::vector<std::string>& interfaces, const std::vector<Vec3>& points,
                const Cells& cells) {
  text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  for (std::size_t i = 0; i < names.size(); ++i)
    text << "<!-- yarn " << i << ": " << comment_text(names[i]) << " -->\n";
  for (std::size_t i = 0; i < interfaces.size(); ++i)
    text << "<!-- interface " << i << ": " << comment_text(interfaces[i]) << " -->\n";
  text << "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\""
       << (std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian")
       << "\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
       << "  <UnstructuredGrid>\n";
  if (!names.empty() || !interfaces.empty()) {
    text << "    <FieldData>\n";
    write_names(text, names);
    write_names(text, interfaces);
    text << "    </FieldData>\n";
  }
  text << "    <Piece NumberOfPoints=\"" << points.size() << "\" NumberOfCells=\"" << cells.count()
       << "\">\n      <Points>\n";
  write_array(text, "Points", flat(points), 3);
  text << "      </Points>\n      <Cells>\n";
  write_cells(text, cells);
  text << "      </Cells>\n";
}

Result<WriteFacts> finish(TextBuffer& text, std::size_t points, std::size_t cells) {
  text << "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
  return finished(text, {{"points", points}, {"cells", cells}});
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& /*options*/) {
  TextBuffer text(output);
  std::vector<std::string> names;
  for (const fem::Region& region : mesh.regions)
    if (region.kind == fem::Region::Kind::yarn) names.push_back(region.name);
  std::vector<std::string> interfaces;
  for (const fem::Interface& interface : mesh.interfaces)
    interfaces.push_back(mesh.regions[interface.first].name + " and " + mesh.regions[interface.second].name);
  Cells cells = cells_of(mesh);
  (mesh.joining == fem::Joining::cohesive ? add_wedges : add_triangles)(cells, mesh);
  for (const auto& n : mesh.layers.wedges) cells.add(13, std::array{n[0], n[2], n[1], n[3], n[5], n[4]});
  write_grid(text, names, interfaces, mesh.nodes, cells);
  text << "      <CellData Scalars=\"yarn\">\n";
  write_cell_data(text, mesh);
  text << "      </CellData>\n";
  return finish(text, mesh.nodes.size(), cells.count());
}

Result<WriteFacts> write_gaps(const solid::GapMap& map, OutputFile& output) {
  constexpr std::uint8_t triangle = 5;
  std::vector<Vec3> points;
  std::vector<double> gaps;
  std::vector<std::int32_t> yarns;
  Cells cells;
  for (std::size_t k = 0; k < map.skins.size(); ++k) {
    const contact::SkinMesh& skin = map.skins[k];
    const auto first = static_cast<std::int64_t>(points.size());
    points.insert(points.end(), skin.vertices.begin(), skin.vertices.end());
    gaps.insert(gaps.end(), map.gaps[k].begin(), map.gaps[k].end());
    yarns.insert(yarns.end(), skin.triangles.size(), static_cast<std::int32_t>(k));
    for (const auto& t : skin.triangles)
      cells.add(triangle, std::array{first + t[0], first + t[1], first + t[2]});
  }
  TextBuffer text(output);
  write_grid(text, map.names, {}, points, cells);
  text << "      <PointData Scalars=\"gap\">\n";
  write_array(text, "gap", gaps);
  text << "      </PointData>\n      <CellData>\n";
  write_array(text, "yarn", yarns);
  text << "      </CellData>\n";
  return finish(text, points.size(), cells.count());
}

bool is_a_vtk_grid(std::string_view head) {
  return head.find("<VTKFile") != std::string_view::npos &&
         head.find("UnstructuredGrid") != std::string_view::npos;
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "vtu",
                                  .title = "VTK unstructured grid",
                                  .extensions = {".vtu"},
                                  .sniff = is_a_vtk_grid,
                                  .read_mesh = read_mesh,
                                  .write_mesh = write,
                                  .order_of_surfaces = 2,
                                  .order_of_cohesive = 2,
                                  .order_of_pores = 2,
                                  .has_layers = true,
                                  .write_gap_map = write_gaps};
  return self;
}

}  // namespace selvage::formats::vtu
